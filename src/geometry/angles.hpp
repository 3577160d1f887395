// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "delfront/point.hpp"

namespace delfront {

constexpr double kDegree = std::numbers::pi / 180;

/// @brief In radians, 0 to pi; 0 where a vector is nothing.
inline double angle_between(Point a, Point b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

/// @brief Of the triangle's three, in degrees.
inline double smallest_angle_deg(Point a, Point b, Point c) {
  return std::min({angle_between(b - a, c - a), angle_between(c - b, a - b), angle_between(a - c, b - c)}) / kDegree;
}

/// @brief Squared sine of the triangle's smallest angle: what compares angles without inverse functions. 0 where flat.
inline double smallest_squared_sine(Point a, Point b, Point c) {
  const Point u = b - a, v = c - b, w = a - c;
  const double u2 = squared_length(u), v2 = squared_length(v), w2 = squared_length(w);
  const double shortest = std::min({u2, v2, w2});
  const double product = shortest == u2 ? v2 * w2 : shortest == v2 ? u2 * w2 : u2 * v2;
  return product > 0 ? squared_length(cross(u, v)) / product : 0;
}

/// @brief The smallest angles of triangles, in degrees, summed up.
struct SmallestAngles {
  std::size_t triangles = 0, below_25_deg = 0;
  double min_deg = 180, sum_deg = 0;

  void add(double angle_deg) {
    ++triangles;
    below_25_deg += angle_deg < 25;
    min_deg = std::min(min_deg, angle_deg);
    sum_deg += angle_deg;
  }
  double mean_deg() const { return triangles > 0 ? sum_deg / double(triangles) : 0; }
};

}  // namespace delfront
