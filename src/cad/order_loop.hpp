// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "delfront/brep.hpp"

namespace delfront::cad {

/// @brief One side of a loop as it lies in the parameter plane.
struct LoopSide {
  Point2 begin, end;
  std::array<CornerId, 2> corners;  ///< at begin and end
};

/// @brief The order in which sides go on into each other: by corners, and of several by the nearest place in the plane,
/// as the two ways along a seam have the same corners.
/// @param extent  of the face in the plane: what is near along u and v
/// @return numbers of sides; one list a closed loop
std::vector<std::vector<std::size_t>> order_loop(const std::vector<LoopSide>& sides, Point2 extent);

}  // namespace delfront::cad
