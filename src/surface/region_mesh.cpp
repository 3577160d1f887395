// SPDX-License-Identifier: Apache-2.0
#include "surface/region_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "base/hilbert.hpp"

namespace delfront {
namespace {

constexpr double kFoldCosine = 0.35;  ///< least cosine between triangles that come and those that go
constexpr double kMargin = 1e-9;      ///< flips back and forth are not flips

Point unit(Point p) {
  const double size = length(p);
  return size > 0 ? p / size : p;
}

Point area_vector(Point a, Point b, Point c) { return cross(b - a, c - a); }

}  // namespace

double triangle_quality(Point a, Point b, Point c, Point normal) {
  const double sum = squared_length(b - a) + squared_length(c - b) + squared_length(a - c);
  const Point twice = area_vector(a, b, c);
  const double q = 2 * std::sqrt(3.0) * length(twice) / sum;
  return dot(twice, normal) > kFoldCosine * length(twice) ? q : -q;
}

RegionMesh::RegionMesh(const SurfaceSupport& support, RegionGrid grid) : support_(support), grid_(std::move(grid)) {
  link();
}

void RegionMesh::bond(std::uint32_t side, std::uint32_t other) {
  other_[side] = other;
  if (other != kNone) other_[other] = side;
}

/// Sides that run in opposite directions between the same points are bonded; borders have a side twice at most where a
/// line runs through the region, and are left open.
void RegionMesh::link() {
  const std::size_t n = grid_.triangles.size();
  other_.assign(3 * n, kNone);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> items;
  items.reserve(3 * n);
  for (std::uint32_t s = 0; s < 3 * n; ++s) {
    const std::uint32_t low = std::min(point(s), point(next(s))), high = std::max(point(s), point(next(s)));
    items.push_back({std::uint64_t(low) << 32 | high, s});
  }
  radix_sort(items);
  for (std::size_t i = 0; i + 1 < items.size(); ++i) {
    const auto [key, s] = items[i];
    if (key != items[i + 1].first) continue;
    if (!std::binary_search(grid_.border_sides.begin(), grid_.border_sides.end(), key)) bond(s, items[i + 1].second);
  }
  side_at_.assign(grid_.points.size(), kNone);
  for (std::uint32_t s = 0; s < 3 * n; ++s) side_at_[point(s)] = s;
}

/// The triangles round an inner point.
bool RegionMesh::ring(std::uint32_t p) {
  ring_.triangles.clear();
  ring_.points.clear();
  const std::uint32_t begin = side_at_[p];
  if (begin == kNone) return false;
  std::uint32_t s = begin;
  do {
    ring_.triangles.push_back(s / 3);
    ring_.points.push_back(point(next(s)));
    s = other_[before(s)];
    if (s == kNone || ring_.triangles.size() > 100) return false;
  } while (s != begin);
  return true;
}

/// The triangles at a point, from border to border; where the border touches itself in the point: one such part.
void RegionMesh::fan(std::uint32_t p) {
  ring_.triangles.clear();
  ring_.points.clear();
  const std::uint32_t any = side_at_[p];
  if (any == kNone) return;
  std::uint32_t begin = any;
  while (other_[begin] != kNone) {
    begin = next(other_[begin]);
    if (begin == any) break;
  }
  std::uint32_t s = begin;
  do {
    ring_.triangles.push_back(s / 3);
    ring_.points.push_back(point(next(s)));
    if (other_[before(s)] == kNone) {
      ring_.points.push_back(point(before(s)));
      return;
    }
    s = other_[before(s)];
  } while (s != begin);
}

bool RegionMesh::is_joined(std::uint32_t p, std::uint32_t q) {
  fan(p);
  return std::find(ring_.points.begin(), ring_.points.end(), q) != ring_.points.end();
}

Point RegionMesh::ring_normal() const {
  Point sum;
  for (const std::uint32_t t : ring_.triangles) {
    const auto& [a, b, c] = grid_.triangles[t];
    sum = sum + area_vector(at(a), at(b), at(c));
  }
  return unit(sum);
}

/// Side a b of triangles a b c and b a d becomes c d, where that is a valid pair of triangles and the sum of the angles
/// at c and d is over 180 degrees.
bool RegionMesh::flip(std::uint32_t side) {
  const std::uint32_t other = other_[side];
  if (other == kNone) return false;
  const std::uint32_t a = point(side), b = point(next(side)), c = point(before(side)), d = point(before(other));
  const Point pa = at(a), pb = at(b), pc = at(c), pd = at(d);
  const Point u = pa - pc, v = pb - pc, x = pb - pd, y = pa - pd;
  // sin(c + d) < 0, without angles
  const double sin_c = length(cross(u, v)), sin_d = length(cross(x, y)), cos_c = dot(u, v), cos_d = dot(x, y);
  if (sin_c * cos_d + cos_c * sin_d >= -kMargin * (std::abs(sin_c * cos_d) + std::abs(cos_c * sin_d))) return false;
  const Point old = area_vector(pa, pb, pc) + area_vector(pb, pa, pd);
  const Point first = area_vector(pa, pd, pc), second = area_vector(pd, pb, pc);
  const double size = length(old);
  if (!(dot(first, old) > kFoldCosine * size * length(first)) ||
      !(dot(second, old) > kFoldCosine * size * length(second)))
    return false;
  if (c == d || is_joined(c, d)) return false;
  const std::uint32_t t = side / 3, w = other / 3;
  const std::uint32_t bc = other_[next(side)], ca = other_[before(side)], ad = other_[next(other)],
                      db = other_[before(other)];
  grid_.triangles[t] = {a, d, c};
  grid_.triangles[w] = {d, b, c};
  bond(3 * t, ad);
  bond(3 * t + 1, 3 * w + 2);
  bond(3 * t + 2, ca);
  bond(3 * w, db);
  bond(3 * w + 1, bc);
  side_at_[a] = 3 * t;
  side_at_[d] = 3 * t + 1;
  side_at_[c] = 3 * t + 2;
  side_at_[b] = 3 * w + 1;
  return true;
}

std::size_t RegionMesh::flip_to_delaunay(int passes) {
  std::size_t total = 0;
  for (int pass = 0; pass < passes; ++pass) {
    std::size_t count = 0;
    for (std::uint32_t s = 0; s < other_.size(); ++s)
      if (other_[s] != kNone && s < other_[s] && is_alive(s)) count += flip(s);
    total += count;
    if (count == 0) break;
  }
  return total;
}

double RegionMesh::worst_of_ring(Point place) const {
  double worst = 1;
  const std::size_t n = ring_.points.size();
  const Point normal = ring_normal_;
  for (std::size_t i = 0; i < n; ++i)
    worst = std::min(worst, triangle_quality(place, at(ring_.points[i]), at(ring_.points[(i + 1) % n]), normal));
  return worst;
}

bool RegionMesh::smooth_point(std::uint32_t p) {
  if (!ring(p)) return false;
  ring_normal_ = ring_normal();
  Point sum;
  double weight = 0;
  for (const std::uint32_t q : ring_.points) {
    sum = sum + at(q);
    weight += 1;
  }
  const Point from = at(p);
  Point step = sum / weight - from;
  step = step - dot(step, ring_normal_) * ring_normal_;
  const double size = length(step);
  const double worst = worst_of_ring(from);
  for (const double share : {1.0, 0.5}) {
    const auto foot = support_.project(from + share * step, ring_normal_, grid_.triangle_of_point[p],
                                       2 * size + distance(from, at(ring_.points[0])));
    if (!foot.found() || worst_of_ring(foot.at) <= worst) continue;
    grid_.points[p] = foot.at;
    grid_.triangle_of_point[p] = foot.triangle;
    return true;
  }
  return false;
}

std::size_t RegionMesh::smooth(int passes) {
  std::size_t total = 0;
  for (int pass = 0; pass < passes; ++pass)
    for (auto p = static_cast<std::uint32_t>(grid_.num_border); p < grid_.points.size(); ++p) total += smooth_point(p);
  return total;
}

RegionGrid RegionMesh::take() {
  compact();
  return std::move(grid_);
}

void RegionMesh::compact() {
  auto& triangles = grid_.triangles;
  triangles.erase(std::remove_if(triangles.begin(), triangles.end(), [](const auto& t) { return t[0] == kNone; }),
                  triangles.end());
  std::vector<std::uint32_t> number(grid_.points.size(), kNone);
  for (const auto& t : triangles)
    for (const std::uint32_t p : t) number[p] = 0;
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < number.size(); ++p) {
    if (number[p] == kNone && p >= grid_.num_border) continue;
    grid_.points[count] = grid_.points[p];
    grid_.triangle_of_point[count] = grid_.triangle_of_point[p];
    number[p] = count++;
  }
  grid_.points.resize(count);
  grid_.triangle_of_point.resize(count);
  for (auto& t : triangles)
    for (std::uint32_t& p : t) p = number[p];
}

}  // namespace delfront
