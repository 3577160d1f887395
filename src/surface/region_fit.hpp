// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/size_field.hpp"
#include "surface/region_mesh.hpp"

namespace delfront {

/// @brief Collapse inner sides under `least` of the wanted size, split those over `most` of it, where that is valid.
/// @return changes made
std::size_t fit_lengths(RegionMesh& mesh, const SurfaceSupport& support, const SizeField& size, double least,
                        double most);

/// @brief What follows the front: flips, points moved along the surface, sides that are far too long or short mended.
/// @param to_delaunay  flip to the end
void improve_region(RegionMesh& mesh, const SurfaceSupport& support, const SizeField& size, bool to_delaunay);

}  // namespace delfront
