// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "delfront/errors.hpp"
#include "delfront/nurbs.hpp"

namespace delfront {
namespace {

constexpr int kMostSteps = 40, kMostHalvings = 10;

double along(double low, double high, std::size_t i, std::size_t samples) {
  const double f = double(i) / double(samples - 1);
  return (1 - f) * low + f * high;
}

/// Newton's method for one parameter, held between bounds; never farther than the start.
double polish(const SmoothCurve& curve, std::array<double, 2> range, Point p, double t) {
  CurveDerivatives c = curve.derivatives(t);
  double best = squared_length(c.at - p);
  for (int step = 0; step < kMostSteps; ++step) {
    const Point r = c.at - p;
    const double slope = dot(r, c.first), square = dot(c.first, c.first), bend = square + dot(r, c.second);
    const double by = bend > 1e-3 * square ? bend : square;
    if (!(by > 0)) break;
    double move = -slope / by;
    bool is_nearer = false;
    for (int halving = 0; halving < kMostHalvings && !is_nearer; ++halving, move *= 0.5) {
      const double next = std::clamp(t + move, range[0], range[1]);
      const CurveDerivatives there = curve.derivatives(next);
      is_nearer = squared_length(there.at - p) < best;
      if (!is_nearer) continue;
      best = squared_length(there.at - p);
      t = next;
      c = there;
    }
    if (!is_nearer) break;
  }
  return t;
}

}  // namespace

SurfaceSearch::SurfaceSearch(SurfacePointer surface, std::array<std::size_t, 2> samples)
    : SurfaceSearch(surface, surface->box(), samples) {}

SurfaceSearch::SurfaceSearch(SurfacePointer surface, const ParameterBox& box, std::array<std::size_t, 2> samples)
    : surface_(std::move(surface)), box_(box), samples_(samples) {
  if (!std::isfinite(box.high.x - box.low.x) || !std::isfinite(box.high.y - box.low.y) || samples[0] < 2 ||
      samples[1] < 2)
    throw InputError("a search over a surface needs a finite box and two samples along each parameter at least");
  for (std::size_t i = 0; i < samples[0]; ++i)
    for (std::size_t j = 0; j < samples[1]; ++j)
      net_.push_back(
          surface_->at({along(box.low.x, box.high.x, i, samples[0]), along(box.low.y, box.high.y, j, samples[1])}));
}

SurfaceSearch::Found SurfaceSearch::closest(Point p) const {
  const auto [rows, columns] = samples_;
  std::vector<double> away(net_.size());
  for (std::size_t k = 0; k < net_.size(); ++k) away[k] = squared_length(net_[k] - p);
  Found found;
  found.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j) {
      bool is_least = true;
      for (std::size_t a = i > 0 ? i - 1 : 0; a < std::min(rows, i + 2) && is_least; ++a)
        for (std::size_t b = j > 0 ? j - 1 : 0; b < std::min(columns, j + 2); ++b)
          is_least = is_least && away[i * columns + j] <= away[a * columns + b];
      if (!is_least) continue;
      const Point2 uv =
          surface_->closest(p, {along(box_.low.x, box_.high.x, i, rows), along(box_.low.y, box_.high.y, j, columns)});
      const Point at = surface_->at(uv);
      if (distance(at, p) < found.distance) found = {uv, at, distance(at, p)};
    }
  return found;
}

NearestOnCurve closest_on_curve(const SmoothCurve& curve, std::array<double, 2> range, Point p, std::size_t samples) {
  samples = std::max<std::size_t>(samples, 3);
  std::vector<double> away(samples);
  for (std::size_t i = 0; i < samples; ++i)
    away[i] = squared_length(curve.at(along(range[0], range[1], i, samples)) - p);
  NearestOnCurve found;
  found.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples; ++i) {
    if ((i > 0 && away[i - 1] < away[i]) || (i + 1 < samples && away[i + 1] < away[i])) continue;
    const double t = polish(curve, range, p, along(range[0], range[1], i, samples));
    const Point at = curve.at(t);
    if (distance(at, p) < found.distance) found = {t, at, distance(at, p)};
  }
  return found;
}

}  // namespace delfront
