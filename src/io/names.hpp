// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <vector>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief What a format lets a name contain.
enum class NameRule {
  line,       ///< no control characters, not empty (VTK XML, PLY, STL, OBJ, medit comments)
  quoted,     ///< as line, and no double quotes (MSH)
  word,       ///< as line, and no blanks nor any of !%=,;()"'{} (SU2, UGRID's .mapbc)
  foam_word,  ///< letters, digits, '_', '-', '.', beginning with a letter or '_' (OpenFOAM, Fluent)
  any_case,   ///< as foam_word, and large and small letters are the same (Abaqus)
  hdf5,       ///< as line, without '/', not "." nor ".." (VTKHDF)
  cgns        ///< as hdf5, and at most 32 characters (CGNS)
};

/// @brief The name of each group as the format holds it, unique among those of one dimension (numbered _2, _3, …).
///
/// Empty names become "patch", "region", "curve" or "point".
/// @param[in,out] notes  a sentence for each name that changed
/// @param written        dimensions of the groups that the format holds: of others nothing is said
std::vector<std::string> fit_names(const Mesh& mesh, NameRule rule, const char* format, std::vector<std::string>& notes,
                                   std::array<int, 2> written = {0, 3});

}  // namespace delfront
