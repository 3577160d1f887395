// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "planar/far_field.hpp"
#include "planar_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

NamedMesh triangle_of_lines(Point offset, const std::string& stem) {
  NamedMesh input{{}, stem};
  input.mesh.dimension = 2;
  for (const Point p : {Point{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) input.mesh.points.push_back(p + offset);
  CellBlock& lines = input.mesh.block(CellType::line);
  for (const std::size_t i : {0, 1, 2}) {
    lines.vertices.push_back(VertexId(i));
    lines.vertices.push_back(VertexId((i + 1) % 3));
    lines.group.push_back(GroupId());
  }
  return input;
}

TEST(BuildPlanarDomain, D5_points_are_welded_and_curves_named) {
  Context context;
  NamedMesh second = triangle_of_lines({0, 0, 0}, "a");
  second.mesh.points[VertexId(0)] = {1, 1, 0};
  second.mesh.points[VertexId(1)] = {1, -0.0, 0};
  const PlanarDomain domain = build_planar_domain({triangle_of_lines({0, 0, 0}, "a"), second}, context);
  EXPECT_EQ(domain.points.size(), 4u);
  ASSERT_EQ(domain.curves.size(), 2u);
  EXPECT_EQ(domain.curves[CurveId(0)].name, "a");
  EXPECT_EQ(domain.curves[CurveId(1)].name, "a_2");
  EXPECT_EQ(domain.inner_loops, InnerLoops::by_direction);
}

TEST(BuildPlanarDomain, D5_seeds_come_from_groups_of_points) {
  Context context;
  NamedMesh input = triangle_of_lines({0, 0, 0}, "a");
  input.mesh.points.push_back({0.2, 0.2, 0});
  input.mesh.points.push_back({0.3, 0.3, 0});
  const GroupId hole = input.mesh.add_group(0, "holes", "hole"), region = input.mesh.add_group(0, "air", "region");
  CellBlock& vertices = input.mesh.block(CellType::vertex);
  vertices.vertices = {VertexId(3), VertexId(4)};
  vertices.group = {hole, region};
  input.mesh.fields.push_back({"h", Field::On::vertices, CellType::vertex, 1, {9, 9, 9, 9, 0.125}});
  const PlanarDomain domain = build_planar_domain({input}, context);
  EXPECT_EQ(domain.points.size(), 3u);
  ASSERT_EQ(domain.holes.size(), 1u);
  EXPECT_EQ(domain.holes[0], (Point2{0.2, 0.2}));
  ASSERT_EQ(domain.regions.size(), 1u);
  EXPECT_EQ(domain.regions[0].name, "air");
  EXPECT_EQ(domain.regions[0].h, 0.125);
  EXPECT_EQ(domain.inner_loops, InnerLoops::are_regions);
}

TEST(BuildPlanarDomain, D5_what_is_no_domain_is_refused) {
  Context context;
  EXPECT_THROW(build_planar_domain({triangle_of_lines({0, 0, 1}, "a")}, context), InputError);
  EXPECT_THROW(build_planar_domain({{Mesh{}, "a"}}, context), InputError);
}

PlanarDomain with_far_field(EncloseOptions enclose, SizeOptions sizes = {}) {
  PlanarDomain domain;
  Context context;
  add_loop(domain, circle({0, 0}, 0.5, 40), "body");
  const CurveId far = add_far_field(domain, enclose, sizes, {2, 1, 0}, context);
  EXPECT_EQ(domain.curves[far].kind, "farfield");
  return domain;
}

TEST(PlanarFarField, D5_circle_by_growth) {
  EncloseOptions enclose;
  enclose.shape = "circle";
  enclose.size = {20, "c"};
  SizeOptions sizes;
  sizes.growth = 1.3;
  const PlanarDomain domain = with_far_field(enclose, sizes);
  const double n = double(domain.points.size() - 40);
  for (std::size_t i = 40; i < domain.points.size(); ++i) {
    const Point2 p = domain.points[VertexId(i)];
    EXPECT_NEAR(std::hypot(p.x, p.y), 20, 1e-12);
  }
  // From 2 pi 0.5 / 40 at 19.5: (19.5 * 0.3 + 0.0785) / 1.3.
  EXPECT_NEAR(2 * std::numbers::pi * 20 / n, (19.5 * 0.3 + 0.0785) / 1.3, 0.2);
  Context context;
  const std::vector<Finding> findings = check_planar_domain(domain, context);
  EXPECT_FALSE(has_errors(findings));
}

TEST(PlanarFarField, D5_box_and_sizes) {
  EncloseOptions enclose;
  enclose.shape = "box";
  enclose.size = {3, ""};
  enclose.h = Length{0.5, ""};
  EXPECT_EQ(with_far_field(enclose).points.size(), 40u + 4 * 12);
  enclose.corners = {-1, -2, 0, 3, 2, 0};
  EXPECT_EQ(with_far_field(enclose).points.size(), 40u + 2 * 8 + 2 * 8);
}

TEST(PlanarFarField, D5_the_body_must_lie_inside) {
  EncloseOptions enclose;
  enclose.shape = "circle";
  enclose.size = {0.4, ""};
  EXPECT_THROW(with_far_field(enclose), InputError);
  enclose.size = {0, ""};
  EXPECT_THROW(with_far_field(enclose), UsageError);
}

}  // namespace
}  // namespace delfront
