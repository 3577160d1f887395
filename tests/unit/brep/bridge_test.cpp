// SPDX-License-Identifier: Apache-2.0
// Prisms with sides too narrow for the cells: what is gridded across, and what is not.
#include "brep_fixtures.hpp"
#include "delfront/uniform_size.hpp"

namespace delfront {
namespace {

using namespace fixtures;

double area_of(const std::vector<Point2>& polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point2 p = polygon[k], q = polygon[(k + 1) % polygon.size()];
    twice += p.x * q.y - p.y * q.x;
  }
  return 0.5 * twice;
}

double volume_of(const Model& m) {
  double six = 0;
  for (const auto& t : m.triangles) six += dot(m.points[t[0]], cross(m.points[t[1]], m.points[t[2]]));
  return six / 6;
}

void expect_solid(const Brep& brep, const Gridded& made) {
  Context context;
  const SurfaceReport look = check_surface(made.model, context);
  EXPECT_TRUE(look.can_bound_volume);
  EXPECT_TRUE(look.is_oriented);
  EXPECT_EQ(topology_of(made.model).euler, 2);
  for (const Finding& f : look.findings) EXPECT_NE(f.severity, Severity::error) << f.message;
  EXPECT_LT(farthest_from_entity(made, brep), 1e-12);
  EXPECT_EQ(made.report.entity.size(), made.model.points.size());
  for (const Curve& curve : made.model.curves)
    for (std::size_t i = 0; i + 1 < curve.vertices.size(); ++i) {
      const bool is_side = std::any_of(made.model.triangles.begin(), made.model.triangles.end(), [&](const auto& t) {
        return std::find(t.begin(), t.end(), curve.vertices[i]) != t.end() &&
               std::find(t.begin(), t.end(), curve.vertices[i + 1]) != t.end();
      });
      EXPECT_TRUE(is_side) << curve.name << " leaves the triangles";
    }
}

constexpr double kSize = 0.1;
const UniformSize& size_field() {
  static const UniformSize field(kSize);
  return field;
}
BrepOptions bridging(double below) { return {.least_size = below, .bridge_below = below}; }

TEST(Bridge, ACornerCutOffByATinyEdgeIsOne) {
  const Brep brep = make_prism({{0, 0}, {1, 0}, {1, 0.999}, {0.999, 1}, {0, 1}}, 1);
  const Gridded kept = grid(brep, size_field(), bridging(0)), made = grid(brep, size_field(), bridging(0.01));
  EXPECT_LT(kept.report.min_angle_deg, 5);
  expect_solid(brep, made);
  EXPECT_GT(made.report.min_angle_deg, 20);
  EXPECT_EQ(made.report.faces[4].triangles, 0u) << "the cut corner's face";
  EXPECT_NEAR(volume_of(made.model), 1, 0.002);
  ASSERT_FALSE(made.report.bridges.empty());
  for (const BrepBridge& bridge : made.report.bridges) EXPECT_LT(bridge.width, 0.01);
}

TEST(Bridge, AStepTooLowForACellIsGone) {
  const double step = 0.001;
  const Brep brep = make_prism({{0, 0}, {1, 0}, {1, 1}, {0.5, 1}, {0.5, 1 - step}, {0, 1 - step}}, 1);
  const Gridded made = grid(brep, size_field(), bridging(0.01));
  expect_solid(brep, made);
  EXPECT_GT(made.report.min_angle_deg, 20);
  EXPECT_EQ(made.report.faces[5].triangles, 0u);
  EXPECT_NEAR(volume_of(made.model), 1, 0.002);
}

TEST(Bridge, APlateThinnerThanTheLimitKeepsItsRim) {
  const Brep brep = make_prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0.005);
  const Gridded made = grid(brep, size_field(), bridging(0.01));
  expect_solid(brep, made);
  EXPECT_TRUE(made.report.bridges.empty());
  EXPECT_NEAR(volume_of(made.model), 0.005, 1e-12);
}

TEST(Bridge, WhatIsWideEnoughIsLeftAlone) {
  const Brep brep = make_prism({{0, 0}, {1, 0}, {1, 0.95}, {0.95, 1}, {0, 1}}, 1);
  const Gridded kept = grid(brep, size_field(), bridging(0)), made = grid(brep, size_field(), {.bridge_below = 0.01});
  EXPECT_TRUE(made.report.bridges.empty());
  EXPECT_EQ(made.model.points, kept.model.points);
  EXPECT_EQ(made.model.triangles, kept.model.triangles);
}

TEST(Bridge, ASharpCornerOfAnOpenFaceIsNotCutOff) {
  const double h = std::tan(2 * kPi / 180);
  const std::vector<Point> points = {{0, 0, 0}, {1, 0, 0}, {1, h, 0}};
  const Brep brep = make_polyhedron(points, {{0, 1, 2}});
  const Gridded made = grid(brep, size_field(), bridging(0.01));
  for (const Point& p : points)
    EXPECT_NE(std::find(made.model.points.begin(), made.model.points.end(), p), made.model.points.end());
  EXPECT_EQ(topology_of(made.model).euler, 1);
}

TEST(Bridge, RandomPrismsStaySolid) {
  std::uint64_t state = 20261123;
  const auto random = [&] {
    return double((state = state * 6364136223846793005u + 1442695040888963407u) >> 11) / 9007199254740992.0;
  };
  for (int k = 0; k < 40; ++k) {
    SCOPED_TRACE(k);
    std::vector<Point2> polygon;  // round, with corners from 1e-5 apart
    double angle = 0;
    while (true) {
      polygon.push_back({std::cos(angle), std::sin(angle)});
      angle += random() < 0.5 ? std::pow(10, -1 - 4 * random()) : 0.2 + random();
      if (angle > 2 * kPi - 0.3) break;
    }
    const Brep brep = make_prism(polygon, 0.5);
    const Gridded made = grid(brep, UniformSize(0.15), bridging(0.02));
    expect_solid(brep, made);
    EXPECT_GT(made.report.min_angle_deg, 0.7 * 0.02 / (1.6 * 0.15) * 180 / kPi);  // what is 0.02 wide stays
    EXPECT_NEAR(volume_of(made.model), 0.5 * area_of(polygon), 0.03);
  }
}

}  // namespace
}  // namespace delfront
