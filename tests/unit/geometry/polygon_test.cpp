// SPDX-License-Identifier: Apache-2.0
#include "geometry/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace delfront {
namespace {

double area_along_z(Point a, Point b, Point c) { return 0.5 * cross(b - a, c - a).z; }

double polygon_area(const std::vector<Point>& corners) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) sum += area_along_z(corners[0], corners[i], corners[i + 1]);
  return sum;
}

/// All corners used, every triangle turning like the polygon (none flat), areas adding up: a triangulation of it.
void expect_triangulated(const std::vector<Point>& corners) {
  const auto triangles = triangulate_polygon(corners);
  ASSERT_EQ(triangles.size(), corners.size() - 2);
  const double whole = polygon_area(corners);
  double sum = 0;
  std::vector<bool> used(corners.size(), false);
  for (const auto& [a, b, c] : triangles) {
    const double area = area_along_z(corners[std::size_t(a)], corners[std::size_t(b)], corners[std::size_t(c)]);
    EXPECT_GT(area * whole, 0) << "flat or turned: " << a << " " << b << " " << c;
    sum += area;
    used[std::size_t(a)] = used[std::size_t(b)] = used[std::size_t(c)] = true;
  }
  EXPECT_NEAR(sum, whole, 1e-12 * std::abs(whole));
  for (bool u : used) EXPECT_TRUE(u);
}

TEST(Polygon, quad_is_cut_along_the_better_diagonal) {
  const auto triangles = triangulate_polygon(std::vector<Point>{{0, 0, 0}, {3, -1, 0}, {0.2, 3, 0}, {-0.5, 0.8, 0}});
  ASSERT_EQ(triangles.size(), 2u);
  expect_triangulated({{0, 0, 0}, {3, -1, 0}, {0.2, 3, 0}, {-0.5, 0.8, 0}});
}

TEST(Polygon, corners_straight_between_their_neighbours_make_no_flat_triangle) {
  expect_triangulated({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 1, 0}});             // all on one side
  expect_triangulated({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0}});  // opposite
  expect_triangulated({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {2, 2, 0}, {0, 4, 0}, {0, 2, 0}});  // on all sides
  expect_triangulated({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 2, 0}, {1, 1, 0}, {1, 0, 0}});  // clockwise
  expect_triangulated({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 4, 0}, {3, 1, 0}, {1, 1, 0}, {1, 4, 0}, {0, 4, 0}});  // U
  expect_triangulated({{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 2, 0}, {1, 2, 0}, {1, 3, 0}, {0, 3, 0}});
}

TEST(Polygon, lattice_stars_of_all_kinds_are_triangulated) {
  constexpr unsigned kSeed = 3;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " round " << round);
    // A star-shaped polygon on a lattice: concave and straight corners are frequent.
    const int n = 5 + int(random() % 20);
    std::vector<Point> corners;
    double previous = -1;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n, radius = 3 + double(random() % 9);
      const Point p{std::round(radius * std::cos(angle)), std::round(radius * std::sin(angle)), 0};
      double turned = std::atan2(p.y, p.x);
      if (turned < 0) turned += 2 * std::numbers::pi;
      if (turned <= previous) continue;
      previous = turned;
      corners.push_back(p);
    }
    bool is_star = corners.size() >= 4 && polygon_area(corners) > 0;
    for (std::size_t i = 0; i < corners.size(); ++i)
      is_star = is_star && area_along_z({0, 0, 0}, corners[i], corners[(i + 1) % corners.size()]) > 0;
    if (is_star) expect_triangulated(corners);
  }
}

TEST(Polygon, any_plane_and_a_slight_warp_will_do) {
  std::vector<Point> corners;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2 * std::numbers::pi * i / 12;
    corners.push_back({0.01 * (i % 2), std::cos(angle), std::sin(angle)});
  }
  const auto triangles = triangulate_polygon(corners);
  ASSERT_EQ(triangles.size(), 10u);
  for (const auto& [a, b, c] : triangles)
    EXPECT_GT(
        cross(corners[std::size_t(b)] - corners[std::size_t(a)], corners[std::size_t(c)] - corners[std::size_t(a)]).x,
        0);
}

TEST(Polygon, without_area_or_crossing_itself_still_ends_with_all_triangles) {
  EXPECT_EQ(triangulate_polygon(std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}).size(), 2u);
  EXPECT_EQ(triangulate_polygon(std::vector<Point>(5, Point{1, 1, 1})).size(), 3u);
  EXPECT_EQ(triangulate_polygon(std::vector<Point>{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}, {-1, 1, 0}}).size(), 3u);
}

}  // namespace
}  // namespace delfront
