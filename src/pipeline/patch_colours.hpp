// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

#include "delfront/brep.hpp"
#include "delfront/cad.hpp"
#include "delfront/model.hpp"

namespace delfront {

/// @brief RRGGBB by name; empty: there are several under that name, or faces without one.
using ColoursByName = std::map<std::string, std::string>;

/// @brief Take up the colours of a CAD file's faces, by the names they have now.
/// @param stem  what faces without a name are called
void add_face_colours(const Brep& brep, const CadReport& cad, const std::string& stem, ColoursByName& colours);

/// @brief Which patch each triangle was in, under which name.
struct PatchesBefore {
  explicit PatchesBefore(const Model& model);
  std::vector<std::string> names;
  Array<TriangleId, PatchId> patch_of_triangle;
};

/// @brief Colours by the names that patches have after they were named and merged; patches of several are left out.
ColoursByName colours_after(const PatchesBefore& before, const Model& model, const ColoursByName& colours);

}  // namespace delfront
