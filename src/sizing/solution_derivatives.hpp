// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/solution_metric.hpp"
#include "sizing/simplex_grid.hpp"

namespace delfront {

/// @brief Of each vertex an equal part of the volume (area) of its cells.
std::vector<double> lumped_volumes(const SimplexGrid& grid);

/// @throws InputError  too few nodes to fit a quadratic
NodeDerivatives recover_derivatives(const SimplexGrid& grid, const std::vector<double>& values, Recovery recovery,
                                    Context& context);

/// @brief A symmetric tensor's eigenvalues (in the plane two) and directions, the third then along z.
struct Principal {
  std::array<double, 3> value{};
  std::array<Point, 3> direction{};
};
Principal principal_axes(const Metric& tensor, int dimension);
/// @brief The tensor with these; in the plane zz is the greater of the two values.
Metric tensor_of(const Principal& axes, int dimension);

}  // namespace delfront
