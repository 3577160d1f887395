// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/mesh.hpp"
#include "delfront/model.hpp"
#include "volume/recover.hpp"

namespace delfront {

/// @brief The finished grid: tets by region, the boundary's triangles by patch, vertices of the model first.
///
/// Model vertices that bound nothing that is kept are left out; the order of the others stays. Boundary faces point out
/// of the region with the lower id; those with cells on both sides belong to a group that says so. Curves are lines,
/// corners vertex cells, each in a group of its name.
/// @param[in] grid  hand it over (std::move): its arrays are freed while the mesh grows, so that the two are never
/// there in full together
/// @par Threads  the same mesh for any number
Mesh to_mesh(BoundaryGrid grid, const Model& model, int threads = 1);

}  // namespace delfront
