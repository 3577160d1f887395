// SPDX-License-Identifier: Apache-2.0
// What CAD has and smooth geometry elsewhere has not: lines by arc length, cones by their radius at a height, surfaces
// by extrusion and revolution, and what another library evaluates.
#include "cad/shapes.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "delfront/errors.hpp"

namespace delfront::cad {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kPoint = 1e-9;  ///< of the extent: sides of a surface that are one point
constexpr int kSamples = 16;     ///< along a side

class LineCurve final : public SmoothCurve {
 public:
  LineCurve(Point origin, Point along) : origin_(origin), along_(along) {}
  CurveDerivatives derivatives(double t) const override { return {origin_ + t * along_, along_, {}}; }
  std::array<double, 2> range() const override { return {-kInfinite, kInfinite}; }

 private:
  Point origin_, along_;
};

class OtherCurveOf final : public SmoothCurve {
 public:
  explicit OtherCurveOf(const CurveData& data) : other_(data.other), range_(data.range) {}
  CurveDerivatives derivatives(double t) const override { return other_->derivatives(t); }
  std::array<double, 2> range() const override { return range_; }

 private:
  std::shared_ptr<const OtherCurve> other_;
  std::array<double, 2> range_;
};

/// origin + f x + g y, with f, g = t, 0 or cos t, sin t.
class RoundOrStraight final : public ParameterCurve {
 public:
  explicit RoundOrStraight(const ParameterCurveData& data)
      : origin_(data.origin), x_(data.x), y_(data.y), is_round_(data.kind == ParameterCurveData::Kind::ellipse) {}
  ParameterCurveDerivatives derivatives(double t) const override {
    if (!is_round_) return {place(t, 0), {x_.x, x_.y}, {}};
    const double c = std::cos(t), s = std::sin(t);
    return {place(c, s), {c * y_.x - s * x_.x, c * y_.y - s * x_.y}, {-c * x_.x - s * y_.x, -c * x_.y - s * y_.y}};
  }

 private:
  Point2 place(double f, double g) const { return {origin_.x + f * x_.x + g * y_.x, origin_.y + f * x_.y + g * y_.y}; }
  Point2 origin_, x_, y_;
  bool is_round_;
};

class OtherParameterCurveOf final : public ParameterCurve {
 public:
  explicit OtherParameterCurveOf(std::shared_ptr<const OtherParameterCurve> other) : other_(std::move(other)) {}
  ParameterCurveDerivatives derivatives(double t) const override { return other_->derivatives(t); }

 private:
  std::shared_ptr<const OtherParameterCurve> other_;
};

/// Radius r at v = 0, more by the half angle's sine for each unit of v; the tip is where it is 0.
class RadiusCone final : public SmoothSurface {
 public:
  RadiusCone(const SurfaceData& data, const ParameterBox& used)
      : f_(data.frame), r_(data.a), out_(std::sin(data.b)), up_(std::cos(data.b)) {
    const double tip = out_ == 0 ? kInfinite : -r_ / out_, slack = 1e-6 * (used.high.y - used.low.y);
    if (out_ > 0 && used.low.y >= tip - slack) low_ = tip, sides_.v_low = true;
    if (out_ < 0 && used.high.y <= tip + slack) high_ = tip, sides_.v_high = true;
  }
  ParameterBox box() const override { return {{0, low_}, {kTurn, high_}}; }
  std::array<double, 2> period() const override { return {kTurn, 0}; }
  DegenerateSides degenerate_sides() const override { return sides_; }
  SurfaceDerivatives derivatives(Point2 uv) const override {
    const Point round = std::cos(uv.x) * f_.x + std::sin(uv.x) * f_.y;
    const Point on = std::cos(uv.x) * f_.y - std::sin(uv.x) * f_.x;
    const double r = r_ + uv.y * out_;
    return {f_.origin + r * round + uv.y * up_ * f_.z, r * on, out_ * round + up_ * f_.z, -r * round, out_ * on, {}};
  }

 private:
  SpaceFrame f_;
  double r_, out_, up_, low_ = -kInfinite, high_ = kInfinite;
  DegenerateSides sides_;
};

class Extrusion final : public SmoothSurface {
 public:
  explicit Extrusion(const SurfaceData& data)
      : curve_(make_curve(data.curve)), way_(data.frame.z), box_(data.box), period_(data.period) {}
  ParameterBox box() const override { return box_; }
  std::array<double, 2> period() const override { return period_; }
  SurfaceDerivatives derivatives(Point2 uv) const override {
    const CurveDerivatives c = curve_->derivatives(uv.x);
    return {c.at + uv.y * way_, c.first, way_, c.second, {}, {}};
  }

 private:
  CurvePointer curve_;
  Point way_;
  ParameterBox box_;
  std::array<double, 2> period_;
};

class Revolution final : public SmoothSurface {
 public:
  explicit Revolution(const SurfaceData& data)
      : curve_(make_curve(data.curve)),
        origin_(data.frame.origin),
        axis_(data.frame.z),
        box_(data.box),
        period_(data.period) {
    double extent = 0;
    const auto away = [&](double v) { return length(cross(curve_->at(v) - origin_, axis_)); };
    if (!std::isfinite(box_.high.y - box_.low.y)) return;
    for (int i = 0; i <= kSamples; ++i)
      extent = std::max(extent, away(box_.low.y + i * (box_.high.y - box_.low.y) / kSamples));
    sides_.v_low = away(box_.low.y) <= kPoint * extent;
    sides_.v_high = away(box_.high.y) <= kPoint * extent;
  }
  ParameterBox box() const override { return box_; }
  std::array<double, 2> period() const override { return period_; }
  DegenerateSides degenerate_sides() const override { return sides_; }
  SurfaceDerivatives derivatives(Point2 uv) const override {
    const CurveDerivatives c = curve_->derivatives(uv.y);
    const Turned at(c.at - origin_, axis_, uv.x), first(c.first, axis_, uv.x), second(c.second, axis_, uv.x);
    return {origin_ + at.there, at.once, first.there, at.twice, first.once, second.there};
  }

 private:
  /// A vector turned round the axis, and its derivatives by the angle.
  struct Turned {
    Turned(Point d, Point axis, double angle) {
      const Point along = dot(d, axis) * axis, out = d - along, on = cross(axis, d);
      const double cosine = std::cos(angle), sine = std::sin(angle);
      there = along + cosine * out + sine * on;
      once = cosine * on - sine * out;
      twice = -cosine * out - sine * on;
    }
    Point there, once, twice;
  };
  CurvePointer curve_;
  Point origin_, axis_;
  ParameterBox box_;
  std::array<double, 2> period_;
  DegenerateSides sides_;
};

class OtherSurfaceOf final : public SmoothSurface {
 public:
  OtherSurfaceOf(const SurfaceData& data, const ParameterBox& used)
      : other_(data.other), box_(data.box), period_(data.period) {
    Box extent;
    for (int i = 0; i <= kSamples; ++i)
      for (int j = 0; j <= kSamples; ++j) extent.add(other_->derivatives(between(used, i, j)).at);
    const double near = kPoint * extent.diagonal();
    sides_.v_low = is_point(near, [&](int i) { return Point2{between(used, i, 0).x, box_.low.y}; });
    sides_.v_high = is_point(near, [&](int i) { return Point2{between(used, i, 0).x, box_.high.y}; });
    sides_.u_low = is_point(near, [&](int i) { return Point2{box_.low.x, between(used, 0, i).y}; });
    sides_.u_high = is_point(near, [&](int i) { return Point2{box_.high.x, between(used, 0, i).y}; });
  }
  ParameterBox box() const override { return box_; }
  std::array<double, 2> period() const override { return period_; }
  DegenerateSides degenerate_sides() const override { return sides_; }
  SurfaceDerivatives derivatives(Point2 uv) const override { return other_->derivatives(uv); }

 private:
  static Point2 between(const ParameterBox& b, int i, int j) {
    return {b.low.x + i * (b.high.x - b.low.x) / kSamples, b.low.y + j * (b.high.y - b.low.y) / kSamples};
  }
  template <class Place>
  bool is_point(double near, const Place& place) const {
    if (!std::isfinite(place(0).x) || !std::isfinite(place(0).y)) return false;
    const Point first = other_->derivatives(place(0)).at;
    for (int i = 1; i <= kSamples; ++i)
      if (!(distance(first, other_->derivatives(place(i)).at) <= near)) return false;
    return true;
  }
  std::shared_ptr<const OtherSurface> other_;
  ParameterBox box_;
  std::array<double, 2> period_;
  DegenerateSides sides_;
};

SurfacePointer make_spline_surface(const SurfaceData& data, const ParameterBox& used) {
  SurfacePointer ours = make_nurbs_surface(data.nurbs);
  if (!data.other) return ours;  // the face stays within the knots
  const bool is_same =
      (data.period[0] > 0) == (ours->period()[0] > 0) && (data.period[1] > 0) == (ours->period()[1] > 0);
  return is_same ? ours : std::make_shared<OtherSurfaceOf>(data, used);
}

}  // namespace

CurvePointer make_curve(const CurveData& data) {
  switch (data.kind) {
    case CurveData::Kind::none:
      return nullptr;
    case CurveData::Kind::line:
      return std::make_shared<LineCurve>(data.frame.origin, data.frame.x);
    case CurveData::Kind::ellipse:
      return make_ellipse(data.frame, data.a, data.b);
    case CurveData::Kind::nurbs:
      return make_nurbs_curve(data.nurbs);
    case CurveData::Kind::other:
      break;
  }
  return std::make_shared<OtherCurveOf>(data);
}

ParameterCurvePointer make_parameter_curve(const ParameterCurveData& data) {
  if (data.kind == ParameterCurveData::Kind::nurbs) return make_nurbs_parameter_curve(data.nurbs);
  if (data.kind == ParameterCurveData::Kind::other) return std::make_shared<OtherParameterCurveOf>(data.other);
  return std::make_shared<RoundOrStraight>(data);
}

SurfacePointer make_surface(const SurfaceData& data, const ParameterBox& used) {
  using Kind = SurfaceData::Kind;
  switch (data.kind) {
    case Kind::plane:
      return make_plane_surface(data.frame);
    case Kind::cylinder:
      return make_cylinder_surface(data.frame, data.a);
    case Kind::cone:
      return std::make_shared<RadiusCone>(data, used);
    case Kind::sphere:
      return make_sphere_surface(data.frame, data.a);
    case Kind::torus:
      return make_torus_surface(data.frame, data.a, data.b);
    case Kind::nurbs:
      return make_spline_surface(data, used);
    case Kind::extrusion:
      return std::make_shared<Extrusion>(data);
    case Kind::revolution:
      return std::make_shared<Revolution>(data);
    case Kind::other:
      break;
  }
  return std::make_shared<OtherSurfaceOf>(data, used);
}

}  // namespace delfront::cad
