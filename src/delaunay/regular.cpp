// SPDX-License-Identifier: Apache-2.0
// Lifted to |p|^2 - weight, points have a lower convex hull, whose facets are the regular tets. A new point either lies
// above that hull (it is hidden, and stays so) or sees a connected set of facets from below, which it replaces;
// vertices inside of that set become hidden. With lifts perturbed symbolically the lifted points are in general
// position, so every test has an answer, the set seen is a ball, and no new tet is flat: a face in whose plane the
// point lies has the same answer on both sides, since both tests compare the point with the same lifted plane. A ghost
// (a, b, c, infinity) is in conflict with points strictly beyond its face, and with coplanar ones when the real tet
// behind the face is.
#include "delaunay/regular.hpp"

#include "predicates/power.hpp"

namespace delfront {

void RegularKernel::start(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d) {
  walker_.start(a, b, c, d);
  counts_.points += 4;
}

KernelCounts RegularKernel::counts() const {
  KernelCounts sum = counts_;
  sum.walk_steps = walker_.counts.walk_steps;
  return sum;
}

bool RegularKernel::in_conflict(TetIndex t, VertexIndex v) {
  const std::uint32_t* n = &c_.node[4 * t];
  if (n[3] == kGhost) {
    const int side = orient3d(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), c_.point(v));
    if (side != 0) return side > 0;
    n = &c_.node[c_.neigh[4 * t + 3] & ~3u];
  }
  ++counts_.insphere_tests;
  const auto at = [&](VertexIndex w) { return WeightedPoint{c_.point(w), c_.vertex[w].h}; };
  return power_test_perturbed(at(n[0]), at(n[1]), at(n[2]), at(n[3]), at(v)) > 0;
}

bool RegularKernel::insert(VertexIndex v) {
  const TetIndex holder = walker_.locate(v, walker_.last_tet);
  if (!in_conflict(holder, v)) return false;
  grow_cavity(holder, v);
  fill_cavity(v);
  ++counts_.points;
  return true;
}

void RegularKernel::grow_cavity(TetIndex start, VertexIndex v) {
  cavity_.assign(1, start);
  border_.clear();
  c_.flag[start] |= TetComplex::marked;
  for (std::size_t i = 0; i < cavity_.size(); ++i)
    for (FaceRef ref = 4 * cavity_[i]; ref < 4 * cavity_[i] + 4; ++ref) {
      const TetIndex next = c_.neigh[ref] >> 2;
      if (c_.flag[next] & TetComplex::marked) continue;
      if (!in_conflict(next, v)) {
        border_.push_back(ref);
        continue;
      }
      c_.flag[next] |= TetComplex::marked;
      cavity_.push_back(next);
    }
}

void RegularKernel::fill_cavity(VertexIndex v) {
  ball_.faces.clear();
  for (const FaceRef ref : border_) {
    const auto [x, y, z] = c_.face_nodes(ref);
    Ball::Face face{};
    face.node[0] = x, face.node[1] = y, face.node[2] = z;
    face.outer = c_.neigh[ref];
    ball_.faces.push_back(face);
  }
  for (const TetIndex t : cavity_) {
    for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref)
      if (c_.node[ref] != kGhost) c_.vertex_tet[c_.node[ref]] = kNoIndex;  // those on the border get a new one
    c_.kill_tet(t);
  }
  made_.clear();
  while (made_.size() < border_.size()) made_.push_back(c_.new_tet());
  ball_.number_vertices();
  ball_.write_tets(c_, v, made_, 0);
  c_.vertex_tet[v] = made_[0];
  walker_.last_tet = made_[0];
  counts_.tets_deleted += cavity_.size();
  counts_.tets_created += made_.size();
}

}  // namespace delfront
