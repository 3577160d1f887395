// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief One or two cells (of a facet) with their neighbours, seen along the sharpest edge of the first.
struct CellPicture {
  std::string svg;                   ///< empty: no such cell, or one without a fixed shape
  std::vector<std::string> touches;  ///< names of boundaries that have a facet of these cells
};

/// @brief Pictures of cells of the highest dimension.
/// @param picks  by picture, numbers of cells in the order in which the grid stores them
/// @par Cost  two sweeps over the cells, whatever the number of pictures
std::vector<CellPicture> draw_cells(const Mesh& mesh, const std::vector<std::vector<std::uint32_t>>& picks);

}  // namespace delfront
