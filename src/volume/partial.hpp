// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/mesh.hpp"
#include "delfront/model.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief The grid as far as it came, to look at: all tets between vertices of the model and points on its edges, in
/// one region "unfinished"; the model's triangles by patch, those that are no face of a tet in a patch
/// "missing_or_divided".
///
/// No valid grid: what lies outside may be there too, and triangles may be divided or crossed.
/// @param complex  in any state; the eight vertices after the model's are not the model's
/// @par Cost  O(n log n)
Mesh mesh_unfinished(const TetComplex& complex, const Model& model);

}  // namespace delfront
