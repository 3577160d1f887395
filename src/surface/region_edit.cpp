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
  side_at_.push_back(kNone);
  return static_cast<std::uint32_t>(grid_.points.size() - 1);
}

Point RegionMesh::normal(std::uint32_t side) const {
  Point sum;
  for (const std::uint32_t s : {side, other_[side]}) {
    if (s == kNone) continue;
    const auto& [a, b, c] = grid_.triangles[s / 3];
    sum = sum + cross(at(b) - at(a), at(c) - at(a));
  }
  const double size = length(sum);
  return size > 0 ? sum / size : sum;
}

/// The points of a triangle know it.
void RegionMesh::bond_triangle(std::uint32_t t) {
  for (std::uint32_t k = 0; k < 3; ++k) side_at_[grid_.triangles[t][k]] = 3 * t + k;
}

/// Triangle a b c becomes a p c and p b c; so does the one across.
void RegionMesh::split(std::uint32_t side, std::uint32_t p) {
  const std::uint32_t other = other_[side];
  const auto halve = [&](std::uint32_t s) {
    const std::uint32_t a = point(s), b = point(next(s)), c = point(before(s));
    const std::uint32_t bc = other_[next(s)], ca = other_[before(s)], t = s / 3;
    const auto fresh = static_cast<std::uint32_t>(grid_.triangles.size());
    grid_.triangles[t] = {a, p, c};
    grid_.triangles.push_back({p, b, c});
    other_.resize(other_.size() + 3, kNone);
    bond(3 * t + 2, ca);
    bond(3 * t + 1, 3 * fresh + 2);
    bond(3 * fresh + 1, bc);
    other_[3 * t] = kNone;
    bond_triangle(t);
    bond_triangle(fresh);
    return std::array<std::uint32_t, 2>{3 * t, 3 * fresh};  // a p, p b
  };
  const auto [ap, pb] = halve(side);
  if (other == kNone) return;
  const auto [bp, pa] = halve(other);
  bond(ap, pa);
  bond(pb, bp);
}

std::array<std::uint32_t, 2> RegionMesh::along_border(std::uint32_t p) {
  fan(p);
  if (ring_.points.size() == ring_.triangles.size()) return {p, p};
  return {ring_.points.front(), ring_.points.back()};
}

bool RegionMesh::may_collapse(std::uint32_t v, std::uint32_t u, double longest) {
  fan(u);
  const std::vector<std::uint32_t> round_u = ring_.points;
  fan(v);
  const auto& points = ring_.points;
  if (points.empty()) return false;
  const bool is_inner = points.size() == ring_.triangles.size();
  const auto at_u = std::find(points.begin(), points.end(), u);
  if (at_u == points.end()) return false;
  if (is_inner && points.size() < 4) return false;  // it would leave a triangle twice
  if (!is_inner && at_u != points.begin() && at_u + 1 != points.end()) return false;
  if (ring_.triangles.size() == 1) {  // an ear goes, where it is not all there is
    const std::uint32_t t = ring_.triangles[0], s = side_at_[v];
    if (other_[next(s)] == kNone || s / 3 != t) return false;
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
  std::vector<std::uint32_t> touched;
  for (const std::uint32_t t : ring_.triangles) {
    auto& corner = grid_.triangles[t];
    const std::uint32_t at_v = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
    if (corner[0] != u && corner[1] != u && corner[2] != u) {
      touched.push_back(t);
      continue;
    }
    // triangle v u x goes: what lies over u x and over x v meet
    const bool u_follows = corner[(at_v + 1) % 3] == u;
    const std::uint32_t far = other_[3 * t + (at_v + 1) % 3];
    const std::uint32_t near = other_[3 * t + (u_follows ? (at_v + 2) % 3 : at_v)];
    for (std::uint32_t k = 0; k < 3; ++k) other_[3 * t + k] = kNone;
    if (far != kNone) {
      bond(far, near);
      touched.push_back(far / 3);
    } else if (near != kNone) {
      other_[near] = kNone;
    }
    if (near != kNone) touched.push_back(near / 3);
    corner = {kNone, kNone, kNone};
  }
  for (const std::uint32_t t : ring_.triangles)
    for (std::uint32_t& p : grid_.triangles[t])
      if (p == v) p = u;
  side_at_[v] = kNone;
  for (const std::uint32_t t : touched)
    if (grid_.triangles[t][0] != kNone) bond_triangle(t);
  return true;
}

}  // namespace delfront
