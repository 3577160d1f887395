// SPDX-License-Identifier: Apache-2.0
#include "volume/visible_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace delfront {

namespace {

constexpr int kHalvings = 60;  ///< of the first step: down to the resolution of doubles
constexpr int kClimbSteps = 30;
constexpr int kRelaxations = 1000, kStepsPerMargin = 40;

bool sees_all(const std::vector<Wall>& walls, Point p) {
  const ExactPoint at = ExactPoint::explicit_point(p);
  return std::all_of(walls.begin(), walls.end(), [&](const Wall& w) { return orient3d(w[0], w[1], w[2], at) > 0; });
}

Point climb(const std::vector<Wall>& walls, Point p, double best, double step) {
  for (int k = 0; k < kClimbSteps; ++k) {
    bool moved = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) {
        Point next = p;
        next[axis] += sign * step;
        const double ratio = measure_worst_ratio(walls, next);
        if (ratio <= best || !sees_all(walls, next)) continue;
        p = next, best = ratio, moved = true;
      }
    if (!moved) step *= 0.5;
  }
  return p;
}

/// Steps to the front of the wall that lies worst, again and again, by margins that shrink: finds thin kernels too.
/// Source: the relaxation method for linear inequalities, Agmon (1954), Motzkin & Schoenberg (1954).
std::optional<Point> relax(const std::vector<Wall>& walls, Point p, double reach) {
  double margin = 0.1 * reach;
  for (int k = 0; k < kRelaxations; ++k) {
    if (k % kStepsPerMargin == kStepsPerMargin - 1) margin *= 0.25;
    double worst = std::numeric_limits<double>::infinity();
    Point normal;
    for (const Wall& w : walls) {
      Point n = cross(w[1].approx - w[0].approx, w[2].approx - w[0].approx);
      const double l = length(n);
      if (!(l > 0)) continue;
      n = n / l;
      if (const double d = dot(n, p - w[0].approx); d < worst) worst = d, normal = n;
    }
    if (worst > 0 && sees_all(walls, p)) return p;
    if (worst < margin) p = p + (margin - worst) * normal;
  }
  return std::nullopt;
}

}  // namespace

double measure_worst_ratio(const std::vector<Wall>& walls, Point p) {
  double worst = 1;
  for (const Wall& w : walls) {
    const Point a = w[0].approx, b = w[1].approx, c = w[2].approx;
    const double volume = dot(cross(b - a, c - a), p - a) / 6;
    const double sum = squared_length(b - a) + squared_length(c - a) + squared_length(p - a) + squared_length(c - b) +
                       squared_length(p - b) + squared_length(p - c);
    worst = std::min(worst, volume <= 0 || sum <= 0 ? 0 : 12 * std::cbrt(9 * volume * volume) / sum);
  }
  return worst;
}

std::optional<Point> find_visible_point(const std::vector<Wall>& walls, Point start,
                                        const std::vector<Point>& directions, double reach, bool at_any_cost) {
  std::optional<Point> found;
  double best = 0;
  for (const Point& towards : directions) {
    const double l = length(towards);
    if (!(l > 0)) continue;
    double step = reach;
    for (int k = 0; k < kHalvings; ++k, step *= 0.5) {
      const Point p = start + (step / l) * towards;
      if (!sees_all(walls, p)) continue;
      const double ratio = measure_worst_ratio(walls, p);
      if (found && ratio < best) break;
      found = p, best = ratio;
    }
  }
  if (!found && at_any_cost && (found = relax(walls, start, reach))) best = measure_worst_ratio(walls, *found);
  return found ? climb(walls, *found, best, 0.25 * reach) : found;
}

}  // namespace delfront
