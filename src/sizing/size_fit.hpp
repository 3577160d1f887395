// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/context.hpp"
#include "delfront/grid_check.hpp"
#include "delfront/mesh.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief Compare every edge of the cells of the highest dimension with the size wanted at its middle.
/// @param size  isotropic, and the one that the grid was made to
/// @throws Cancelled, LimitError
/// @par Threads  the same for any number
/// @par Cost  that of one size an edge; memory as FacetSweep
SizeFit measure_size_fit(const Mesh& mesh, const SizeField& size, const Context& context);

}  // namespace delfront
