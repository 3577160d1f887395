// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "brep/face_grid.hpp"

namespace delfront {

/// @brief Mark points of a border where the surface's normal says nothing of triangles as long as the border's sides:
/// most of what is some way off on the surface faces against it.
///
/// So it is where the mapping folds (du x dv passes through 0 and turns round) and along lips that are sharper than the
/// sides are long.
void mark_vague_normals(const SmoothSurface& surface, FaceGrid& border);

/// @brief Whether normals turn round from one point of a border to the next: what even charts make of such a face may
/// fold.
bool turns_round(const SmoothSurface& surface, const FaceGrid& border);

}  // namespace delfront
