// SPDX-License-Identifier: Apache-2.0
#include "planar/kernel.hpp"

#include <algorithm>
#include <cmath>

namespace delfront {

namespace {
/// A constrained edge is seen under at most 110 degrees: cos^2 of it, for the test without a root.
constexpr double kSquaredCosineOfWidest = 0.117;
}  // namespace

std::uint32_t PlanarKernel::random() { return random_state_ = random_state_ * 1664525u + 1013904223u; }

void PlanarKernel::start(VertexIndex a, VertexIndex b, VertexIndex c) {
  if (orient2d(c_.point[a], c_.point[b], c_.point[c]) < 0) std::swap(b, c);
  c_.tri.assign(4, {});
  const VertexIndex n[3] = {a, b, c};
  c_.tri[0] = {{a, b, c}, {}, 0, flags_of_new};
  for (unsigned e = 0; e < 3; ++e)
    c_.tri[1 + e] = {{n[previous_of(e)], n[next_of(e)], kInfinity}, {}, 0, flags_of_new};
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
  const double low = by_x ? std::min(a.x, b.x) : std::min(a.y, b.y), high = by_x ? std::max(a.x, b.x) : std::max(a.y, b.y);
  const double at = by_x ? p.x : p.y;
  return low < at && at < high;
}

inline bool PlanarKernel::is_in_conflict(TriIndex t, Point2 p) const {
  const Triangle& s = c_.tri[t];
  if (s.node[2] == kInfinity) [[unlikely]]
    return is_ghost_in_conflict(s, p);
  return incircle(c_.point[s.node[0]], c_.point[s.node[1]], c_.point[s.node[2]], p) > 0;
}

void PlanarKernel::grow_cavity(TriIndex holder, Point2 p) {
  cavity_.clear();
  edges_.clear();
  stack_.clear();
  const Triangle* tri = c_.tri.data();
  cavity_.push_back(holder);
  // Depth first, each triangle's edges in anticlockwise order: so the cavity's edges come in order too.
  for (int e = 2; e >= 0; --e) stack_.push_back(4 * holder + unsigned(e));
  while (!stack_.empty()) {
    const EdgeRef ref = stack_.back();
    stack_.pop_back();
    const Triangle& from = tri[ref >> 2];
    const EdgeRef outer = from.neigh[ref & 3];
    const std::uint32_t is_constrained = from.flags >> (ref & 3) & 1;
    if (!is_constrained) {
      ++counts.incircle_tests;
      if (is_in_conflict(outer >> 2, p)) {
        cavity_.push_back(outer >> 2);
        stack_.push_back(TriComplex::previous_edge(outer));
        stack_.push_back(TriComplex::next_edge(outer));
        continue;
      }
    }
    edges_.push_back({outer, from.node[next_of(ref & 3)], from.node[previous_of(ref & 3)], is_constrained});
  }
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

PlanarKernel::Insert PlanarKernel::check_cavity(Point2 p, const Limits& limits) const {
  const double min_squared = limits.min_distance * limits.min_distance;
  for (const CavityEdge& edge : edges_) {
    if (edge.a == kInfinity) continue;
    const Point2 to_a = c_.point[edge.a] - p;
    if (squared_length(to_a) < min_squared) return Insert::too_close;
    if (!edge.is_constrained) continue;
    const Point2 to_b = c_.point[edge.b] - p;
    if (cross(to_a, to_b) <= 0) return Insert::encroached;
    if (!limits.keeps_off_segments) continue;
    const double cosine = dot(to_a, to_b);
    if (cosine < 0 && cosine * cosine > kSquaredCosineOfWidest * squared_length(to_a) * squared_length(to_b))
      return Insert::encroached;
  }
  return Insert::done;
}

PlanarKernel::Insert PlanarKernel::insert_into(TriIndex holder, VertexIndex v, const Limits& limits) {
  const Point2 p = c_.point[v];
  if (has_duplicate(holder, p)) return Insert::duplicate;
  const double min_squared = limits.min_distance * limits.min_distance;
  for (const VertexIndex w : c_.tri[holder].node)
    if (w != kInfinity && squared_length(c_.point[w] - p) < min_squared) return Insert::too_close;
  grow_cavity(holder, p);
  const Insert verdict = check_cavity(p, limits);
  if (verdict != Insert::done) return verdict;
  // p may lie on a constrained edge exactly, or so near that a triangle with it would be flat.
  for (const CavityEdge& edge : edges_)
    if (edge.is_constrained && edge.a != kInfinity && edge.b != kInfinity &&
        orient2d(c_.point[edge.a], c_.point[edge.b], p) <= 0)
      return Insert::encroached;
  fill_cavity(v);
  return Insert::done;
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
    tri[t] = {{v, edge.a, edge.b},
              {edge.outer, 4 * after + 2, 4 * before + 1},
              region,
              flags_of_new | edge.is_constrained};
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
