// SPDX-License-Identifier: Apache-2.0
// From a place in the middle of the edge the nearest place on the surface is searched for all over it; from there on
// each sample begins where the one before ended, so that seams are run over without a jump. At a pole, where one of the
// parameters says nothing, the curve runs on as it came.
#include "geometry_text/projection.hpp"

#include <algorithm>
#include <cmath>

#include "delfront/nurbs.hpp"

namespace delfront {
namespace {

constexpr std::size_t kSamples = 128;  ///< pieces of the edge
constexpr double kFlat = 1e-10;        ///< sine squared between tangents: a pole

class ProjectedCurve final : public ParameterCurve {
 public:
  ProjectedCurve(SurfacePointer surface, CurvePointer edge, std::array<double, 2> range, std::vector<Point2> samples)
      : surface_(std::move(surface)), edge_(std::move(edge)), range_(range), samples_(std::move(samples)) {}

  ParameterCurveDerivatives derivatives(double t) const override {
    const auto last = double(samples_.size() - 1);
    const double step = (range_[1] - range_[0]) / last, place = std::clamp((t - range_[0]) / step, 0.0, last);
    const auto i = std::min(std::size_t(place), samples_.size() - 2);
    const double f = place - double(i);
    const Point2 a = samples_[i], b = samples_[i + 1];
    ParameterCurveDerivatives d;
    d.at = {(1 - f) * a.x + f * b.x, (1 - f) * a.y + f * b.y};
    d.first = {(b.x - a.x) / step, (b.y - a.y) / step};
    if (f == 0 || f == 1) {
      if (f == 1) d.at = b;
    } else {
      d.at = surface_->closest(edge_->at(t), d.at);
    }
    const SurfaceDerivatives s = surface_->derivatives(d.at);
    const CurveDerivatives c = edge_->derivatives(t);
    const double e = dot(s.u, s.u), g = dot(s.u, s.v), h = dot(s.v, s.v), det = e * h - g * g;
    if (!(det > kFlat * e * h)) return d;
    const auto solve = [&](Point p) {
      const double pu = dot(p, s.u), pv = dot(p, s.v);
      return Point2{(h * pu - g * pv) / det, (e * pv - g * pu) / det};
    };
    d.first = solve(c.first);
    d.second = solve(c.second - d.first.x * d.first.x * s.uu - 2 * d.first.x * d.first.y * s.uv -
                     d.first.y * d.first.y * s.vv);
    return d;
  }

 private:
  SurfacePointer surface_;
  CurvePointer edge_;
  std::array<double, 2> range_;
  std::vector<Point2> samples_;
};

class MovedCurve final : public ParameterCurve {
 public:
  MovedCurve(ParameterCurvePointer curve, Point2 by) : curve_(std::move(curve)), by_(by) {}
  ParameterCurveDerivatives derivatives(double t) const override {
    ParameterCurveDerivatives d = curve_->derivatives(t);
    d.at = {d.at.x + by_.x, d.at.y + by_.y};
    return d;
  }

 private:
  ParameterCurvePointer curve_;
  Point2 by_;
};

class Walk {
 public:
  Walk(const SurfacePointer& surface, std::vector<Point> places)
      : surface_(*surface), places_(std::move(places)), uv_(places_.size()) {}

  std::vector<Point2> run(Point2 middle) {
    const std::size_t start = places_.size() / 2;
    uv_[start] = middle;
    for (std::size_t i = start + 1; i < places_.size(); ++i) place(i, -1, i == start + 1);
    for (std::size_t i = start; i-- > 0;) place(i, 1, false);
    return std::move(uv_);
  }

 private:
  void place(std::size_t i, int from, bool is_first) {
    const Point2 last = uv_[i + std::size_t(from)];
    Point2 start = last;
    if (!is_first) {
      const Point2 before = uv_[i + std::size_t(2 * from)];
      start = {2 * last.x - before.x, 2 * last.y - before.y};
    }
    Point2 found = surface_.closest(places_[i], start);
    if (distance(surface_.at(found), places_[i]) > 2 * distance(surface_.at(last), places_[i]) + 0.0)
      found = surface_.closest(places_[i], last);  // the way on was none
    const ParameterBox box = surface_.box();
    const DegenerateSides sides = surface_.degenerate_sides();
    const auto snap = [](double& value, double side, double end, double before) {
      if (std::abs(value - side) <= 1e-6 * std::abs(end - side)) value = side;
      return value == side && before != side;
    };
    if ((sides.v_low && snap(found.y, box.low.y, box.high.y, last.y)) ||
        (sides.v_high && snap(found.y, box.high.y, box.low.y, last.y)))
      found.x = start.x;
    if ((sides.u_low && snap(found.x, box.low.x, box.high.x, last.x)) ||
        (sides.u_high && snap(found.x, box.high.x, box.low.x, last.x)))
      found.y = start.y;
    uv_[i] = found;
  }

  const SmoothSurface& surface_;
  std::vector<Point> places_;
  std::vector<Point2> uv_;
};

}  // namespace

ParameterBox finite_box(const SmoothSurface& surface, double reach) {
  ParameterBox box = surface.box();
  if (!std::isfinite(box.low.x)) box.low.x = -reach;
  if (!std::isfinite(box.low.y)) box.low.y = -reach;
  if (!std::isfinite(box.high.x)) box.high.x = reach;
  if (!std::isfinite(box.high.y)) box.high.y = reach;
  return box;
}

Projection project_edge(const SurfacePointer& surface, const CurvePointer& edge, std::array<double, 2> range,
                        double reach) {
  std::vector<Point> places;
  for (std::size_t i = 0; i <= kSamples; ++i) {
    const double f = double(i) / double(kSamples);
    places.push_back(edge->at((1 - f) * range[0] + f * range[1]));
  }
  const SurfaceSearch search(surface, finite_box(*surface, reach), {25, 25});
  std::vector<Point2> uv = Walk(surface, places).run(search.closest(places[kSamples / 2]).uv);
  Projection result;
  for (std::size_t i = 0; i <= kSamples; ++i) {
    const double away = distance(surface->at(uv[i]), places[i]);
    if (away <= result.farthest) continue;
    result.farthest = away;
    result.farthest_at = places[i];
  }
  result.curve = std::make_shared<ProjectedCurve>(surface, edge, range, std::move(uv));
  return result;
}

ParameterCurvePointer move_parameter_curve(ParameterCurvePointer curve, Point2 by) {
  if (by.x == 0 && by.y == 0) return curve;
  return std::make_shared<MovedCurve>(std::move(curve), by);
}

}  // namespace delfront
