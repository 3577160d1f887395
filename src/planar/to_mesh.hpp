// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "planar/constrain.hpp"

namespace delfront {

/// @brief The grid's kept triangles as a 2-D Mesh: regions are groups of dimension 2, curves groups of dimension 1.
///
/// Given points first, as they came, the others along the Hilbert curve. Lines have the region with the lower colour on
/// their left. A curve with both one-sided and two-sided lines becomes two groups.
Mesh to_mesh(const PlanarGrid& grid, const PlanarDomain& domain);

}  // namespace delfront
