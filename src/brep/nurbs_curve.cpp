// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "brep/nurbs_basis.hpp"

namespace delfront {
namespace {

constexpr double kSamePlace = 1e-12;     ///< of the extent of the control points
constexpr double kSameDirection = 1e-9;  ///< of the derivative

/// What curves in space and in the plane have in common.
class Spline {
 public:
  explicit Spline(const NurbsCurveData& data)
      : line_((check_nurbs(data), data.degree), data.knots),
        points_(weighted(data.points, data.weights)),
        is_rational_(!data.weights.empty()) {
    is_closed_ = ends_agree(data);
  }

  std::array<double, 2> range() const { return {line_.low(), line_.high()}; }
  bool is_closed() const { return is_closed_; }

  CurveDerivatives derivatives(double t) const {
    switch (line_.degree()) {
      case 1:
        return evaluate<1>(t);
      case 2:
        return evaluate<2>(t);
      case 3:
        return evaluate<3>(t);
      default:
        return evaluate<0>(t);
    }
  }

 private:
  template <int kDegree>
  CurveDerivatives evaluate(double t) const {
    const int p = kDegree > 0 ? kDegree : line_.degree();
    if (is_closed_) t = line_.wrapped(t);
    const std::size_t span = line_.span(t);
    Basis b;
    line_.basis<kDegree>(span, t, 2, b);
    Point4 at = Point4::Zero(), first = Point4::Zero(), second = Point4::Zero();
    const Point4* const control = points_.data() + span - std::size_t(p);
    for (int i = 0; i <= p; ++i) {
      at += b.value[i] * control[i];
      first += b.first[i] * control[i];
      second += b.second[i] * control[i];
    }
    if (!is_rational_) return {to_point(at), to_point(first), to_point(second)};
    const double over = 1 / at[3];  // A4.2
    CurveDerivatives d;
    d.at = over * to_point(at);
    d.first = over * (to_point(first) - first[3] * d.at);
    d.second = over * (to_point(second) - 2 * first[3] * d.first - second[3] * d.at);
    return d;
  }

  bool ends_agree(const NurbsCurveData& data) const {
    Box box;
    for (const Point& p : data.points) box.add(p);
    const CurveDerivatives a = derivatives(line_.low()), b = derivatives(line_.high());
    return distance(a.at, b.at) <= kSamePlace * box.diagonal() &&
           distance(a.first, b.first) <= kSameDirection * length(a.first);
  }

  KnotLine line_;
  std::vector<Point4> points_;
  bool is_rational_, is_closed_ = false;
};

class NurbsCurve final : public SmoothCurve {
 public:
  explicit NurbsCurve(const NurbsCurveData& data) : spline_(data) {}
  CurveDerivatives derivatives(double t) const override { return spline_.derivatives(t); }
  std::array<double, 2> range() const override { return spline_.range(); }
  bool is_closed() const override { return spline_.is_closed(); }

 private:
  Spline spline_;
};

class NurbsParameterCurve final : public ParameterCurve {
 public:
  explicit NurbsParameterCurve(const NurbsCurveData& data) : spline_(data) {}
  ParameterCurveDerivatives derivatives(double t) const override {
    const CurveDerivatives d = spline_.derivatives(t);
    return {{d.at.x, d.at.y}, {d.first.x, d.first.y}, {d.second.x, d.second.y}};
  }

 private:
  Spline spline_;
};

}  // namespace

CurvePointer make_nurbs_curve(const NurbsCurveData& data) { return std::make_shared<NurbsCurve>(data); }
ParameterCurvePointer make_nurbs_parameter_curve(const NurbsCurveData& data) {
  return std::make_shared<NurbsParameterCurve>(data);
}

}  // namespace delfront
