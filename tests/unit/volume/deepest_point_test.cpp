// SPDX-License-Identifier: Apache-2.0
#include "volume/deepest_point.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace delfront {
namespace {

std::vector<HalfSpace> box_planes(const Point& low, const Point& high) {
  return {{low, {1, 0, 0}},   {low, {0, 2, 0}},   {low, {0, 0, 0.1}},
          {high, {-3, 0, 0}}, {high, {0, -1, 0}}, {high, {0, 0, -1}}};
}

double depth_at(const std::vector<HalfSpace>& planes, const Point& p) {
  double least = 1e300;
  for (const HalfSpace& s : planes) least = std::min(least, dot(s.normal, p - s.at) / length(s.normal));
  return least;
}

TEST(DeepestPoint, in_a_box_half_its_shortest_side) {
  const auto planes = box_planes({-1, 3, 10}, {4, 5, 17});
  const DeepestPoint found = find_deepest_point(planes);
  EXPECT_NEAR(found.depth, 1, 1e-12);
  EXPECT_NEAR(depth_at(planes, found.at), 1, 1e-12);
}

TEST(DeepestPoint, in_a_regular_simplex_the_centre) {
  const Point corner[4] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  std::vector<HalfSpace> planes;
  for (int i = 0; i < 4; ++i) planes.push_back({corner[(i + 1) % 4], corner[i]});
  const DeepestPoint found = find_deepest_point(planes);
  EXPECT_NEAR(length(found.at), 0, 1e-12);
  EXPECT_NEAR(found.depth, 1 / std::sqrt(3), 1e-12);
}

TEST(DeepestPoint, no_kernel_has_a_negative_depth) {
  auto planes = box_planes({0, 0, 0}, {1, 1, 1});
  planes.push_back({{2, 0, 0}, {1, 0, 0}});
  EXPECT_NEAR(find_deepest_point(planes).depth, -0.5, 1e-12);
}

/// Planes that keep off a ball in a thin gap: at least as deep as the ball, and deeper than any place tried.
TEST(DeepestPoint, is_the_deepest_of_random_planes) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    const double radius = std::pow(10.0, -6.0 * (seed % 4) / 3);
    std::vector<HalfSpace> planes = box_planes({-2, -2, -2}, {2, 2, 2});
    for (int i = 0; i < 60; ++i) {
      const Point n{normal(random), normal(random), normal(random)};
      const double away = radius * (1 + 0.1 * std::fabs(normal(random)));
      planes.push_back({(-away / length(n)) * n, n});
    }
    const DeepestPoint found = find_deepest_point(planes);
    EXPECT_NEAR(depth_at(planes, found.at), found.depth, 1e-11);
    EXPECT_GE(found.depth, radius - 1e-11);
    for (int i = 0; i < 100; ++i) {
      const Point p = found.at + radius * Point{normal(random), normal(random), normal(random)};
      EXPECT_LE(depth_at(planes, p), found.depth + 1e-11);
    }
  }
}

}  // namespace
}  // namespace delfront
