// SPDX-License-Identifier: Apache-2.0
#include "delfront/nurbs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "brep/nurbs_basis.hpp"
#include "delfront/errors.hpp"
#include "nurbs_fixtures.hpp"
#include "support/errors.hpp"

namespace delfront {
namespace {

using namespace fixtures;

constexpr double kPi = std::numbers::pi;

SpaceFrame some_frame() {
  const Point z = Point{1, 2, 3} / std::sqrt(14.0), x = Point{3, 0, -1} / std::sqrt(10.0);
  return {{0.5, -1, 2}, x, cross(z, x), z};
}

TEST(NurbsBasis, SumsToOneAndDerivativesToNothing) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const int degree = 1 + int(dice.up_to(kMostDegree - 1));
    const KnotLine line(degree, random_knots(dice, std::size_t(degree) + 6, degree, seed % 2 == 0));
    for (int k = 0; k < 40; ++k) {
      const double t = dice(line.low(), line.high());
      const std::size_t span = line.span(t);
      ASSERT_LE(line.knots()[span], t);
      ASSERT_TRUE(t < line.knots()[span + 1] || t == line.high());
      Basis b;
      line.basis<0>(span, t, 2, b);
      double sum = 0, first = 0, second = 0, most = 1;
      for (int i = 0; i <= degree; ++i) {
        EXPECT_GE(b.value[i], 0);
        sum += b.value[i];
        first += b.first[i];
        second += b.second[i];
        most = std::max({most, std::abs(b.first[i]), std::abs(b.second[i])});
      }
      EXPECT_NEAR(sum, 1, 1e-13);
      EXPECT_NEAR(first, 0, 1e-12 * most);
      EXPECT_NEAR(second, 0, 1e-12 * most);
    }
  }
}

/// By cubic steps of the finite size: derivatives that agree to a part in a million.
template <class At>
Point difference(const At& at, double t, double step) {
  return (8 * (at(t + step) - at(t - step)) - (at(t + 2 * step) - at(t - 2 * step))) / (12 * step);
}

TEST(NurbsCurve, DerivativesAreThoseOfDifferences) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const NurbsCurveData data = random_curve(dice, 2 + int(dice.up_to(6)), seed % 2 == 0, seed % 3 != 0);
    const CurvePointer curve = make_nurbs_curve(data);
    const ParameterCurvePointer plane = make_nurbs_parameter_curve(data);
    const auto [low, high] = curve->range();
    for (int k = 0; k < 20; ++k) {
      const double t = dice(low, high), step = 1e-4;
      bool is_at_knot = false;
      for (const double knot : data.knots) is_at_knot = is_at_knot || std::abs(t - knot) < 3 * step;
      if (is_at_knot) continue;
      const CurveDerivatives d = curve->derivatives(t);
      const double scale = 1 + length(d.first) + length(d.second);
      EXPECT_LT(distance(d.first, difference([&](double s) { return curve->at(s); }, t, step)), 1e-6 * scale);
      EXPECT_LT(distance(d.second, difference([&](double s) { return curve->derivatives(s).first; }, t, step)),
                1e-5 * scale * scale);
      const ParameterCurveDerivatives q = plane->derivatives(t);
      EXPECT_EQ(q.at.x, d.at.x);
      EXPECT_EQ(q.second.y, d.second.y);
    }
  }
}

TEST(NurbsSurface, DerivativesAreThoseOfDifferences) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const std::array<int, 2> degree =
        seed % 3 == 0 ? std::array<int, 2>{3, 3} : std::array<int, 2>{2 + int(dice.up_to(3)), 2 + int(dice.up_to(3))};
    const NurbsSurfaceData data = random_surface(dice, degree, seed % 2 == 0, seed % 5 != 0);
    const SurfacePointer surface = make_nurbs_surface(data);
    const ParameterBox box = surface->box();
    for (int k = 0; k < 20; ++k) {
      const Point2 uv = {dice(box.low.x, box.high.x), dice(box.low.y, box.high.y)};
      const double step = 1e-4;
      bool is_at_knot = false;
      for (const double knot : data.knots[0]) is_at_knot = is_at_knot || std::abs(uv.x - knot) < 3 * step;
      for (const double knot : data.knots[1]) is_at_knot = is_at_knot || std::abs(uv.y - knot) < 3 * step;
      if (is_at_knot) continue;
      const auto along_u = [&](auto what) {
        return difference([&](double u) { return surface->derivatives({u, uv.y}).*what; }, uv.x, step);
      };
      const auto along_v = [&](auto what) {
        return difference([&](double v) { return surface->derivatives({uv.x, v}).*what; }, uv.y, step);
      };
      const SurfaceDerivatives s = surface->derivatives(uv);
      const double scale = 1 + length(s.u) + length(s.v) + length(s.uu) + length(s.uv) + length(s.vv);
      EXPECT_LT(distance(s.u, along_u(&SurfaceDerivatives::at)), 1e-6 * scale);
      EXPECT_LT(distance(s.v, along_v(&SurfaceDerivatives::at)), 1e-6 * scale);
      EXPECT_LT(distance(s.uu, along_u(&SurfaceDerivatives::u)), 1e-5 * scale * scale);
      EXPECT_LT(distance(s.uv, along_v(&SurfaceDerivatives::u)), 1e-5 * scale * scale);
      EXPECT_LT(distance(s.vv, along_v(&SurfaceDerivatives::v)), 1e-5 * scale * scale);
      const SurfaceTangents t = surface->tangents(uv);
      EXPECT_LT(distance(t.at, s.at) + distance(t.u, s.u) + distance(t.v, s.v), 1e-13 * scale);
    }
  }
}

void expect_same(const SmoothCurve& a, const SmoothCurve& b, Dice& dice) {
  const auto [low, high] = a.range();
  ASSERT_EQ(b.range()[0], low);
  ASSERT_EQ(b.range()[1], high);
  for (int k = 0; k <= 30; ++k) {
    const double t = k == 0 ? low : k == 30 ? high : dice(low, high);
    const CurveDerivatives c = a.derivatives(t), d = b.derivatives(t);
    const double scale = 1 + length(c.first) + length(c.second);
    EXPECT_LT(distance(c.at, d.at), 1e-12 * scale) << t;
    EXPECT_LT(distance(c.first, d.first), 1e-10 * scale) << t;
    EXPECT_LT(distance(c.second, d.second), 1e-9 * scale * scale) << t;
  }
}

TEST(NurbsCurve, CopiesWithMoreKnotsOrAHigherDegreeAreTheSameCurve) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const NurbsCurveData data = random_curve(dice, 1 + int(dice.up_to(5)), seed % 2 == 0, seed % 3 != 0);
    const CurvePointer curve = make_nurbs_curve(data);
    const auto [low, high] = curve->range();
    const NurbsCurveData finer = insert_knot(data, dice(low, high), 1 + int(dice.up_to(std::size_t(data.degree) - 1)));
    EXPECT_GT(finer.points.size(), data.points.size());
    expect_same(*curve, *make_nurbs_curve(finer), dice);
    const NurbsCurveData raised = raise_degree(data), twice = raise_degree(raised);
    EXPECT_EQ(twice.degree, data.degree + 2);
    expect_same(*curve, *make_nurbs_curve(raised), dice);
    expect_same(*curve, *make_nurbs_curve(twice), dice);
    const NurbsCurveData clamped = clamp_ends(data);
    EXPECT_LT(distance(clamped.points.front(), curve->at(low)), 1e-13);
    EXPECT_LT(distance(clamped.points.back(), curve->at(high)), 1e-13);
    expect_same(*curve, *make_nurbs_curve(clamped), dice);
  }
}

TEST(NurbsSurface, CopiesWithMoreKnotsOrAHigherDegreeAreTheSameSurface) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const NurbsSurfaceData data = random_surface(dice, {3, 2}, seed % 2 == 0, seed % 3 != 0);
    const SurfacePointer surface = make_nurbs_surface(data);
    const ParameterBox box = surface->box();
    for (const NurbsSurfaceData& copy :
         {insert_knot(data, 0, dice(box.low.x, box.high.x)), insert_knot(data, 1, dice(box.low.y, box.high.y), 2),
          raise_degree(data, 0), raise_degree(raise_degree(data, 1), 1)}) {
      const SurfacePointer other = make_nurbs_surface(copy);
      for (int k = 0; k < 20; ++k) {
        const Point2 uv = {dice(box.low.x, box.high.x), dice(box.low.y, box.high.y)};
        const SurfaceDerivatives s = surface->derivatives(uv), t = other->derivatives(uv);
        const double scale = 1 + length(s.u) + length(s.v) + length(s.uu) + length(s.uv) + length(s.vv);
        EXPECT_LT(distance(s.at, t.at), 1e-12 * scale);
        EXPECT_LT(distance(s.u, t.u) + distance(s.v, t.v), 1e-10 * scale);
        EXPECT_LT(distance(s.uu, t.uu) + distance(s.uv, t.uv) + distance(s.vv, t.vv), 1e-9 * scale * scale);
      }
    }
  }
}

TEST(NurbsRound, CirclesAndArcsAreExact) {
  const SpaceFrame frame = some_frame();
  for (const auto& [from, to] : {std::pair{0.0, 2 * kPi}, {0.3, 0.8}, {-1.0, 4.0}, {0.0, kPi / 2}})
    for (const NurbsCurveData& data : {nurbs_arc(frame, 2.5, from, to), nurbs_circle(frame, 2.5)}) {
      const CurvePointer curve = make_nurbs_curve(data);
      for (int k = 0; k <= 100; ++k) {
        const CurveDerivatives d = curve->derivatives(k / 100.0);
        EXPECT_NEAR(distance(d.at, frame.origin), 2.5, 1e-13);
        EXPECT_NEAR(dot(d.at - frame.origin, frame.z), 0, 1e-13);
        const Point bend = cross(d.first, d.second) / std::pow(length(d.first), 3);
        EXPECT_NEAR(length(bend), 0.4, 1e-11);
      }
    }
  EXPECT_TRUE(make_nurbs_curve(nurbs_circle(frame, 2.5))->is_closed());
  EXPECT_FALSE(make_nurbs_curve(nurbs_arc(frame, 2.5, 0, 4))->is_closed());
  const CurvePointer arc = make_nurbs_curve(nurbs_arc(frame, 2, 0.3, 0.8));
  EXPECT_LT(distance(arc->at(0), frame.to_space({2 * std::cos(0.3), 2 * std::sin(0.3), 0})), 1e-14);
  EXPECT_LT(distance(arc->at(1), frame.to_space({2 * std::cos(0.8), 2 * std::sin(0.8), 0})), 1e-14);
}

TEST(NurbsRound, SpheresCylindersAndToriAreExact) {
  const SpaceFrame frame = some_frame();
  const SurfacePointer sphere = make_nurbs_surface(nurbs_sphere(frame, 2)),
                       cylinder = make_nurbs_surface(nurbs_cylinder(frame, 2, 3)),
                       torus = make_nurbs_surface(nurbs_torus(frame, 2, 0.7));
  for (int i = 0; i <= 40; ++i)
    for (int j = 0; j <= 40; ++j) {
      const Point2 uv = {i / 40.0, j / 40.0};
      const auto local = [&](Point p) {
        const Point d = p - frame.origin;
        return Point{dot(d, frame.x), dot(d, frame.y), dot(d, frame.z)};
      };
      EXPECT_NEAR(distance(sphere->at(uv), frame.origin), 2, 1e-13);
      EXPECT_NEAR(dot(sphere->normal(uv), sphere->at(uv) - frame.origin), 2, 1e-12);
      const Point c = local(cylinder->at(uv)), t = local(torus->at(uv));
      EXPECT_NEAR(std::hypot(c.x, c.y), 2, 1e-13);
      EXPECT_NEAR(c.z, 3 * uv.y, 1e-13);
      EXPECT_NEAR(std::hypot(std::hypot(t.x, t.y) - 2, t.z), 0.7, 1e-13);
      const Point ring = frame.to_space(Point{t.x, t.y, 0} * (2 / std::hypot(t.x, t.y)));
      EXPECT_NEAR(dot(torus->normal(uv), torus->at(uv) - ring), 0.7, 1e-12);
      if (j > 0 && j < 40) {
        EXPECT_NEAR(largest_curvature(sphere->derivatives(uv)), 0.5, 1e-7);  // of a root of rounding
      }
    }
  EXPECT_EQ(sphere->period(), (std::array<double, 2>{1, 0}));
  EXPECT_EQ(cylinder->period(), (std::array<double, 2>{1, 0}));
  EXPECT_EQ(torus->period(), (std::array<double, 2>{1, 1}));
  EXPECT_TRUE(sphere->degenerate_sides().v_low && sphere->degenerate_sides().v_high);
  EXPECT_FALSE(sphere->degenerate_sides().u_low || sphere->degenerate_sides().u_high);
  EXPECT_FALSE(torus->degenerate_sides().v_low || cylinder->degenerate_sides().v_low);
  EXPECT_LT(distance(torus->at({1.25, -0.25}), torus->at({0.25, 0.75})), 1e-13);
}

TEST(NurbsInterpolate, GoesThroughItsPointsAndIsSmooth) {
  for (unsigned seed = 1; seed <= 30; ++seed)
    for (const bool is_closed : {false, true}) {
      SCOPED_TRACE(seed);
      Dice dice(seed);
      const std::size_t count = 3 + dice.up_to(12);
      std::vector<Point> points;
      for (std::size_t i = 0; i < count; ++i) points.push_back({dice(-1, 1), dice(-1, 1), dice(-1, 1)});
      const NurbsCurveData data = interpolate_points(points, is_closed);
      const CurvePointer curve = make_nurbs_curve(data);
      EXPECT_EQ(curve->range(), (std::array<double, 2>{0, 1}));
      EXPECT_EQ(curve->is_closed(), is_closed);
      double chords = 0, all = 0;
      for (std::size_t i = 0; i + (is_closed ? 0 : 1) < count; ++i) all += distance(points[i], points[(i + 1) % count]);
      for (std::size_t i = 0; i < count; ++i) {
        const double t = std::min(chords / all, 1.0);
        EXPECT_LT(distance(curve->at(t), points[i]), 1e-12);
        chords += distance(points[i], points[(i + 1) % count]);
        if (i == 0 || i + 1 == count) continue;
        const CurveDerivatives a = curve->derivatives(t - 1e-9), b = curve->derivatives(t + 1e-9);
        EXPECT_LT(distance(a.second, b.second), 1e-5 * (1 + length(a.second)));
      }
      if (!is_closed) continue;
      EXPECT_LT(distance(curve->derivatives(0).second, curve->derivatives(1).second),
                1e-9 * (1 + length(curve->derivatives(0).second)));
    }
}

TEST(NurbsInterpolate, IsOfFourthOrderOnACircle) {
  double last = 0;
  for (const std::size_t count : {16u, 32u, 64u}) {
    for (const bool is_closed : {false, true}) {
      std::vector<Point> points;
      for (std::size_t i = 0; i < count; ++i) {
        const double angle = (is_closed ? 2 : 1) * kPi * double(i) / double(is_closed ? count : count - 1);
        points.push_back({std::cos(angle), std::sin(angle), 0});
      }
      const CurvePointer curve = make_nurbs_curve(interpolate_points(points, is_closed));
      double off = 0;
      for (int k = 0; k <= 1000; ++k) off = std::max(off, std::abs(length(curve->at(k / 1000.0)) - 1));
      if (is_closed && last > 0) {
        EXPECT_LT(off, last / 12);
      }
      if (is_closed) last = off;
      EXPECT_LT(off, 60 * std::pow(double(count), -4));
    }
  }
}

TEST(NurbsInterpolate, SurfacesGoThroughTheirSections) {
  for (const bool is_closed : {false, true})
    for (const int degree : {1, 2, 3}) {
      std::vector<std::vector<Point>> sections;
      for (std::size_t s = 0; s < 5; ++s) {
        sections.emplace_back();
        for (std::size_t i = 0; i < 12; ++i) {
          const double angle = 2 * kPi * double(i) / 12, r = 1 - 0.15 * double(s);
          sections.back().push_back({r * std::cos(angle) + 0.2 * double(s), 0.3 * r * std::sin(angle), double(s)});
        }
      }
      const NurbsSurfaceData data = interpolate_sections(sections, is_closed, degree);
      const SurfacePointer surface = make_nurbs_surface(data);
      EXPECT_EQ(surface->period()[0] > 0, is_closed);
      const SurfaceSearch search(surface);
      for (const std::vector<Point>& section : sections)
        for (const Point& p : section) EXPECT_LT(search.closest(p).distance, 1e-9);
      const ParameterBox box = surface->box();
      EXPECT_LT(distance(surface->at(box.low), sections[0][0]), 1e-13);
      EXPECT_NEAR(surface->at({0.3, box.high.y}).z, 4, 1e-13);
    }
}

TEST(NurbsInterpolate, LoftOfUnlikeSectionsHasThemAsItsCurves) {
  Dice dice(5);
  std::vector<NurbsCurveData> sections;
  for (int s = 0; s < 4; ++s) {
    sections.push_back(s == 1 ? nurbs_arc({}, 1, 0.2, 2.5) : random_curve(dice, 2 + s % 3, false, true));
    for (Point& p : sections.back().points) p.z = 2 * s;
  }
  const SurfacePointer surface = make_nurbs_surface(loft(sections));
  const ParameterBox box = surface->box();
  for (int s : {0, 3}) {  // along their whole length, at the same parameter
    const CurvePointer curve = make_nurbs_curve(sections[std::size_t(s)]);
    const auto [low, high] = curve->range();
    for (int k = 0; k <= 20; ++k)
      EXPECT_LT(
          distance(surface->at({k / 20.0, s == 0 ? box.low.y : box.high.y}), curve->at(low + (high - low) * k / 20)),
          1e-12);
  }
}

TEST(NurbsSearch, IsNeverFartherThanTheBestOfManySamples) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const SurfacePointer surface =
        make_nurbs_surface(seed % 4 == 0 ? nurbs_torus({}, 2, 0.8) : random_surface(dice, {3, 2}, seed % 2 == 0, true));
    const ParameterBox box = surface->box();
    const SurfaceSearch search(surface);
    std::vector<Point> samples;
    Box extent;
    for (int i = 0; i <= 200; ++i)
      for (int j = 0; j <= 200; ++j) {
        samples.push_back(surface->at(
            {box.low.x + (box.high.x - box.low.x) * i / 200, box.low.y + (box.high.y - box.low.y) * j / 200}));
        extent.add(samples.back());
      }
    for (int k = 0; k < 60; ++k) {
      Point p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = dice(extent.low[axis] - 1, extent.high[axis] + 1);
      double best = 1e300;
      for (const Point& q : samples) best = std::min(best, distance(p, q));
      const SurfaceSearch::Found found = search.closest(p);
      EXPECT_LE(found.distance, best * (1 + 1e-12));
      EXPECT_EQ(found.at, surface->at(found.uv));
      EXPECT_GT(found.distance, best - extent.diagonal() / 50);
    }
  }
}

TEST(NurbsSearch, CurvesToo) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const CurvePointer curve = make_nurbs_curve(random_curve(dice, 3, seed % 2 == 0, true));
    const auto range = curve->range();
    for (int k = 0; k < 20; ++k) {
      const Point p = {dice(-2, 2), dice(-2, 2), dice(-2, 2)};
      double best = 1e300;
      for (int i = 0; i <= 5000; ++i)
        best = std::min(best, distance(p, curve->at(range[0] + (range[1] - range[0]) * i / 5000)));
      EXPECT_LE(closest_on_curve(*curve, range, p).distance, best * (1 + 1e-12));
    }
  }
}

TEST(NurbsBadInput, IsRefusedWithWhatIsWrong) {
  const NurbsCurveData good = interpolate_points(std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 0, 0}});
  const auto refused = [&](const auto& spoil) {
    NurbsCurveData bad = good;
    spoil(bad);
    return message_of<InputError>([&] { make_nurbs_curve(bad); });
  };
  expect_mentions(refused([](auto& d) { d.knots[2] = 0.5; }), {"knot 4", "ascend"});
  expect_mentions(refused([](auto& d) { d.knots.pop_back(); }), {"7 knots", "need 8"});
  expect_mentions(refused([](auto& d) { d.weights = {1, 1, 0, 1}; }), {"weight 3", "positive"});
  expect_mentions(refused([](auto& d) { d.weights = {1, 1}; }), {"2 weights", "4 control points"});
  expect_mentions(refused([](auto& d) { d.degree = 26; }), {"degree", "1 to 25"});
  expect_mentions(refused([](auto& d) { d.degree = 4; }), {"needs 5"});
  expect_mentions(refused([](auto& d) { d.points[1].y = std::nan(""); }), {"point 2", "not finite"});
  expect_mentions(refused([](auto& d) { d.knots = {0, 0, 0, 0, 0, 0, 0, 0}; }), {"too often"});
  expect_mentions(refused([](auto& d) {
                    d.points.resize(8, {4, 4, 4});
                    d.knots = {0, 0, 0, 0, 0.5, 0.5, 0.5, 0.5, 1, 1, 1, 1};
                  }),
                  {"0.5", "too often"});
  NurbsSurfaceData surface = nurbs_sphere({}, 1);
  surface.points.pop_back();
  expect_mentions(message_of<InputError>([&] { make_nurbs_surface(surface); }), {"44", "9 by 5"});
  expect_mentions(message_of<InputError>([&] { interpolate_points(std::vector<Point>{{0, 0, 0}}); }), {"1 point"});
  expect_mentions(message_of<InputError>([&] {
                    interpolate_points(std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}});
                  }),
                  {"2 and 3", "the same"});
  expect_mentions(message_of<InputError>([&] { insert_knot(good, 1.5); }), {"outside"});
  expect_mentions(message_of<InputError>([&] {
                    interpolate_sections({{{0, 0, 0}, {1, 0, 0}}, {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}}});
                  }),
                  {"section 2", "3 points"});
}

}  // namespace
}  // namespace delfront
