// SPDX-License-Identifier: Apache-2.0
#include "planar/kernel.hpp"

#include <algorithm>
#include <cmath>

namespace delfront {

namespace {

/// A constrained edge is seen under at most 110 degrees: cos^2 of it, for the test without a root.
constexpr double kSquaredCosineOfWidest = 0.117;
/// From the ends of one, where p stands over it, p is seen at no less than 27 degrees: tan^2 of it.
constexpr double kSquaredTangentOfLowest = 0.26;

/// Whether p over the edge a -> b would make a bad triangle with it that nothing could mend.
bool is_too_low(Point2 a, Point2 b, Point2 p) {
  const Point2 to_a = a - p, to_b = b - p, along = b - a;
  const double cosine = dot(to_a, to_b);
  if (cosine < 0 && cosine * cosine > kSquaredCosineOfWidest * squared_length(to_a) * squared_length(to_b)) return true;
  const double from_a = -dot(to_a, along), from_b = dot(to_b, along), height = cross(to_a, to_b);
  if (from_a <= 0 || from_b <= 0) return false;
  const double farther = std::max(from_a, from_b);
  return height * height < kSquaredTangentOfLowest * farther * farther;
}

}  // namespace

std::uint32_t PlanarKernel::random() { return random_state_ = random_state_ * 1664525u + 1013904223u; }

void PlanarKernel::start(VertexIndex a, VertexIndex b, VertexIndex c) {
  if (orient2d(c_.point[a], c_.point[b], c_.point[c]) < 0) std::swap(b, c);
  c_.tri.assign(4, {});
  const VertexIndex n[3] = {a, b, c};
  c_.tri[0] = {{a, b, c}, {}, 0, flags_of_new};
  for (unsigned e = 0; e < 3; ++e) c_.tri[1 + e] = {{n[previous_of(e)], n[next_of(e)], kInfinity}, {}, 0, flags_of_new};
  for (unsigned e = 0; e < 3; ++e) {
    c_.bond(e, 4 * (1 + e) + 2);
    c_.bond(4 * (1 + e) + 0, 4 * (1 + previous_of(e)) + 1);
  }
  last_tri = 0;
}

TriIndex PlanarKernel::locate(Point2 p, TriIndex t) {
  const Triangle* tri = c_.tri.data();
  const Point2* point = c_.point.data();
  if (c_.is_ghost(t)) t = tri[t].neigh[2] >> 2;
  unsigned entry = 3;
  for (;;) {
    const Triangle& s = tri[t];
    if (s.node[2] == kInfinity) return t;
    ++counts.walk_steps;
    // The edges in an order by chance: without it, a walk in a constrained triangulation can go round for ever.
    unsigned e = entry < 3 ? entry : 0;
    const bool is_forward = random() >> 31;
    unsigned step = 0;
    for (; step < 3; ++step) {
      if (step > 0 || entry == 3) {
        const VertexIndex a = s.node[next_of(e)], b = s.node[previous_of(e)];
        if (orient2d(point[a], point[b], p) < 0) break;
      }
      e = is_forward ? next_of(e) : previous_of(e);
    }
    if (step == 3) return t;
    const EdgeRef other = s.neigh[e];
    t = other >> 2;
    entry = other & 3;
  }
}

bool PlanarKernel::is_ghost_in_conflict(const Triangle& ghost, Point2 p) const {
  const Point2 a = c_.point[ghost.node[0]], b = c_.point[ghost.node[1]];
  const int side = orient2d(a, b, p);
  if (side != 0) return side > 0;
  // On the line of the hull edge: its open segment belongs to it.
  const bool by_x = a.x != b.x;
  const double low = by_x ? std::min(a.x, b.x) : std::min(a.y, b.y),
               high = by_x ? std::max(a.x, b.x) : std::max(a.y, b.y);
  const double at = by_x ? p.x : p.y;
  return low < at && at < high;
}

/// Sign of incircle(b, a, apex, p), with the differences to p made already: two of the three are the last triangle's.
/// The bound is that of incircle() in predicates_inline.hpp, whose terms these are.
inline bool PlanarKernel::is_in_conflict(const Triangle& s, VertexIndex apex, const Open& edge, Point2 p,
                                         Point2 to_apex) const {
  if (s.node[2] == kInfinity) [[unlikely]]
    return is_ghost_in_conflict(s, p);
  const Point2 a = edge.to_a, b = edge.to_b, c = to_apex;
  const double a2 = squared_length(a), b2 = squared_length(b), c2 = squared_length(c);
  const double det = b2 * cross(a, c) + a2 * cross(c, b) + c2 * cross(b, a);
  const double extent = detail::max3(a.x, b.x, c.x) * detail::max3(a.y, b.y, c.y) * std::max(std::max(a2, b2), c2);
  if (std::fabs(det) > detail::kIncircleBound * extent + detail::kTinyPlane) [[likely]]
    return det > 0;
  return incircle(c_.point[edge.b], c_.point[edge.a], c_.point[apex], p) > 0;
}

bool PlanarKernel::grow_cavity(TriIndex holder, Point2 p, double min_squared) {
  cavity_.clear();
  edges_.clear();
  stack_.clear();
  const Triangle* tri = c_.tri.data();
  const Point2* point = c_.point.data();
  const auto to = [&](VertexIndex v) { return v == kInfinity ? Point2{} : point[v] - p; };
  const auto is_near = [&](VertexIndex v, Point2 d) { return squared_length(d) < min_squared && v != kInfinity; };
  const Triangle& first = tri[holder];
  const Point2 d[3] = {to(first.node[0]), to(first.node[1]), to(first.node[2])};
  cavity_.push_back(holder);
  // Depth first, each triangle's edges in anticlockwise order: so the cavity's edges come in order too.
  for (unsigned e = 3; e-- > 0;) {
    if (is_near(first.node[e], d[e])) return false;
    const unsigned i = next_of(e), j = previous_of(e);
    stack_.push_back({first.neigh[e], first.node[i], first.node[j], first.flags >> e & 1, d[i], d[j]});
  }
  std::uint64_t tests = 0;
  while (!stack_.empty()) {
    Open open = stack_.back();
    stack_.pop_back();
    while (!open.is_constrained) {
      const TriIndex t = open.outer >> 2;
      const unsigned e = open.outer & 3, i = next_of(e), j = previous_of(e);  // node i is b, node j is a
      const Triangle& s = tri[t];
      const VertexIndex apex = s.node[e];
      const Point2 to_apex = to(apex);
      ++tests;
      if (!is_in_conflict(s, apex, open, p, to_apex)) break;
      if (is_near(apex, to_apex)) return false;
      cavity_.push_back(t);
      stack_.push_back({s.neigh[j], apex, open.b, s.flags >> j & 1, to_apex, open.to_b});
      open = {s.neigh[i], open.a, apex, s.flags >> i & 1, open.to_a, to_apex};
    }
    edges_.push_back({open.outer, open.a, open.b, open.is_constrained});
  }
  counts.incircle_tests += tests;
  return true;
}

bool PlanarKernel::has_duplicate(TriIndex holder, Point2 p) {
  for (const VertexIndex v : c_.tri[holder].node)
    if (v != kInfinity && c_.point[v].x == p.x && c_.point[v].y == p.y) {
      duplicate_of = v;
      return true;
    }
  return false;
}

PlanarKernel::Insert PlanarKernel::insert_into(TriIndex holder, VertexIndex v) {
  const Point2 p = c_.point[v];
  if (has_duplicate(holder, p)) return Insert::duplicate;
  grow_cavity(holder, p);
  fill_cavity(v);
  return Insert::done;
}

PlanarKernel::Insert PlanarKernel::check_segments(Point2 p, const Limits& limits) const {
  for (const CavityEdge& edge : edges_) {
    if (!edge.is_constrained || edge.a == kInfinity || edge.b == kInfinity) continue;
    // p may lie on a segment exactly, or behind it where the walk found no way round.
    if (orient2d(c_.point[edge.a], c_.point[edge.b], p) <= 0) return Insert::encroached;
    if (!limits.keeps_off_segments) continue;
    if (is_too_low(c_.point[edge.a], c_.point[edge.b], p)) return Insert::encroached;
  }
  return Insert::done;
}

PlanarKernel::Insert PlanarKernel::insert_into(TriIndex holder, VertexIndex v, const Limits& limits) {
  const Point2 p = c_.point[v];
  if (has_duplicate(holder, p)) return Insert::duplicate;
  if (!grow_cavity(holder, p, limits.min_distance * limits.min_distance)) return Insert::too_close;
  const Insert verdict = check_segments(p, limits);
  if (verdict == Insert::done) fill_cavity(v);
  return verdict;
}

/// A new ghost comes as (v, infinity, b); its ghost node goes last.
void PlanarKernel::turn_ghost(TriIndex t) {
  Triangle& s = c_.tri[t];
  const Triangle old = s;
  for (unsigned k = 0; k < 3; ++k) {
    s.node[next_of(k)] = old.node[k];
    s.neigh[next_of(k)] = old.neigh[k];
  }
  s.flags = (old.flags & ~kEdgeBits) | (old.flags & 1) << 1 | (old.flags & 2) << 1 | (old.flags & 4) >> 2;
  for (unsigned k = 0; k < 3; ++k) c_.tri[s.neigh[k] >> 2].neigh[s.neigh[k] & 3] = 4 * t + k;
}

void PlanarKernel::fill_cavity(VertexIndex v) {
  const std::size_t n = edges_.size();
  const std::uint32_t region = c_.tri[cavity_.front()].region;
  made_.assign(cavity_.begin(), cavity_.end());
  while (made_.size() < n) made_.push_back(c_.new_slot());
  Triangle* tri = c_.tri.data();
  TriIndex ghost_to_turn = kNoTri;
  TriIndex before = made_[n - 1];
  for (std::size_t i = 0; i < n; ++i) {
    const CavityEdge& edge = edges_[i];
    const TriIndex t = made_[i], after = made_[i + 1 < n ? i + 1 : 0];
    tri[t] = {
        {v, edge.a, edge.b}, {edge.outer, 4 * after + 2, 4 * before + 1}, region, flags_of_new | edge.is_constrained};
    tri[edge.outer >> 2].neigh[edge.outer & 3] = 4 * t;
    if (edge.a == kInfinity) [[unlikely]]
      ghost_to_turn = t;
    else if (edge.b != kInfinity)
      last_tri = t;
    before = t;
  }
  if (ghost_to_turn != kNoTri) turn_ghost(ghost_to_turn);
  ++counts.points;
  counts.triangles_created += n;
}

}  // namespace delfront
