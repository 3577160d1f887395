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
  if (is_urgent_) return true;
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

bool LocalOperations::keeps_edges() const {
  return !c_.loses_kept_edge(cavity_, [this](VertexIndex a, VertexIndex b) {
    return std::any_of(hole_.begin(), hole_.end(), [&](const HoleFace& face) {
      const auto n = c_.face_nodes(face.ref);
      return std::find(n.begin(), n.end(), a) != n.end() && std::find(n.begin(), n.end(), b) != n.end();
    });
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
  if (worst > bound && is_far_from_hole(p, bound, 1) && keeps_boundary_vertices() && keeps_edges() &&
      std::all_of(hole_.begin(), hole_.end(), is_positive)) {
    commit_insertion(p);
    return true;
  }
  clear_cavity();
  return false;
}

/// The mean unit normal, into the cavity, of the constrained faces of its hole.
Point LocalOperations::measure_inwards() const {
  Point sum;
  for (const HoleFace& face : hole_) {
    if (!c_.is_constrained(face.ref)) continue;
    const auto n = c_.face_nodes(face.ref);
    const Point normal = cross(c_.point(n[1]) - c_.point(n[0]), c_.point(n[2]) - c_.point(n[0]));
    if (const double l = length(normal); l > 0) sum = sum + normal / l;
  }
  const double l = length(sum);
  return l > 0 ? sum / l : sum;
}

/// The midpoint of edge e of t, with the edge's whole ring as the first cavity. Where that lies in a flat part of the
/// boundary and the tet is urgent: from places off it, since no cavity can be grown from a place in it.
bool LocalOperations::insert_at_edge(TetIndex t, const std::uint8_t* e, double bound, double enough) {
  const VertexIndex a = c_.node[4 * t + e[0]], b = c_.node[4 * t + e[1]];
  if (c_.keeps_edge(a, b)) return false;
  const Point middle = 0.5 * (c_.point(a) + c_.point(b));
  const double reach = distance(c_.point(a), c_.point(b));
  c_.edge_ring(t, a, b, star_);
  for (const TetIndex r : star_) {
    if (c_.is_ghost(r) || c_.region[r] != c_.region[t]) return false;
    for (unsigned f = 0; f < 4; ++f) {
      const VertexIndex opposite = c_.node[4 * r + f];
      if (c_.is_constrained(4 * r + f) && opposite != a && opposite != b) return false;
    }
  }
  const std::vector<TetIndex> ring = star_;
  for (const double away : {0.0, 0.1, 0.01, 1e-4}) {
    for (const TetIndex r : ring) add_to_cavity(r, middle);
    const Point inwards = away > 0 ? measure_inwards() : Point{};
    const Point p = middle + (away * reach) * inwards;
    if (away > 0) rebuild_hole(cavity_.size(), p);
    if (try_point(p, bound, enough)) return true;
    if (!is_urgent_) return false;
  }
  return false;
}

bool LocalOperations::insert(TetIndex t, double goal, double enough, bool is_urgent) {
  const double now = quality(t);
  const double bound = std::max(kGain * now, std::min(goal, kInsertionGain * now));
  const std::uint32_t* n = &c_.node[4 * t];
  const Point corner[4] = {c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), c_.point(n[3])};
  const Point centroid = 0.25 * (corner[0] + corner[1] + corner[2] + corner[3]);
  is_urgent_ = is_urgent;
  clear_cavity();
  add_to_cavity(t, centroid);
  if (try_point(centroid, bound, enough)) return true;
  double length[6];
  std::array<std::uint8_t, 6> order{0, 1, 2, 3, 4, 5};
  for (unsigned e = 0; e < 6; ++e) length[e] = squared_length(corner[kEdgeNodes[e][0]] - corner[kEdgeNodes[e][1]]);
  std::stable_sort(order.begin(), order.end(), [&](std::uint8_t a, std::uint8_t b) { return length[a] > length[b]; });
  const std::size_t tries = is_urgent ? order.size() : 1;  // the longest edge is the one that most often helps
  return std::any_of(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(tries),
                     [&](std::uint8_t e) { return insert_at_edge(t, kEdgeNodes[e], bound, enough); });
}

}  // namespace delfront
