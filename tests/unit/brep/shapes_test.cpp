// SPDX-License-Identifier: Apache-2.0
// Derivatives against differences, normals at poles, places found again, points along edges.
#include <random>

#include "brep/chart.hpp"
#include "brep/edge_points.hpp"
#include "brep_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

SpaceFrame odd_frame() {
  SpaceFrame frame;
  frame.origin = {3, -1, 2};
  frame.x = {0.6, 0.8, 0};
  frame.y = {-0.8 * 0.6, 0.6 * 0.6, 0.8};
  frame.z = cross(frame.x, frame.y);
  return frame;
}

struct Named {
  std::string name;
  SurfacePointer surface;
  ParameterBox box;
};

std::vector<Named> all_surfaces() {
  const SpaceFrame f = odd_frame();
  return {{"plane", make_plane_surface(f), {{-1, -1}, {2, 1}}},
          {"cylinder", make_cylinder_surface(f, 0.7), {{0, -1}, {6, 2}}},
          {"cone", make_cone_surface(f, 0.5), {{0, 0.2}, {6, 2}}},
          {"sphere", make_sphere_surface(f, 1.5), {{0, -1.3}, {6, 1.3}}},
          {"torus", make_torus_surface(f, 2, 0.6), {{0, 0}, {6, 6}}},
          {"bicubic", make_bicubic_surface(wavy_patch(f)), {{0.1, 0.1}, {0.9, 0.9}}}};
}

TEST(Shapes, DerivativesOfSurfacesAreTheirDifferences) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Named& n : all_surfaces()) {
    SCOPED_TRACE(n.name);
    for (int i = 0; i < 50; ++i) {
      const Point2 uv = {n.box.low.x + unit(random) * (n.box.high.x - n.box.low.x),
                         n.box.low.y + unit(random) * (n.box.high.y - n.box.low.y)};
      const double d = 1e-5;
      const SurfaceDerivatives s = n.surface->derivatives(uv);
      const auto at = [&](double x, double y) { return n.surface->tangents({uv.x + x, uv.y + y}); };
      EXPECT_LT(length((at(d, 0).at - at(-d, 0).at) / (2 * d) - s.u), 1e-8);
      EXPECT_LT(length((at(0, d).at - at(0, -d).at) / (2 * d) - s.v), 1e-8);
      EXPECT_LT(length((at(d, 0).u - at(-d, 0).u) / (2 * d) - s.uu), 1e-8);
      EXPECT_LT(length((at(0, d).u - at(0, -d).u) / (2 * d) - s.uv), 1e-8);
      EXPECT_LT(length((at(0, d).v - at(0, -d).v) / (2 * d) - s.vv), 1e-8);
      EXPECT_EQ(s.at, n.surface->at(uv));
      EXPECT_LT(length(cross(s.u, s.v) / length(cross(s.u, s.v)) - n.surface->normal(uv)), 1e-12);
    }
  }
}

TEST(Shapes, CurvaturesAreTheKnownOnes) {
  const SpaceFrame f = odd_frame();
  EXPECT_EQ(largest_curvature(make_plane_surface(f)->derivatives({1, 2})), 0);
  EXPECT_NEAR(largest_curvature(make_cylinder_surface(f, 0.5)->derivatives({1, 2})), 2, 1e-12);
  EXPECT_NEAR(largest_curvature(make_sphere_surface(f, 4)->derivatives({1, 0.5})), 0.25, 1e-7);
  EXPECT_NEAR(largest_curvature(make_torus_surface(f, 2, 0.5)->derivatives({1, kPi})), 2, 1e-12);
  EXPECT_NEAR(largest_curvature(make_cone_surface(f, 0.6)->derivatives({1, 2})), 1 / (2 * std::tan(0.6)), 1e-12);
}

TEST(Shapes, NormalsAreThereAtPoles) {
  const SpaceFrame f = odd_frame();
  const SurfacePointer sphere = make_sphere_surface(f, 2), cone = make_cone_surface(f, 0.5);
  for (const double u : {0.0, 1.0, 4.0}) {
    EXPECT_LT(length(sphere->normal({u, kPi / 2}) - f.z), 1e-12);
    EXPECT_LT(length(sphere->normal({u, -kPi / 2}) + f.z), 1e-12);
    EXPECT_LT(length(cone->normal({u, 0}) - cone->normal({u, 1})), 1e-12);
  }
}

TEST(Shapes, PlacesAreFoundAgainFromAStartNearBy) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Named& n : all_surfaces()) {
    SCOPED_TRACE(n.name);
    for (int i = 0; i < 50; ++i) {
      const double wide = n.box.high.x - n.box.low.x, tall = n.box.high.y - n.box.low.y;
      const Point2 uv = {n.box.low.x + unit(random) * wide, n.box.low.y + unit(random) * tall};
      const Point2 start = {uv.x + 0.05 * wide * (unit(random) - 0.5), uv.y + 0.05 * tall * (unit(random) - 0.5)};
      const Point p = n.surface->at(uv) + 0.05 * n.surface->normal(uv);
      const Point2 found = n.surface->closest(p, start);
      EXPECT_LT(distance(n.surface->at(found), n.surface->at(uv)), 1e-7);
    }
  }
}

TEST(Shapes, DerivativesOfCurvesAreTheirDifferences) {
  const SpaceFrame f = odd_frame();
  const SurfacePointer torus = make_torus_surface(f, 2, 0.5);
  const std::vector<CurvePointer> curves = {make_line({1, 2, 3}, {-1, 0, 5}), make_ellipse(f, 2, 0.5),
                                            make_cubic({Point{0, 0, 0}, {1, 2, 0}, {2, -1, 1}, {3, 0, 2}}),
                                            make_curve_on(torus, make_parameter_ellipse({1, 2}, 0.5, 0.9), {0, 1}),
                                            make_curve_on(torus, make_parameter_line({1, 2}, {3, 7}), {0, 1})};
  for (const CurvePointer& curve : curves)
    for (double t = 0.05; t < 1; t += 0.1) {
      const double d = 1e-5;
      const CurveDerivatives c = curve->derivatives(t);
      EXPECT_LT(length((curve->at(t + d) - curve->at(t - d)) / (2 * d) - c.first), 2e-8);
      EXPECT_LT(length((curve->derivatives(t + d).first - curve->derivatives(t - d).first) / (2 * d) - c.second), 2e-7);
    }
  EXPECT_EQ(curves[0]->at(1), (Point{-1, 0, 5}));
}

TEST(EdgePoints, EqualPartsOfTheIntegralAndSymmetric) {
  const CurvePointer cubic = make_cubic({Point{0, 0, 0}, {1, 2, 0}, {3, 2, 0}, {4, 0, 0}});  // x -> 4 - x
  const auto sample = [&](double t, bool) {
    const CurveDerivatives c = cubic->derivatives(t);
    return CurveSample{c.at, c.first, 0};
  };
  const LinearSize uniform(0.11, 1, {}, 0, 4);
  const WantedSize size(uniform, 0.7);
  const std::vector<double> t = divide_curve(sample, {0, 1}, size, 1);
  double shortest = 1e300, longest = 0;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    EXPECT_NEAR(t[i], 1 - t[t.size() - 1 - i], 1e-12);
    double along = 0;
    for (int k = 0; k < 100; ++k)
      along +=
          distance(cubic->at(t[i] + (t[i + 1] - t[i]) * k / 100), cubic->at(t[i] + (t[i + 1] - t[i]) * (k + 1) / 100));
    shortest = std::min(shortest, along);
    longest = std::max(longest, along);
  }
  EXPECT_NEAR(longest / shortest, 1, 1e-3);
  EXPECT_NEAR(longest, 0.11, 0.11 / double(t.size()));
}

TEST(EdgePoints, GradedSidesAreAsLongAsAskedFor) {
  const CurvePointer line = make_line({0, 0, 0}, {10, 0, 0});
  const auto sample = [&](double t, bool) {
    const CurveDerivatives c = line->derivatives(t);
    return CurveSample{c.at, c.first, 0};
  };
  const LinearSize graded(0.05, 20, {}, 0, 10);
  const WantedSize size(graded, 0.7);
  const std::vector<double> t = divide_curve(sample, {0, 1}, size, 1);
  // the integral of dx / (a + b x) is ln(20) / b
  EXPECT_EQ(t.size() - 1, std::size_t(std::lround(std::log(20.0) / 0.095)));
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    const double expected = (std::pow(20.0, double(i + 1) / double(t.size() - 1)) - 1) / 19;
    EXPECT_NEAR(t[i + 1], expected, 1e-5);
  }
}

TEST(EdgePoints, BendsNeedSidesWhateverIsAskedFor) {
  const CurvePointer circle = make_ellipse({}, 1, 1);
  const auto sample = [&](double t, bool) {
    const CurveDerivatives c = circle->derivatives(t);
    return CurveSample{c.at, c.first, 1};
  };
  const LinearSize huge(1e6, 1, {}, 0, 1);
  EXPECT_EQ(divide_curve(sample, circle->range(), WantedSize(huge, 2 * kPi / 9), 3).size(), 10u);
  EXPECT_EQ(divide_curve(sample, circle->range(), WantedSize(huge, 100), 3).size(), 4u);
}

TEST(Chart, PolarOfASphereIsConformalAndThereAndBackIsTheSame) {
  const SurfacePointer sphere = make_sphere_surface(odd_frame(), 2);
  const ParameterBox box = {{0, -1}, {2 * kPi, kPi / 2}};
  for (const auto pole : {Chart::Pole::none, Chart::Pole::v_high}) {
    const Chart chart(*sphere, box, pole);
    for (double u = 0.1; u < 6.2; u += 0.5)
      for (double v = -0.9; v < 1.5; v += 0.2) {
        const Point2 xy = chart.to_chart({u, v}), back = chart.to_uv(xy);
        EXPECT_NEAR(back.x, u, 1e-12);
        EXPECT_NEAR(back.y, v, 1e-12);
        const Chart::Place place = chart.place(xy);
        const double d = 1e-6;
        const Point x = (chart.place({xy.x + d, xy.y}).at - chart.place({xy.x - d, xy.y}).at) / (2 * d);
        EXPECT_LT(length(x - place.x), 0.02 * length(place.x));
        EXPECT_GT(dot(cross(place.x, place.y), sphere->normal({u, v})), 0);
        if (chart.is_polar()) {
          EXPECT_LT(Chart::stretch(place), 1.03);
        }
      }
  }
}

TEST(Chart, ConesAreUnrolledUnlessTheyAreSharp) {
  for (const double half : {kPi / 6, kPi / 3, kPi / 4}) {
    const SurfacePointer cone = make_cone_surface({}, half);
    const Chart chart(*cone, {{0, 0}, {2 * kPi, 3}}, Chart::Pole::v_low);
    for (const double v : {0.01, 0.5, 2.0}) {
      const Point2 xy = chart.to_chart({1, v});
      EXPECT_NEAR(3 * std::hypot(xy.x, xy.y), v, 1e-3 * v);  // charts are 1 wide
      const double stretch = half < kPi / 5 ? 1 / std::sin(half) : 1;
      EXPECT_NEAR(Chart::stretch(chart.place(xy)), stretch, 0.02 * stretch);
    }
  }
}

}  // namespace
}  // namespace delfront
