// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "delfront/planar.hpp"

namespace delfront::fixtures {

/// @brief Add a loop of points to a domain, in their order, as a curve of its own.
inline void add_loop(PlanarDomain& domain, const std::vector<Point2>& loop, const std::string& name,
                     const std::string& kind = "") {
  const CurveId curve = domain.curves.next_id();
  domain.curves.push_back({name, kind});
  const std::size_t first = domain.points.size();
  for (const Point2 p : loop) domain.points.push_back(p);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    domain.segments.push_back({VertexId(first + i), VertexId(first + (i + 1) % loop.size())});
    domain.curve_of_segment.push_back(curve);
  }
}

/// @brief n points on a circle, anticlockwise; clockwise for a negative radius.
inline std::vector<Point2> circle(Point2 centre, double radius, int n) {
  std::vector<Point2> loop;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    loop.push_back({centre.x + std::abs(radius) * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
  return loop;
}

/// @brief The square [0, 1]^2 with n segments a side, anticlockwise.
inline std::vector<Point2> square(int n) {
  std::vector<Point2> loop;
  for (int i = 0; i < n; ++i) loop.push_back({double(i) / n, 0});
  for (int i = 0; i < n; ++i) loop.push_back({1, double(i) / n});
  for (int i = 0; i < n; ++i) loop.push_back({1 - double(i) / n, 1});
  for (int i = 0; i < n; ++i) loop.push_back({0, 1 - double(i) / n});
  return loop;
}

inline double area_of(const std::vector<Point2>& loop) {
  double area = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Point2 a = loop[i], b = loop[(i + 1) % loop.size()];
    area += 0.5 * ((a.x - loop[0].x) * (b.y - loop[0].y) - (b.x - loop[0].x) * (a.y - loop[0].y));
  }
  return area;
}

/// @brief A star-shaped polygon round a centre with radii from low to high: anticlockwise, never crosses itself.
inline std::vector<Point2> star(std::mt19937_64& random, Point2 centre, double low, double high, int n) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point2> loop;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.8 * unit(random)) / n, r = low + (high - low) * unit(random);
    loop.push_back({centre.x + r * std::cos(angle), centre.y + r * std::sin(angle)});
  }
  return loop;
}

inline std::vector<Point2> reversed(std::vector<Point2> loop) { return {loop.rbegin(), loop.rend()}; }

}  // namespace delfront::fixtures
