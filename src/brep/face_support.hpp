// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "brep/face_grid.hpp"

namespace delfront {

/// @brief A fine triangulation of a face: what stands for it where its mapping is no good, with parameters.
///
/// Seams are closed and poles are single points in it. Its border runs through the points of the edges.
struct FaceSupport {
  Model model;                                   ///< one patch, no features
  std::vector<std::array<Point2, 3>> corner_uv;  ///< by triangle, unwrapped
};

/// @brief Constrained Delaunay triangulation of the loops and of a lattice inside, fine enough for the surface's turns.
/// @throws InputError  loops that cross in the parameter plane
FaceSupport make_face_support(const Brep& brep, const BrepFace& face, const Array<EdgeId, EdgePoints>& edges,
                              Context& context);

}  // namespace delfront
