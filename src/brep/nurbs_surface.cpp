// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "brep/nurbs_basis.hpp"

namespace delfront {
namespace {

constexpr double kSamePlace = 1e-12;       ///< of the extent of the control points
constexpr double kSameDirection = 1e-9;    ///< of the largest derivative
constexpr std::size_t kMostSamples = 400;  ///< along a side
constexpr double kSettled =
    1e-12;  ///< of the squared distance: a step of Newton's method that gains no more is the last
constexpr int kMostSteps = 40, kMostHalvings = 10;

class NurbsSurface final : public SmoothSurface {
 public:
  explicit NurbsSurface(const NurbsSurfaceData& data)
      : u_((check_nurbs(data), data.degree[0]), data.knots[0]),
        v_(data.degree[1], data.knots[1]),
        row_(data.count[1]),
        points_(weighted(data.points, data.weights)),
        is_rational_(!data.weights.empty()) {
    const std::size_t last_u = data.count[0] - 1, last_v = data.count[1] - 1;
    const auto is_one = [&](std::size_t begin, std::size_t step, std::size_t count) {
      for (std::size_t k = 1; k < count; ++k)
        if (!(data.points[begin + k * step] == data.points[begin])) return false;
      return true;
    };
    const auto begins = [](const KnotLine& line) { return line.knots()[0] == line.low(); };
    const auto ends = [](const KnotLine& line) { return line.knots().back() == line.high(); };
    sides_.u_low = begins(u_) && is_one(0, 1, data.count[1]);
    sides_.u_high = ends(u_) && is_one(last_u * row_, 1, data.count[1]);
    sides_.v_low = begins(v_) && is_one(0, row_, data.count[0]);
    sides_.v_high = ends(v_) && is_one(last_v, row_, data.count[0]);
    Box box;
    for (const Point& p : data.points) box.add(p);
    const std::array<bool, 2> closes = {sides_agree(true, box.diagonal()), sides_agree(false, box.diagonal())};
    if (closes[0]) period_[0] = u_.high() - u_.low();
    if (closes[1]) period_[1] = v_.high() - v_.low();
  }

  ParameterBox box() const override { return {{u_.low(), v_.low()}, {u_.high(), v_.high()}}; }
  std::array<double, 2> period() const override { return period_; }
  DegenerateSides degenerate_sides() const override { return sides_; }

  SurfaceDerivatives derivatives(Point2 uv) const override {
    return with_degrees([&]<int kU, int kV>() { return second_order<kU, kV>(uv); });
  }
  SurfaceTangents tangents(Point2 uv) const override {
    return with_degrees([&]<int kU, int kV>() { return first_order<kU, kV>(uv); });
  }

  Point2 closest(Point p, Point2 start) const override;

 private:
  struct Place {
    std::size_t span_u, span_v;
    Basis u, v;
  };

  /// What is computed with the degrees known to the compiler where they are usual ones, else with 0 for both.
  template <class Work>
  auto with_degrees(const Work& work) const -> decltype(work.template operator()<0, 0>()) {
    const auto with_v = [&]<int kU>() {
      switch (v_.degree()) {
        case 1:
          return work.template operator()<kU, 1>();
        case 2:
          return work.template operator()<kU, 2>();
        case 3:
          return work.template operator()<kU, 3>();
        case 4:
          return work.template operator()<kU, 4>();
        default:
          return work.template operator()<0, 0>();
      }
    };
    switch (u_.degree()) {
      case 1:
        return with_v.template operator()<1>();
      case 2:
        return with_v.template operator()<2>();
      case 3:
        return with_v.template operator()<3>();
      case 4:
        return with_v.template operator()<4>();
      default:
        return work.template operator()<0, 0>();
    }
  }

  template <int kU, int kV>
  void find_basis(Point2 uv, int orders, Place& b) const {
    if (period_[0] > 0) uv.x = u_.wrapped(uv.x);
    if (period_[1] > 0) uv.y = v_.wrapped(uv.y);
    b.span_u = u_.span(uv.x);
    b.span_v = v_.span(uv.y);
    u_.basis<kU>(b.span_u, uv.x, orders, b.u);
    v_.basis<kV>(b.span_v, uv.y, orders, b.v);
  }
  const Point4* row(const Place& b, int i, int p, int q) const {
    return points_.data() + (b.span_u - std::size_t(p) + std::size_t(i)) * row_ + b.span_v - std::size_t(q);
  }

  template <int kU, int kV>
  SurfaceDerivatives second_order(Point2 uv) const {
    const int p = kU > 0 ? kU : u_.degree(), q = kV > 0 ? kV : v_.degree();
    Place b;
    find_basis<kU, kV>(uv, 2, b);
    Point4 at = Point4::Zero(), u = at, v = at, uu = at, mixed = at, vv = at;
    for (int i = 0; i <= p; ++i) {
      const Point4* const control = row(b, i, p, q);
      Point4 value = Point4::Zero(), first = value, second = value;
      for (int j = 0; j <= q; ++j) {
        value += b.v.value[j] * control[j];
        first += b.v.first[j] * control[j];
        second += b.v.second[j] * control[j];
      }
      at += b.u.value[i] * value;
      u += b.u.first[i] * value;
      v += b.u.value[i] * first;
      uu += b.u.second[i] * value;
      mixed += b.u.first[i] * first;
      vv += b.u.value[i] * second;
    }
    if (!is_rational_) return {to_point(at), to_point(u), to_point(v), to_point(uu), to_point(mixed), to_point(vv)};
    const double over = 1 / at[3];  // A4.4
    SurfaceDerivatives s;
    s.at = over * to_point(at);
    s.u = over * (to_point(u) - u[3] * s.at);
    s.v = over * (to_point(v) - v[3] * s.at);
    s.uu = over * (to_point(uu) - 2 * u[3] * s.u - uu[3] * s.at);
    s.uv = over * (to_point(mixed) - u[3] * s.v - v[3] * s.u - mixed[3] * s.at);
    s.vv = over * (to_point(vv) - 2 * v[3] * s.v - vv[3] * s.at);
    return s;
  }

  template <int kU, int kV>
  SurfaceTangents first_order(Point2 uv) const {
    const int p = kU > 0 ? kU : u_.degree(), q = kV > 0 ? kV : v_.degree();
    Place b;
    find_basis<kU, kV>(uv, 1, b);
    Point4 at = Point4::Zero(), u = at, v = at;
    for (int i = 0; i <= p; ++i) {
      const Point4* const control = row(b, i, p, q);
      Point4 value = Point4::Zero(), first = value;
      for (int j = 0; j <= q; ++j) {
        value += b.v.value[j] * control[j];
        first += b.v.first[j] * control[j];
      }
      at += b.u.value[i] * value;
      u += b.u.first[i] * value;
      v += b.u.value[i] * first;
    }
    if (!is_rational_) return {to_point(at), to_point(u), to_point(v)};
    const double over = 1 / at[3];
    const Point place = over * to_point(at);
    return {place, over * (to_point(u) - u[3] * place), over * (to_point(v) - v[3] * place)};
  }

  /// Whether the sides across u (or v) are the same in space, and go on into each other.
  bool sides_agree(bool across_u, double extent) const {
    const KnotLine &ends = across_u ? u_ : v_, &along = across_u ? v_ : u_;
    std::vector<double> at;
    const std::vector<double>& knots = along.knots();
    const auto p = std::size_t(along.degree());
    const std::size_t every = 1 + (knots.size() - 2 * p) * (p + 1) / kMostSamples;
    for (std::size_t i = p; i + p + 1 < knots.size(); i += every)
      for (std::size_t k = 0; k <= p && knots[i] < knots[i + 1]; ++k)
        at.push_back(knots[i] + (knots[i + 1] - knots[i]) * (double(k) + 0.5) / double(p + 1));
    double apart = 0, turned = 0, most = 0;
    for (const double t : at) {
      const SurfaceTangents a = tangents(across_u ? Point2{ends.low(), t} : Point2{t, ends.low()});
      const SurfaceTangents b = tangents(across_u ? Point2{ends.high(), t} : Point2{t, ends.high()});
      apart = std::max(apart, distance(a.at, b.at));
      turned = std::max(turned, across_u ? distance(a.u, b.u) : distance(a.v, b.v));
      most = std::max(most, length(across_u ? a.u : a.v));
    }
    return apart <= kSamePlace * extent && turned <= kSameDirection * most;
  }

  KnotLine u_, v_;
  std::size_t row_;
  std::vector<Point4> points_;
  bool is_rational_;
  std::array<double, 2> period_{0, 0};
  DegenerateSides sides_;
};

/// One parameter of Newton's method: held at a side of the box where the way on leads outside.
struct Side {
  double low, high;
  bool is_free;  ///< a period
  bool holds(double t, double descent) const {
    return !is_free && ((t <= low && descent < 0) || (t >= high && descent > 0));
  }
  double kept(double t) const { return is_free ? t : std::clamp(t, low, high); }
};

/// The step from a place towards the nearest, along the parameters that are not held.
Point2 newton_step(const SurfaceDerivatives& s, Point r, bool holds_u, bool holds_v) {
  const double fu = dot(r, s.u), fv = dot(r, s.v), e = dot(s.u, s.u), f = dot(s.u, s.v), g = dot(s.v, s.v);
  double a = e + dot(r, s.uu), c = f + dot(r, s.uv), d = g + dot(r, s.vv);
  const auto alone = [](double slope, double bend, double square) {
    const double by = bend > 1e-3 * square ? bend : square;
    return by > 0 ? -slope / by : 0;
  };
  if (holds_u && holds_v) return {0, 0};
  if (holds_u) return {0, alone(fv, d, g)};
  if (holds_v) return {alone(fu, a, e), 0};
  if (!(a * d - c * c > 1e-3 * e * g) || !(a > 0)) a = e, c = f, d = g;  // not convex: Gauss and Newton
  const double det = a * d - c * c;
  if (!(det > 1e-14 * a * d)) return {alone(fu, a, e), alone(fv, d, g)};
  return {-(d * fu - c * fv) / det, -(a * fv - c * fu) / det};
}

}  // namespace

Point2 NurbsSurface::closest(Point p, Point2 start) const {
  const Side u{u_.low(), u_.high(), period_[0] > 0}, v{v_.low(), v_.high(), period_[1] > 0};
  Point2 uv = start;
  SurfaceDerivatives s = derivatives(uv);
  double best = squared_length(s.at - p);
  for (int step = 0; step < kMostSteps; ++step) {
    const Point r = s.at - p;
    Point2 by = newton_step(s, r, u.holds(uv.x, -dot(r, s.u)), v.holds(uv.y, -dot(r, s.v)));
    bool is_nearer = false;
    const double before = best;
    for (int halving = 0; halving < kMostHalvings && !is_nearer; ++halving) {
      const Point2 next = {u.kept(uv.x + by.x), v.kept(uv.y + by.y)};
      const SurfaceDerivatives there = derivatives(next);
      const double away = squared_length(there.at - p);
      is_nearer = away < best;
      by = {0.5 * by.x, 0.5 * by.y};
      if (!is_nearer) continue;
      best = away;
      uv = next;
      s = there;
    }
    if (!is_nearer || before - best <= kSettled * before) break;
  }
  return uv;
}

SurfacePointer make_nurbs_surface(const NurbsSurfaceData& data) { return std::make_shared<NurbsSurface>(data); }

}  // namespace delfront
