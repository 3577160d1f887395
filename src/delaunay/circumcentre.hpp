// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "delfront/point.hpp"

namespace delfront {

/// @brief Centre of the sphere through the corners of a positive tetrahedron, however flat: from exact integers where
/// plain arithmetic would be wrong by more than 2e-13 of the tet's largest extent; otherwise by no more than that. The
/// exact one is rounded three times: relative to corner d, and on being added to it.
Point circumcentre(Point a, Point b, Point c, Point d);

/// @brief Centre of the circle through the corners of a triangle in the plane that is not flat, likewise.
std::array<double, 2> circumcentre2(const std::array<double, 2>& a, const std::array<double, 2>& b,
                                    const std::array<double, 2>& c);

}  // namespace delfront
