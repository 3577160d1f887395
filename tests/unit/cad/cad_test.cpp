// SPDX-License-Identifier: Apache-2.0
// What of CAD files needs no OpenCASCADE: suffixes, missing files, loops put in order, our own curves and surfaces.
#include "delfront/cad.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "cad/order_loop.hpp"
#include "cad/shapes.hpp"

namespace delfront {
namespace {

using cad::CurveData;
using cad::LoopSide;
using cad::ParameterCurveData;
using cad::SurfaceData;

TEST(ReadCad, D1_suffixes_in_any_case) {
  for (const char* path : {"a.step", "A.STP", "dir/b.Iges", "b.IGS", "c.brep", "c.brp", "d.egads"})
    EXPECT_TRUE(is_cad_file(path)) << path;
  for (const char* path : {"a.stl", "step", "a.step.toml", ""}) EXPECT_FALSE(is_cad_file(path)) << path;
}

TEST(ReadCad, D4_what_is_no_file_is_said_first) {
  CadReport report;
  Context context;
  const auto message = [&](const std::string& path) -> std::string {
    try {
      read_cad(path, {}, report, context);
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_NE(message("nowhere.step").find("no such file"), std::string::npos);
  const auto empty = std::filesystem::temp_directory_path() / "delfront_empty.step";
  std::ofstream(empty).close();
  EXPECT_NE(message(empty.string()).find("empty"), std::string::npos);
  std::filesystem::remove(empty);
  EXPECT_NE(message(std::filesystem::temp_directory_path().string()).find("folder"), std::string::npos);
}

TEST(OrderLoop, D1_shuffled_sides_come_in_order) {
  std::mt19937 random(5);
  std::vector<LoopSide> sides;
  constexpr std::size_t n = 9;
  const auto place = [](std::size_t i) {
    const double a = 2 * std::numbers::pi * double(i % n) / double(n);
    return Point2{std::cos(a), std::sin(a)};
  };
  for (std::size_t i = 0; i < n; ++i) sides.push_back({place(i), place(i + 1), {CornerId(i), CornerId((i + 1) % n)}});
  for (int round = 0; round < 20; ++round) {
    std::shuffle(sides.begin(), sides.end(), random);
    const auto loops = cad::order_loop(sides, {2, 2});
    ASSERT_EQ(loops.size(), 1u);
    ASSERT_EQ(loops[0].size(), n);
    for (std::size_t k = 0; k < n; ++k)
      EXPECT_EQ(sides[loops[0][k]].corners[1], sides[loops[0][(k + 1) % n]].corners[0]);
  }
}

TEST(OrderLoop, D1_the_two_ways_along_a_seam_are_told_by_their_place) {
  // a cylinder's side: bottom, seam up at u = 1, top back, seam down at u = 0, all between two corners
  const CornerId a(std::size_t(0)), b(std::size_t(1));
  const std::vector<LoopSide> sides = {
      {{0, 0}, {1, 0}, {a, a}}, {{0, 1}, {0, 0}, {b, a}}, {{1, 0}, {1, 1}, {a, b}}, {{1, 1}, {0, 1}, {b, b}}};
  const auto loops = cad::order_loop(sides, {1, 1});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0], (std::vector<std::size_t>{0, 2, 3, 1}));
}

TEST(OrderLoop, D1_two_rings_in_one_wire_are_two_loops) {
  const CornerId a(std::size_t(0)), b(std::size_t(1));
  const std::vector<LoopSide> sides = {{{0, 0}, {0, 0}, {a, a}}, {{3, 3}, {3, 3}, {b, b}}};
  EXPECT_EQ(cad::order_loop(sides, {3, 3}).size(), 2u);
}

/// Derivatives against central differences.
void expect_derivatives(const SmoothSurface& s, Point2 uv) {
  constexpr double e = 1e-5;
  const SurfaceDerivatives d = s.derivatives(uv);
  const auto at = [&](double du, double dv) { return s.derivatives({uv.x + du, uv.y + dv}); };
  EXPECT_LT(distance(d.u, (at(e, 0).at - at(-e, 0).at) / (2 * e)), 1e-7);
  EXPECT_LT(distance(d.v, (at(0, e).at - at(0, -e).at) / (2 * e)), 1e-7);
  EXPECT_LT(distance(d.uu, (at(e, 0).u - at(-e, 0).u) / (2 * e)), 1e-7);
  EXPECT_LT(distance(d.uv, (at(0, e).u - at(0, -e).u) / (2 * e)), 1e-7);
  EXPECT_LT(distance(d.vv, (at(0, e).v - at(0, -e).v) / (2 * e)), 1e-7);
}

CurveData arc() {
  CurveData c;
  c.kind = CurveData::Kind::ellipse;
  c.frame = {{2, 0, 0.5}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
  c.a = 0.5;
  c.b = 0.3;
  return c;
}

TEST(CadShapes, D1_surfaces_have_the_derivatives_they_say) {
  SurfaceData cone;
  cone.kind = SurfaceData::Kind::cone;
  cone.a = 1.5;
  cone.b = -0.4;
  SurfaceData extrusion;
  extrusion.kind = SurfaceData::Kind::extrusion;
  extrusion.curve = arc();
  extrusion.frame.z = {0.6, 0.8, 0};
  SurfaceData revolution;
  revolution.kind = SurfaceData::Kind::revolution;
  revolution.curve = arc();
  revolution.frame = {{0.1, 0.2, 0.3}, {1, 0, 0}, {0, 1, 0}, {0, 0.6, 0.8}};
  revolution.box = {{0, 0}, {6.28, 6.28}};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> in(0.1, 1.2);
  for (const SurfaceData& data : {cone, extrusion, revolution}) {
    const SurfacePointer s = cad::make_surface(data, {{0, 0}, {1, 1}});
    for (int i = 0; i < 20; ++i) expect_derivatives(*s, {in(random), in(random)});
  }
}

TEST(CadShapes, D1_a_cone_of_either_half_angle_knows_its_tip) {
  for (const double angle : {0.5, -0.5}) {
    SurfaceData data;
    data.kind = SurfaceData::Kind::cone;
    data.a = 2;
    data.b = angle;
    const double tip = -2 / std::sin(angle);
    const ParameterBox used = angle > 0 ? ParameterBox{{0, tip}, {6, 0}} : ParameterBox{{0, 0}, {6, tip}};
    const SurfacePointer s = cad::make_surface(data, used);
    EXPECT_EQ(s->degenerate_sides().v_low, angle > 0);
    EXPECT_EQ(s->degenerate_sides().v_high, angle < 0);
    EXPECT_LT(distance(s->at({1, tip}), s->at({4, tip})), 1e-12);
  }
}

TEST(CadShapes, D1_parameter_curves_turned_and_mirrored) {
  ParameterCurveData ring;
  ring.kind = ParameterCurveData::Kind::ellipse;
  ring.origin = {1, 2};
  ring.x = {0, 3};
  ring.y = {2, 0};  // runs clockwise
  const ParameterCurvePointer c = cad::make_parameter_curve(ring);
  EXPECT_NEAR(c->at(0).y, 5, 1e-15);
  EXPECT_NEAR(c->at(std::numbers::pi / 2).x, 3, 1e-15);
  const ParameterCurveDerivatives d = c->derivatives(0.3);
  EXPECT_NEAR(d.first.x, 2 * std::cos(0.3), 1e-15);
  EXPECT_NEAR(d.second.y, -3 * std::cos(0.3), 1e-15);
}

}  // namespace
}  // namespace delfront
