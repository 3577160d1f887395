// SPDX-License-Identifier: Apache-2.0
// Circles and what turns round an axis, exactly: arcs of up to a quarter as quadratics with weights (chapter 7, 8.5).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "delfront/errors.hpp"
#include "delfront/nurbs.hpp"

namespace delfront {
namespace {

constexpr double kOnAxis = 1e-15;  ///< of the extent of the curve

// beginnings of eighths of a turn; the odd ones are where tangents of quarters meet
constexpr double kTurnX[9] = {1, 1, 0, -1, -1, -1, 0, 1, 1}, kTurnY[9] = {0, 1, 1, 1, 0, -1, -1, -1, 0};

double turn_weight(std::size_t i) { return i % 2 == 1 ? std::numbers::sqrt2 / 2 : 1; }

std::vector<double> arc_knots(std::size_t pieces) {
  std::vector<double> knots = {0};
  for (std::size_t k = 0; k <= pieces; ++k) knots.insert(knots.end(), 2, double(k) / double(pieces));
  knots.push_back(1);
  return knots;
}

}  // namespace

NurbsCurveData nurbs_circle(const SpaceFrame& frame, double radius) {
  NurbsCurveData made{2, arc_knots(4), {}, {}};
  for (std::size_t i = 0; i < 9; ++i) {
    made.points.push_back(frame.to_space({radius * kTurnX[i], radius * kTurnY[i], 0}));
    made.weights.push_back(turn_weight(i));
  }
  return made;
}

NurbsCurveData nurbs_arc(const SpaceFrame& frame, double radius, double from, double to) {
  if (!(from < to) || !(to - from < 2 * std::numbers::pi * (1 + 1e-12)))
    throw InputError("an arc goes from an angle to a larger one, by a full turn at most");
  const auto pieces = std::size_t(std::max(1.0, std::ceil((to - from) / (std::numbers::pi / 2) - 1e-9)));
  const double half = 0.5 * (to - from) / double(pieces), weight = std::cos(half);
  NurbsCurveData made{2, arc_knots(pieces), {}, {}};
  for (std::size_t i = 0; i <= 2 * pieces; ++i) {
    const double angle = from + half * double(i), r = i % 2 == 1 ? radius / weight : radius;
    made.points.push_back(frame.to_space({r * std::cos(angle), r * std::sin(angle), 0}));
    made.weights.push_back(i % 2 == 1 ? weight : 1);
  }
  return made;
}

NurbsSurfaceData revolve(const NurbsCurveData& curve, const SpaceFrame& frame) {
  check_nurbs(curve);
  double extent = 0;
  for (const Point& p : curve.points) extent = std::max(extent, distance(p, frame.origin));
  NurbsSurfaceData made;
  made.degree = {2, curve.degree};
  made.knots = {arc_knots(4), curve.knots};
  made.count = {9, curve.points.size()};
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t j = 0; j < curve.points.size(); ++j) {
      const Point from = curve.points[j] - frame.origin;
      double x = dot(from, frame.x), y = dot(from, frame.y);
      if (std::hypot(x, y) <= kOnAxis * extent) x = y = 0;
      const Point turned = {x * kTurnX[i] - y * kTurnY[i], x * kTurnY[i] + y * kTurnX[i], dot(from, frame.z)};
      made.points.push_back(frame.to_space(turned));
      made.weights.push_back(turn_weight(i) * (curve.weights.empty() ? 1 : curve.weights[j]));
    }
  return made;
}

NurbsSurfaceData nurbs_sphere(const SpaceFrame& frame, double radius) {
  NurbsCurveData half{2, arc_knots(2), {}, {}};
  for (std::size_t i = 0; i < 5; ++i) {
    const std::size_t turn = (i + 6) % 8;  // from below, by the x axis, upwards
    half.points.push_back(frame.to_space({radius * kTurnX[turn], 0, radius * kTurnY[turn]}));
    half.weights.push_back(turn_weight(i));
  }
  return revolve(half, frame);
}

NurbsSurfaceData nurbs_cylinder(const SpaceFrame& frame, double radius, double height) {
  return revolve({1, {0, 0, 1, 1}, {frame.to_space({radius, 0, 0}), frame.to_space({radius, 0, height})}, {}}, frame);
}

NurbsSurfaceData nurbs_torus(const SpaceFrame& frame, double radius, double tube) {
  // x and z of the frame are x and y of the circle's
  const SpaceFrame circle{frame.to_space({radius, 0, 0}), frame.x, frame.z, -1.0 * frame.y};
  return revolve(nurbs_circle(circle, tube), frame);
}

}  // namespace delfront
