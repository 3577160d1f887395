// SPDX-License-Identifier: Apache-2.0
// Bowyer-Watson insertion: walk to the tet that holds the point, grow the cavity of tets whose circumsphere holds it,
// (with constraints) shrink the cavity until every face of it sees the point, fill it with one tet a face.
// Terms: a ghost tet (a, b, c, infinity) stands for the outside of hull face (a, b, c); it is in conflict with points
// strictly beyond its face, and with coplanar ones when the real tet behind the face is.
#include <algorithm>

#include "delaunay/delaunay.hpp"

namespace delfront {

namespace {

/// Vertices as plain coordinates: the fast path, while no vertex lies implicitly on a segment.
struct ExplicitView {
  const TetComplex& c;
  Point operator()(VertexIndex v) const { return c.vertex[v].point(); }
};

/// Vertices exactly, Steiner points on segments included.
struct ExactView {
  const TetComplex& c;
  ExactPoint operator()(VertexIndex v) const { return c.exact(v); }
};

constexpr std::size_t kTableVertices = 32;   ///< balls up to this size are bonded through a table of directed edges
constexpr std::uint64_t kLongWalk = 100000;  ///< steps after which a walk gives way to a scan of all tets

}  // namespace

std::uint32_t DelaunayKernel::random() {
  random_state_ = random_state_ * 1664525u + 1013904223u;
  return random_state_ >> 16;
}

void DelaunayKernel::start(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d) {
  if (c_.orient(a, b, c, d) < 0) std::swap(a, b);
  const TetIndex inner = c_.new_tet();
  c_.set_nodes(inner, a, b, c, d);
  c_.region[inner] = 0;
  const VertexIndex corner[4] = {a, b, c, d};
  TetIndex ghost[4];
  for (unsigned f = 0; f < 4; ++f) {
    ghost[f] = c_.new_tet();
    const auto [x, y, z] = c_.face_nodes(4 * inner + f);
    c_.set_nodes(ghost[f], x, z, y, kGhost);  // seen from outside: the other way round
    c_.region[ghost[f]] = TetComplex::kOutside;
    c_.bond(4 * inner + f, 4 * ghost[f] + 3);
  }
  for (unsigned f = 0; f < 4; ++f)
    for (unsigned g = 0; g < 4; ++g)
      if (f != g)  // ghosts f and g share the face without corner g of ghost f, that is without corner f of ghost g
        c_.neigh[4 * ghost[f] + static_cast<unsigned>(c_.local_index(ghost[f], corner[g]))] =
            4 * ghost[g] + static_cast<unsigned>(c_.local_index(ghost[g], corner[f]));
  for (const VertexIndex v : corner) c_.vertex_tet[v] = inner;
  last_tet = inner;
}

TetIndex DelaunayKernel::locate(VertexIndex v, TetIndex hint) {
  return c_.segment_points.empty() ? walk(ExplicitView{c_}, v, hint) : walk(ExactView{c_}, v, hint);
}

DelaunayKernel::Insert DelaunayKernel::insert(VertexIndex v, TetIndex hint, const Limits& limits) {
  return c_.segment_points.empty() ? insert_with(ExplicitView{c_}, v, hint, limits)
                                   : insert_with(ExactView{c_}, v, hint, limits);
}

template <class View>
TetIndex DelaunayKernel::walk(const View& view, VertexIndex v, TetIndex hint) {
  TetIndex t = hint == kNoIndex || c_.is_dead(hint) ? last_tet : hint;
  if (c_.is_ghost(t)) t = c_.neigh[4 * t + 3] >> 2;
  const auto p = view(v);
  unsigned entered = 4;
  for (std::uint64_t steps = 0; steps < kLongWalk; ++steps) {
    ++counts.walk_steps;
    const unsigned first = random();
    unsigned leave = 4;
    for (unsigned k = 0; k < 4 && leave == 4; ++k) {
      const unsigned f = (first + k) & 3;
      if (f == entered) continue;
      const auto [x, y, z] = c_.face_nodes(4 * t + f);
      if (orient3d(view(x), view(y), view(z), p) < 0) leave = f;
    }
    if (leave == 4) return t;
    const FaceRef next = c_.neigh[4 * t + leave];
    t = next >> 2;
    entered = next & 3;
    if (c_.is_ghost(t)) return t;
  }
  // A walk this long is wandering: in a complex that is not Delaunay it may do so for ever.
  for (t = 0; t < c_.num_slots(); ++t) {
    if (c_.is_dead(t) || c_.is_ghost(t)) continue;
    bool holds = true;
    for (unsigned f = 0; f < 4 && holds; ++f) {
      const auto [x, y, z] = c_.face_nodes(4 * t + f);
      holds = orient3d(view(x), view(y), view(z), p) >= 0;
    }
    if (holds) return t;
  }
  for (t = 0; t < c_.num_slots(); ++t)
    if (!c_.is_dead(t) && c_.is_ghost(t) &&
        orient3d(view(c_.node[4 * t]), view(c_.node[4 * t + 1]), view(c_.node[4 * t + 2]), p) > 0)
      return t;
  DELFRONT_CHECK(false && "every point lies in a tet or beyond the hull");
  return kNoIndex;
}

template <class View>
bool DelaunayKernel::in_conflict(const View& view, TetIndex t, VertexIndex v) {
  const std::uint32_t* n = &c_.node[4 * t];
  if (n[3] == kGhost) {
    const int side = orient3d(view(n[0]), view(n[1]), view(n[2]), view(v));
    if (side != 0) return side > 0;
    t = c_.neigh[4 * t + 3] >> 2;
    n = &c_.node[4 * t];
  }
  ++counts.insphere_tests;
  return insphere_perturbed(view(n[0]), view(n[1]), view(n[2]), view(n[3]), view(v)) > 0;
}

template <class View>
void DelaunayKernel::grow_cavity(const View& view, TetIndex start, VertexIndex v, bool constrained) {
  cavity_.assign(1, start);
  tested_.clear();
  c_.flag[start] |= TetComplex::marked;
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    const TetIndex t = cavity_[i];
    for (unsigned f = 0; f < 4; ++f) {
      const TetIndex next = c_.neigh[4 * t + f] >> 2;
      if (c_.flag[next] & (TetComplex::marked | TetComplex::visited)) continue;
      if (constrained && c_.is_constrained(4 * t + f)) continue;
      if (in_conflict(view, next, v)) {
        c_.flag[next] |= TetComplex::marked;
        cavity_.push_back(next);
      } else {
        c_.flag[next] |= TetComplex::visited;
        tested_.push_back(next);
      }
    }
  }
}

void DelaunayKernel::collect_cavity_faces() {
  faces_.clear();
  for (const TetIndex t : cavity_) {
    for (unsigned f = 0; f < 4; ++f) {
      const FaceRef ref = 4 * t + f, outer = c_.neigh[ref];
      const bool constrained = c_.is_constrained(ref);
      if ((c_.flag[outer >> 2] & TetComplex::marked) && !constrained) continue;
      const auto [x, y, z] = c_.face_nodes(ref);
      faces_.push_back({{x, y, z}, outer, t, constrained});
    }
  }
}

template <class View>
bool DelaunayKernel::make_star_shaped(const View& view, TetIndex start, VertexIndex v) {
  const auto p = view(v);
  for (bool changed = true; changed;) {
    changed = false;
    collect_cavity_faces();
    for (const CavityFace& face : faces_) {
      if (!(c_.flag[face.inner] & TetComplex::marked)) continue;
      const auto [x, y, z] = face.node;
      const bool is_seen = x != kGhost && y != kGhost && z != kGhost && orient3d(view(x), view(y), view(z), p) > 0;
      if (is_seen) continue;
      if (face.inner == start) return false;
      c_.flag[face.inner] =
          static_cast<std::uint16_t>((c_.flag[face.inner] & ~TetComplex::marked) | TetComplex::visited);
      tested_.push_back(face.inner);
      changed = true;
    }
    if (changed) std::erase_if(cavity_, [&](TetIndex t) { return !(c_.flag[t] & TetComplex::marked); });
  }
  return true;
}

/// Vertices inside of the cavity would vanish. Leaves the cavity's boundary vertices in ball_vertices_.
bool DelaunayKernel::swallows_a_vertex() {
  slot_of_vertex_.resize(c_.num_vertices() + 1);
  ball_vertices_.clear();
  auto is_in_ball = [&](VertexIndex v) {
    const std::uint32_t slot = slot_of_vertex_[v + 1];
    return slot < ball_vertices_.size() && ball_vertices_[slot] == v;
  };
  for (const CavityFace& face : faces_)
    for (const VertexIndex v : face.node)
      if (!is_in_ball(v)) {
        slot_of_vertex_[v + 1] = static_cast<std::uint32_t>(ball_vertices_.size());
        ball_vertices_.push_back(v);
      }
  for (const TetIndex t : cavity_)
    for (unsigned i = 0; i < 4; ++i)
      if (!is_in_ball(c_.node[4 * t + i])) return true;
  return false;
}

bool DelaunayKernel::is_too_close(VertexIndex v, double min_distance) const {
  const Point p = c_.point(v);
  const double limit = min_distance * min_distance;
  for (const CavityFace& face : faces_)
    for (const VertexIndex w : face.node)
      if (w != kGhost && squared_length(c_.point(w) - p) < limit) return true;
  return false;
}

void DelaunayKernel::clear_marks() {
  constexpr auto keep = static_cast<std::uint16_t>(~(TetComplex::marked | TetComplex::visited));
  for (const TetIndex t : cavity_) c_.flag[t] &= keep;
  for (const TetIndex t : tested_) c_.flag[t] &= keep;
}

template <class View>
DelaunayKernel::Insert DelaunayKernel::insert_with(const View& view, VertexIndex v, TetIndex hint,
                                                   const Limits& limits) {
  made_.clear();
  const TetIndex start = walk(view, v, hint);
  if (limits.constrained && c_.is_ghost(start)) return Insert::outside;
  if (!c_.is_ghost(start))
    for (unsigned i = 0; i < 4; ++i) {
      const VertexIndex w = c_.node[4 * start + i];
      if (compare_xyz(view(w), view(v)) == 0) {
        duplicate_of = w;
        return Insert::duplicate;
      }
    }
  grow_cavity(view, start, v, limits.constrained);
  if (limits.constrained) {
    if (!make_star_shaped(view, start, v) || swallows_a_vertex()) {
      clear_marks();
      return Insert::not_visible;
    }
  } else {
    collect_cavity_faces();
  }
  if (limits.min_distance > 0 && is_too_close(v, limits.min_distance)) {
    clear_marks();
    return Insert::too_close;
  }
  clear_marks();
  fill_cavity(v);
  ++counts.points;
  counts.tets_deleted += cavity_.size();
  counts.tets_created += faces_.size();
  return Insert::done;
}

/// One tet (v, x, z, y) a face (x, y, z): its face 0 looks outside. Slots of the cavity are used again.
void DelaunayKernel::fill_cavity(VertexIndex v) {
  const std::size_t reused = std::min(cavity_.size(), faces_.size());
  const std::uint32_t colour = c_.region[cavity_[0]];
  made_.clear();
  for (std::size_t i = 0; i < faces_.size(); ++i) made_.push_back(i < reused ? cavity_[i] : c_.new_tet());
  for (std::size_t i = reused; i < cavity_.size(); ++i) c_.kill_tet(cavity_[i]);
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    auto [x, y, z] = faces_[i].node;
    const TetIndex t = made_[i];
    if (x == kGhost || z == kGhost) {  // rotate the ghost into the middle, where it becomes node 3
      const auto [a, b, c] = faces_[i].node;
      if (x == kGhost) x = c, y = a, z = b;
      if (c == kGhost) x = b, y = c, z = a;
    }
    faces_[i].node[0] = x, faces_[i].node[1] = y, faces_[i].node[2] = z;
    c_.set_nodes(t, v, x, z, y);
    c_.flag[t] = static_cast<std::uint16_t>(TetComplex::fresh | (faces_[i].constrained ? 1 : 0));
    c_.region[t] = y == kGhost ? TetComplex::kOutside : colour;
    c_.bond(4 * t, faces_[i].outer);
    c_.vertex_tet[x] = t;
    c_.vertex_tet[z] = t;
    if (y != kGhost) c_.vertex_tet[y] = t;
  }
  c_.vertex_tet[v] = made_[0];
  last_tet = made_[0];
  bond_new_tets();
}

/// The face of tet (v, x, z, y) over the directed edge a -> b of its outer face meets the one over b -> a.
void DelaunayKernel::bond_new_tets() {
  slot_of_vertex_.resize(c_.num_vertices() + 1);
  ball_vertices_.clear();
  auto slot = [&](VertexIndex v) {
    std::uint32_t& s = slot_of_vertex_[v + 1];
    if (s >= ball_vertices_.size() || ball_vertices_[s] != v) {
      s = static_cast<std::uint32_t>(ball_vertices_.size());
      ball_vertices_.push_back(v);
    }
    return s;
  };
  // Nodes 1, 2, 3 of the new tet are x, z, y: the edge opposite x is y -> z, and so on.
  constexpr unsigned kFaceOfEdge[3] = {2, 1, 3};  // edges x -> y (opposite z), y -> z (opposite x), z -> x (opposite y)
  if (faces_.size() <= 2 * kTableVertices - 4) {
    edge_table_.resize(kTableVertices * kTableVertices);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const std::uint32_t s[3] = {slot(faces_[i].node[0]), slot(faces_[i].node[1]), slot(faces_[i].node[2])};
      for (unsigned k = 0; k < 3; ++k)
        edge_table_[kTableVertices * s[k] + s[(k + 1) % 3]] = 4 * made_[i] + kFaceOfEdge[k];
    }
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const std::uint32_t s[3] = {slot(faces_[i].node[0]), slot(faces_[i].node[1]), slot(faces_[i].node[2])};
      for (unsigned k = 0; k < 3; ++k)
        c_.neigh[4 * made_[i] + kFaceOfEdge[k]] = edge_table_[kTableVertices * s[(k + 1) % 3] + s[k]];
    }
    return;
  }
  edge_list_.clear();
  for (std::size_t i = 0; i < faces_.size(); ++i)
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint64_t a = slot(faces_[i].node[k]), b = slot(faces_[i].node[(k + 1) % 3]);
      const std::uint64_t key = (std::min(a, b) << 32) | std::max(a, b);
      edge_list_.push_back({key, 4 * made_[i] + kFaceOfEdge[k]});
    }
  std::sort(edge_list_.begin(), edge_list_.end());
  for (std::size_t i = 0; i + 1 < edge_list_.size(); i += 2) c_.bond(edge_list_[i].second, edge_list_[i + 1].second);
}

}  // namespace delfront
