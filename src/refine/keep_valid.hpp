// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "refine/boundary_points.hpp"
#include "refine/cell_splitter.hpp"

namespace delfront {

/// @brief See that all children are positive at every corner, by exact predicates, and those with moved points not
/// squashed: tetrahedra take another inner diagonal where that helps; else the moved points of a bad child go half the
/// way back, then all of it.
///
/// @param[in,out] fine   the divided grid; its moved points stand at their places
/// @param[in,out] moved  ascending; `halves` says where they stand in the end
/// @param least_share    of each corner's volume with points in the middle
/// @throws MeshingError  a child that is not positive though none of its points was moved
void keep_valid(const Mesh& coarse, const MidPoints& mids, CellSplitter& splitter, Mesh& fine,
                std::vector<MovedPoint>& moved, double least_share, Context& context);

}  // namespace delfront
