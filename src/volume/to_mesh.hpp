// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/mesh.hpp"
#include "delfront/model.hpp"
#include "volume/recover.hpp"

namespace delfront {

/// @brief The finished grid: tets by region, the boundary's triangles by patch, vertices of the model first.
///
/// Model vertices that bound nothing that is kept are left out; the order of the others stays. Boundary faces point out
/// of the region with the lower id; those with cells on both sides belong to a group that says so.
Mesh to_mesh(const BoundaryGrid& grid, const Model& model);

}  // namespace delfront
