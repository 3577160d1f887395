// SPDX-License-Identifier: Apache-2.0
#include "volume/front_obstacles.hpp"

#include <algorithm>

#include "predicates/predicates.hpp"

namespace delfront {

FrontObstacles::FrontObstacles(const TetComplex& complex) {
  add_all(complex);
  if (empty()) return;
  find_regions(complex);
  std::erase_if(obstacles_, [](const FrontObstacle& o) { return o.region == TetComplex::kOutside; });
  Box all;
  for (const FrontObstacle& o : obstacles_) {
    Box box;
    box.add(complex.point(o.a));
    box.add(complex.point(o.b));
    box_.push_back(box);
    all.add(box);
  }
  tree_.clear(all);
  for (std::size_t i = 0; i < size(); ++i) tree_.insert(static_cast<std::uint32_t>(i), box_[i]);
}

/// Edges that are kept, and points of the boundary that neither have such an edge nor lie on a face.
void FrontObstacles::add_all(const TetComplex& c) {
  for (const auto& [a, b] : c.kept_edges.sorted()) obstacles_.push_back({a, b});
  std::vector<std::uint8_t> is_held(c.num_vertices(), 0);
  for (const FrontObstacle& o : obstacles_) is_held[o.a] = is_held[o.b] = 1;
  is_end_ = is_held;
  for (FaceRef ref = 0; ref < 4 * c.num_slots(); ++ref)
    if (!c.is_dead(ref >> 2) && !c.is_ghost(ref >> 2) && c.is_constrained(ref))
      for (const VertexIndex v : c.face_nodes(ref)) is_held[v] = 1;
  for (VertexIndex v = 0; v < c.num_vertices(); ++v) {
    if (c.vertex_tet[v] == kNoIndex || !c.on_boundary[v] || is_held[v]) continue;
    obstacles_.push_back({v, v});
    is_end_[v] = 1;
  }
  std::sort(obstacles_.begin(), obstacles_.end(),
            [](const FrontObstacle& p, const FrontObstacle& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
}

void FrontObstacles::find_regions(const TetComplex& c) {
  const auto find_at = [&](VertexIndex a, VertexIndex b) {
    return is_end(a) && is_end(b) ? find(std::min(a, b), std::max(a, b)) : size();
  };
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    for (unsigned i = 0; i < 4; ++i)
      for (unsigned j = i; j < 4; ++j) {
        const std::size_t at = find_at(c.node[4 * t + i], c.node[4 * t + j]);
        if (at == size()) continue;
        obstacles_[at].region = c.region[t];
        for (unsigned face = 0; face < 4; ++face)
          if (face != i && face != j && c.is_constrained(4 * t + face)) obstacles_[at].tets = 1;
      }
  }
}

std::size_t FrontObstacles::find(VertexIndex a, VertexIndex b) const {
  const auto at = std::lower_bound(obstacles_.begin(), obstacles_.end(), std::array{a, b},
                                   [](const FrontObstacle& o, const std::array<VertexIndex, 2>& e) {
                                     return o.a != e[0] ? o.a < e[0] : o.b < e[1];
                                   });
  return at != obstacles_.end() && at->a == a && at->b == b ? static_cast<std::size_t>(at - obstacles_.begin())
                                                            : size();
}

void FrontObstacles::count(const std::array<VertexIndex, 4>& nodes, bool comes) {
  for (unsigned i = 0; i < 4; ++i) {
    if (!is_end(nodes[i])) continue;
    for (unsigned j = i; j < 4; ++j) {
      if (!is_end(nodes[j])) continue;
      const std::size_t at = find(std::min(nodes[i], nodes[j]), std::max(nodes[i], nodes[j]));
      if (at < size()) comes ? ++obstacles_[at].tets : --obstacles_[at].tets;
    }
  }
}

std::size_t FrontObstacles::num_pending() const {
  return static_cast<std::size_t>(
      std::count_if(obstacles_.begin(), obstacles_.end(), [](const FrontObstacle& o) { return o.is_pending(); }));
}

namespace {

/// Signs of the ends with the sides of the tet: above 0 within.
using EndSigns = std::array<std::array<int, 2>, 4>;

/// @pre no common corners, the ends are not both beyond one side
bool passes_through(const std::array<NumberedPoint, 2>& s, const std::array<NumberedPoint, 4>& tet,
                    const EndSigns& sign) {
  for (unsigned end = 0; end < 2; ++end)
    if (std::all_of(sign.begin(), sign.end(), [&](const auto& of_side) { return of_side[end] >= 0; })) return true;
  // It enters through a side whose plane it does not lie in.
  for (unsigned side = 0; side < 4; ++side) {
    const auto [a, b] = sign[side];
    if (a * b > 0 || (a == 0 && b == 0)) continue;
    int least = 1, most = -1;
    for (unsigned i = 0; i < 3; ++i) {
      const Point &p = tet[kFaceNodes[side][i]].at, &q = tet[kFaceNodes[side][(i + 1) % 3]].at;
      const int turn = orient3d(s[0].at, s[1].at, p, q);
      least = std::min(least, turn), most = std::max(most, turn);
    }
    if (least >= 0 || most <= 0) return true;
  }
  return false;
}

}  // namespace

bool is_met_by_tet(const std::array<NumberedPoint, 2>& s, const std::array<NumberedPoint, 4>& tet) {
  std::array<unsigned, 2> corner{4, 4};
  for (unsigned end = 0; end < 2; ++end)
    for (unsigned i = 0; i < 4; ++i)
      if (tet[i].id == s[end].id) corner[end] = i;
  if (corner[0] < 4 && corner[1] < 4) return false;
  EndSigns sign{};
  for (unsigned side = 0; side < 4; ++side) {
    const auto& k = kFaceNodes[side];
    for (unsigned end = 0; end < 2; ++end)
      if (corner[end] == 4) sign[side][end] = orient3d(tet[k[0]].at, tet[k[1]].at, tet[k[2]].at, s[end].at);
  }
  for (unsigned end = 0; end < 2; ++end) {
    if (corner[end] == 4) continue;
    for (unsigned side = 0; side < 4; ++side)  // those at the corner
      if (side != corner[end] && sign[side][1 - end] < 0) return false;
    return true;
  }
  for (const auto& [a, b] : sign)
    if (a < 0 && b < 0) return false;
  return passes_through(s, tet, sign);
}

}  // namespace delfront
