// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "surface/front.hpp"
#include "surface/line_points.hpp"
#include "surface/parts.hpp"

namespace delfront {

/// @brief The regions' grids as one model; triangles stand region by region, input_face is their number.
struct AssembledSurface {
  Model model;
  std::vector<std::uint32_t> region_of_triangle;
};

AssembledSurface assemble(const SurfaceParts& parts, const LinePoints& lines, const std::vector<RegionBorder>& borders,
                          const std::vector<RegionGrid>& grids);

}  // namespace delfront
