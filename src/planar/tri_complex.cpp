// SPDX-License-Identifier: Apache-2.0
#include "planar/tri_complex.hpp"

namespace delfront {

TriIndex TriComplex::new_slot() {
  if (!free_slots.empty()) {
    const TriIndex t = free_slots.back();
    free_slots.pop_back();
    return t;
  }
  if (tri.size() >= kMostTriangles) throw LimitError("more than 2^30 triangles; ask for larger sizes");
  tri.push_back({});
  return static_cast<TriIndex>(tri.size() - 1);
}

void TriComplex::free_slot(TriIndex t) {
  tri[t].flags = kDead;
  free_slots.push_back(t);
}

void TriComplex::index_vertices() {
  vertex_tri.assign(point.size(), kNoTri);
  for (TriIndex t = 0; t < tri.size(); ++t) {
    if (is_dead(t) || is_ghost(t)) continue;
    for (const VertexIndex v : tri[t].node) vertex_tri[v] = t;
  }
}

EdgeRef TriComplex::find_edge(VertexIndex a, VertexIndex b) const {
  if (vertex_tri[a] == kNoTri) return kNoTri;
  const EdgeRef first = first_edge(a);
  EdgeRef ref = first;
  do {
    if (target(ref) == b) return ref;
    ref = turn_left(ref);
  } while (ref != first);
  return kNoTri;
}

// t = (.., a at next, b at previous) with apex c; u over the edge with apex d. Afterwards t = (d, c, a) read as nodes
// [a, d, c] and u = [b, c, d]: the common edge lies opposite node 0 of both.
EdgeRef TriComplex::flip(EdgeRef ref) {
  const EdgeRef other = across(ref);
  const TriIndex t = ref >> 2, u = other >> 2;
  const VertexIndex a = origin(ref), b = target(ref), c = apex(ref), d = apex(other);
  const EdgeRef bc = across(next_edge(ref)), ca = across(previous_edge(ref));
  const EdgeRef ad = across(next_edge(other)), db = across(previous_edge(other));
  const bool is_bc = is_constrained(bc), is_ca = is_constrained(ca);
  const bool is_ad = is_constrained(ad), is_db = is_constrained(db);
  const auto flags = [](std::uint32_t old, bool one, bool two) {
    return (old & ~kEdgeBits) | (one ? 2u : 0u) | (two ? 4u : 0u);
  };
  tri[t] = {{a, d, c}, {4 * u, ca, ad}, tri[t].region, flags(tri[t].flags, is_ca, is_ad)};
  tri[u] = {{b, c, d}, {4 * t, db, bc}, tri[u].region, flags(tri[u].flags, is_db, is_bc)};
  tri[ca >> 2].neigh[ca & 3] = 4 * t + 1;
  tri[ad >> 2].neigh[ad & 3] = 4 * t + 2;
  tri[db >> 2].neigh[db & 3] = 4 * u + 1;
  tri[bc >> 2].neigh[bc & 3] = 4 * u + 2;
  if (!vertex_tri.empty()) vertex_tri[a] = vertex_tri[c] = vertex_tri[d] = t, vertex_tri[b] = u;
  return 4 * t;
}

const char* TriComplex::find_defect() const {
  for (TriIndex t = 0; t < tri.size(); ++t) {
    if (is_dead(t)) continue;
    const Triangle& s = tri[t];
    for (unsigned e = 0; e < 3; ++e) {
      const EdgeRef other = s.neigh[e];
      if ((other & 3) == 3 || other >> 2 >= tri.size() || is_dead(other >> 2)) return "a neighbour that does not exist";
      if (across(other) != 4 * t + e) return "a bond that leads one way only";
      if (origin(other) != s.node[previous_of(e)] || target(other) != s.node[next_of(e)])
        return "neighbours with different nodes on their edge";
      if (is_constrained(other) != is_constrained(4 * t + e)) return "an edge constrained on one side only";
    }
    if (is_ghost(t)) continue;
    if (s.node[0] == kInfinity || s.node[1] == kInfinity) return "a ghost whose last node is not the ghost vertex";
    if (orient2d(point[s.node[0]], point[s.node[1]], point[s.node[2]]) <= 0) return "a triangle that is not positive";
  }
  return "";
}

bool TriComplex::is_delaunay() const {
  for (TriIndex t = 0; t < tri.size(); ++t) {
    if (is_dead(t) || is_ghost(t)) continue;
    const Triangle& s = tri[t];
    for (unsigned e = 0; e < 3; ++e) {
      const EdgeRef other = s.neigh[e];
      if (s.flags >> e & 1 || is_ghost(other >> 2)) continue;
      if (incircle(point[s.node[0]], point[s.node[1]], point[s.node[2]], point[apex(other)]) > 0) return false;
    }
  }
  return true;
}

}  // namespace delfront
