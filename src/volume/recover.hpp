// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/model.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief A tetrahedrization whose faces include every given triangle, vertex for vertex, with regions coloured (T2).
///
/// @return the complex: vertices 0 … n-1 are the model's points, in order; every triangle of the model is a face
/// flagged constrained (or, where report.left says so, a union of such faces); tets outside every kept region are
/// kOutside
/// @pre check_surface(model) finds no error
/// @throws MeshingError with the places
TetComplex tetrahedralize_boundary(const Model& model, RecoveryReport& report, Context& context);

}  // namespace delfront
