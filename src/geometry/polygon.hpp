// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

/// @brief Cut a polygon into num_corners - 2 triangles by ear clipping; corners keep their turning sense.
///
/// The polygon may be slightly warped: it is seen along the axis that its area vector is nearest to. Best ears (by
/// their smallest angle) go first. A corner that lies straight between its neighbours never makes a flat triangle: it
/// splits the triangle that gets its side. Where no such cut exists (the polygon crosses itself or has no area), a fan
/// comes out, for the surface check to name.
/// @param corners  at least 3
/// @return corner numbers, three a triangle
/// @par Cost    O(n^2) for usual polygons
/// @par Source  Meisters (1975), "Polygons have ears"; the rule for straight corners is ours
std::vector<std::array<int, 3>> triangulate_polygon(std::span<const Point> corners);

}  // namespace delfront
