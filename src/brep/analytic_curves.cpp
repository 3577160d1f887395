// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "delfront/brep_shapes.hpp"

namespace delfront {
namespace {

class Line : public SmoothCurve {
 public:
  Line(Point from, Point to) : from_(from), to_(to) {}
  CurveDerivatives derivatives(double t) const override { return {at(t), to_ - from_, {}}; }
  Point at(double t) const override { return (1 - t) * from_ + t * to_; }  // both ends exactly
  std::array<double, 2> range() const override { return {0, 1}; }

 private:
  Point from_, to_;
};

class Ellipse : public SmoothCurve {
 public:
  Ellipse(const SpaceFrame& frame, double a, double b) : frame_(frame), a_(a), b_(b) {}
  CurveDerivatives derivatives(double t) const override {
    const double c = std::cos(t), s = std::sin(t);
    const Point out = frame_.turn({a_ * c, b_ * s, 0});
    return {frame_.origin + out, frame_.turn({-a_ * s, b_ * c, 0}), -1.0 * out};
  }
  std::array<double, 2> range() const override { return {0, 2 * std::numbers::pi}; }
  bool is_closed() const override { return true; }

 private:
  SpaceFrame frame_;
  double a_, b_;
};

class Cubic : public SmoothCurve {
 public:
  explicit Cubic(const std::array<Point, 4>& control) : b_(control) {}
  CurveDerivatives derivatives(double t) const override {
    const double s = 1 - t;
    const Point p = s * b_[0] + t * b_[1], q = s * b_[1] + t * b_[2], r = s * b_[2] + t * b_[3];
    const Point pq = s * p + t * q, qr = s * q + t * r;
    return {s * pq + t * qr, 3 * (qr - pq), 6 * (r - 2 * q + p)};
  }
  std::array<double, 2> range() const override { return {0, 1}; }

 private:
  std::array<Point, 4> b_;
};

class CurveOnSurface : public SmoothCurve {
 public:
  CurveOnSurface(SurfacePointer surface, ParameterCurvePointer curve, std::array<double, 2> range, bool is_closed)
      : surface_(std::move(surface)), curve_(std::move(curve)), range_(range), is_closed_(is_closed) {}
  CurveDerivatives derivatives(double t) const override {
    const auto [uv, d, dd] = curve_->derivatives(t);
    const SurfaceDerivatives s = surface_->derivatives(uv);
    return {s.at, d.x * s.u + d.y * s.v,
            d.x * d.x * s.uu + 2 * d.x * d.y * s.uv + d.y * d.y * s.vv + dd.x * s.u + dd.y * s.v};
  }
  Point at(double t) const override { return surface_->at(curve_->at(t)); }
  std::array<double, 2> range() const override { return range_; }
  bool is_closed() const override { return is_closed_; }

 private:
  SurfacePointer surface_;
  ParameterCurvePointer curve_;
  std::array<double, 2> range_;
  bool is_closed_;
};

class ParameterLine : public ParameterCurve {
 public:
  ParameterLine(Point2 from, Point2 to, std::array<double, 2> range) : from_(from), to_(to), range_(range) {}
  ParameterCurveDerivatives derivatives(double t) const override {
    const double over = 1 / (range_[1] - range_[0]), f = (t - range_[0]) * over, g = 1 - f;
    const Point2 along = {(to_.x - from_.x) * over, (to_.y - from_.y) * over};
    return {{g * from_.x + f * to_.x, g * from_.y + f * to_.y}, along, {0, 0}};
  }

 private:
  Point2 from_, to_;
  std::array<double, 2> range_;
};

class ParameterEllipse : public ParameterCurve {
 public:
  ParameterEllipse(Point2 centre, double a, double b) : centre_(centre), a_(a), b_(b) {}
  ParameterCurveDerivatives derivatives(double t) const override {
    const double c = std::cos(t), s = std::sin(t);
    return {{centre_.x + a_ * c, centre_.y + b_ * s}, {-a_ * s, b_ * c}, {-a_ * c, -b_ * s}};
  }

 private:
  Point2 centre_;
  double a_, b_;
};

}  // namespace

CurvePointer make_line(Point from, Point to) { return std::make_shared<Line>(from, to); }
CurvePointer make_ellipse(const SpaceFrame& frame, double a, double b) {
  return std::make_shared<Ellipse>(frame, a, b);
}
CurvePointer make_cubic(const std::array<Point, 4>& control) { return std::make_shared<Cubic>(control); }
CurvePointer make_curve_on(SurfacePointer surface, ParameterCurvePointer curve, std::array<double, 2> range,
                           bool is_closed) {
  return std::make_shared<CurveOnSurface>(std::move(surface), std::move(curve), range, is_closed);
}
ParameterCurvePointer make_parameter_line(Point2 from, Point2 to, std::array<double, 2> range) {
  return std::make_shared<ParameterLine>(from, to, range);
}
ParameterCurvePointer make_parameter_ellipse(Point2 centre, double a, double b) {
  return std::make_shared<ParameterEllipse>(centre, a, b);
}

}  // namespace delfront
