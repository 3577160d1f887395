// SPDX-License-Identifier: Apache-2.0
#include "delfront/geometry_sizes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "delfront/errors.hpp"
#include "fmt/format.h"
#include "geometry_fixtures.hpp"
#include "support/errors.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using fixtures::expect_mentions;
using fixtures::kTurn;
using fixtures::message_of;
using fixtures::Range;
using fixtures::range_of;
using fixtures::SurfaceBuilder;

constexpr double kRadian = kTurn / 360;

Model cube() {
  Context context;
  return build_model({{fixtures::cube_surface(), "cube"}}, context);
}

CurvatureSizes angle_of(double degrees) {
  CurvatureSizes wish;
  wish.angle_deg = degrees;
  return wish;
}

Model turned_and_scaled(Model model, double scale) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (Point& p : model.points) {
    const Point q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    p = scale * Point{q.x, c * q.y - s * q.z, s * q.y + c * q.z};
  }
  return model;
}

TEST(NamedSizes, S7_sources_lie_on_what_is_named) {
  Context context;
  Model model = cube();
  Curve curve{"edge", {model.triangles[TriangleId(0)][0], model.triangles[TriangleId(0)][1]}};
  model.curves.push_back(curve);
  model.corners.push_back(model.triangles[TriangleId(0)][0]);
  model.corner_names.push_back("apex");
  const std::vector<NamedSize> sizes{{"x*", 0.2}, {"xmin", 0.1}, {"edge", 0.05}, {"apex", 0.01}};
  const GeometrySources found = find_named_sizes(model, sizes, context);
  EXPECT_EQ(found.report.num_sources, 2u + 2u + 1u + 1u);
  EXPECT_EQ(found.report.smallest, 0.01);
  for (const SizeSource& source : found.sources) {
    EXPECT_EQ(source.law.kind, SizeLaw::Kind::step);
    const Simplex& shape = std::get<Simplex>(source.shape);
    if (shape.num_corners == 3) {
      EXPECT_EQ(source.law.delta0, shape.corner[0].x == 0 ? 0.1 : 0.2);
      EXPECT_TRUE(shape.corner[0].x == shape.corner[1].x && shape.corner[1].x == shape.corner[2].x);
    }
  }
}

TEST(NamedSizes, S7_a_pattern_that_fits_nothing_is_refused) {
  Context context;
  const std::vector<NamedSize> wrong{{"xmni", 0.2}}, negative{{"xmin", -1}};
  const std::string error = message_of<UsageError>([&] { find_named_sizes(cube(), wrong, context); });
  expect_mentions(error, {"did you mean 'xmin'", "zmax"});
  EXPECT_THROW(find_named_sizes(cube(), negative, context), UsageError);
}

TEST(CurvatureSizes, S9_sizes_on_a_radius) {
  CurvatureSizes wish;
  EXPECT_TRUE(std::isinf(size_on_radius(1, wish)));
  wish.cells_per_turn = 12;
  EXPECT_NEAR(size_on_radius(2, wish), kTurn * 2 / 12, 1e-12);
  EXPECT_NEAR(size_on_radius(2, angle_of(30)), 4 * std::sin(15 * kRadian), 1e-12);
  CurvatureSizes tangent = angle_of(30);
  tangent.form = CurvatureSizes::Form::tangent;
  EXPECT_NEAR(size_on_radius(2, tangent), 4 * std::tan(15 * kRadian), 1e-12);
  CurvatureSizes deviation;
  deviation.deviation = 0.01;
  const double h = size_on_radius(2, deviation);
  EXPECT_NEAR(2 - std::sqrt(4 - h * h / 4), 0.01, 1e-12);
}

TEST(CurvatureSizes, S9_spheres_cylinders_and_tori_of_any_triangulation) {
  Context context;
  const struct {
    const char* what;
    double r;
    std::function<void(SurfaceBuilder&)> add;
  } cases[] = {
      {"sphere, even", 2, [](SurfaceBuilder& to) { fixtures::add_sphere(to, 2, 24, 12, 0); }},
      {"sphere, zigzag", 2, [](SurfaceBuilder& to) { fixtures::add_sphere(to, 2, 40, 20, 2); }},
      {"sphere, needles", 2, [](SurfaceBuilder& to) { fixtures::add_sphere(to, 2, 120, 14, 1); }},
      {"cylinder, one layer of needles", 1, [](SurfaceBuilder& to) { fixtures::add_cylinder(to, 1, 10, 24, 1, 0); }},
      {"cylinder, coarse", 1, [](SurfaceBuilder& to) { fixtures::add_cylinder(to, 1, 3, 12, 4, 2); }},
      {"cylinder, flat rings", 1, [](SurfaceBuilder& to) { fixtures::add_cylinder(to, 1, 1, 16, 60, 1); }},
      {"cylinder, fine", 1, [](SurfaceBuilder& to) { fixtures::add_cylinder(to, 1, 1, 200, 10, 2); }},
      {"torus", 0.5, [](SurfaceBuilder& to) { fixtures::add_torus(to, 2, 0.5, 60, 24, 0); }},
      {"torus, needles", 0.5, [](SurfaceBuilder& to) { fixtures::add_torus(to, 2, 0.5, 150, 16, 2); }},
  };
  for (const auto& c : cases) {
    SurfaceBuilder builder;
    c.add(builder);
    const GeometrySources found = find_curvature_sizes(builder.model(), angle_of(20), context);
    const double expected = 2 * c.r * std::sin(10 * kRadian);
    const Range range = range_of(found);
    EXPECT_EQ(range.count, builder.model().triangles.size()) << c.what;
    EXPECT_NEAR(range.low, expected, 0.1 * expected) << c.what;
    EXPECT_NEAR(range.high, expected, 0.1 * expected) << c.what;
  }
}

TEST(CurvatureSizes, S9_the_sphere_of_facets) {
  Context context;
  const Model model = build_model({{fixtures::sphere_surface(3), "sphere"}}, context);
  const Range range = range_of(find_curvature_sizes(model, angle_of(20), context));
  EXPECT_NEAR(range.low, 2 * std::sin(10 * kRadian), 0.03);
  EXPECT_NEAR(range.high, 2 * std::sin(10 * kRadian), 0.03);
}

TEST(CurvatureSizes, S9_planes_and_creases_ask_for_nothing) {
  Context context;
  EXPECT_TRUE(find_curvature_sizes(cube(), angle_of(5), context).sources.empty());
  EXPECT_TRUE(find_curvature_sizes(cube(), {}, context).sources.empty());
}

TEST(CurvatureSizes, S9_flat_faces_beside_fillets_stay_large) {
  // a quarter of a tube of radius 1 between two long plates: the plates' triangles touch the curved part
  Context context;
  SurfaceBuilder builder;
  builder.patch("fillet");
  std::vector<Point> profile{{-20, 1, 0}};
  for (int i = 0; i <= 6; ++i) profile.push_back({std::sin(15 * i * kRadian), std::cos(15 * i * kRadian), 0});
  profile.push_back({1, -20, 0});
  builder.grid(8, 1, [&](int i, int j) { return profile[std::size_t(i)] + Point{0, 0, 10.0 * j}; });
  const GeometrySources found = find_curvature_sizes(builder.model(), angle_of(20), context);
  const double expected = 2 * std::sin(10 * kRadian);
  for (const SizeSource& source : found.sources) {
    const Simplex& shape = std::get<Simplex>(source.shape);
    const bool is_plate = shape.corner[0].x < -1 || shape.corner[1].x < -1 || shape.corner[2].x < -1 ||
                          shape.corner[0].y < -1 || shape.corner[1].y < -1 || shape.corner[2].y < -1;
    if (is_plate)
      EXPECT_GT(source.law.delta0, 10 * expected);
    else
      EXPECT_LT(source.law.delta0, 2.1 * expected);  // the first and last strips have half of the turn
    EXPECT_GT(source.law.delta0, 0.9 * expected);
  }
}

TEST(CurvatureSizes, S9_rims_of_flat_discs) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_disc(builder, 3, 0, 30, true);
  const GeometrySources found = find_curvature_sizes(builder.model(), angle_of(20), context);
  const Range range = range_of(found, 2);
  EXPECT_EQ(range.count, 30u);
  EXPECT_EQ(range_of(found, 3).count, 0u);
  EXPECT_NEAR(range.low, 6 * std::sin(10 * kRadian), 1e-9);
  EXPECT_NEAR(range.high, 6 * std::sin(10 * kRadian), 1e-9);
}

TEST(CurvatureSizes, S9_bounds_scaling_and_turning) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_torus(builder, 2, 0.5, 40, 16, 1);
  const Model model = builder.model();
  CurvatureSizes wish = angle_of(20);
  const Range plain = range_of(find_curvature_sizes(model, wish, context));
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const Range range = range_of(find_curvature_sizes(turned_and_scaled(model, scale), wish, context));
    EXPECT_EQ(range.count, plain.count);
    EXPECT_NEAR(range.low, scale * plain.low, 1e-8 * scale);
    EXPECT_NEAR(range.high, scale * plain.high, 1e-8 * scale);
  }
  wish.hmin = 1.002 * plain.low;
  const GeometrySources bounded = find_curvature_sizes(model, wish, context);
  EXPECT_EQ(bounded.report.smallest, wish.hmin);
  EXPECT_GT(bounded.report.num_at_hmin, 0u);
  wish.hmax = 1.008 * plain.low;
  EXPECT_LT(find_curvature_sizes(model, wish, context).sources.size(), bounded.sources.size());
}

TEST(CurvatureSizes, S9_bad_wishes_are_refused) {
  Context context;
  const auto refused = [&](const CurvatureSizes& wish) {
    EXPECT_THROW(find_curvature_sizes(cube(), wish, context), UsageError);
  };
  refused(angle_of(0));
  refused(angle_of(180));
  CurvatureSizes wish;
  wish.cells_per_turn = 0;
  refused(wish);
  wish = {};
  wish.deviation = -1;
  refused(wish);
  wish = angle_of(10);
  wish.hmin = 2;
  wish.hmax = 1;
  refused(wish);
  wish = angle_of(10);
  wish.hmin = std::nan("");
  refused(wish);
}

TEST(FaceAngleSizes, S9_the_angle_wanted_is_met_in_one_step) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_cylinder(builder, 1, 4, 16, 4, 0);  // 22.5 degrees between strips
  FaceAngleSizes wish;
  wish.angle_deg = 15;
  const Range sine = range_of(find_face_angle_sizes(builder.model(), wish, context), 2);
  EXPECT_EQ(sine.count, 16u * 4u);
  EXPECT_NEAR(sine.low, 2 * std::sin(7.5 * kRadian), 1e-9);
  EXPECT_NEAR(sine.high, 2 * std::sin(7.5 * kRadian), 1e-9);
  wish.form = CurvatureSizes::Form::tangent;
  const double chord = 2 * std::sin(11.25 * kRadian);
  EXPECT_NEAR(range_of(find_face_angle_sizes(builder.model(), wish, context), 2).low,
              chord * std::tan(7.5 * kRadian) / std::tan(11.25 * kRadian), 1e-9);
  wish.angle_deg = 2;
  EXPECT_NEAR(range_of(find_face_angle_sizes(builder.model(), wish, context), 2).low, 0.5 * chord, 1e-9);
  wish.angle_deg = 23;  // wanted already
  EXPECT_TRUE(find_face_angle_sizes(builder.model(), wish, context).sources.empty());
  wish.least_ratio = 1;
  EXPECT_THROW(find_face_angle_sizes(builder.model(), wish, context), UsageError);
}

TEST(SurfaceAccuracy, S13_of_a_cylinder_and_a_sphere) {
  Context context;
  SurfaceBuilder builder;
  fixtures::add_cylinder(builder, 1, 4, 24, 8, 0);
  SurfaceLimits limits;
  limits.angle_deg = 14;
  limits.side = 0.3;
  const SurfaceAccuracy tube = measure_surface_accuracy(builder.model(), limits, context);
  EXPECT_NEAR(tube.angle_deg.value, 15, 1e-6);
  EXPECT_EQ(tube.angle_deg.num_beyond, 24u * 8u);
  EXPECT_NEAR(tube.deviation.value, 1 - std::cos(7.5 * kRadian), 0.05 * (1 - std::cos(7.5 * kRadian)));
  EXPECT_NEAR(tube.side.value, 2 * std::sin(7.5 * kRadian), 1e-9);
  EXPECT_EQ(tube.side.num_beyond, 24u * 9u);
  EXPECT_NEAR(tube.line_distance.value, 4, 1e-9);
  const Model sphere = build_model({{fixtures::sphere_surface(2), "sphere"}}, context);
  double deviation = 0;
  for (std::size_t t = 0; t < sphere.triangles.size(); ++t) {
    const auto& [a, b, c] = sphere.triangles[TriangleId(t)];
    const Point normal = cross(sphere.points[b] - sphere.points[a], sphere.points[c] - sphere.points[a]);
    deviation = std::max(deviation, 1 - dot(sphere.points[a], normal) / length(normal));
  }
  const SurfaceAccuracy ball = measure_surface_accuracy(sphere, {}, context);
  EXPECT_NEAR(ball.deviation.value, deviation, 0.1 * deviation);
  EXPECT_EQ(ball.deviation.num_beyond, 0u);
  EXPECT_TRUE(std::isinf(ball.line_distance.value));
}

}  // namespace
}  // namespace delfront
