// SPDX-License-Identifier: Apache-2.0
// Edge removal: ring tet i is (a, b, p_i, p_i+1) positive, so the ring turns anticlockwise seen from b. A triangle
// (p_i, p_j, p_k), i < j < k, of the ring's polygon makes the tets (p_i, p_j, p_k, b) and (p_i, p_k, p_j, a).
// Face removal is the inverse: the face's polygon, seen from the apex above, turns anticlockwise; each of its edges
// (p, q) makes the tet (below, above, p, q).
#include "tetra/flips.hpp"

namespace delfront {

namespace {

constexpr int kMaxDepth = 4;  // faces removed beyond the first one, along one branch

}  // namespace

bool Flips::collect_ring(TetIndex t, VertexIndex a, VertexIndex b) {
  ring_.clear();
  ring_vertex_.clear();
  if (c_.keeps_edge(a, b)) return false;
  const std::uint8_t* other = kOtherNodes[c_.local_index(t, a)][c_.local_index(t, b)];
  unsigned leave = other[0];
  VertexIndex behind = c_.node[4 * t + other[0]], ahead = c_.node[4 * t + other[1]];
  TetIndex at = t;
  do {
    const FaceRef out = 4 * at + leave;
    if (c_.is_constrained(out) || c_.is_ghost(at) || ring_.size() == kMaxRing) return false;
    if (c_.region[at] != c_.region[t]) return false;
    ring_.push_back(at);
    ring_vertex_.push_back(behind);
    const FaceRef enter = c_.neigh[out];
    at = enter >> 2;
    behind = ahead;
    leave = static_cast<unsigned>(c_.local_index(at, ahead));
    ahead = c_.node[enter];
  } while (at != t);
  return ring_.size() >= 3;
}

void Flips::measure_ring_triangles(VertexIndex a, VertexIndex b) {
  const std::size_t n = ring_.size();
  Point p[kMaxRing];
  for (std::size_t i = 0; i < n; ++i) p[i] = c_.point(ring_vertex_[i]);
  faces_.clear();
  for (std::size_t i = 0; i + 2 < n; ++i)
    for (std::size_t j = i + 1; j + 1 < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k) faces_.add(p[i], p[j], p[k]);
  faces_.measure(c_.point(b), quality_);
  faces_.measure(c_.point(a), quality_below_);
  for (std::size_t i = 0; i < faces_.size(); ++i) quality_[i] = std::min(quality_[i], -quality_below_[i]);
}

double Flips::fill_table(double bound) {
  const std::size_t n = ring_.size();
  // quality_[index(i, j, k)] in the order measure_ring_triangles counted; offsets of each i and (i, j).
  std::uint16_t start[kMaxRing][kMaxRing];
  std::uint16_t count = 0;
  for (std::size_t i = 0; i + 2 < n; ++i) {
    for (std::size_t j = i + 1; j + 1 < n; ++j) {
      start[i][j] = count;
      count = static_cast<std::uint16_t>(count + (n - 1 - j));
    }
  }
  for (std::size_t i = 0; i + 1 < n; ++i) best_[i][i + 1] = std::numeric_limits<double>::infinity();
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t k = i + span;
      double best = -1;
      for (std::size_t j = i + 1; j < k; ++j) {
        const double value = std::min({quality_[start[i][j] + (k - j - 1)], best_[i][j], best_[j][k]});
        if (value <= best) continue;
        best = value;
        split_[i][k] = static_cast<std::uint8_t>(j);
      }
      best_[i][k] = best > bound ? best : -1;
    }
  }
  return best_[0][n - 1];
}

void Flips::add_polygon(std::size_t i, std::size_t k, VertexIndex a, VertexIndex b, Retriangulation& plan) const {
  if (k < i + 2) return;
  const std::size_t j = split_[i][k];
  plan.made.push_back({ring_vertex_[i], ring_vertex_[j], ring_vertex_[k], b});
  plan.made.push_back({ring_vertex_[i], ring_vertex_[k], ring_vertex_[j], a});
  add_polygon(i, j, a, b, plan);
  add_polygon(j, k, a, b, plan);
}

bool Flips::plan_edge_removal(TetIndex t, VertexIndex a, VertexIndex b, double bound, Retriangulation& plan) {
  if (!collect_ring(t, a, b)) return false;
  measure_ring_triangles(a, b);
  const double worst = fill_table(bound);
  if (!(worst > bound)) return false;
  plan.worst = worst;
  plan.old_tets.assign(ring_.begin(), ring_.end());
  plan.made.clear();
  add_polygon(0, ring_.size() - 1, a, b, plan);
  return true;
}

double Flips::replace_face_edge(FaceRef below, FaceRef above, VertexIndex p, VertexIndex q, double bound, int depth) {
  // `below` and `above` are the faces (.., p, q) of the two tets removed last that look away from the edge to be made.
  const VertexIndex bottom = trial_.made[0][0], top = trial_.made[0][1];
  const double alone = measure_quality(c_.point(q), c_.point(bottom), c_.point(p), c_.point(top));
  const std::size_t num_made = trial_.made.size(), num_old = trial_.old_tets.size();
  trial_.made.push_back({bottom, top, p, q});
  if (alone > bound || depth == 0) return alone;
  const FaceRef under = c_.neigh[below], over = c_.neigh[above];
  const VertexIndex w = c_.node[under];
  if (w != c_.node[over] || w == kGhost || c_.is_constrained(below) || c_.is_constrained(above)) return alone;
  if (c_.keeps_edge(p, q)) return alone;
  const TetIndex lower = under >> 2, upper = over >> 2;
  const FaceRef between = 4 * lower + static_cast<unsigned>(c_.local_index(lower, bottom));
  if (c_.neigh[between] >> 2 != upper || c_.is_constrained(between)) return alone;
  for (const TetIndex t : trial_.old_tets)
    if (t == lower || t == upper) return alone;
  if (c_.region[lower] != c_.region[trial_.old_tets[0]]) return alone;
  trial_.made.pop_back();
  trial_.old_tets.push_back(lower);
  trial_.old_tets.push_back(upper);
  const auto face = [this](TetIndex t, VertexIndex v) { return 4 * t + static_cast<unsigned>(c_.local_index(t, v)); };
  double worst = replace_face_edge(face(lower, q), face(upper, q), p, w, bound, depth - 1);
  if (worst > alone) worst = std::min(worst, replace_face_edge(face(lower, p), face(upper, p), w, q, bound, depth - 1));
  if (worst > alone) return worst;
  trial_.made.resize(num_made);
  trial_.old_tets.resize(num_old);
  trial_.made.push_back({bottom, top, p, q});
  return alone;
}

bool Flips::plan_face_removal(FaceRef ref, double bound, Retriangulation& plan) {
  const FaceRef other = c_.neigh[ref];
  const TetIndex above = ref >> 2, below = other >> 2;
  if (c_.is_constrained(ref) || c_.is_ghost(above) || c_.is_ghost(below)) return false;
  if (c_.region[above] != c_.region[below]) return false;
  const VertexIndex top = c_.node[ref], bottom = c_.node[other];
  const std::array<VertexIndex, 3> n = c_.face_nodes(ref);
  trial_.old_tets.assign({above, below});
  trial_.made.assign(1, {bottom, top, kNoIndex, kNoIndex});  // names the new edge for replace_face_edge
  double worst = std::numeric_limits<double>::infinity();
  for (unsigned i = 0; i < 3 && worst > bound; ++i) {
    const VertexIndex p = n[i], q = n[(i + 1) % 3], r = n[(i + 2) % 3];
    const FaceRef down = 4 * below + static_cast<unsigned>(c_.local_index(below, r));
    const FaceRef up = 4 * above + static_cast<unsigned>(c_.local_index(above, r));
    worst = std::min(worst, replace_face_edge(down, up, p, q, bound, kMaxDepth));
  }
  if (!(worst > bound)) return false;
  plan.worst = worst;
  plan.old_tets.assign(trial_.old_tets.begin(), trial_.old_tets.end());
  plan.made.assign(trial_.made.begin() + 1, trial_.made.end());
  return true;
}

/// The tet's edges, largest dihedral angle first: in a sliver those are its two diagonals, whose removal mends it.
std::array<std::uint8_t, 6> Flips::order_edges(TetIndex t) const {
  const std::uint32_t* n = &c_.node[4 * t];
  Point normal[4];
  for (unsigned f = 0; f < 4; ++f) {
    const Point p = c_.point(n[kFaceNodes[f][0]]);
    normal[f] = cross(c_.point(n[kFaceNodes[f][1]]) - p, c_.point(n[kFaceNodes[f][2]]) - p);
    normal[f] = normal[f] / (length(normal[f]) + kTiniestProduct);
  }
  double flatness[6];  // minus the cosine of the angle
  std::array<std::uint8_t, 6> order{0, 1, 2, 3, 4, 5};
  for (unsigned e = 0; e < 6; ++e) flatness[e] = dot(normal[kEdgeNodes[5 - e][0]], normal[kEdgeNodes[5 - e][1]]);
  std::sort(order.begin(), order.end(), [&](std::uint8_t a, std::uint8_t b) { return flatness[a] > flatness[b]; });
  return order;
}

bool Flips::plan_best(TetIndex t, double bound, double enough, Retriangulation& plan) {
  bool found = false;
  double best = bound;
  for (const std::uint8_t i : order_edges(t)) {
    const std::uint8_t* e = kEdgeNodes[i];
    if (!plan_edge_removal(t, c_.node[4 * t + e[0]], c_.node[4 * t + e[1]], best, plan)) continue;
    found = true;
    best = plan.worst;
    if (best > enough) return true;
  }
  for (unsigned f = 0; f < 4; ++f) {
    if (!plan_face_removal(4 * t + f, best, plan)) continue;
    found = true;
    best = plan.worst;
    if (best > enough) return true;
  }
  return found;
}

bool Flips::commit(const Retriangulation& plan, std::vector<TetIndex>& new_tets) {
  for (const auto& n : plan.made)
    if (c_.orient(n[0], n[1], n[2], n[3]) <= 0) return false;
  c_.replace(plan.old_tets, plan.made, new_tets);
  return true;
}

}  // namespace delfront
