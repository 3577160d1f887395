// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "delfront/planar.hpp"
#include "planar/kernel.hpp"

namespace delfront {
namespace {

/// Every triangle positive, every bond both ways, no point of a neighbour in a circle (which is enough for all points),
/// the hull convex and as long as Euler's formula says.
void expect_delaunay(const std::vector<Point2>& points, const Triangulation2& t) {
  std::set<std::uint32_t> used;
  for (std::size_t i = 0; i < t.triangles.size(); ++i) {
    const auto& n = t.triangles[i];
    ASSERT_GT(orient2d(points[n[0]], points[n[1]], points[n[2]]), 0);
    used.insert(n.begin(), n.end());
    for (unsigned e = 0; e < 3; ++e) {
      const std::uint32_t other = t.neighbours[i][e];
      if (other == Triangulation2::kNone) continue;
      const auto& m = t.triangles[other];
      unsigned back = 0;
      while (back < 3 && t.neighbours[other][back] != i) ++back;
      ASSERT_LT(back, 3u);
      ASSERT_EQ(n[(e + 1) % 3], m[(back + 2) % 3]);
      ASSERT_EQ(n[(e + 2) % 3], m[(back + 1) % 3]);
      ASSERT_LE(incircle(points[n[0]], points[n[1]], points[n[2]], points[m[back]]), 0);
    }
  }
  ASSERT_EQ(used.size() + t.duplicates.size(), points.size());
  const std::size_t h = t.hull.size();
  for (std::size_t i = 0; i < h; ++i)
    ASSERT_GE(orient2d(points[t.hull[i]], points[t.hull[(i + 1) % h]], points[t.hull[(i + 2) % h]]), 0);
  EXPECT_EQ(t.triangles.size(), 2 * used.size() - 2 - h);
}

Triangulation2 triangulate(const std::vector<Point2>& points) {
  Context context;
  return delaunay2(points, context);
}

TEST(Delaunay2, T4_random_points) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<Point2> points(20000);
    for (Point2& p : points) p = {unit(random), unit(random)};
    const Triangulation2 t = triangulate(points);
    expect_delaunay(points, t);
    EXPECT_TRUE(t.duplicates.empty());
  }
}

TEST(Delaunay2, T4_every_point_outside_of_every_circle_by_brute_force) {
  std::mt19937_64 random(11);
  std::uniform_int_distribution<int> cell(0, 12);
  std::vector<Point2> points(150);
  for (Point2& p : points) p = {double(cell(random)), double(cell(random))};
  const Triangulation2 t = triangulate(points);
  for (const auto& n : t.triangles)
    for (const Point2 p : points) EXPECT_LE(incircle(points[n[0]], points[n[1]], points[n[2]], p), 0);
}

TEST(Delaunay2, T4_lattice_far_from_the_origin) {
  std::vector<Point2> points;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) points.push_back({1e6 + 0.1 * i, -1e6 + 0.1 * j});
  expect_delaunay(points, triangulate(points));
}

TEST(Delaunay2, T4_cocircular_points) {
  // Whole-number points at exactly the same distance from the origin: 1105^2 has 108 of them.
  std::vector<Point2> points;
  for (int x = -1105; x <= 1105; ++x) {
    const int y = int(std::lround(std::sqrt(1105.0 * 1105 - double(x) * x)));
    if (x * x + y * y != 1105 * 1105) continue;
    points.push_back({double(x), double(y)});
    if (y > 0) points.push_back({double(x), double(-y)});
  }
  ASSERT_EQ(points.size(), 108u);
  const Triangulation2 t = triangulate(points);
  expect_delaunay(points, t);
  EXPECT_EQ(t.hull.size(), points.size());
  points.push_back({0, 0});
  EXPECT_EQ(triangulate(points).triangles.size(), 108u);
}

TEST(Delaunay2, T4_many_points_on_few_lines) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point2> points;
  for (int i = 0; i < 3000; ++i) points.push_back({unit(random), i % 3 ? 0.0 : 1.0});
  for (int i = 0; i < 1000; ++i) {
    const double x = unit(random);
    points.push_back({x, x});
  }
  expect_delaunay(points, triangulate(points));
}

TEST(Delaunay2, T4_strongly_graded_points) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point2> points;
  for (int i = 0; i < 20000; ++i) {
    const double r = std::pow(10, -8 * unit(random)), angle = 6.2831853 * unit(random);
    points.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  expect_delaunay(points, triangulate(points));
}

TEST(Delaunay2, T4_of_equal_points_the_first_is_used) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> cell(0, 40);
  std::vector<Point2> points(5000);
  for (Point2& p : points) p = {double(cell(random)), double(cell(random))};
  points[7] = {-0.0, 3};
  points[9] = {0.0, 3};
  std::map<std::pair<double, double>, std::uint32_t> first;
  for (std::uint32_t i = 0; i < points.size(); ++i) first.try_emplace({points[i].x + 0.0, points[i].y}, i);
  const Triangulation2 t = triangulate(points);
  expect_delaunay(points, t);
  ASSERT_EQ(t.duplicates.size(), points.size() - first.size());
  for (const auto& [point, same] : t.duplicates) EXPECT_EQ(same, first.at({points[point].x + 0.0, points[point].y}));
}

TEST(Delaunay2, T4_the_same_bytes_twice) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point2> points(5000);
  for (Point2& p : points) p = {unit(random), unit(random)};
  EXPECT_EQ(triangulate(points).triangles, triangulate(points).triangles);
}

TEST(Delaunay2, T4_work_per_point_is_that_of_theory) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  TriComplex complex;
  for (int i = 0; i < 50000; ++i) complex.point.push_back({unit(random), unit(random)});
  PlanarKernel kernel(complex);
  Context context;
  build_delaunay(complex, kernel, context);
  const double n = double(kernel.counts.points);
  EXPECT_LT(double(kernel.counts.triangles_created) / n, 6.4);
  EXPECT_LT(double(kernel.counts.incircle_tests) / n, 10);
  EXPECT_LT(double(kernel.counts.walk_steps) / n, 5);
}

TEST(Delaunay2, what_has_no_triangle_is_refused) {
  EXPECT_THROW(triangulate({}), InputError);
  EXPECT_THROW(triangulate({{0, 0}, {1, 0}}), InputError);
  EXPECT_THROW(triangulate({{0, 0}, {1, 1}, {2, 2}, {0.5, 0.5}}), InputError);
  EXPECT_THROW(triangulate({{2, 3}, {2, 3}, {2, 3}, {2, 3}}), InputError);
  EXPECT_THROW(triangulate({{0, 0}, {1, 0}, {0, std::nan("")}}), InputError);
  EXPECT_THROW(triangulate({{0, 0}, {1, 0}, {0, 1e200}}), InputError);
}

}  // namespace
}  // namespace delfront
