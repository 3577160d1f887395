// SPDX-License-Identifier: Apache-2.0
#pragma once
// Small point sets on which the definition of a tetrahedrization can be tested by brute force, and which are hard for
// it.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "delfront/point.hpp"

namespace delfront::point_sets {

struct NamedSet {
  std::string name;
  std::vector<Point> points;
};

inline std::vector<Point> random_points(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> points;
  for (std::size_t i = 0; i < n; ++i) points.push_back({uniform(random), uniform(random), uniform(random)});
  return points;
}

inline std::vector<Point> lattice(int n, double spacing, Point origin) {
  std::vector<Point> points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) points.push_back(origin + spacing * Point{double(i), double(j), double(k)});
  return points;
}

inline std::size_t num_places(const std::vector<Point>& points) {
  std::set<std::array<double, 3>> places;
  for (const Point& p : points) places.insert({p.x + 0.0, p.y + 0.0, p.z + 0.0});
  return places.size();
}

/// @brief Up to 220 points each: random, lattices, on spheres, in lines and planes, clustered, repeated.
inline std::vector<NamedSet> small_sets() {
  std::vector<NamedSet> sets;
  sets.push_back({"random, seed 31", random_points(150, 31)});
  sets.push_back({"lattice", lattice(5, 1, {})});
  sets.push_back({"lattice with rounding", lattice(4, 0.1, {0.3, -1.7, 1e3})});
  std::vector<Point> sphere;  // all integer points of x^2 + y^2 + z^2 = 15^2
  for (int x = -15; x <= 15; ++x)
    for (int y = -15; y <= 15; ++y)
      for (int z = -15; z <= 15; ++z)
        if (x * x + y * y + z * z == 225) sphere.push_back({double(x), double(y), double(z)});
  sets.push_back({"on a sphere", sphere});
  std::vector<Point> rounded = random_points(80, 32);
  for (Point& p : rounded) p = (p - Point{0.5, 0.5, 0.5}) / length(p - Point{0.5, 0.5, 0.5});
  rounded.push_back({0, 0, 0});
  sets.push_back({"on a sphere but for rounding, seed 32", rounded});
  std::vector<Point> lines;  // three lines through the origin, two in space, and a few points
  for (int i = -15; i <= 15; ++i) {
    lines.push_back({double(i), 0, 0});
    lines.push_back({0, double(i), double(i)});
    lines.push_back({1, 2, double(i)});
    lines.push_back({double(i), 40, 1});
  }
  sets.push_back({"lines", lines});
  std::vector<Point> planes;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      planes.push_back({double(i), double(j), 0});
      planes.push_back({double(i), 0.5, double(j) - 3.5});
    }
  planes.push_back({3, 3, 1e-30});
  sets.push_back({"planes", planes});
  std::vector<Point> clusters;
  for (int c = 0; c < 5; ++c)
    for (const Point& p : random_points(30, 40 + static_cast<unsigned>(c)))
      clusters.push_back(Point{double(c), double(c * c), 0} + std::pow(10.0, -2.0 * c) * p);
  sets.push_back({"clusters, seeds 40 to 44", clusters});
  std::vector<Point> repeated = random_points(60, 33);
  for (std::size_t i = 0; i < 60; i += 2) repeated.insert(repeated.begin() + static_cast<long>(i), repeated[59 - i]);
  repeated.push_back({0.0, 0, 0});
  repeated.push_back({-0.0, 0, -0.0});
  sets.push_back({"repeated, seed 33", repeated});
  std::vector<Point> ulps = lattice(4, 0x1p-52, {1, 1, 1});
  sets.push_back({"neighbours in floating point", ulps});
  return sets;
}

}  // namespace delfront::point_sets
