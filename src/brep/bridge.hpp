// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "delfront/brep.hpp"

namespace delfront {

/// @brief A surface grid, and where on the Brep each of its points and corners of triangles lies.
struct BrepGrid {
  Model model;
  std::vector<VertexEntity> entity;              ///< by point
  std::vector<std::array<Point2, 3>> corner_uv;  ///< by triangle
};

/// @brief Grid across what is too narrow for its triangles: tiny edges, sliver faces, borders that touch (virtual
/// topology).
///
/// Where a triangle has a small angle, points closer than `below` become one of them, and a triangle lower than that,
/// with its longest side on a border, is folded onto it: the border then runs through its third corner. No point moves.
/// Done only where the smallest angle round it rises, triangles keep facing as their surface, neighbours do not fold
/// onto each other, and connections stay those of the geometry (link condition, Dey and others 1999).
/// @param below  how far geometry may be moved, > 0
/// @return one a place, in the order of the work
/// @par Cost O(n) to look, little where there is nothing
std::vector<BrepBridge> bridge_narrow_parts(const Brep& brep, double below, BrepGrid& grid, const Context& context);

}  // namespace delfront
