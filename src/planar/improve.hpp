// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "planar/constrain.hpp"

namespace delfront {

struct PlanarImproveOptions {
  double min_angle = 30;  ///< degrees: triangles below it are worked on
  int max_passes = 8;
  VertexIndex first_free = 0;  ///< vertices before it are given: they stay
};

/// @brief Raise angles below the goal: move points, insert and remove some, flip edges (T5).
///
/// No operation lowers the smallest angle of the triangles it touches. Given points and constrained edges stay.
/// Angles between two constrained edges are the input's, and left alone.
/// @return min_dihedral_*_deg: smallest angles, degrees; below_goal_forced: at a corner between
/// constrained edges, or with given points at all corners
ImproveReport improve_complex(PlanarGrid& grid, const PlanarImproveOptions& options, Context& context);

}  // namespace delfront
