// SPDX-License-Identifier: Apache-2.0
// Bowyer-Watson insertion: walk to the tet that holds the point, grow the cavity of tets whose circumsphere holds it,
// (with constraints) shrink the cavity until every face of it sees the point, fill it with one tet a face.
// Terms: a ghost tet (a, b, c, infinity) stands for the outside of hull face (a, b, c); it is in conflict with points
// strictly beyond its face, and with coplanar ones when the real tet behind the face is.
#include <algorithm>
#include <bit>

#include "delaunay/delaunay.hpp"
#include "delaunay/face_tests.hpp"
#include "delfront/errors.hpp"

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

constexpr std::uint64_t kLongWalk = 1000;  ///< steps, and a quarter of the tets, after which a walk gives way to a scan
constexpr unsigned kAllFaces = 15;
constexpr std::size_t kFewFaces = 64;

}  // namespace

void add_counts(KernelCounts& sum, const KernelCounts& other) {
  sum.points += other.points;
  sum.walk_steps += other.walk_steps;
  sum.insphere_tests += other.insphere_tests;
  sum.exact_tests += other.exact_tests;
  sum.tets_deleted += other.tets_deleted;
  sum.tets_created += other.tets_created;
}

std::uint32_t DelaunayKernel::random() {
  random_state_ = random_state_ * 1664525u + 1013904223u;
  return random_state_ >> 16;
}

void DelaunayKernel::enter(const Territory& territory, SlotStock slots) {
  territory_ = territory;
  is_in_territory_ = true;
  slots_ = std::move(slots);
}

SlotStock DelaunayKernel::leave() {
  territory_ = {};
  is_in_territory_ = false;
  return std::exchange(slots_, {});
}

bool DelaunayKernel::is_ours(TetIndex t) const {
  const std::uint32_t* n = &c_.node[4 * t];
  return territory_.holds(n[0]) && territory_.holds(n[1]) && territory_.holds(n[2]) && territory_.holds(n[3]);
}

TetIndex DelaunayKernel::take_slot() { return !is_in_territory_ || slots_.size() == 0 ? c_.new_tet() : slots_.take(); }

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

DelaunayKernel::Insert DelaunayKernel::insert(VertexIndex v, TetIndex hint, const Limits& limits) {
  const TetIndex holder = locate(v, hint);
  return holder == kNoIndex ? Insert::not_ours : insert_into(holder, v, limits);
}

/// Bits of the faces of t that have v strictly behind them.
unsigned DelaunayKernel::faces_behind(TetIndex t, VertexIndex v) const {
  unsigned behind = 0, open = kAllFaces;
  if (c_.segment_points.empty()) {
    const TetVertex* corner[4];
    for (unsigned f = 0; f < 4; ++f) corner[f] = &c_.vertex[c_.node[4 * t + f]];
    const FaceTests tests = test_sides(corner, c_.vertex[v]);
    behind = tests.unseen;
    open = kAllFaces & ~(tests.seen | tests.unseen);
  }
  for (unsigned f = 0; open; ++f, open >>= 1) {
    const auto [x, y, z] = c_.face_nodes(4 * t + f);
    if ((open & 1) && c_.orient(x, y, z, v) < 0) behind |= 1u << f;
  }
  return behind;
}

TetIndex DelaunayKernel::locate(VertexIndex v, TetIndex hint, std::uint64_t max_steps) {
  TetIndex t = hint == kNoIndex || c_.is_dead(hint) ? last_tet : hint;
  if (!is_ours(t)) return kNoIndex;
  if (c_.is_ghost(t)) t = c_.neigh[4 * t + 3] >> 2;
  if (!is_ours(t)) return kNoIndex;
  const std::uint64_t last_step = max_steps > 0 ? max_steps : kLongWalk + c_.num_slots() / 4;
  for (std::uint64_t steps = 0; steps < last_step; ++steps) {
    ++counts.walk_steps;
    const unsigned behind = faces_behind(t, v);
    if (behind == 0) return t;
    // One of them at random: always the first could go round in circles.
    const unsigned turn = random() & 3;
    const unsigned turned = (behind >> turn | behind << (4 - turn)) & kAllFaces;
    const unsigned leave = (static_cast<unsigned>(std::countr_zero(turned)) + turn) & 3;
    const FaceRef next = c_.neigh[4 * t + leave];
    if (!territory_.holds(c_.node[next])) return kNoIndex;
    t = next >> 2;
    if (c_.is_ghost(t)) return t;
  }
  // A walk this long is wandering: in a complex that is not Delaunay it may do so for ever.
  return max_steps > 0 || is_confined() ? kNoIndex : scan(v);
}

TetIndex DelaunayKernel::scan(VertexIndex v) const {
  for (TetIndex t = 0; t < c_.num_slots(); ++t)
    if (!c_.is_dead(t) && !c_.is_ghost(t) && faces_behind(t, v) == 0) return t;
  for (TetIndex t = 0; t < c_.num_slots(); ++t)
    if (!c_.is_dead(t) && c_.is_ghost(t) && c_.orient(c_.node[4 * t], c_.node[4 * t + 1], c_.node[4 * t + 2], v) > 0)
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
    n = &c_.node[c_.neigh[4 * t + 3] & ~3u];
  }
  ++counts.exact_tests;
  return insphere_perturbed(view(n[0]), view(n[1]), view(n[2]), view(n[3]), view(v)) > 0;
}

/// Without the filter of test_faces: for ghosts and for implicit points.
template <class View>
DelaunayKernel::Faces DelaunayKernel::look_across_exactly(const View& view, TetIndex t, VertexIndex v,
                                                          double min_distance) {
  unsigned inside = 0, seen = 0, close = 0;
  for (unsigned f = 0; f < 4; ++f) {
    const FaceRef ref = 4 * t + f, outer = c_.neigh[ref];
    const VertexIndex apex = c_.node[outer];
    const auto [x, y, z] = c_.face_nodes(ref);
    const bool has_ghost = c_.is_ghost(t) && f != 3;
    if (!has_ghost && orient3d(view(x), view(y), view(z), view(v)) > 0) seen |= 1u << f;
    if (apex != kGhost && squared_length(c_.point(apex) - c_.point(v)) < min_distance * min_distance) close |= 1u << f;
    if (!(c_.flag[outer >> 2] & TetComplex::marked) && territory_.holds(apex) && in_conflict(view, outer >> 2, v))
      inside |= 1u << f;
  }
  return {static_cast<std::uint8_t>(inside), static_cast<std::uint8_t>(seen), static_cast<std::uint8_t>(close)};
}

/// Which neighbours of cavity tet t are in conflict with v, which of its faces see v, which apexes are too close: where
/// the first filter leaves something open, or ghosts are about.
/// @param open        faces whose neighbours are to be told
/// @param with_sides  whether all of `seen` is wanted
DelaunayKernel::Faces DelaunayKernel::look_across(TetIndex t, VertexIndex v, unsigned open, bool with_sides,
                                                  double min_distance) {
  if (!c_.segment_points.empty()) return look_across_exactly(ExactView{c_}, t, v, min_distance);
  if (c_.is_ghost(t)) return look_across_exactly(ExplicitView{c_}, t, v, min_distance);
  const TetVertex *corner[4], *apex[4];
  unsigned ghosts = 0, close = 0;
  for (unsigned f = 0; f < 4; ++f) {
    corner[f] = &c_.vertex[c_.node[4 * t + f]];
    const VertexIndex w = c_.node[c_.neigh[4 * t + f]];
    ghosts |= static_cast<unsigned>(w == kGhost) << f;
    apex[f] = w == kGhost ? corner[f] : &c_.vertex[w];
    const bool is_close = squared_length(apex[f]->point() - c_.point(v)) < min_distance * min_distance;
    close |= static_cast<unsigned>(is_close) << f;
  }
  FaceTests tests = test_faces_twofold(corner, apex, c_.vertex[v]);
  counts.insphere_tests += 4;
  const unsigned unknown = (with_sides ? kAllFaces : ghosts) & ~(tests.seen | tests.unseen);
  for (unsigned f = 0; unknown >> f; ++f) {
    if (!(unknown >> f & 1)) continue;
    const auto [x, y, z] = c_.face_nodes(4 * t + f);
    if (orient3d(c_.point(x), c_.point(y), c_.point(z), c_.point(v)) > 0) tests.seen |= 1u << f;
  }
  // A ghost is in conflict with points beyond its face, and in its plane since t, behind it, is in conflict.
  unsigned inside = (tests.inside & ~ghosts) | (ghosts & ~tests.seen);
  const unsigned left = open & ~(tests.inside | tests.outside | ghosts);
  for (unsigned f = 0; f < 4; ++f)
    if (left >> f & 1) inside |= static_cast<unsigned>(is_inside_exactly(4 * t + f, v, tests.tie >> f & 1)) << f;
  return {static_cast<std::uint8_t>(inside), static_cast<std::uint8_t>(tests.seen),
          static_cast<std::uint8_t>(close & ~ghosts)};
}

/// Whether the tet across a face is in conflict with v. `is_tie`: v is known to lie on its sphere.
bool DelaunayKernel::is_inside_exactly(FaceRef face, VertexIndex v, bool is_tie) {
  ++counts.exact_tests;
  const std::uint32_t* const n = &c_.node[c_.neigh[face] & ~3u];
  const Point a = c_.point(n[0]), b = c_.point(n[1]), c = c_.point(n[2]), d = c_.point(n[3]), e = c_.point(v);
  const int sign = is_tie ? 0 : detail::insphere_exact(a, b, c, d, e);
  return (sign != 0 ? sign : detail::insphere_tie(a, b, c, d, e)) > 0;
}

/// The usual case of look_across: all vertices real and explicit, all tests that matter decided by the first bounds.
/// @param apex  across the four faces
/// @return false where it is not the usual case
template <bool kConstrained>
[[gnu::always_inline]] inline bool DelaunayKernel::look_across_fast(TetIndex t, const VertexIndex* apex, VertexIndex v,
                                                                    unsigned open, double min_distance2, Faces& faces) {
  const std::uint32_t* const n = &c_.node[4 * t];
  if (n[3] == kGhost || std::max(std::max(apex[0], apex[1]), std::max(apex[2], apex[3])) == kGhost) return false;
  const TetVertex* const all = c_.vertex.data();
  const TetVertex* const corners[4] = {all + n[0], all + n[1], all + n[2], all + n[3]};
  const TetVertex* const apexes[4] = {all + apex[0], all + apex[1], all + apex[2], all + apex[3]};
  const FaceTests tests = test_faces<kConstrained>(corners, apexes, all[v], min_distance2);
  if (((tests.inside | tests.outside) & open) != open) return false;
  if (kConstrained && (tests.seen | tests.unseen) != kAllFaces) return false;
  counts.insphere_tests += 4;
  faces = {static_cast<std::uint8_t>(tests.inside), static_cast<std::uint8_t>(tests.seen),
           static_cast<std::uint8_t>(tests.close)};
  return true;
}

/// Breadth-first from `start`; leaves the cavity, the refs of its faces and the vertices it came to. Written without
/// branches on the outcome of tests, which no processor can guess.
template <bool kConstrained>
DelaunayKernel::Insert DelaunayKernel::grow_cavity(TetIndex start, VertexIndex v, double min_distance) {
  const double min_distance2 = min_distance * min_distance;
  const bool is_exact = !c_.segment_points.empty();
  cavity_.clear();
  cavity_.push_back(start);
  seen_.clear();
  border_.clear();
  c_.flag[start] |= TetComplex::marked;
  is_star_shaped_ = true;
  if (kConstrained) {
    reached_.assign(&c_.node[4 * start], &c_.node[4 * start] + 4);
    for (const VertexIndex w : reached_)
      if (squared_length(c_.point(w) - c_.point(v)) < min_distance2) return Insert::too_close;
  }
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    const TetIndex t = cavity_[i];
    FaceRef outer[4];
    VertexIndex apex[4];
    unsigned marked = 0;
    for (unsigned f = 0; f < 4; ++f) {
      outer[f] = c_.neigh[4 * t + f];
      apex[f] = c_.node[outer[f]];
      marked |= static_cast<unsigned>((c_.flag[outer[f] >> 2] & TetComplex::marked) != 0) << f;
    }
    const unsigned walls = kConstrained ? c_.flag[t] & kAllFaces : 0, open = kAllFaces & ~(marked | walls);
    if (is_confined() && has_foreign(apex, open)) return Insert::not_ours;
    Faces faces;
    if (is_exact || !look_across_fast<kConstrained>(t, apex, v, open, min_distance2, faces))
      faces = look_across(t, v, open, kConstrained, min_distance);
    const unsigned grown = open & faces.inside, border = (open & ~grown) | walls;
    cavity_.reserve_more(4);
    border_.reserve_more(4);
    for (unsigned f = 0; f < 4; ++f) {
      const TetIndex next = outer[f] >> 2;
      const unsigned bit = grown >> f & 1;
      __builtin_prefetch(&c_.neigh[4 * next]);
      cavity_.push_if(next, bit);
      border_.push_if(4 * t + f, border >> f & 1);
      c_.flag[next] = static_cast<std::uint16_t>(c_.flag[next] | bit * TetComplex::marked);
    }
    if (kConstrained) {
      if (faces.close & grown) return Insert::too_close;
      is_star_shaped_ &= !(border & ~faces.seen);
      seen_.push_back(faces.seen);
      for (unsigned f = 0; f < 4; ++f)
        if (grown >> f & 1) reached_.push_back(apex[f]);
    }
  }
  return Insert::done;
}

bool DelaunayKernel::has_foreign(const VertexIndex* apex, unsigned faces) const {
  unsigned foreign = 0;
  for (unsigned f = 0; f < 4; ++f) {
    const VertexIndex v = apex[f] == kGhost ? 0 : apex[f];
    foreign |= static_cast<unsigned>(apex[f] != kGhost && territory_.key[v] - territory_.first >= territory_.size) << f;
  }
  return foreign & faces;
}

void DelaunayKernel::add_to_border(TetIndex t, unsigned faces) {
  border_.reserve_more(4);
  for (unsigned f = 0; f < 4; ++f) border_.push_if(4 * t + f, faces >> f & 1);
}

/// The faces of a cavity that has been reduced.
void DelaunayKernel::collect_border() {
  border_.clear();
  for (const TetIndex t : cavity_) {
    unsigned faces = c_.flag[t] & kAllFaces;
    for (unsigned f = 0; f < 4; ++f)
      if (!(c_.flag[c_.neigh[4 * t + f] >> 2] & TetComplex::marked)) faces |= 1u << f;
    add_to_border(t, faces);
  }
}

void DelaunayKernel::make_ball() {
  ball_.faces.resize(border_.size());
  for (std::size_t i = 0; i < border_.size(); ++i) {
    const FaceRef ref = border_[i];
    const auto [x, y, z] = c_.face_nodes(ref);
    ball_.faces[i] = {{x, y, z}, c_.neigh[ref], {0, 0, 0}, c_.is_constrained(ref)};
  }
  ball_.number_vertices();
}

/// Leaves out the tets whose outer faces do not see the point, until all do.
bool DelaunayKernel::make_star_shaped(TetIndex start) {
  for (;;) {
    bool changed = false;
    for (std::size_t i = 0; i < cavity_.size(); ++i) {
      const TetIndex t = cavity_[i];
      unsigned border = c_.flag[t] & kAllFaces;
      for (unsigned f = 0; f < 4; ++f)
        if (!(c_.flag[c_.neigh[4 * t + f] >> 2] & TetComplex::marked)) border |= 1u << f;
      if (!(border & ~seen_[i])) continue;
      if (t == start) return false;
      c_.flag[t] &= static_cast<std::uint16_t>(~TetComplex::marked);
      changed = true;
    }
    if (!changed) return true;
    drop_unmarked();
  }
}

void DelaunayKernel::drop_unmarked() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    if (!(c_.flag[cavity_[i]] & TetComplex::marked)) continue;
    cavity_[kept] = cavity_[i];
    seen_[kept++] = seen_[i];
  }
  cavity_.resize(kept);
  seen_.resize(kept);
  collect_border();
}

/// Vertices inside of the cavity would vanish.
bool DelaunayKernel::swallows_a_vertex() const {
  for (const TetIndex t : cavity_)
    for (unsigned i = 0; i < 4; ++i)
      if (!ball_.has_vertex(c_.node[4 * t + i])) return true;
  return false;
}

/// Kept edges inside of the cavity would vanish too: leaves out the tets around them, but for that of the point.
/// @return false where no cavity is left
bool DelaunayKernel::spare_kept_edges(TetIndex start) {
  std::vector<std::array<VertexIndex, 2>> edges;  // of a large ball, or each would be sought among all faces
  const auto collect_edges = [&] {
    edges.clear();
    if (ball_.faces.size() <= kFewFaces) return;
    for (const Ball::Face& f : ball_.faces)
      for (unsigned k = 0; k < 3; ++k) edges.push_back({f.node[k], f.node[(k + 1) % 3]});
    std::sort(edges.begin(), edges.end());
  };
  const auto is_on_ball = [&](VertexIndex a, VertexIndex b) {  // each edge stands there in both directions
    if (!edges.empty()) return std::binary_search(edges.begin(), edges.end(), std::array<VertexIndex, 2>{a, b});
    return std::any_of(ball_.faces.begin(), ball_.faces.end(), [&](const Ball::Face& f) {
      const VertexIndex* n = f.node;
      return (n[0] == a || n[1] == a || n[2] == a) && (n[0] == b || n[1] == b || n[2] == b);
    });
  };
  collect_edges();
  for (;;) {
    const auto [a, b] = c_.find_lost_edge({cavity_.data(), cavity_.size()}, is_on_ball);
    if (a == kNoIndex) return true;
    for (const TetIndex t : cavity_)
      if (t != start && c_.has_vertex(t, a) && c_.has_vertex(t, b))
        c_.flag[t] &= static_cast<std::uint16_t>(~TetComplex::marked);
    const std::size_t before = cavity_.size();
    drop_unmarked();
    if (cavity_.size() == before || !make_star_shaped(start)) return false;
    make_ball();
    collect_edges();
  }
}

void DelaunayKernel::clear_marks() {
  for (const TetIndex t : cavity_) c_.flag[t] &= static_cast<std::uint16_t>(~TetComplex::marked);
}

/// @return a vertex of the tet at v's place, or kNoIndex
VertexIndex DelaunayKernel::find_duplicate(TetIndex start, VertexIndex v) const {
  const bool is_exact = !c_.segment_points.empty();
  for (unsigned i = 0; i < 4; ++i) {
    const VertexIndex w = c_.node[4 * start + i];
    if (w == kGhost) continue;
    if (is_exact ? compare_xyz(c_.exact(w), c_.exact(v)) == 0 : c_.point(w) == c_.point(v)) return w;
  }
  return kNoIndex;
}

DelaunayKernel::Insert DelaunayKernel::insert_into(TetIndex start, VertexIndex v, const Limits& limits) {
  made_.clear();
  if (!is_ours(start)) return Insert::not_ours;
  if (limits.constrained && c_.is_ghost(start)) return Insert::outside;
  duplicate_of = find_duplicate(start, v);
  if (duplicate_of != kNoIndex) return Insert::duplicate;
  const Insert result = insert_checked(v, start, limits);
  if (result != Insert::done) clear_marks();
  return result;
}

DelaunayKernel::Insert DelaunayKernel::insert_checked(VertexIndex v, TetIndex start, const Limits& limits) {
  const Insert grown = limits.constrained ? grow_cavity<true>(start, v, limits.min_distance)
                                          : grow_cavity<false>(start, v, limits.min_distance);
  if (grown != Insert::done) return grown;
  if (limits.constrained) {
    const std::size_t grown_size = cavity_.size();
    if (!is_star_shaped_ && !make_star_shaped(start)) return Insert::not_visible;
    make_ball();
    if (!c_.kept_edges.empty() && !spare_kept_edges(start)) return Insert::not_visible;
    const bool is_whole = cavity_.size() == grown_size;
    if (is_whole ? !std::all_of(reached_.begin(), reached_.end(), [&](VertexIndex w) { return ball_.has_vertex(w); })
                 : swallows_a_vertex())
      return Insert::not_visible;
  } else {
    make_ball();
  }
  if (!has_room()) return Insert::not_ours;
  fill_cavity(v);
  ++counts.points;
  counts.tets_deleted += cavity_.size();
  counts.tets_created += ball_.faces.size();
  return Insert::done;
}

/// One tet (v, x, z, y) a face (x, y, z): its face 0 looks outside. Slots of the cavity are used again.
void DelaunayKernel::fill_cavity(VertexIndex v) {
  const std::size_t reused = std::min(cavity_.size(), ball_.faces.size());
  const std::uint32_t colour = c_.region[cavity_[0]];
  made_.assign(cavity_.begin(), cavity_.begin() + reused);
  while (made_.size() < ball_.faces.size()) made_.push_back(take_slot());
  for (std::size_t i = reused; i < cavity_.size(); ++i) {
    if (!is_in_territory_) {
      c_.kill_tet(cavity_[i]);
    } else {
      c_.bury_tet(cavity_[i]);
      slots_.give(cavity_[i]);
    }
  }
  ball_.write_tets(c_, v, made_, colour);
  c_.vertex_tet[v] = made_[0];
  last_tet = made_[0];
}

}  // namespace delfront
