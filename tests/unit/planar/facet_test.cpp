// SPDX-License-Identifier: Apache-2.0
#include "delfront/facet.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

std::set<Edge> sides_of(const FacetTriangles& made) {
  std::set<Edge> sides;
  for (const auto& t : made.triangles)
    for (std::size_t k = 0; k < 3; ++k) sides.insert(std::minmax(t[k], t[(k + 1) % 3]));
  return sides;
}

/// Twice the area vector.
Point area_of(const FacetOutline& facet, const FacetTriangles& made) {
  Point sum;
  for (const auto& [a, b, c] : made.triangles)
    sum = sum + cross(facet.points[b] - facet.points[a], facet.points[c] - facet.points[a]);
  return sum;
}

FacetOutline square() {
  return {{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, {}, {0, 0, 1}};
}

void add_edge(FacetOutline& facet, Point a, Point b) {
  const auto n = static_cast<std::uint32_t>(facet.points.size());
  facet.points.push_back(a);
  facet.points.push_back(b);
  facet.edges.push_back({n, n + 1});
}

TEST(Facet, edges_and_points_inside_are_sides_and_corners) {
  FacetOutline facet = square();
  add_edge(facet, {1, 1, 0}, {2, 1.5, 0});
  add_edge(facet, {3, 3, 0}, {3, 1, 0});
  facet.points.push_back({1, 3, 0});
  Context context;
  const FacetTriangles made = triangulate_facet(facet, context);
  for (const auto& [a, b] : facet.edges) EXPECT_TRUE(sides_of(made).contains(std::minmax(a, b)));
  EXPECT_EQ(area_of(facet, made), (Point{0, 0, 32}));
  // Euler: 4 on the hull, 5 inside.
  EXPECT_EQ(made.triangles.size(), 2u * 5 + 4 - 2);
  EXPECT_EQ(made.pieces.size(), facet.edges.size());
  facet.normal = {0, 0, -3};
  EXPECT_EQ(area_of(facet, triangulate_facet(facet, context)), (Point{0, 0, -32}));
}

TEST(Facet, an_edge_is_split_at_points_on_it) {
  FacetOutline facet = square();
  facet.points.push_back({2, 0, 0});
  Context context;
  const FacetTriangles made = triangulate_facet(facet, context);
  EXPECT_EQ(made.triangles.size(), 3u);
  EXPECT_EQ(made.pieces.size(), 5u);
  for (const auto& piece : made.pieces) EXPECT_EQ(piece.edge == 0, piece.a == 4 || piece.b == 4);
}

TEST(Facet, an_edge_from_a_point_to_itself_is_left_out) {
  FacetOutline facet = square();
  facet.edges.insert(facet.edges.begin() + 1, {{2, 2}, {0, 0}});
  Context context;
  const FacetTriangles made = triangulate_facet(facet, context);
  EXPECT_EQ(made.triangles.size(), 2u);
  EXPECT_EQ(made.pieces.size(), 4u);
  for (const auto& piece : made.pieces) EXPECT_NE(piece.a, piece.b);
}

TEST(Facet, holes_are_left_open) {
  FacetOutline facet = square();
  for (const auto& [x, y] : {std::pair{1., 1.}, {2., 1.}, {2., 2.}, {1., 2.}}) facet.points.push_back({x, y, 0});
  facet.edges.insert(facet.edges.end(), {{4, 5}, {5, 6}, {6, 7}, {7, 4}});
  facet.holes = {{1.5, 1.5, 0}};
  Context context;
  const FacetTriangles made = triangulate_facet(facet, context);
  EXPECT_EQ(area_of(facet, made), (Point{0, 0, 30}));
  EXPECT_EQ(made.triangles.size(), 8u);
}

TEST(Facet, what_cannot_be_is_refused) {
  Context context;
  const auto message = [&](const FacetOutline& facet) -> std::string {
    try {
      triangulate_facet(facet, context);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  FacetOutline outside = square(), across = square(), apart = square(), open = square(), line = square(),
               twice = square();
  add_edge(outside, {5, 5, 0}, {6, 5, 0});
  EXPECT_NE(message(outside).find("outside of it"), std::string::npos) << message(outside);
  add_edge(across, {1, 1, 0}, {5, 1, 0});
  EXPECT_NE(message(across).find("cross"), std::string::npos) << message(across);
  apart.points.push_back({5, 5, 0});
  EXPECT_NE(message(apart).find("outside of it"), std::string::npos) << message(apart);
  open.edges.pop_back();
  EXPECT_NE(message(open).find("enclose nothing"), std::string::npos) << message(open);
  for (Point& p : line.points) p.y = 0;
  EXPECT_NE(message(line), "");
  twice.points.push_back({4, 4, 1});
  EXPECT_NE(message(twice).find("at one place"), std::string::npos) << message(twice);
}

/// Polygons out of the axes, slightly warped by rounding, with points and short edges inside.
TEST(Facet, random_facets_in_space) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto vector = [&] { return Point{unit(random), unit(random), unit(random)}; };
    Point u = vector();
    u = u / length(u);
    Point normal = cross(u, vector());
    normal = normal / length(normal);
    const Point v = cross(normal, u), origin = vector();
    FacetOutline facet;
    facet.normal = normal;
    const std::uint32_t n = 3 + seed % 20;
    double area = 0;
    std::vector<double> radius(n);
    for (double& r : radius) r = 1.5 + 0.5 * unit(random);
    for (std::uint32_t i = 0; i < n; ++i) {
      const double turn = 2 * std::numbers::pi * i / n;
      facet.points.push_back(origin + radius[i] * (std::cos(turn) * u + std::sin(turn) * v));
      facet.edges.push_back({i, (i + 1) % n});
      area += radius[i] * radius[(i + 1) % n] * std::sin(2 * std::numbers::pi / n);
    }
    // Each in a circle of its own, well inside of every such polygon.
    for (int i = 0; i < 6; ++i) {
      const double turn = i * std::numbers::pi / 3;
      const Point at = origin + 0.3 * (std::cos(turn) * u + std::sin(turn) * v);
      add_edge(facet, at, at + 0.1 * (unit(random) * u + unit(random) * v));
    }
    facet.points.push_back(origin);
    Context context;
    const FacetTriangles made = triangulate_facet(facet, context);
    for (const auto& [a, b] : facet.edges) EXPECT_TRUE(sides_of(made).contains(std::minmax(a, b)));
    EXPECT_NEAR(dot(area_of(facet, made), normal), area, 1e-12 * area);
    EXPECT_EQ(made.triangles.size(), 2 * facet.points.size() - n - 2);
  }
}

}  // namespace
}  // namespace delfront
