// SPDX-License-Identifier: Apache-2.0
// Maximise d over (x, y, z, d) with normal . (x, y, z) - d >= normal . at for unit normals. Planes are added one by
// one; one that cuts the present optimum off holds the new one, which is looked for on it, with one unknown less.
#include "volume/deepest_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace delfront {

namespace {

constexpr int kUnknowns = 4;
constexpr double kReach = 2;         ///< of the cube, in extents of the planes
constexpr double kRounding = 1e-14;  ///< planes have unit normals, places are about 1 from the middle

using Unknowns = std::array<double, kUnknowns>;

/// sum factor[k] x[k] <= most
struct Bound {
  Unknowns factor{};
  double most = 0;
};

/// x of the first n unknowns, within +-kReach each, that keeps the bounds and maximises sum aim[k] x[k].
/// @return whether there is one
bool maximise(int n, const std::vector<Bound>& bounds, const Unknowns& aim, Unknowns& x);

bool maximise_on_line(const std::vector<Bound>& bounds, double aim, double& x) {
  double low = -kReach, high = kReach;
  for (const Bound& b : bounds) {
    if (std::fabs(b.factor[0]) <= kRounding) {
      if (b.most < -kRounding) return false;
    } else if (b.factor[0] > 0) {
      high = std::min(high, b.most / b.factor[0]);
    } else {
      low = std::max(low, b.most / b.factor[0]);
    }
  }
  if (low > high + kRounding) return false;
  x = aim >= 0 ? high : low;
  return true;
}

/// The unknown `k` as the bound, met exactly, gives it by the others; takes it out of another bound or aim.
struct Elimination {
  const Bound& bound;
  int k, last;

  Bound apply(const Bound& other) const {
    Bound reduced = other;
    const double share = other.factor[k] / bound.factor[k];
    for (int i = 0; i <= last; ++i) reduced.factor[i] -= share * bound.factor[i];
    reduced.most -= share * bound.most;
    std::swap(reduced.factor[k], reduced.factor[last]);
    reduced.factor[last] = 0;
    double longest = 0;
    for (int i = 0; i < last; ++i) longest = std::max(longest, std::fabs(reduced.factor[i]));
    if (longest > kRounding) {
      for (int i = 0; i < last; ++i) reduced.factor[i] /= longest;
      reduced.most /= longest;
    }
    return reduced;
  }
  Unknowns apply(const Unknowns& aim) const {
    Unknowns reduced = aim;
    const double share = aim[k] / bound.factor[k];
    for (int i = 0; i <= last; ++i) reduced[i] -= share * bound.factor[i];
    std::swap(reduced[k], reduced[last]);
    return reduced;
  }
  Unknowns undo(Unknowns x) const {
    std::swap(x[k], x[last]);
    double rest = bound.most;
    for (int i = 0; i <= last; ++i)
      if (i != k) rest -= bound.factor[i] * x[i];
    x[k] = rest / bound.factor[k];
    return x;
  }
};

bool maximise(int n, const std::vector<Bound>& bounds, const Unknowns& aim, Unknowns& x) {
  if (n == 1) return maximise_on_line(bounds, aim[0], x[0]);
  for (int k = 0; k < n; ++k) x[k] = aim[k] >= 0 ? kReach : -kReach;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const Bound& bound = bounds[i];
    double sum = -bound.most;
    for (int k = 0; k < n; ++k) sum += bound.factor[k] * x[k];
    if (sum <= kRounding) continue;
    int largest = 0;
    for (int k = 1; k < n; ++k)
      if (std::fabs(bound.factor[k]) > std::fabs(bound.factor[largest])) largest = k;
    if (std::fabs(bound.factor[largest]) <= kRounding) return false;
    const Elimination by{bound, largest, n - 1};
    std::vector<Bound> before;
    for (const double sign : {1.0, -1.0}) {
      Bound side;
      side.factor[largest] = sign, side.most = kReach;
      before.push_back(by.apply(side));
    }
    for (std::size_t j = 0; j < i; ++j) before.push_back(by.apply(bounds[j]));
    Unknowns on_bound{};
    if (!maximise(n - 1, before, by.apply(aim), on_bound)) return false;
    x = by.undo(on_bound);
  }
  return true;
}

}  // namespace

DeepestPoint find_deepest_point(const std::vector<HalfSpace>& planes) {
  Point middle;
  for (const HalfSpace& plane : planes) middle = middle + plane.at / static_cast<double>(planes.size());
  double extent = 0;
  for (const HalfSpace& plane : planes) extent = std::max(extent, distance(plane.at, middle));
  if (!(extent > 0)) return {middle, -1};
  std::vector<Bound> bounds;
  for (const HalfSpace& plane : planes) {
    const double l = length(plane.normal);
    if (!(l > 0)) continue;
    const Point n = plane.normal / l;
    bounds.push_back({{-n.x, -n.y, -n.z, 1}, -dot(n, plane.at - middle) / extent});
  }
  std::mt19937 random(1);
  for (std::size_t i = bounds.size(); i > 1; --i) std::swap(bounds[i - 1], bounds[random() % i]);
  Unknowns x{};
  if (!maximise(kUnknowns, bounds, {0, 0, 0, 1}, x)) return {middle, -extent};
  return {middle + extent * Point{x[0], x[1], x[2]}, extent * x[3]};
}

}  // namespace delfront
