// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/mesh.hpp"
#include "refine/mid_points.hpp"

namespace delfront {

/// @brief The coarse grid's fields on the finer one, whose blocks stand: of vertices by linear interpolation, of cells
/// those of the parents.
void carry_fields(const Mesh& coarse, const MidPoints& mids, Mesh& fine, int threads);

}  // namespace delfront
