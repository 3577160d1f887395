// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "planar/constrain.hpp"

namespace delfront {

struct PlanarSmoothOptions {
  int passes = 5;
  VertexIndex first_free = 0;  ///< vertices before it are given: they stay
};

/// @brief Even out what a front has left where its layers met (F18): flips and moves of the points put in.
///
/// A point moves to the mean of the places from which its opposite edges would be seen as in a regular triangle, where
/// that raises the mean quality of its triangles and lowers the worst angle below neither what it was nor 40 degrees.
/// Points with regular triangles round them are passed over. Edges are made Delaunay before and after.
/// @pre complex.vertex_tri is filled  @post complex.find_defect() is empty
/// @return points moved, edges flipped, the smallest angle before and after
/// @par Cost    about 0.1 microseconds a triangle
/// @par Source  mean of ideal places: Zhou & Shimada (2000)
ImproveReport smooth_complex(PlanarGrid& grid, const PlanarSmoothOptions& options, Context& context);

}  // namespace delfront
