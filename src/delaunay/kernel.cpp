// SPDX-License-Identifier: Apache-2.0
// Bowyer-Watson insertion: walk to the tet that holds the point, grow the cavity of tets whose circumsphere holds it,
// (with constraints) shrink the cavity until every face of it sees the point, fill it with one tet a face.
// Terms: a ghost tet (a, b, c, infinity) stands for the outside of hull face (a, b, c); it is in conflict with points
// strictly beyond its face, and with coplanar ones when the real tet behind the face is.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

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

constexpr std::size_t kTableVertices = 64;  ///< balls up to this size are bonded through a table of directed edges
constexpr double kSphereSlack = 1e-9;       ///< of a squared distance: nearer to a kept sphere the exact test decides
constexpr std::uint64_t kLongWalk = 1000;  ///< steps, and a quarter of the tets, after which a walk gives way to a scan

/// Through the origin and a, b, c; bc = b x c, det = det[a, b, c].
Circumsphere sphere_from_origin(const Point& a, const Point& b, const Point& c, const Point& bc, double det) {
  const double aa = squared_length(a), bb = squared_length(b), cc = squared_length(c);
  const Point offset = (aa * bc + bb * cross(c, a) + cc * cross(a, b)) / (2 * det);
  const double longest = std::max({aa, bb, cc}), squared_radius = squared_length(offset);
  // Condition longest^3 / det at most 1e4 keeps the relative error of the squared radius below 1e-10.
  const bool is_sure = longest * longest * longest <= 1e8 * (det * det);
  return {offset, is_sure ? squared_radius : -squared_radius};
}

}  // namespace

Circumsphere circumsphere(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point u = b - a, v = c - a, w = d - a, vw = cross(v, w);
  const double det = dot(u, vw);
  if (!(std::abs(det) > 0)) return {a, -std::numeric_limits<double>::infinity()};
  Circumsphere s = sphere_from_origin(u, v, w, vw, det);
  s.centre = s.centre + a;
  if (!std::isfinite(s.squared_radius)) s.squared_radius = -std::numeric_limits<double>::infinity();
  return s;
}

void DelaunayKernel::keep_spheres() {
  DELFRONT_CHECK(c_.segment_points.empty());
  spheres_.assign(c_.num_slots(), {});
  for (TetIndex t = 0; t < c_.num_slots(); ++t) {
    if (c_.is_dead(t) || c_.is_ghost(t)) continue;
    const std::uint32_t* n = &c_.node[4 * t];
    spheres_[t] = circumsphere(c_.point(n[0]), c_.point(n[1]), c_.point(n[2]), c_.point(n[3]));
  }
}

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

TetIndex DelaunayKernel::locate(VertexIndex v, TetIndex hint, std::uint64_t max_steps) {
  return c_.segment_points.empty() ? walk(ExplicitView{c_}, v, hint, max_steps)
                                   : walk(ExactView{c_}, v, hint, max_steps);
}

DelaunayKernel::Insert DelaunayKernel::insert(VertexIndex v, TetIndex hint, const Limits& limits) {
  return insert_into(locate(v, hint), v, limits);
}

DelaunayKernel::Insert DelaunayKernel::insert_into(TetIndex holder, VertexIndex v, const Limits& limits) {
  DELFRONT_CHECK(limits.constrained || spheres_.empty());
  return c_.segment_points.empty() ? insert_with(ExplicitView{c_}, v, holder, limits)
                                   : insert_with(ExactView{c_}, v, holder, limits);
}

template <class View>
TetIndex DelaunayKernel::walk(const View& view, VertexIndex v, TetIndex hint, std::uint64_t max_steps) {
  TetIndex t = hint == kNoIndex || c_.is_dead(hint) ? last_tet : hint;
  if (c_.is_ghost(t)) t = c_.neigh[4 * t + 3] >> 2;
  const auto p = view(v);
  unsigned entered = 4;
  const std::uint64_t last_step = max_steps > 0 ? max_steps : kLongWalk + c_.num_slots() / 4;
  for (std::uint64_t steps = 0; steps < last_step; ++steps) {
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
  if (max_steps > 0) return kNoIndex;
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
  if (!spheres_.empty()) {
    const Circumsphere& s = spheres_[t];
    const double away = squared_length(c_.point(v) - s.centre), power = away - s.squared_radius;
    if (s.is_sure() && std::abs(power) > kSphereSlack * (away + s.squared_radius)) {
      ++counts.insphere_tests;
      return power < 0;
    }
  }
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

void DelaunayKernel::add_cavity_face(FaceRef ref, bool constrained) {
  const auto [x, y, z] = c_.face_nodes(ref);
  faces_.push_back({{x, y, z}, c_.neigh[ref], ref >> 2, {0, 0, 0}, constrained});
}

/// What in_conflict reads, fetched early: its time is the memory's.
void DelaunayKernel::prefetch_neighbours(TetIndex t) const {
  for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) {
    const TetIndex next = c_.neigh[ref] >> 2;
    __builtin_prefetch(&c_.flag[next], 1);
    if (!spheres_.empty())
      __builtin_prefetch(&spheres_[next]);
    else
      __builtin_prefetch(&c_.node[4 * next]);
  }
}

/// Breadth-first from `start`; leaves the cavity, its faces and the vertices it came to.
/// @return false where a vertex is too close
template <class View>
bool DelaunayKernel::grow_cavity(const View& view, TetIndex start, VertexIndex v, const Limits& limits) {
  const Point p = c_.point(v);
  cavity_.assign(1, start);
  tested_.clear();
  faces_.clear();
  reached_.assign(c_.node.begin() + 4 * start, c_.node.begin() + 4 * start + 4);
  is_cavity_reduced_ = false;
  for (const VertexIndex w : reached_)
    if (is_too_close(w, p, limits.min_distance)) return false;
  c_.flag[start] |= TetComplex::marked;
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    if (i + 1 < cavity_.size()) prefetch_neighbours(cavity_[i + 1]);
    for (FaceRef ref = 4 * cavity_[i]; ref < 4 * cavity_[i] + 4; ++ref) {
      const FaceRef outer = c_.neigh[ref];
      const TetIndex next = outer >> 2;
      if (limits.constrained && c_.is_constrained(ref)) {
        add_cavity_face(ref, true);
      } else if (c_.flag[next] & TetComplex::marked) {
        continue;
      } else if (c_.flag[next] & TetComplex::visited) {
        add_cavity_face(ref, c_.is_constrained(ref));
      } else if (in_conflict(view, next, v)) {
        if (is_too_close(c_.node[outer], p, limits.min_distance)) return false;
        reached_.push_back(c_.node[outer]);
        c_.flag[next] |= TetComplex::marked;
        __builtin_prefetch(&c_.neigh[4 * next]);
        __builtin_prefetch(&c_.node[4 * next]);
        cavity_.push_back(next);
      } else {
        c_.flag[next] |= TetComplex::visited;
        tested_.push_back(next);
        add_cavity_face(ref, c_.is_constrained(ref));
      }
    }
  }
  return true;
}

void DelaunayKernel::collect_cavity_faces() {
  faces_.clear();
  for (const TetIndex t : cavity_) {
    for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) {
      const bool constrained = c_.is_constrained(ref);
      if (!(c_.flag[c_.neigh[ref] >> 2] & TetComplex::marked) || constrained) add_cavity_face(ref, constrained);
    }
  }
}

/// Whether p sees the face from inside, with explicit vertices. The sphere through both comes out of the same numbers.
bool DelaunayKernel::is_seen(CavityFace& face, const Point& p, Circumsphere& sphere) const {
  const auto [x, y, z] = face.node;
  if (x == kGhost || y == kGhost || z == kGhost) return false;
  const Point a = c_.point(x) - p, b = c_.point(z) - p, c = c_.point(y) - p;
  const Point bc = cross(b, c);
  const double det = dot(a, bc);  // > 0 where (p, x, z, y) is positive
  // The error bound of orient3d: the same differences, expanded along another row.
  const double extent = detail::max3(a.x, b.x, c.x) * detail::max3(a.y, b.y, c.y) * detail::max3(a.z, b.z, c.z);
  if (!(det > detail::kOrient3dBound * extent + detail::kTinyOrient3d)) {
    sphere = circumsphere(p, c_.point(x), c_.point(z), c_.point(y));
    return orient3d(c_.point(x), c_.point(y), c_.point(z), p) > 0;
  }
  sphere = sphere_from_origin(a, b, c, bc, det);
  sphere.centre = sphere.centre + p;
  return true;
}

template <class View>
bool DelaunayKernel::make_star_shaped(const View& view, TetIndex start, VertexIndex v) {
  const auto p = view(v);
  const Point at = c_.point(v);
  const bool with_spheres = !spheres_.empty();
  for (bool changed = true; changed;) {
    changed = false;
    face_spheres_.resize(with_spheres ? faces_.size() : 0);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      CavityFace& face = faces_[i];
      if (!(c_.flag[face.inner] & TetComplex::marked)) continue;
      const auto [x, y, z] = face.node;
      if (with_spheres ? is_seen(face, at, face_spheres_[i])
                       : x != kGhost && y != kGhost && z != kGhost && orient3d(view(x), view(y), view(z), p) > 0)
        continue;
      if (face.inner == start) return false;
      c_.flag[face.inner] =
          static_cast<std::uint16_t>((c_.flag[face.inner] & ~TetComplex::marked) | TetComplex::visited);
      tested_.push_back(face.inner);
      changed = true;
    }
    if (!changed) break;
    is_cavity_reduced_ = true;
    std::erase_if(cavity_, [&](TetIndex t) { return !(c_.flag[t] & TetComplex::marked); });
    collect_cavity_faces();
  }
  return true;
}

bool DelaunayKernel::is_in_ball(VertexIndex v) const {
  const std::uint32_t slot = slot_of_vertex_[v + 1];
  return slot < ball_vertices_.size() && ball_vertices_[slot] == v;
}

/// Numbers the vertices of the cavity's boundary from 0, into ball_vertices_ and the faces.
void DelaunayKernel::number_ball_vertices() {
  slot_of_vertex_.resize(c_.num_vertices() + 1);
  ball_vertices_.clear();
  for (CavityFace& face : faces_)
    for (unsigned k = 0; k < 3; ++k) {
      const VertexIndex v = face.node[k];
      if (!is_in_ball(v)) {
        slot_of_vertex_[v + 1] = static_cast<std::uint32_t>(ball_vertices_.size());
        ball_vertices_.push_back(v);
      }
      face.slot[k] = slot_of_vertex_[v + 1];
    }
}

/// Vertices inside of the cavity would vanish.
bool DelaunayKernel::swallows_a_vertex() const {
  if (!is_cavity_reduced_)
    return !std::all_of(reached_.begin(), reached_.end(), [&](VertexIndex w) { return is_in_ball(w); });
  for (const TetIndex t : cavity_)
    for (unsigned i = 0; i < 4; ++i)
      if (!is_in_ball(c_.node[4 * t + i])) return true;
  return false;
}

bool DelaunayKernel::is_too_close(VertexIndex w, const Point& p, double min_distance) const {
  return min_distance > 0 && w != kGhost && squared_length(c_.point(w) - p) < min_distance * min_distance;
}

void DelaunayKernel::clear_marks() {
  constexpr auto keep = static_cast<std::uint16_t>(~(TetComplex::marked | TetComplex::visited));
  for (const TetIndex t : cavity_) c_.flag[t] &= keep;
  for (const TetIndex t : tested_) c_.flag[t] &= keep;
}

template <class View>
DelaunayKernel::Insert DelaunayKernel::insert_with(const View& view, VertexIndex v, TetIndex start,
                                                   const Limits& limits) {
  made_.clear();
  if (limits.constrained && c_.is_ghost(start)) return Insert::outside;
  if (!c_.is_ghost(start))
    for (unsigned i = 0; i < 4; ++i) {
      const VertexIndex w = c_.node[4 * start + i];
      if (compare_xyz(view(w), view(v)) == 0) {
        duplicate_of = w;
        return Insert::duplicate;
      }
    }
  if (!grow_cavity(view, start, v, limits)) {
    clear_marks();
    return Insert::too_close;
  }
  const bool is_star_shaped = !limits.constrained || make_star_shaped(view, start, v);
  if (is_star_shaped) number_ball_vertices();
  clear_marks();
  if (!is_star_shaped || (limits.constrained && swallows_a_vertex())) return Insert::not_visible;
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
      CavityFace& face = faces_[i];
      const std::ptrdiff_t first = x == kGhost ? 2 : 1;
      std::rotate(face.node, face.node + first, face.node + 3);
      std::rotate(face.slot, face.slot + first, face.slot + 3);
      x = face.node[0], y = face.node[1], z = face.node[2];
    }
    c_.set_nodes(t, v, x, z, y);
    c_.flag[t] = static_cast<std::uint16_t>(TetComplex::fresh | (faces_[i].constrained ? 1 : 0));
    c_.region[t] = y == kGhost ? TetComplex::kOutside : colour;
    c_.bond(4 * t, faces_[i].outer);
    c_.vertex_tet[x] = t;
    c_.vertex_tet[z] = t;
    if (y != kGhost) c_.vertex_tet[y] = t;
  }
  if (!spheres_.empty()) {
    spheres_.resize(c_.num_slots());
    for (std::size_t i = 0; i < faces_.size(); ++i) spheres_[made_[i]] = face_spheres_[i];
  }
  c_.vertex_tet[v] = made_[0];
  last_tet = made_[0];
  bond_new_tets();
}

// Nodes 1, 2, 3 of the new tet are x, z, y: the edge opposite x is y -> z, and so on.
constexpr unsigned kFaceOfEdge[3] = {2, 1, 3};  // edges x -> y (opposite z), y -> z (opposite x), z -> x (opposite y)

/// The face of tet (v, x, z, y) over the directed edge a -> b of its outer face meets the one over b -> a.
void DelaunayKernel::bond_new_tets() {
  if (ball_vertices_.size() > kTableVertices) return bond_by_hash();
  edge_table_.resize(kTableVertices * kTableVertices);
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const std::uint32_t* s = faces_[i].slot;
    for (unsigned k = 0; k < 3; ++k)
      edge_table_[kTableVertices * s[k] + s[(k + 1) % 3]] = 4 * made_[i] + kFaceOfEdge[k];
  }
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const std::uint32_t* s = faces_[i].slot;
    for (unsigned k = 0; k < 3; ++k)
      c_.neigh[4 * made_[i] + kFaceOfEdge[k]] = edge_table_[kTableVertices * s[(k + 1) % 3] + s[k]];
  }
}

/// For balls of any size: open addressing by the undirected edge.
void DelaunayKernel::bond_by_hash() {
  constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  const std::size_t size = std::bit_ceil(4 * faces_.size()), mask = size - 1;
  edge_hash_.assign(size, {kEmpty, kNoIndex});
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    for (unsigned k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(faces_[i].slot[k], faces_[i].slot[(k + 1) % 3]);
      const std::uint64_t key = std::uint64_t{a} << 32 | b;
      const FaceRef ref = 4 * made_[i] + kFaceOfEdge[k];
      std::size_t at = static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ull >> 32) & mask;
      while (edge_hash_[at].first != kEmpty && edge_hash_[at].first != key) at = (at + 1) & mask;
      if (edge_hash_[at].first == key)
        c_.bond(edge_hash_[at].second, ref);
      else
        edge_hash_[at] = {key, ref};
    }
  }
}

}  // namespace delfront
