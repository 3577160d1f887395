// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/findings.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

/// @brief What the page shows.
struct PageInput {
  std::string name;               ///< of the file
  const Mesh* mesh = nullptr;     ///< a grid in space or in the plane, or a surface
  bool is_grid = true;            ///< false: a surface to be gridded
  std::vector<Finding> findings;  ///< shown as markers and outlines
};

/// @brief A grid as the page takes it: "DFVIEW1\0", the header's length (u32, and 0), a JSON header, arrays.
///
/// Little-endian; points are float32 relative to the header's `centre`, vertices and groups uint32, values float32. The
/// header tells type, place and length of each array (docs/viewer.md).
/// @param is_compact  arrays are ordered to compress well, and values rounded to 11 significant bits (0.05 %)
/// @throws InputError  a cell names a point that is not there
/// @par Cost  O(n); about 100 bytes a tetrahedron while it runs
std::string make_page_data(const PageInput& input, bool is_compact, Context& context);

/// @brief The findings in a file that write_defects() wrote: kinds, severities, places, outlines.
/// @throws InputError  unreadable, or no file of defects
std::vector<Finding> read_defects(const std::string& path, Context& context);

}  // namespace delfront
