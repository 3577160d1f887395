// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "delfront/context.hpp"
#include "delfront/metric.hpp"
#include "sizing/simplex_grid.hpp"

namespace delfront {

/// @return the slope that a growth factor allows: (growth - 1) / growth
inline double slope_of(double growth) { return 1 - 1 / growth; }

/// @brief A triangle (a segment repeats its end) and the sizes at its corners, linear between them.
struct SizedFace {
  std::array<Point, 3> corner;
  std::array<double, 3> size;
};

/// @return the least of size(q) + slope |p - q| over the points q of a segment or a triangle, exact to rounding
double least_cone_on_segment(Point p, Point a, Point b, double size_a, double size_b, double slope);
double least_cone_on_face(Point p, const SizedFace& face, double slope);
/// @brief The same over the boundary of a cell.
double least_cone_on_cell(Point p, const SimplexGrid& grid, std::size_t cell, const std::vector<double>& size,
                          double slope);

/// @brief Cells in which the linear field rises with more than `slope`, ascending.
std::vector<std::uint32_t> find_steep_cells(const SimplexGrid& grid, const std::vector<double>& size, double slope);

/// @brief Intersects the metrics along the edges: what one end allows at the other is its own metric with all three
/// sizes larger by slope times the length of the edge. Stops at changes below 1e-6 of a size.
/// @return how many nodes were changed
/// @par Source  Alauzet (2010), h-growth in physical space
std::size_t limit_metric_growth(const SimplexGrid& grid, double slope, std::vector<Metric>& metric, Context& context);

}  // namespace delfront
