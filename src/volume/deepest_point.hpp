// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

/// @brief A plane by a place on it and its normal (any length but 0).
struct HalfSpace {
  Point at, normal;
};

struct DeepestPoint {
  Point at;
  double depth = 0;  ///< least distance in front of the planes; negative: no place is in front of all
};

/// @brief The place that lies deepest in front of all planes, within a cube round them; ties in no certain way.
///
/// Where walls of a cavity have a kernel, it is in it: a linear program with four unknowns, solved plane by plane.
/// In doubles, so that what depends on it needs an exact test.
/// @par Cost    O(n), expected over the order of the planes, which is mixed in a fixed way
/// @par Source  Seidel (1991)
DeepestPoint find_deepest_point(const std::vector<HalfSpace>& planes);

}  // namespace delfront
