// SPDX-License-Identifier: Apache-2.0
#include "geometry/enclose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "delfront/surface_check.hpp"
#include "support/support.hpp"
#include "surface_fixtures.hpp"

namespace delfront {
namespace {

using fixtures::model_of;
using fixtures::summary;

LengthScale scale_of(const Model& model) {
  return {model.bounding_box().diagonal(), model.bounding_box().longest_side(), 0};
}

Model cube_in(EncloseOptions options) {
  Model model = model_of(fixtures::cube_surface());
  Context context;
  add_far_field(model, options, scale_of(model), context);
  return model;
}

/// Sides of all triangles of a patch: smallest, mean, largest.
std::array<double, 3> sides_of(const Model& model, PatchId patch) {
  double least = std::numeric_limits<double>::infinity(), most = 0, sum = 0;
  std::size_t count = 0;
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    if (model.patch_of_triangle[TriangleId(t)] != patch) continue;
    const auto& corners = model.triangles[TriangleId(t)];
    for (std::size_t k = 0; k < 3; ++k) {
      const double side = distance(model.points[corners[k]], model.points[corners[(k + 1) % 3]]);
      least = std::min(least, side);
      most = std::max(most, side);
      sum += side;
      ++count;
    }
  }
  return {least, sum / double(count), most};
}

void expect_shell_around_cube(const Model& model, double volume, double tolerance) {
  Context context;
  const SurfaceReport report = check_surface(model, context);
  EXPECT_TRUE(report.can_bound_volume && report.is_closed && report.is_manifold && report.is_oriented)
      << summary(report);
  ASSERT_EQ(report.components.size(), 2u);
  EXPECT_EQ(report.components[0].inside_of, 1);
  EXPECT_EQ(report.components[1].inside_of, -1);
  EXPECT_NEAR(report.components[1].signed_volume, volume, tolerance) << "outward: positive";
  EXPECT_EQ(report.min_angle_deg > 30, true) << report.min_angle_deg;
}

TEST(FarField, box_of_a_size_is_closed_outward_and_appended) {
  const Model before = model_of(fixtures::cube_surface());
  const Model model = cube_in({"box", {5, ""}, {}, "farfield", Length{1, ""}});
  expect_shell_around_cube(model, 1000, 1e-9);
  for (std::size_t v = 0; v < before.points.size(); ++v)
    EXPECT_EQ(model.points[VertexId(v)], before.points[VertexId(v)]);
  for (std::size_t t = 0; t < 12; ++t) EXPECT_EQ(model.triangles[TriangleId(t)], before.triangles[TriangleId(t)]);
  EXPECT_EQ(model.patches[PatchId(6)].name, "farfield");
  EXPECT_EQ(model.patches[PatchId(6)].kind, "farfield");
  EXPECT_EQ(model.triangles.size(), 12u + 6 * 100 * 2);
  EXPECT_EQ(model.patch_of_triangle.size(), model.triangles.size());
  EXPECT_EQ(model.input_face.size(), model.triangles.size());
  const auto [least, mean, most] = sides_of(model, PatchId(6));
  EXPECT_NEAR(least, 1, 1e-12);
  EXPECT_NEAR(most, std::sqrt(2.0), 1e-12);
}

TEST(FarField, box_of_corners_has_exactly_these_and_exactly_flat_sides) {
  const std::array<double, 6> corners = {-1.1, -2.3, -0.7, 4.7, 3.1, 2.9};
  const Model model = cube_in({"box", {}, corners, "tunnel", Length{0.37, ""}});
  expect_shell_around_cube(model, 5.8 * 5.4 * 3.6, 1e-9);
  for (std::size_t v = 8; v < model.points.size(); ++v) {
    const Point p = model.points[VertexId(v)];
    bool is_on_side = false;
    for (int k = 0; k < 3; ++k)
      is_on_side = is_on_side || p[k] == corners[std::size_t(k)] || p[k] == corners[std::size_t(k) + 3];
    EXPECT_TRUE(is_on_side) << v;
  }
}

TEST(FarField, sphere_is_round_closed_outward_and_of_the_size_asked_for) {
  for (const double h : {3.0, 1.0, 0.4}) {
    const Model model = cube_in({"sphere", {4, ""}, {}, "farfield", Length{h, ""}});
    const double full = 4.0 / 3 * std::numbers::pi * 64;
    expect_shell_around_cube(model, full, full * h * h / 16);
    for (std::size_t v = 8; v < model.points.size(); ++v)
      EXPECT_NEAR(distance(model.points[VertexId(v)], {0.5, 0.5, 0.5}), 4, 1e-12);
    const auto [least, mean, most] = sides_of(model, PatchId(6));
    EXPECT_NEAR(mean, h, 0.25 * h);
    EXPECT_LT(most / least, 1.5);
  }
}

TEST(FarField, has_a_size_of_its_own_where_none_is_given) {
  const Model model = cube_in({"sphere", {20, "c"}, {}, "farfield", {}});
  const auto [least, mean, most] = sides_of(model, PatchId(6));
  EXPECT_NEAR(mean, 4, 0.6) << "a fifth of 20 longest sides";
  const Model percent = cube_in({"box", {200, "%"}, {}, "farfield", {}});
  EXPECT_NEAR(percent.bounding_box().high.x, 0.5 + 2 * std::sqrt(3.0), 1e-12);
}

TEST(FarField, must_enclose_the_input_strictly) {
  EXPECT_THROW(cube_in({"box", {0.5, ""}, {}, "farfield", {}}), InputError) << "touches the cube";
  EXPECT_NO_THROW(cube_in({"box", {0.5000001, ""}, {}, "farfield", Length{0.5, ""}}));
  EXPECT_THROW(cube_in({"box", {}, std::array<double, 6>{-1, -1, -1, 3, 3, 0.9}, "farfield", {}}), InputError);
  EXPECT_THROW(cube_in({"sphere", {0.5, ""}, {}, "farfield", {}}), InputError);
  EXPECT_THROW(cube_in({"sphere", {0.87, ""}, {}, "farfield", Length{2, ""}}), InputError)
      << "the sphere encloses the cube, its facets do not";
  try {
    cube_in({"box", {}, std::array<double, 6>{-1, -1, -1, 3, 3, 0.75}, "farfield", {}});
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.places.size(), 1u);
    EXPECT_EQ(error.places[0].at.z, 1);
    EXPECT_NE(std::string(error.what()).find("0.25"), std::string::npos) << error.what();
  }
}

TEST(FarField, wrong_options_are_named) {
  EXPECT_THROW(cube_in({"cone", {5, ""}, {}, "farfield", {}}), UsageError);
  EXPECT_THROW(cube_in({"box", {-5, ""}, {}, "farfield", {}}), UsageError);
  EXPECT_THROW(cube_in({"sphere", {5, ""}, {}, "farfield", Length{0, ""}}), UsageError);
  EXPECT_THROW(cube_in({"sphere", {5, ""}, {}, "farfield", Length{1e-6, ""}}), UsageError) << "far too many triangles";
  EXPECT_THROW(cube_in({"box", {}, std::array<double, 6>{3, -1, -1, -3, 3, 3}, "farfield", {}}), UsageError);
  const Model none = cube_in({"none", {}, {}, "farfield", {}});
  EXPECT_EQ(none.triangles.size(), 12u);
}

TEST(FarField, a_taken_name_is_numbered) {
  Model model = model_of(fixtures::cube_surface());
  Context context;
  std::string warning;
  context.on_log = [&](LogLevel, const std::string& message) { warning = message; };
  const PatchId patch = add_far_field(model, {"box", {5, ""}, {}, "zmax", {}}, scale_of(model), context);
  EXPECT_EQ(model.patches[patch].name, "zmax_2");
  EXPECT_NE(warning.find("zmax_2"), std::string::npos);
}

}  // namespace
}  // namespace delfront
