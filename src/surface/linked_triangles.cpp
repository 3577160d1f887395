// SPDX-License-Identifier: Apache-2.0
#include "surface/linked_triangles.hpp"

#include <algorithm>

#include "base/hilbert.hpp"

namespace delfront {
namespace {

constexpr std::size_t kMostRound = 100;  ///< triangles of a ring

}  // namespace

void LinkedTriangles::link(std::vector<Triangle> triangles, std::size_t num_points,
                           const std::vector<std::uint64_t>& open) {
  triangles_ = std::move(triangles);
  const auto n = static_cast<std::uint32_t>(3 * triangles_.size());
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sides;
  sides.reserve(n);
  for (std::uint32_t s = 0; s < n; ++s) {
    const std::uint32_t a = point(s), b = point(next(s));
    sides.push_back({std::uint64_t(std::min(a, b)) << 32 | std::max(a, b), s});
  }
  radix_sort(sides);
  other_.assign(n, kNone);
  // only two that run opposite ways: round a point of a surface that is none, the way on would never end
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const auto [key, s] = sides[i];
    const std::uint32_t w = sides[i + 1].second;
    if (key == sides[i + 1].first && other_[s] == kNone && point(s) != point(w) &&
        !std::binary_search(open.begin(), open.end(), key))
      bond(s, w);
  }
  side_at_.assign(num_points, kNone);
  for (std::uint32_t s = 0; s < n; ++s) side_at_[point(s)] = s;
}

/// Either may be none: the other is at the border then.
void LinkedTriangles::bond(std::uint32_t side, std::uint32_t other) {
  if (side != kNone) other_[side] = other;
  if (other != kNone) other_[other] = side;
}

/// The points of a triangle know it.
void LinkedTriangles::bond_points(std::uint32_t t) {
  for (std::uint32_t k = 0; k < 3; ++k) side_at_[triangles_[t][k]] = 3 * t + k;
}

std::uint32_t LinkedTriangles::add_point() {
  side_at_.push_back(kNone);
  return static_cast<std::uint32_t>(side_at_.size() - 1);
}

void LinkedTriangles::flip(std::uint32_t side) {
  const std::uint32_t other = other_[side], t = side / 3, w = other / 3;
  const std::uint32_t a = point(side), b = point(next(side)), c = point(before(side)), d = point(before(other));
  const std::uint32_t bc = other_[next(side)], ca = other_[before(side)];
  const std::uint32_t ad = other_[next(other)], db = other_[before(other)];
  triangles_[t] = {a, d, c};
  triangles_[w] = {d, b, c};
  bond(3 * t, ad);
  bond(3 * t + 1, 3 * w + 2);
  bond(3 * t + 2, ca);
  bond(3 * w, db);
  bond(3 * w + 1, bc);
  bond_points(w);
  bond_points(t);
}

/// Triangle a b c becomes a p c and p b c; so does the one across.
void LinkedTriangles::split(std::uint32_t side, std::uint32_t p) {
  const std::uint32_t other = other_[side];
  const auto halve = [&](std::uint32_t s) {
    const std::uint32_t a = point(s), b = point(next(s)), c = point(before(s));
    const std::uint32_t bc = other_[next(s)], ca = other_[before(s)], t = s / 3;
    const auto fresh = static_cast<std::uint32_t>(triangles_.size());
    triangles_[t] = {a, p, c};
    triangles_.push_back({p, b, c});
    other_.resize(other_.size() + 3, kNone);
    bond(3 * t + 2, ca);
    bond(3 * t + 1, 3 * fresh + 2);
    bond(3 * fresh + 1, bc);
    other_[3 * t] = kNone;
    bond_points(t);
    bond_points(fresh);
    return std::array<std::uint32_t, 2>{3 * t, 3 * fresh};  // a p, p b
  };
  const auto [ap, pb] = halve(side);
  if (other == kNone) return;
  const auto [bp, pa] = halve(other);
  bond(ap, pa);
  bond(pb, bp);
}

void LinkedTriangles::collapse(std::uint32_t v, std::uint32_t u) {
  fan(v, round_);
  touched_.clear();
  for (const std::uint32_t t : round_.triangles) {
    Triangle& corner = triangles_[t];
    const std::uint32_t at_v = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
    if (corner[0] != u && corner[1] != u && corner[2] != u) {
      touched_.push_back(t);
      continue;
    }
    // triangle v u x: what lies over u x and over x v meet; v x u: over x u and over v x
    const bool u_follows = corner[(at_v + 1) % 3] == u;
    const std::uint32_t far = other_[3 * t + (at_v + 1) % 3];
    const std::uint32_t near = other_[3 * t + (u_follows ? (at_v + 2) % 3 : at_v)];
    for (std::uint32_t k = 0; k < 3; ++k) other_[3 * t + k] = kNone;
    bond(far, near);
    for (const std::uint32_t s : {far, near})
      if (s != kNone) touched_.push_back(s / 3);
    corner = {kNone, kNone, kNone};
  }
  for (const std::uint32_t t : round_.triangles)
    for (std::uint32_t& p : triangles_[t])
      if (p == v) p = u;
  side_at_[v] = kNone;
  for (const std::uint32_t t : touched_)
    if (!is_gone(t)) bond_points(t);
}

bool LinkedTriangles::ring(std::uint32_t p, TriangleRing& found) const {
  found.triangles.clear();
  found.points.clear();
  const std::uint32_t begin = side_at_[p];
  if (begin == kNone) return false;
  std::uint32_t s = begin;
  do {
    found.triangles.push_back(s / 3);
    found.points.push_back(point(next(s)));
    s = other_[before(s)];
    if (s == kNone || found.triangles.size() > kMostRound) return false;
  } while (s != begin);
  return true;
}

void LinkedTriangles::fan(std::uint32_t p, TriangleRing& found) const {
  found.triangles.clear();
  found.points.clear();
  const std::uint32_t any = side_at_[p];
  if (any == kNone) return;
  std::uint32_t begin = any;
  while (other_[begin] != kNone) {
    begin = next(other_[begin]);
    if (begin == any) break;
  }
  std::uint32_t s = begin;
  do {
    found.triangles.push_back(s / 3);
    found.points.push_back(point(next(s)));
    if (other_[before(s)] == kNone) {
      found.points.push_back(point(before(s)));
      return;
    }
    s = other_[before(s)];
  } while (s != begin);
}

}  // namespace delfront
