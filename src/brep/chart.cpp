// SPDX-License-Identifier: Apache-2.0
#include "brep/chart.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace delfront {
namespace {

constexpr int kPieces = 256, kAcross = 9;  ///< of tables; samples across for means
constexpr int kFewPieces = 32;             ///< of tables where lengths are even
constexpr double kEven = 1.0001;           ///< ratio of lengths that are
constexpr double kAlmostStraight = 1.01;   ///< ratio of slopes
constexpr double kMostTurn = 1.9 * std::numbers::pi;
constexpr double kNearPole = 0.5;      ///< of the length from the pole: there ...
constexpr double kMostPower = 2;       ///< ... the radius grows with that power at most: lips would shrink to nothing
constexpr double kLeastAround = 1e-3;  ///< of the widest: another pole at the far end
constexpr double kLeastUnrolled = 1.3 * std::numbers::pi;  ///< with less, few triangles at the tip turn by too much
constexpr double kFullTurn = 1 - 1e-9;                     ///< of a period

/// So that charts of scaled copies are the same.
std::vector<double> in_units(std::vector<double> values, double unit) {
  for (double& value : values) value /= unit;
  return values;
}

}  // namespace

RisingTable::RisingTable(double first, double step, std::vector<double> values)
    : first_(first), step_(step), values_(std::move(values)) {
  double least = 1e300, most = 0;
  for (std::size_t i = 0; i + 1 < values_.size(); ++i) {
    least = std::min(least, values_[i + 1] - values_[i]);
    most = std::max(most, values_[i + 1] - values_[i]);
  }
  if (most > kAlmostStraight * least) return;
  step_ *= double(values_.size() - 1);
  values_ = {values_.front(), values_.back()};
}

double RisingTable::at(double x) const {
  const double place = (x - first_) / step_;
  const auto i = std::size_t(std::min(std::max(0.0, place), double(values_.size() - 2)));  // 0 where it is no number
  const double f = place - double(i);
  return (1 - f) * values_[i] + f * values_[i + 1];
}

RisingTable::Inverse RisingTable::inverse(double y) const {
  std::size_t i = 0;
  if (values_.size() > 2) {
    const auto above = std::upper_bound(values_.begin() + 1, values_.end() - 1, y);
    i = std::size_t(above - values_.begin()) - 1;
  }
  const double slope = step_ / (values_[i + 1] - values_[i]);
  return {first_ + double(i) * step_ + (y - values_[i]) * slope, slope};
}

Chart::Chart(const SmoothSurface& surface, const ParameterBox& box, Pole pole) : surface_(surface), pole_(pole) {
  if (pole == Pole::none)
    make_linear(box);
  else
    make_polar(box);
}

void Chart::make_linear(const ParameterBox& box) {
  const double wide = box.high.x - box.low.x, tall = box.high.y - box.low.y;
  const auto table = [&](bool along_u, int pieces) {
    const double step = (along_u ? wide : tall) / pieces;
    const auto count = static_cast<std::size_t>(pieces);
    std::vector<double> lengths(count), values = {0};
    double all = 0;
    for (int i = 0; i < pieces; ++i) {
      for (int j = 0; j < kAcross; ++j) {
        const double f = (i + 0.5) / pieces, g = (j + 0.5) / kAcross;
        const SurfaceTangents s =
            surface_.tangents({box.low.x + (along_u ? f : g) * wide, box.low.y + (along_u ? g : f) * tall});
        lengths[std::size_t(i)] += length(along_u ? s.u : s.v) / kAcross;
      }
      all += lengths[std::size_t(i)];
    }
    for (const double l : lengths) values.push_back(values.back() + std::max(l, 1e-3 * all / pieces) * step);
    const auto [least, most] = std::minmax_element(lengths.begin(), lengths.end());
    return std::pair{values, *most <= kEven * *least};
  };
  const auto fine_table =
      [&](bool along_u) {  // most faces are of planes and cylinders, whose lengths are the same all over
        auto [values, is_even] = table(along_u, kFewPieces);
        return is_even ? values : table(along_u, kPieces).first;
      };
  std::vector<double> u = fine_table(true), v = fine_table(false);
  const double unit = std::max(u.back(), v.back()), num_u = double(u.size() - 1), num_v = double(v.size() - 1);
  u_ = RisingTable(box.low.x, wide / num_u, in_units(std::move(u), unit));
  v_ = RisingTable(box.low.y, tall / num_v, in_units(std::move(v), unit));
}

void Chart::make_polar(const ParameterBox& box) {
  const ParameterBox whole = surface_.box();
  const bool by_v = is_radial_v(), low = is_low();
  pole_at_ = by_v ? (low ? whole.low.y : whole.high.y) : (low ? whole.low.x : whole.high.x);
  const double a0 = by_v ? box.low.x : box.low.y, a1 = by_v ? box.high.x : box.high.y;
  const double w0 = by_v ? box.low.y : box.low.x, w1 = by_v ? box.high.y : box.high.x;
  const double period = surface_.period()[by_v ? 0 : 1], inside = low ? 1 : -1;
  const double far = std::max(std::abs(w0 - pole_at_), std::abs(w1 - pole_at_)), step = far / kPieces;
  middle_ = 0.5 * (a0 + a1);
  std::vector<double> speed(kPieces + 1, 0), around(kPieces + 1, 0);
  double turn = 0;
  for (int i = 0; i <= kPieces; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const double a = a0 + (a1 - a0) * (j + 0.5) / kAcross;
      const SurfaceDerivatives s = surface_.derivatives(uv_of(a, pole_at_ + inside * step * i));
      const double radial = length(by_v ? s.v : s.u);
      speed[std::size_t(i)] += radial / kAcross;
      around[std::size_t(i)] += length(by_v ? s.u : s.v) / kAcross;
      if (i == 0 && radial > 0) turn += length(s.uv) / radial * (a1 - a0) / kAcross;
    }
  const double most = *std::max_element(around.begin(), around.end());
  for (std::size_t i = 1; i < around.size(); ++i) around[i] = std::max(around[i], kLeastAround * most);
  // a cone that is not too sharp is unrolled: its seam is on two sides then
  const bool is_full = period > 0 && a1 - a0 >= kFullTurn * period && !(turn >= kLeastUnrolled && turn <= kMostTurn);
  const double rate = is_full ? 2 * std::numbers::pi / period : (turn > 0 ? std::min(turn, kMostTurn) : 1) / (a1 - a0);
  angle_ = (by_v == low ? -1 : 1) * rate;
  // d ln radius = k ds / r, with r the mean radius in space, s the length from the pole and k = dr / ds there
  std::vector<double> values = {0, 0};
  double s = 0.5 * step * (speed[0] + speed[1]), log_over = 0;
  const double k = around[1] / rate / s;
  values[1] = s;
  double all = 0;
  for (std::size_t i = 0; i < kPieces; ++i) all += 0.5 * step * (speed[i] + speed[i + 1]);
  const auto excess = [&](std::size_t i, double at) {
    const double wanted = k * rate / around[i];
    return (at < kNearPole * all ? std::min(wanted, kMostPower / at) : wanted) - 1 / at;
  };
  for (std::size_t i = 1; i < kPieces; ++i) {
    const double ds = 0.5 * step * (speed[i] + speed[i + 1]);
    log_over += 0.5 * ds * (excess(i, s) + excess(i + 1, s + ds));
    s += ds;
    values.push_back(std::max(s * std::exp(log_over), values.back() * (1 + 1e-9)));
  }
  const double unit = values.back();
  values = in_units(std::move(values), unit);
  smallest_ = 1e-9 * values[1];
  radius_ = RisingTable(0, step, std::move(values));
}

Point2 Chart::to_chart(Point2 uv) const {
  if (plane_) return plane_->to_plane(uv);
  if (!is_polar()) return {u_.at(uv.x), v_.at(uv.y)};
  const double radial = is_radial_v() ? uv.y : uv.x, angular = is_radial_v() ? uv.x : uv.y;
  const double radius = radius_.at(is_low() ? radial - pole_at_ : pole_at_ - radial);
  const double angle = angle_ * (angular - middle_);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

Point2 Chart::to_uv(Point2 xy) const {
  if (plane_) return plane_->to_uv(xy);
  if (!is_polar()) return {u_.inverse(xy.x).x, v_.inverse(xy.y).x};
  const double away = radius_.inverse(std::hypot(xy.x, xy.y)).x;
  return uv_of(middle_ + std::atan2(xy.y, xy.x) / angle_, is_low() ? pole_at_ + away : pole_at_ - away);
}

Chart::Place Chart::place(Point2 xy) const {
  if (plane_) {
    const PlaneMap::Place p = plane_->place(xy);
    return {p.uv, p.at, p.x, p.y};
  }
  if (!is_polar()) {
    const auto u = u_.inverse(xy.x), v = v_.inverse(xy.y);
    const SurfaceTangents s = surface_.tangents({u.x, v.x});
    return {{u.x, v.x}, s.at, u.slope * s.u, v.slope * s.v};
  }
  double radius = std::sqrt(xy.x * xy.x + xy.y * xy.y);
  if (radius < smallest_) {
    xy = {smallest_, 0};
    radius = smallest_;
  }
  const auto [away, slope] = radius_.inverse(radius);
  const double inside = is_low() ? 1 : -1;
  const Point2 uv = uv_of(middle_ + std::atan2(xy.y, xy.x) / angle_, pole_at_ + inside * away);
  const SurfaceTangents s = surface_.tangents(uv);
  const Point angular = (1 / (angle_ * radius * radius)) * (is_radial_v() ? s.u : s.v);
  const Point radial = (inside * slope / radius) * (is_radial_v() ? s.v : s.u);
  return {uv, s.at, xy.x * radial - xy.y * angular, xy.y * radial + xy.x * angular};
}

double Chart::stretch(const Place& place) {
  const double e = dot(place.x, place.x), f = dot(place.x, place.y), g = dot(place.y, place.y);
  const double mean = 0.5 * (e + g), half = std::sqrt(0.25 * (e - g) * (e - g) + f * f);
  return mean - half > 1e-24 * mean ? std::sqrt((mean + half) / (mean - half)) : 1e12;
}

}  // namespace delfront
