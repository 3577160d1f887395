// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "delfront/point.hpp"
#include "predicates/predicates.hpp"

namespace delfront {

/// @brief A triangle by its exact corners, normal towards the side that is to see it.
using Wall = std::array<ExactPoint, 3>;

/// @brief The worst mean ratio of the tets between the walls and p; 0 where one of them is not positive.
double measure_worst_ratio(const std::vector<Wall>& walls, Point p);

/// @brief A place that lies strictly in front of all walls, so that tets from it to them are positive.
///
/// Searched from `start`, whose neighbourhood is expected to hold one, along each direction at ever smaller steps, then
/// moved uphill in the worst mean ratio of the tets. `at_any_cost`: thin places that only relaxation finds will do too.
std::optional<Point> find_visible_point(const std::vector<Wall>& walls, Point start,
                                        const std::vector<Point>& directions, double reach, bool at_any_cost = false);

}  // namespace delfront
