// SPDX-License-Identifier: Apache-2.0
#include "surface/region_mesh.hpp"

#include <algorithm>
#include <cmath>

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
  links_.link(std::move(grid_.triangles), grid_.points.size(), grid_.border_sides);
}

bool RegionMesh::is_joined(std::uint32_t p, std::uint32_t q) {
  links_.fan(p, ring_);
  return std::find(ring_.points.begin(), ring_.points.end(), q) != ring_.points.end();
}

Point RegionMesh::ring_normal() const {
  Point sum;
  for (const std::uint32_t t : ring_.triangles) {
    const auto& [a, b, c] = links_.triangle(t);
    sum = sum + area_vector(at(a), at(b), at(c));
  }
  return unit(sum);
}

/// Side a b of triangles a b c and b a d becomes c d, where that is a valid pair of triangles and the sum of the angles
/// at c and d is over 180 degrees.
bool RegionMesh::flip(std::uint32_t side) {
  const std::uint32_t other = links_.other(side);
  if (other == kNone) return false;
  const auto [a, b] = ends(side);
  const std::uint32_t c = links_.point(links_.before(side)), d = links_.point(links_.before(other));
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
  links_.flip(side);
  return true;
}

std::size_t RegionMesh::flip_to_delaunay(int passes) {
  std::size_t total = 0;
  for (int pass = 0; pass < passes; ++pass) {
    std::size_t count = 0;
    for (std::uint32_t s = 0; s < num_sides(); ++s)
      if (!is_border(s) && s < links_.other(s) && is_alive(s)) count += flip(s);
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
  if (!links_.ring(p, ring_)) return false;
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
  std::vector<std::uint32_t> number(grid_.points.size(), kNone);
  for (const auto& t : links_.triangles()) {
    if (t[0] == kNone) continue;
    grid_.triangles.push_back(t);
    for (const std::uint32_t p : t) number[p] = 0;
  }
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < number.size(); ++p) {
    if (number[p] == kNone && p >= grid_.num_border) continue;
    grid_.points[count] = grid_.points[p];
    grid_.triangle_of_point[count] = grid_.triangle_of_point[p];
    number[p] = count++;
  }
  grid_.points.resize(count);
  grid_.triangle_of_point.resize(count);
  for (auto& t : grid_.triangles)
    for (std::uint32_t& p : t) p = number[p];
  return std::move(grid_);
}

}  // namespace delfront
