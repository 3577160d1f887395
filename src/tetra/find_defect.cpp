// SPDX-License-Identifier: Apache-2.0
// TetComplex::find_defect: every invariant of the complex, checked one by one.
#include <fmt/format.h>

#include <algorithm>

#include "tetra/tet_complex.hpp"

namespace delfront {

namespace {

std::string describe(const TetComplex& c, TetIndex t) {
  const std::uint32_t* n = &c.node[4 * t];
  return fmt::format("tet {} ({}, {}, {}, {})", t, n[0], n[1], n[2], n[3]);
}

std::string find_array_defect(const TetComplex& c) {
  const std::size_t slots = c.num_slots();
  if (c.node.size() != 4 * slots || c.neigh.size() != 4 * slots || c.region.size() != slots)
    return "tet arrays of different lengths";
  if (c.vertex_tet.size() != c.num_vertices() || c.on_boundary.size() != c.num_vertices())
    return "vertex arrays of different lengths";
  std::size_t dead = 0;
  for (TetIndex t = 0; t < slots; ++t) dead += c.is_dead(t) ? 1 : 0;
  if (slots - dead != c.num_live()) return fmt::format("{} live tets, {} counted", slots - dead, c.num_live());
  return {};
}

std::string find_node_defect(const TetComplex& c, TetIndex t) {
  const std::uint32_t* n = &c.node[4 * t];
  const unsigned real = c.is_ghost(t) ? 3 : 4;
  for (unsigned i = 0; i < 4; ++i) {
    if (i < real && n[i] >= c.num_vertices()) return fmt::format("{}: node {} does not exist", describe(c, t), i);
    for (unsigned j = 0; j < i; ++j)
      if (n[i] == n[j]) return fmt::format("{}: a node twice", describe(c, t));
  }
  if (real == 4 && c.orient(n[0], n[1], n[2], n[3]) <= 0) return describe(c, t) + ": not positive";
  if (c.flag[t] & (TetComplex::marked | TetComplex::visited | TetComplex::in_scan))
    return describe(c, t) + ": a scratch flag is set";
  return {};
}

std::string find_face_defect(const TetComplex& c, FaceRef ref) {
  const FaceRef other = c.neigh[ref];
  const TetIndex t = ref >> 2;
  if (other >= c.neigh.size() || c.is_dead(other >> 2))
    return fmt::format("{}: face {} has no live neighbour", describe(c, t), ref & 3);
  if (c.neigh[other] != ref || other >> 2 == t)
    return fmt::format("{}: face {} and its neighbour disagree", describe(c, t), ref & 3);
  auto mine = c.face_nodes(ref);
  auto theirs = c.face_nodes(other);
  // The same three nodes the other way round: align the first one, then compare backwards.
  for (int turn = 0; turn < 3 && theirs[0] != mine[0]; ++turn)
    std::rotate(theirs.begin(), theirs.begin() + 1, theirs.end());
  if (mine[0] != theirs[0] || mine[1] != theirs[2] || mine[2] != theirs[1])
    return fmt::format("{} and {}: nodes of the common face differ", describe(c, t), describe(c, other >> 2));
  if (c.is_constrained(ref) != c.is_constrained(other))
    return fmt::format("{} and {}: constrained on one side only", describe(c, t), describe(c, other >> 2));
  return {};
}

std::string find_vertex_defect(const TetComplex& c, VertexIndex v) {
  const TetIndex t = c.vertex_tet[v];
  if (t == kNoIndex) return {};
  if (t >= c.num_slots() || c.is_dead(t)) return fmt::format("vertex {}: its tet {} is not alive", v, t);
  if (!c.has_vertex(t, v)) return fmt::format("vertex {}: its {} does not have it", v, describe(c, t));
  return {};
}

}  // namespace

std::string TetComplex::find_defect() const {
  if (std::string defect = find_array_defect(*this); !defect.empty()) return defect;
  for (TetIndex t = 0; t < num_slots(); ++t) {
    if (is_dead(t)) {
      if (node[4 * t] != kNoIndex || node[4 * t + 1] != kNoIndex) return fmt::format("dead slot {} has nodes", t);
      continue;
    }
    if (std::string defect = find_node_defect(*this, t); !defect.empty()) return defect;
    for (unsigned f = 0; f < 4; ++f)
      if (std::string defect = find_face_defect(*this, 4 * t + f); !defect.empty()) return defect;
    for (unsigned i = 0; i < (is_ghost(t) ? 3u : 4u); ++i)
      if (vertex_tet[node[4 * t + i]] == kNoIndex) return fmt::format("vertex {} has no tet", node[4 * t + i]);
  }
  for (VertexIndex v = 0; v < num_vertices(); ++v)
    if (std::string defect = find_vertex_defect(*this, v); !defect.empty()) return defect;
  std::vector<TetIndex> scratch;
  for (const auto& [a, b] : kept_edges.sorted())
    if (!on_boundary[a] || !on_boundary[b] || vertex_tet[a] == kNoIndex || find_edge(a, b, scratch) == kNoIndex)
      return fmt::format("the kept edge {} {} is not there, or its ends may move", a, b);
  return {};
}

}  // namespace delfront
