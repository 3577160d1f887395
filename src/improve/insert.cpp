// SPDX-License-Identifier: Apache-2.0
// Insertion of a point: a cavity is grown around a bad tet, always across the hole's face that makes the worst new tet,
// and cut back to the stage that was best; then the point moves to its best place in that hole, and the cavity is grown
// once more from there. Source: Klingner & Shewchuk (2007), with a greedy search in place of their digraph.
#include <algorithm>

#include "improve/operations.hpp"

namespace delfront {

namespace {
constexpr std::size_t kMaxCavity = 48;
constexpr double kShortest = 0.45;         // edges made by an insertion, of the wanted size ...
constexpr double kShortestAtWorst = 0.25;  // ... and where the tet is far below the goal
constexpr double kInsertionGain = 1.5;     // of the squared sine, short of the goal: a point has to be worth it
constexpr double kFirstShare = 0.5;        // of the shortest, where the search starts
constexpr int kRounds = 3;                 // of growing the cavity and moving the point
}  // namespace

bool LocalOperations::can_grow_across(FaceRef to) const {
  const TetIndex t = to >> 2;
  if (c_.is_constrained(to) || c_.is_ghost(t) || c_.region[t] != c_.region[cavity_[0]]) return false;
  for (unsigned f = 0; f < 4; ++f)  // a constrained face with both its tets in the cavity would be lost
    if (c_.is_constrained(4 * t + f) && c_.flag[c_.neigh[4 * t + f] >> 2] & TetComplex::marked) return false;
  return true;
}

void LocalOperations::clear_cavity() {
  for (const TetIndex t : cavity_) c_.flag[t] &= static_cast<std::uint16_t>(~TetComplex::marked);
  cavity_.clear();
  hole_.clear();
}

void LocalOperations::add_to_cavity(TetIndex t, const Point& p) {
  cavity_.push_back(t);
  c_.flag[t] |= TetComplex::marked;
  for (unsigned f = 0; f < 4; ++f) {
    const FaceRef other = c_.neigh[4 * t + f];
    if (c_.flag[other >> 2] & TetComplex::marked) {
      const auto shared = std::find_if(hole_.begin(), hole_.end(), [&](const HoleFace& h) { return h.ref == other; });
      *shared = hole_.back();
      hole_.pop_back();
      continue;
    }
    const auto n = c_.face_nodes(4 * t + f);
    hole_.push_back({4 * t + f, measure_quality(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), p)});
  }
}

void LocalOperations::rebuild_hole(std::size_t num_tets, const Point& p) {
  const std::vector<TetIndex> kept(cavity_.begin(), cavity_.begin() + static_cast<std::ptrdiff_t>(num_tets));
  clear_cavity();
  for (const TetIndex t : kept) add_to_cavity(t, p);
}

void LocalOperations::grow_cavity(const Point& p, double enough) {
  double best = -1;
  std::size_t best_size = cavity_.size();
  while (cavity_.size() <= kMaxCavity) {
    const auto worst = std::min_element(hole_.begin(), hole_.end(),
                                        [](const HoleFace& a, const HoleFace& b) { return a.quality < b.quality; });
    if (worst->quality > best) {
      best = worst->quality;
      best_size = cavity_.size();
    }
    const FaceRef across = c_.neigh[worst->ref];
    if (best > enough || !can_grow_across(across)) break;
    add_to_cavity(across >> 2, p);
  }
  if (best_size < cavity_.size()) rebuild_hole(best_size, p);
}

bool LocalOperations::is_far_from_hole(const Point& p, double bound, double of_least) const {
  const double share = of_least * (bound < quality_of_angle(5) ? kShortestAtWorst : kShortest);
  double h = 0;
  for (unsigned i = 0; i < 4; ++i) h += 0.25 * c_.vertex[c_.node[4 * cavity_[0] + i]].h;
  const double least = share * share * h * h;
  return std::all_of(hole_.begin(), hole_.end(), [&](const HoleFace& face) {
    const auto n = c_.face_nodes(face.ref);
    return squared_length(c_.point(n[0]) - p) >= least && squared_length(c_.point(n[1]) - p) >= least &&
           squared_length(c_.point(n[2]) - p) >= least;
  });
}

bool LocalOperations::keeps_boundary_vertices() {
  candidates_.clear();
  for (const HoleFace& face : hole_) {
    const auto n = c_.face_nodes(face.ref);
    candidates_.insert(candidates_.end(), n.begin(), n.end());
  }
  std::sort(candidates_.begin(), candidates_.end());
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  std::vector<VertexIndex>& lost = star_;
  lost.clear();
  for (const TetIndex t : cavity_)
    for (unsigned i = 0; i < 4; ++i)
      if (!std::binary_search(candidates_.begin(), candidates_.end(), c_.node[4 * t + i]))
        lost.push_back(c_.node[4 * t + i]);
  std::sort(lost.begin(), lost.end());
  lost.erase(std::unique(lost.begin(), lost.end()), lost.end());
  return std::none_of(lost.begin(), lost.end(), [&](VertexIndex v) { return c_.on_boundary[v] != 0; });
}

void LocalOperations::commit_insertion(const Point& p) {
  double h = 0;
  for (const VertexIndex v : candidates_) h += c_.vertex[v].h;
  const VertexIndex v = c_.add_vertex(p, h / static_cast<double>(candidates_.size()));
  plan_.made.clear();
  for (const HoleFace& face : hole_) {
    const auto n = c_.face_nodes(face.ref);
    plan_.made.push_back({n[0], n[1], n[2], v});
  }
  plan_.old_tets.assign(cavity_.begin(), cavity_.end());
  num_dropped += star_.size();
  clear_cavity();
  c_.replace(plan_.old_tets, plan_.made, touched);
}

bool LocalOperations::try_point(Point p, double bound, double enough) {
  if (!is_far_from_hole(p, bound, kFirstShare)) {  // hardly any move mends that: save the search
    clear_cavity();
    return false;
  }
  double worst = -1;
  for (int round = 0; round < kRounds; ++round) {
    grow_cavity(p, enough);
    faces_.clear();
    for (const HoleFace& face : hole_) {
      const auto n = c_.face_nodes(face.ref);
      faces_.add(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]));
    }
    const double before = worst;
    worst = optimise_point(faces_, p, enough, scratch_);
    if (worst > enough || worst <= before) break;
    rebuild_hole(cavity_.size(), p);
  }
  const auto is_positive = [&](const HoleFace& face) {
    const auto n = c_.face_nodes(face.ref);
    return orient3d(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), p) > 0;
  };
  if (worst > bound && is_far_from_hole(p, bound, 1) && keeps_boundary_vertices() &&
      std::all_of(hole_.begin(), hole_.end(), is_positive)) {
    commit_insertion(p);
    return true;
  }
  clear_cavity();
  return false;
}

bool LocalOperations::insert(TetIndex t, double goal, double enough) {
  const double now = quality(t);
  const double bound = std::max(kGain * now, std::min(goal, kInsertionGain * now));
  const std::uint32_t* n = &c_.node[4 * t];
  const Point corner[4] = {c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), c_.point(n[3])};
  const Point centroid = 0.25 * (corner[0] + corner[1] + corner[2] + corner[3]);
  clear_cavity();
  add_to_cavity(t, centroid);
  if (try_point(centroid, bound, enough)) return true;
  // Then the longest edge's midpoint, with the edge's whole ring as the first cavity.
  const std::uint8_t* longest = kEdgeNodes[0];
  for (const auto& e : kEdgeNodes)
    if (squared_length(corner[e[0]] - corner[e[1]]) > squared_length(corner[longest[0]] - corner[longest[1]]))
      longest = e;
  const Point middle = 0.5 * (corner[longest[0]] + corner[longest[1]]);
  c_.edge_ring(t, n[longest[0]], n[longest[1]], star_);
  for (const TetIndex r : star_) {
    if (c_.is_ghost(r) || c_.region[r] != c_.region[t]) return false;
    for (unsigned f = 0; f < 4; ++f) {
      const VertexIndex opposite = c_.node[4 * r + f];
      if (c_.is_constrained(4 * r + f) && opposite != n[longest[0]] && opposite != n[longest[1]]) return false;
    }
  }
  for (const TetIndex r : star_) add_to_cavity(r, middle);
  return try_point(middle, bound, enough);
}

}  // namespace delfront
