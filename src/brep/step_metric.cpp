// SPDX-License-Identifier: Apache-2.0
#include "brep/step_metric.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace delfront {
namespace {

constexpr double kMostLonger = 1.3;   ///< of the wanted length: chords that are left
constexpr int kMostTries = 12;        ///< to shorten a step
constexpr double kLeastFactor = 0.1;  ///< of one try
constexpr double kCutShort = 0.5;     ///< of a step: what leaves more of it outside of the box says nothing
constexpr double kMostStep = 1;       ///< charts are about that wide

}  // namespace

void StepMetric::metrics(std::span<const Point> at, std::span<Metric> metric) const {
  inner_.metrics(at, metric);
  for (std::size_t i = 0; i < at.size(); ++i) metric[i] = by_steps({at[i].x, at[i].y}, metric[i]);
}

void StepMetric::sizes(std::span<const Point> at, std::span<double> size) const {
  std::vector<Metric> metric(at.size());
  metrics(at, metric);
  for (std::size_t i = 0; i < at.size(); ++i)
    size[i] = 1 / std::sqrt(std::max(metric[i].xx + metric[i].yy, 1e-300));  // a bound is enough
}

/// The length along a direction of the chart, shortened from the first until the chord is as wanted.
/// @return 0: the box ends before
double StepMetric::step(Point2 from, Point place, Point2 direction, double first, double wanted) const {
  double length = first;
  for (int k = 0; k < kMostTries; ++k) {
    const Point2 to = chart_.to_uv({from.x + length * direction.x, from.y + length * direction.y});
    const Point2 inside = {std::clamp(to.x, box_.low.x, box_.high.x), std::clamp(to.y, box_.low.y, box_.high.y)};
    const bool is_outside = inside.x != to.x || inside.y != to.y;
    const double chord = distance(chart_.surface().at(inside), place);
    if (!(chord > kMostLonger * wanted)) {
      if (!is_outside) return length;
      const Point2 end = chart_.to_chart(inside);
      return std::hypot(end.x - from.x, end.y - from.y) > kCutShort * length ? length : 0;
    }
    length *= std::clamp(wanted / chord, kLeastFactor, 1 / kMostLonger);
  }
  return length;
}

Metric StepMetric::by_steps(Point2 from, Metric m) const {
  const Chart::Place place = chart_.place(from);
  // M = J^T J / h^2 says what is wanted, by the axis that is longer
  const double x2 = squared_length(place.x), y2 = squared_length(place.y);
  const double wanted = std::sqrt(x2 > y2 ? x2 / m.xx : y2 / m.yy);
  if (!(wanted > 0) || !std::isfinite(wanted)) return m;
  const double angle = 0.5 * std::atan2(2 * m.xy, m.xx - m.yy), c = std::cos(angle), s = std::sin(angle);
  const Point2 axis[2] = {{c, s}, {-s, c}};
  double root[2];
  for (int k = 0; k < 2; ++k) {
    const Point2 d = axis[k];
    const double value = m.xx * d.x * d.x + 2 * m.xy * d.x * d.y + m.yy * d.y * d.y;
    const double first = std::min(1 / std::sqrt(std::max(value, 1e-300)), kMostStep);
    const double ahead = step(from, place.at, d, first, wanted),
                 back = step(from, place.at, {-d.x, -d.y}, first, wanted);
    const double shorter = std::min(ahead, back), longer = std::max(ahead, back);
    root[k] = shorter > 0 ? shorter : longer > 0 ? longer : first;
  }
  const double p = 1 / (root[0] * root[0]), q = 1 / (root[1] * root[1]);
  m.xx = p * c * c + q * s * s;
  m.xy = (p - q) * c * s;
  m.yy = p * s * s + q * c * c;
  return m;
}

}  // namespace delfront
