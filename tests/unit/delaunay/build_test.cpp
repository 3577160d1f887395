// SPDX-License-Identifier: Apache-2.0
// Delaunay tetrahedrizations against the definition itself: no vertex in the (symbolically perturbed) circumsphere of
// any tet, tested by brute force on the point sets that are hardest for it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delfront/errors.hpp"
#include "support/tet_fixtures.hpp"

namespace delfront {
namespace {

std::vector<Point> random_points(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> points;
  for (std::size_t i = 0; i < n; ++i) points.push_back({uniform(random), uniform(random), uniform(random)});
  return points;
}

TetComplex complex_of(const std::vector<Point>& points) {
  TetComplex c;
  for (const Point& p : points) c.add_vertex(p, 1);
  return c;
}

/// The first vertex that lies in a tet's circumsphere, in words; empty for a Delaunay tetrahedrization.
std::string find_vertex_in_sphere(const TetComplex& c) {
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    const std::uint32_t* n = &c.node[4 * t];
    for (VertexIndex v = 0; v < c.num_vertices(); ++v) {
      if (c.vertex_tet[v] == kNoIndex || c.has_vertex(t, v)) continue;
      if (insphere_perturbed(c.point(n[0]), c.point(n[1]), c.point(n[2]), c.point(n[3]), c.point(v)) > 0)
        return "vertex " + std::to_string(v) + " lies in the sphere of tet " + std::to_string(t);
    }
  }
  return {};
}

/// No point strictly beyond a hull face: together with valid bonds, the tets fill the convex hull.
std::string find_point_beyond_hull(const TetComplex& c) {
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || !c.is_ghost(t)) continue;
    for (VertexIndex v = 0; v < c.num_vertices(); ++v)
      if (orient3d(c.point(c.node[4 * t]), c.point(c.node[4 * t + 1]), c.point(c.node[4 * t + 2]), c.point(v)) > 0)
        return "vertex " + std::to_string(v) + " lies beyond hull face of ghost " + std::to_string(t);
  }
  return {};
}

/// Builds, checks everything, and returns the number of real tets.
std::size_t expect_delaunay(const std::vector<Point>& points, std::size_t num_duplicates = 0) {
  TetComplex c = complex_of(points);
  Context context;
  const auto duplicates = build_delaunay(c, context);
  EXPECT_EQ(duplicates.size(), num_duplicates);
  for (const auto& [v, earlier] : duplicates) {
    EXPECT_EQ(c.point(v), c.point(earlier));
    EXPECT_EQ(c.vertex_tet[v], kNoIndex);
    EXPECT_NE(c.vertex_tet[earlier], kNoIndex);
  }
  for (VertexIndex v = 0; v < c.num_vertices(); ++v) {
    const bool is_duplicate = std::any_of(duplicates.begin(), duplicates.end(), [&](auto& d) { return d.first == v; });
    EXPECT_EQ(c.vertex_tet[v] == kNoIndex, is_duplicate) << "vertex " << v;
  }
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(find_vertex_in_sphere(c), "");
  EXPECT_EQ(find_point_beyond_hull(c), "");
  std::size_t real = 0;
  for (TetIndex t = 0; t < c.num_slots(); ++t) real += !c.is_dead(t) && !c.is_ghost(t) ? 1 : 0;
  return real;
}

TEST(BuildDelaunay, random_points_have_empty_spheres) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_delaunay(random_points(300, seed));
  }
}

TEST(BuildDelaunay, the_smallest_sets) {
  const std::vector<Point> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_EQ(expect_delaunay(corners), 1u);
  EXPECT_EQ(expect_delaunay({corners[1], corners[0], corners[2], corners[3]}), 1u);  // the negative order
  std::vector<Point> five = corners;
  five.push_back({0.1, 0.2, 0.3});
  EXPECT_EQ(expect_delaunay(five), 4u);  // inside
  five[4] = {2, 2, 2};
  EXPECT_EQ(expect_delaunay(five), 2u);  // beyond one face, far away
  five[4] = {0.25, 0.25, 0};
  EXPECT_EQ(expect_delaunay(five), 3u);  // on a face
  five[4] = {0.5, 0, 0};
  EXPECT_EQ(expect_delaunay(five), 2u);  // on an edge
}

TEST(BuildDelaunay, a_lattice_where_every_sphere_holds_eight_points) {
  std::vector<Point> points;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k) points.push_back({double(i), double(j), double(k)});
  const std::size_t tets = expect_delaunay(points);
  EXPECT_GE(tets, 5u * 125);  // a cube has five tets or six, and no others come between
  EXPECT_LE(tets, 6u * 125);
}

TEST(BuildDelaunay, points_on_a_sphere_exactly_and_nearly) {
  std::vector<Point> exact;  // all integer points of x^2 + y^2 + z^2 = 15^2
  for (int x = -15; x <= 15; ++x)
    for (int y = -15; y <= 15; ++y)
      for (int z = -15; z <= 15; ++z)
        if (x * x + y * y + z * z == 225) exact.push_back({double(x), double(y), double(z)});
  ASSERT_GT(exact.size(), 50u);
  expect_delaunay(exact);
  exact.push_back({0, 0, 0});
  EXPECT_EQ(expect_delaunay(exact) % 2, 0u);  // one tet a hull face, and closed triangulations have an even number
  std::vector<Point> rounded = random_points(200, 4);
  for (Point& p : rounded) p = (p - Point{0.5, 0.5, 0.5}) / length(p - Point{0.5, 0.5, 0.5});
  expect_delaunay(rounded);
}

TEST(BuildDelaunay, a_plane_and_one_point_off_it) {
  std::vector<Point> points;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) points.push_back({double(i), double(j), 0});
  points.push_back({3.5, 4.25, 1});
  EXPECT_EQ(expect_delaunay(points), 2u * 11 * 11);  // a tet a triangle
  points.push_back({3.5, 4.25, -1});
  expect_delaunay(points);
  points.resize(144);
  points.push_back({3.5, 4.25, 1e-30});  // far below the rounding of everything else
  EXPECT_EQ(expect_delaunay(points), 2u * 11 * 11);
}

TEST(BuildDelaunay, a_line_and_two_points_off_it) {
  std::vector<Point> points;
  for (int i = 0; i < 50; ++i) points.push_back({double(i), double(i), double(i)});
  points.push_back({20, 21, 20});
  points.push_back({30, 30, 31});
  EXPECT_EQ(expect_delaunay(points), 49u);
}

TEST(BuildDelaunay, points_on_two_skew_lines_give_the_quadratic_number) {
  std::vector<Point> points;
  for (int i = 0; i < 20; ++i) {
    points.push_back({double(i), 0, 0});
    points.push_back({0.5, double(i) - 7, 10});
  }
  EXPECT_EQ(expect_delaunay(points), 19u * 19);
}

TEST(BuildDelaunay, duplicates_are_reported_and_left_out) {
  std::vector<Point> points = random_points(100, 5);
  for (std::size_t i = 0; i < 100; i += 3) points.push_back(points[i]);
  points.push_back(points[0]);
  expect_delaunay(points, 35);
  std::vector<Point> zeros = random_points(20, 6);
  zeros.push_back({0, 0, 0});
  zeros.push_back({-0.0, 0, -0.0});
  expect_delaunay(zeros, 1);
}

TEST(BuildDelaunay, clusters_from_far_apart_to_next_to_nothing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Point> points;
  for (int cluster = 0; cluster < 10; ++cluster) {
    const Point centre{uniform(random), uniform(random), uniform(random)};
    const double size = std::pow(10.0, -1.6 * cluster);
    for (int i = 0; i < 30; ++i)
      points.push_back(centre + size * Point{uniform(random), uniform(random), uniform(random)});
  }
  TetComplex c = complex_of(points);  // the smallest clusters may round to a few distinct points
  Context context;
  build_delaunay(c, context);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(find_vertex_in_sphere(c), "");
  EXPECT_EQ(find_point_beyond_hull(c), "");
}

TEST(BuildDelaunay, neighbours_in_floating_point) {
  std::mt19937 random(8);
  std::uniform_int_distribution<int> ulps(0, 7);
  std::set<std::array<int, 3>> taken;
  std::vector<Point> points;
  while (points.size() < 120) {
    const std::array<int, 3> k{ulps(random), ulps(random), ulps(random)};
    if (taken.insert(k).second) points.push_back({1 + k[0] * 0x1p-52, 1 + k[1] * 0x1p-52, 1 + k[2] * 0x1p-52});
  }
  expect_delaunay(points);
}

TEST(BuildDelaunay, the_counts_are_near_theory_for_random_points) {
  TetComplex c = complex_of(random_points(20000, 9));
  Context context;
  KernelCounts counts;
  build_delaunay(c, context, &counts);
  const double n = static_cast<double>(counts.points);
  EXPECT_LE(static_cast<double>(counts.walk_steps) / n, 9);
  EXPECT_GE(static_cast<double>(counts.insphere_tests) / n, 4 * 19);
  EXPECT_LE(static_cast<double>(counts.insphere_tests) / n, 4 * 25);
  EXPECT_LE(static_cast<double>(counts.exact_tests) / n, 0.5);
  EXPECT_GE(static_cast<double>(counts.tets_created) / n, 25);
  EXPECT_LE(static_cast<double>(counts.tets_created) / n, 31);
  EXPECT_EQ(counts.tets_created - counts.tets_deleted + 5, c.num_live());
  EXPECT_EQ(c.find_defect(), "");
}

TEST(BuildDelaunay, two_runs_are_the_same_and_so_is_a_scaled_one) {
  std::vector<Point> points = random_points(3000, 10);
  auto build = [](const std::vector<Point>& p) {
    TetComplex c = complex_of(p);
    Context context;
    build_delaunay(c, context);
    return c;
  };
  const TetComplex first = build(points), second = build(points);
  EXPECT_EQ(first.node, second.node);
  EXPECT_EQ(first.neigh, second.neigh);
  for (const double scale : {0x1p-20, 0x1p20}) {
    std::vector<Point> scaled = points;
    for (Point& p : scaled) p = scale * p;
    EXPECT_EQ(build(scaled).node, first.node) << "scale " << scale;
  }
}

TEST(BuildDelaunay, what_spans_no_volume_is_refused) {
  auto message = [](const std::vector<Point>& points) -> std::string {
    TetComplex c = complex_of(points);
    Context context;
    try {
      build_delaunay(c, context);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_NE(message({}).find("fewer than four"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).find("fewer than four"), std::string::npos);
  EXPECT_NE(message(std::vector<Point>(10, {1, 2, 3})).find("one place"), std::string::npos);
  std::vector<Point> line, plane;
  for (int i = 0; i < 20; ++i) line.push_back({0.1 * i, 0.2 * i, -0.4 * i});
  for (int i = 0; i < 20; ++i) plane.push_back({double(i % 5), double(i / 5), double(i % 5 + i / 5)});
  EXPECT_NE(message(line).find("line"), std::string::npos);
  EXPECT_NE(message(plane).find("plane"), std::string::npos);
}

TEST(BuildDelaunay, stops_when_told_to) {
  TetComplex c = complex_of(random_points(20000, 11));
  std::atomic<bool> cancel = true;
  Context context;
  context.cancel = &cancel;
  EXPECT_THROW(build_delaunay(c, context), Cancelled);
}

}  // namespace
}  // namespace delfront
