// SPDX-License-Identifier: Apache-2.0
#include "volume/edge_flips.hpp"

#include <algorithm>

#include "volume/visible_point.hpp"

namespace delfront {

namespace {
constexpr std::size_t kMaxSwitches = 200;  ///< for one edge, beyond one for each obstacle at first
constexpr int kMaxSideways = 30;
constexpr std::size_t kMaxRing = 40;        ///< tets around an edge that is switched
constexpr std::size_t kMaxVisited = 20000;  ///< tets looked at beyond the star of one end
}  // namespace

bool EdgeFlips::recover(VertexIndex a, VertexIndex b, const std::vector<bool>& flat, std::size_t most_fills) {
  fills_left_ = most_fills;
  sideways_ = kMaxSideways;
  std::size_t most = kMaxSwitches;
  for (std::size_t k = 0; k < most; ++k) {
    const Way way = find_obstacles(a, b);
    if (k == 0) most += obstacles_.size();
    if (way == Way::adjacent) return true;
    if (way == Way::blocked) return false;
    if (!improve(a, b) && !switch_diagonal(a, b, flat)) return false;
  }
  return false;
}

/// Exchanges an edge (p, q) of the flat part for the other diagonal (u, w) of its two neighbours there.
bool EdgeFlips::switch_diagonal(VertexIndex a, VertexIndex b, const std::vector<bool>& flat) {
  auto is_flat = [&](VertexIndex v) { return v < flat.size() && flat[v]; };
  tried_ = obstacles_;
  const std::size_t before = tried_.size(), first = static_cast<std::size_t>(sideways_) % before;
  for (std::size_t k = 0; k < before; ++k) {
    const Obstacle& at = tried_[(first + k) % before];
    for (int e = 0; e < (at.is_edge ? 1 : 3); ++e) {
      const VertexIndex p = at.node[e], q = at.node[(e + 1) % 3];
      if (!is_flat(p) || !is_flat(q) || !collect_ring(at.ref >> 2, p, q)) continue;
      std::vector<VertexIndex> others;
      for (const VertexIndex v : polygon_)
        if (is_flat(v)) others.push_back(v);
      for (std::size_t i = 0; i < others.size(); ++i)
        for (std::size_t j = i + 1; j < others.size(); ++j) {
          may_add_points_ = true;
          const bool switched = switch_edge(at.ref >> 2, p, q, others[i], others[j]);
          may_add_points_ = false;
          if (switched && keep_if_better(a, b, before + (sideways_ > 0 ? 1 : 0))) {
            --sideways_;
            return true;
          }
        }
    }
  }
  return false;
}

/// All that the open segment cuts, searched breadth-first from a.
EdgeFlips::Way EdgeFlips::find_obstacles(VertexIndex a, VertexIndex b) {
  obstacles_.clear();
  c_.star(a, visited_);
  for (const TetIndex t : visited_)
    if (c_.has_vertex(t, b)) return Way::adjacent;
  bool through_vertex = false;
  for (const TetIndex t : visited_) c_.flag[t] |= TetComplex::marked;
  const std::size_t star = visited_.size();
  for (std::size_t i = 0; i < visited_.size() && !through_vertex; ++i)
    if (i < star || visited_.size() < kMaxVisited) add_cut_faces(visited_[i], a, b, through_vertex);
  for (const TetIndex t : visited_) c_.flag[t] &= static_cast<std::uint16_t>(~TetComplex::marked);
  const bool too_long = visited_.size() >= star + kMaxVisited;
  return through_vertex || too_long || obstacles_.empty() ? Way::blocked : Way::open;
}

void EdgeFlips::add_cut_faces(TetIndex t, VertexIndex a, VertexIndex b, bool& through_vertex) {
  if (c_.is_ghost(t)) return;
  for (unsigned f = 0; f < 4; ++f) {
    const FaceRef ref = 4 * t + f, other = c_.neigh[ref];
    const auto n = c_.face_nodes(ref);
    if (std::find(n.begin(), n.end(), a) != n.end() || std::find(n.begin(), n.end(), b) != n.end()) continue;
    if (c_.orient(n[0], n[1], n[2], a) * c_.orient(n[0], n[1], n[2], b) >= 0) continue;
    const int s[3] = {c_.orient(a, b, n[0], n[1]), c_.orient(a, b, n[1], n[2]), c_.orient(a, b, n[2], n[0])};
    if (std::max({s[0], s[1], s[2]}) > 0 && std::min({s[0], s[1], s[2]}) < 0) continue;
    int zeros = 0, edge = -1;
    for (int e = 0; e < 3; ++e)
      if (s[e] == 0) edge = e, ++zeros;
    if (zeros > 1) {
      through_vertex = true;
      return;
    }
    auto visit = [&](TetIndex next) {
      if (c_.flag[next] & TetComplex::marked) return;
      c_.flag[next] |= TetComplex::marked;
      visited_.push_back(next);
    };
    if (edge < 0) {
      if (!(c_.flag[other >> 2] & TetComplex::marked) || ref < other)
        obstacles_.push_back({ref, {n[0], n[1], n[2]}, false});
      visit(other >> 2);
      continue;
    }
    const VertexIndex p = n[static_cast<std::size_t>(edge)], q = n[static_cast<std::size_t>((edge + 1) % 3)];
    const bool is_known = std::any_of(obstacles_.begin(), obstacles_.end(), [&](const Obstacle& o) {
      return o.is_edge && ((o.node[0] == p && o.node[1] == q) || (o.node[0] == q && o.node[1] == p));
    });
    if (is_known) continue;
    obstacles_.push_back({ref, {p, q, kNoIndex}, true});
    c_.edge_ring(t, p, q, ring_);
    for (const TetIndex r : ring_) visit(r);
  }
}

std::size_t EdgeFlips::restore_delaunay(Context& context) {
  std::vector<FaceRef> stack;
  for (FaceRef ref = 0; ref < 4 * c_.num_slots(); ++ref)
    if (!c_.is_dead(ref >> 2) && ref < c_.neigh[ref]) stack.push_back(ref);
  const std::size_t most = 4 * c_.num_slots();
  std::size_t switches = 0;
  while (!stack.empty() && switches < most) {
    const FaceRef ref = stack.back();
    stack.pop_back();
    if (c_.is_dead(ref >> 2) || !make_locally_delaunay(ref)) continue;
    if (++switches % 1024 == 0) context.check_limits();
    for (const TetIndex t : new_tets_)
      for (unsigned f = 0; f < 4; ++f) stack.push_back(4 * t + f);
  }
  return switches;
}

bool EdgeFlips::make_locally_delaunay(FaceRef ref) {
  const TetIndex t = ref >> 2, other = c_.neigh[ref] >> 2;
  if (c_.is_constrained(ref) || c_.is_ghost(t) || c_.is_ghost(other)) return false;
  const VertexIndex top = c_.node[ref], bottom = c_.node[c_.neigh[ref]];
  const std::uint32_t* node = &c_.node[4 * t];
  const int inside = c_.segment_points.empty()
                         ? insphere_perturbed(c_.point(node[0]), c_.point(node[1]), c_.point(node[2]),
                                              c_.point(node[3]), c_.point(bottom))
                         : insphere_perturbed(c_.exact(node[0]), c_.exact(node[1]), c_.exact(node[2]),
                                              c_.exact(node[3]), c_.exact(bottom));
  if (inside <= 0) return false;
  const auto n = c_.face_nodes(ref);
  int reflex = -1, sides = 0, sign = 0;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const int s = c_.orient(bottom, top, n[i], n[(i + 1) % 3]);
    if (s <= 0) reflex = k, sign = s, ++sides;
  }
  if (sides == 0) return switch_face({ref, {n[0], n[1], n[2]}, false});
  if (sides > 1) return false;
  const VertexIndex p = n[static_cast<std::size_t>(reflex)], q = n[static_cast<std::size_t>((reflex + 1) % 3)];
  if (!collect_ring(t, p, q)) return false;
  if (ring_.size() == 3) return switch_edge(t, p, q, kNoIndex, kNoIndex);
  return sign == 0 && ring_.size() == 4 && switch_edge(t, p, q, top, bottom);
}

bool EdgeFlips::improve(VertexIndex a, VertexIndex b) {
  tried_ = obstacles_;
  const std::size_t before = tried_.size();
  for (const Obstacle& at : tried_) {
    const TetIndex t = at.ref >> 2;
    if (!at.is_edge && switch_face(at) && keep_if_better(a, b, before)) return true;
    const VertexIndex above = at.is_edge ? kNoIndex : c_.node[at.ref];
    const VertexIndex below = at.is_edge ? kNoIndex : c_.node[c_.neigh[at.ref]];
    for (int e = 0; e < (at.is_edge ? 1 : 3); ++e) {
      const VertexIndex p = at.node[e], q = at.node[(e + 1) % 3];
      if (required_.has(p, q)) continue;
      for (const auto& [from, to] : {std::pair{a, b}, std::pair{above, below}, std::pair{a, kNoIndex},
                                     std::pair{b, kNoIndex}, std::pair{kNoIndex, kNoIndex}})
        if (switch_edge(t, p, q, from, to) && keep_if_better(a, b, before)) return true;
    }
  }
  return false;
}

/// After a switch: keeps it where fewer obstacles remain, else puts the old tets back.
bool EdgeFlips::keep_if_better(VertexIndex a, VertexIndex b, std::size_t before) {
  const Way way = find_obstacles(a, b);
  if (way == Way::adjacent || (way == Way::open && obstacles_.size() < before)) return true;
  made_ = undo_;
  const std::vector<TetIndex> placed = new_tets_;
  replace(placed);
  // The tets have other indices now; the obstacles tried from here on are found anew.
  find_obstacles(a, b);
  for (Obstacle& o : tried_)
    for (const Obstacle& n : obstacles_)
      if (n.is_edge == o.is_edge && std::is_permutation(n.node, n.node + 3, o.node)) o.ref = n.ref;
  return false;
}

void EdgeFlips::replace(const std::vector<TetIndex>& old_tets) {
  undo_.clear();
  for (const TetIndex t : old_tets) {
    const std::uint32_t* n = &c_.node[4 * t];
    undo_.push_back({n[0], n[1], n[2], n[3]});
  }
  c_.replace(old_tets, made_, new_tets_);
}

bool EdgeFlips::switch_face(const Obstacle& at) {
  const VertexIndex top = c_.node[at.ref], bottom = c_.node[c_.neigh[at.ref]];
  const TetIndex other = c_.neigh[at.ref] >> 2;
  if (c_.is_constrained(at.ref) || c_.is_ghost(at.ref >> 2) || c_.is_ghost(other)) return false;
  made_.clear();
  const auto n = c_.face_nodes(at.ref);
  for (std::size_t k = 0; k < 3; ++k) {
    if (c_.orient(bottom, top, n[k], n[(k + 1) % 3]) <= 0) return false;
    made_.push_back({bottom, top, n[k], n[(k + 1) % 3]});
  }
  replace({at.ref >> 2, other});
  return true;
}

/// The vertices around edge (p, q), turning by the right-hand rule from p to q, into polygon_.
bool EdgeFlips::collect_ring(TetIndex t, VertexIndex p, VertexIndex q) {
  if (required_.has(p, q)) return false;
  c_.edge_ring(t, p, q, ring_);
  const std::size_t n = ring_.size();
  if (n > kMaxRing || n < 3) return false;
  std::vector<std::pair<VertexIndex, VertexIndex>> next;
  for (const TetIndex r : ring_) {
    if (c_.is_ghost(r)) return false;
    VertexIndex v[2];
    std::size_t found = 0;
    for (unsigned k = 0; k < 4; ++k) {
      const VertexIndex w = c_.node[4 * r + k];
      if (w == p || w == q) continue;
      v[found++] = w;
      if (c_.is_constrained(4 * r + k)) return false;  // a face that holds the edge
    }
    if (c_.orient(p, q, v[0], v[1]) < 0) std::swap(v[0], v[1]);
    next.push_back({v[0], v[1]});
  }
  polygon_.assign(1, next[0].first);
  while (polygon_.size() < n)
    for (const auto& [v, w] : next)
      if (v == polygon_.back()) {
        polygon_.push_back(w);
        break;
      }
  return true;
}

/// Takes edge (p, q) away. Where `from` is given, (from, to) is an edge afterwards, or the whole ring is joined to it.
bool EdgeFlips::switch_edge(TetIndex t, VertexIndex p, VertexIndex q, VertexIndex from, VertexIndex to) {
  if (!collect_ring(t, p, q)) return false;
  const std::size_t n = polygon_.size();
  if (from != kNoIndex) {
    const auto first = std::find(polygon_.begin(), polygon_.end(), from);
    if (first == polygon_.end()) return false;
    std::rotate(polygon_.begin(), first, polygon_.end());
  }
  const auto m = static_cast<std::size_t>(std::find(polygon_.begin(), polygon_.end(), to) - polygon_.begin());
  std::vector<std::pair<std::size_t, std::size_t>> parts;
  known_.assign(n * n + 2 * n + 1, 0);
  apex_.assign(n * n + 2 * n + 1, 0);
  if (to != kNoIndex) {
    if (m < 2 || m + 2 > n) return false;
    polygon_.push_back(polygon_[0]);
    parts = {{0, m}, {m, n}};
  } else if (from != kNoIndex) {
    polygon_.push_back(polygon_[0]);
    for (std::size_t k = 1; k + 1 < n; ++k) {  // a fan: triangles (0, k, k + 1)
      const VertexIndex x = polygon_[0], y = polygon_[k], z = polygon_[k + 1];
      if (c_.orient(x, y, z, q) <= 0 || c_.orient(x, z, y, p) <= 0) return false;
    }
  } else {
    polygon_.push_back(polygon_[0]);
    parts = {{0, n - 1}};
  }
  made_.clear();
  for (auto& [i, j] : parts) {
    if (triangulate(p, q, i, j)) continue;
    if (!may_add_points_ || !fill_half_from_point(p, q, i, j)) return false;
    j = i;
  }
  auto add = [&](std::size_t i, std::size_t s, std::size_t j) {
    made_.push_back({polygon_[i], polygon_[s], polygon_[j], q});
    made_.push_back({polygon_[i], polygon_[j], polygon_[s], p});
  };
  if (to == kNoIndex && from != kNoIndex)
    for (std::size_t k = 1; k + 1 < n; ++k) add(0, k, k + 1);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto [i, j] = parts[k];
    if (j < i + 2) continue;
    const std::size_t s = apex_[i * (n + 1) + j];
    add(i, s, j);
    parts.push_back({i, s});
    parts.push_back({s, j});
  }
  const std::vector<TetIndex> old_tets = ring_;
  replace(old_tets);
  return true;
}

/// Fills the part of the ring between its vertices i and j with tets from a new point, near where the diagonals cross.
bool EdgeFlips::fill_half_from_point(VertexIndex p, VertexIndex q, std::size_t i, std::size_t j) {
  if (fills_left_ == 0) return false;
  --fills_left_;
  const VertexIndex u = polygon_[i], w = polygon_[j];
  std::vector<std::array<VertexIndex, 3>> faces = {{u, w, q}, {u, p, w}};
  const Point from = c_.point(p), to = c_.point(q);
  Point middle;
  double reach = distance(from, to);
  for (std::size_t k = i; k < j; ++k) {
    const VertexIndex x = polygon_[k], y = polygon_[k + 1];
    faces.push_back({q, y, x});
    faces.push_back({p, x, y});
    reach = std::max(reach, distance(from, c_.point(y)));
    if (k > i) middle = middle + c_.point(x) / static_cast<double>(j - i - 1);
  }
  const Point e = to - from, d = c_.point(w) - c_.point(u), r = c_.point(u) - from;
  const double ee = dot(e, e), ed = dot(e, d), dd = dot(d, d), det = ee * dd - ed * ed;
  if (!(det > 0)) return false;
  const Point start = from + std::clamp((dot(r, e) * dd - dot(r, d) * ed) / det, 0.0, 1.0) * e;
  Point normal = cross(e, d);
  if (dot(normal, middle - start) < 0) normal = -1 * normal;
  std::vector<Wall> walls;
  for (const auto& f : faces) walls.push_back({c_.exact(f[0]), c_.exact(f[1]), c_.exact(f[2])});
  const auto place = find_visible_point(walls, start, {normal, middle - start}, reach);
  if (!place) return false;
  const VertexIndex v = c_.add_vertex(*place, (c_.vertex[p].h + c_.vertex[q].h) / 2);
  for (const auto& f : faces) made_.push_back({f[0], f[1], f[2], v});
  return true;
}

/// Whether the ring's vertices i … j can be triangulated such that q sees every triangle from above, p from below.
bool EdgeFlips::triangulate(VertexIndex p, VertexIndex q, std::size_t i, std::size_t j) {
  if (j - i < 2) return true;
  const std::size_t at = i * polygon_.size() + j;
  if (known_[at] != 0) return known_[at] > 0;
  known_[at] = -1;
  for (std::size_t s = i + 1; s < j; ++s) {
    const VertexIndex x = polygon_[i], y = polygon_[s], z = polygon_[j];
    if (c_.orient(x, y, z, q) <= 0 || c_.orient(x, z, y, p) <= 0) continue;
    if (!triangulate(p, q, i, s) || !triangulate(p, q, s, j)) continue;
    apex_[at] = static_cast<std::uint8_t>(s);
    known_[at] = 1;
    return true;
  }
  return false;
}

}  // namespace delfront
