// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "brep/face_grid.hpp"

namespace delfront {

/// @brief Sides of the loops, as what a grid of the face keeps: lower vertex * 2^32 + higher, sorted.
std::vector<std::uint64_t> kept_sides_of(const FaceGrid& border);

/// @brief Lift angles that are too small, wherever they are in a face: sides flipped, points moved along the
/// surface, short sides collapsed.
///
/// Works on the few triangles round them, directly in space: across the seams of charts, and where there is none. No
/// operation lowers the smallest angle that it touches, or turns a triangle by much.
/// @param kept_sides  as kept_sides_of() makes them
void lift_small_angles(const SmoothSurface& surface, const std::vector<std::uint64_t>& kept_sides, FaceGrid& grid);

}  // namespace delfront
