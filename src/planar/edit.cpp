// SPDX-License-Identifier: Apache-2.0
#include "planar/edit.hpp"

namespace delfront {

namespace {
constexpr std::uint32_t kReplaced = 16;  ///< in Triangle::flags, during replace()
}

void Replacer::add_side(EdgeRef ref) {
  const VertexIndex a = c_.origin(ref), b = c_.target(ref);
  sides_.push_back({std::min(a, b), std::max(a, b), ref});
}

void Replacer::replace(std::span<const TriIndex> old, std::span<const Corners> corners) {
  const std::uint32_t region = c_.tri[old[0]].region;
  for (const TriIndex t : old) c_.tri[t].flags |= kReplaced;
  sides_.clear();
  kept_.clear();
  for (const TriIndex t : old)
    for (unsigned e = 0; e < 3; ++e) {
      const EdgeRef ref = 4 * t + e, other = c_.across(ref);
      if (!(c_.tri[other >> 2].flags & kReplaced))
        add_side(other);
      else if (c_.is_constrained(ref))
        kept_.push_back({c_.origin(ref), c_.target(ref)});
    }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const TriIndex t = i < old.size() ? old[i] : c_.new_slot();
    c_.tri[t] = {{corners[i][0], corners[i][1], corners[i][2]}, {kNoTri, kNoTri, kNoTri}, region, 0};
    for (unsigned e = 0; e < 3; ++e) {
      add_side(4 * t + e);
      c_.vertex_tri[corners[i][e]] = t;
    }
  }
  for (std::size_t i = corners.size(); i < old.size(); ++i) c_.free_slot(old[i]);
  bond_sides();
  for (const auto& [p, q] : kept_)
    if (const EdgeRef ref = c_.find_edge(p, q); ref != kNoTri) c_.set_constrained(ref, true);
}

void Replacer::bond_sides() {
  std::sort(sides_.begin(), sides_.end());
  DELFRONT_CHECK(sides_.size() % 2 == 0);
  for (std::size_t i = 0; i < sides_.size(); i += 2) {
    const Side &one = sides_[i], &two = sides_[i + 1];
    DELFRONT_CHECK(one.low == two.low && one.high == two.high);
    const bool is_constrained = c_.is_constrained(one.ref) || c_.is_constrained(two.ref);
    c_.bond(one.ref, two.ref);
    if (is_constrained) c_.set_constrained(one.ref, true);
  }
}

bool collect_star(const TriComplex& c, VertexIndex v, std::vector<TriIndex>& triangles,
                  std::vector<VertexIndex>& ring) {
  triangles.clear();
  ring.clear();
  const EdgeRef first = c.first_edge(v);
  EdgeRef ref = first;
  do {
    if (c.is_ghost(ref >> 2)) return false;
    triangles.push_back(ref >> 2);
    ring.push_back(c.target(ref));
    ref = c.turn_left(ref);
  } while (ref != first);
  return true;
}

EdgeRef split_edge(TriComplex& c, EdgeRef ref, VertexIndex m) {
  const bool is_turned = c.is_ghost(ref >> 2);
  if (is_turned) ref = c.across(ref);
  const EdgeRef other = c.across(ref);
  const VertexIndex a = c.origin(ref), b = c.target(ref), up = c.apex(ref), down = c.apex(other);
  const auto is_positive = [&](VertexIndex p, VertexIndex q, VertexIndex r) {
    return r == kInfinity || orient2d(c.point[p], c.point[q], c.point[r]) > 0;
  };
  if (!is_positive(a, m, up) || !is_positive(m, b, up) || !is_positive(b, m, down) || !is_positive(m, a, down))
    return kNoTri;
  const TriIndex t = ref >> 2, u = other >> 2, t2 = c.new_slot(), u2 = c.new_slot();
  const EdgeRef b_up = c.across(TriComplex::next_edge(ref)), up_a = c.across(TriComplex::previous_edge(ref));
  const EdgeRef a_down = c.across(TriComplex::next_edge(other)), down_b = c.across(TriComplex::previous_edge(other));
  const auto bit = [&](EdgeRef r, unsigned e) { return c.is_constrained(r) ? 1u << e : 0u; };
  const std::uint32_t f_b_up = bit(b_up, 0), f_up_a = bit(up_a, 1), f_a_down = bit(a_down, 0),
                      f_down_b = bit(down_b, 1);
  const auto make = [&](TriIndex slot, Corners n, std::uint32_t region, std::uint32_t flags) {
    c.tri[slot] = {{n[0], n[1], n[2]}, {kNoTri, kNoTri, kNoTri}, region, flags | 4};
  };
  make(t, {a, m, up}, c.tri[t].region, f_up_a);
  make(t2, {m, b, up}, c.tri[t].region, f_b_up);
  make(u, {b, m, down}, c.tri[u].region, f_down_b);
  make(u2, {m, a, down}, c.tri[u].region, f_a_down);
  c.bond(4 * t + 1, up_a);
  c.bond(4 * t2 + 0, b_up);
  c.bond(4 * u + 1, down_b);
  c.bond(4 * u2 + 0, a_down);
  c.bond(4 * t + 0, 4 * t2 + 1);
  c.bond(4 * u + 0, 4 * u2 + 1);
  c.bond(4 * t + 2, 4 * u2 + 2);
  c.bond(4 * t2 + 2, 4 * u + 2);
  for (const VertexIndex v : {a, m, up}) c.vertex_tri[v] = t;
  c.vertex_tri[b] = t2;
  if (down != kInfinity) c.vertex_tri[down] = u;
  return is_turned ? 4 * u2 + 2 : 4 * t + 2;
}

std::size_t make_delaunay(TriComplex& c, std::vector<EdgeRef>& edges) {
  std::size_t flips = 0;
  while (!edges.empty()) {
    const EdgeRef ref = edges.back();
    edges.pop_back();
    const EdgeRef other = c.across(ref);
    if (c.is_constrained(ref) || c.is_ghost(ref >> 2) || c.is_ghost(other >> 2)) continue;
    if (incircle(c.point[c.origin(ref)], c.point[c.target(ref)], c.point[c.apex(ref)], c.point[c.apex(other)]) <= 0)
      continue;
    const TriIndex t = ref >> 2, u = other >> 2;
    c.flip(ref);
    ++flips;
    for (const EdgeRef again : {4 * t + 1, 4 * t + 2, 4 * u + 1, 4 * u + 2}) edges.push_back(again);
  }
  return flips;
}

}  // namespace delfront
