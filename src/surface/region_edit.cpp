// SPDX-License-Identifier: Apache-2.0
// Splits and collapses of a region's triangles.
#include <algorithm>

#include "surface/region_mesh.hpp"

namespace delfront {
namespace {

constexpr double kLeastQuality = 0.01;  ///< of triangles that a collapse makes

}  // namespace

std::uint32_t RegionMesh::add_point(Point at, std::uint32_t foot) {
  grid_.points.push_back(at);
  grid_.triangle_of_point.push_back(foot);
  return links_.add_point();
}

Point RegionMesh::normal(std::uint32_t side) const {
  Point sum;
  for (const std::uint32_t s : {side, links_.other(side)}) {
    if (s == kNone) continue;
    const auto& [a, b, c] = links_.triangle(s / 3);
    sum = sum + cross(at(b) - at(a), at(c) - at(a));
  }
  const double size = length(sum);
  return size > 0 ? sum / size : sum;
}

std::array<std::uint32_t, 2> RegionMesh::along_border(std::uint32_t p) {
  links_.fan(p, ring_);
  if (ring_.points.size() == ring_.triangles.size()) return {p, p};
  return {ring_.points.front(), ring_.points.back()};
}

bool RegionMesh::may_collapse(std::uint32_t v, std::uint32_t u, double longest) {
  links_.fan(u, ring_);
  const std::vector<std::uint32_t> round_u = ring_.points;
  links_.fan(v, ring_);
  const auto& points = ring_.points;
  if (points.empty()) return false;
  const bool is_inner = points.size() == ring_.triangles.size();
  const auto at_u = std::find(points.begin(), points.end(), u);
  if (at_u == points.end()) return false;
  if (is_inner && points.size() < 4) return false;  // it would leave a triangle twice
  if (!is_inner && at_u != points.begin() && at_u + 1 != points.end()) return false;
  if (ring_.triangles.size() == 1) {  // an ear goes, where it is not all there is
    const std::uint32_t t = ring_.triangles[0], s = links_.side_at(v);
    if (is_border(links_.next(s)) || s / 3 != t) return false;
  }
  const auto common = std::count_if(points.begin(), points.end(), [&](std::uint32_t p) {
    return std::find(round_u.begin(), round_u.end(), p) != round_u.end();
  });
  if (common != (is_inner ? 2 : 1)) return false;
  for (std::size_t i = 0; i < ring_.triangles.size(); ++i) {
    const std::uint32_t q = points[i], r = points[(i + 1) % points.size()];
    if (!is_inner && i + 1 == points.size()) break;
    if (q != u && distance(at(q), at(u)) > longest) return false;
    if (q == u || r == u) continue;
    Point old = cross(at(q) - at(v), at(r) - at(v));
    const double size = length(old);
    if (!(size > 0))
      old = ring_normal();
    else
      old = old / size;
    if (triangle_quality(at(u), at(q), at(r), old) < kLeastQuality) return false;
  }
  return true;
}

bool RegionMesh::collapse(std::uint32_t v, std::uint32_t u, double longest) {
  if (!may_collapse(v, u, longest)) return false;
  links_.collapse(v, u);
  return true;
}

}  // namespace delfront
