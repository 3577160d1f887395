// SPDX-License-Identifier: Apache-2.0
// The tetrahedral complex: searches around vertices and edges, and the replacement of a cavity.
#include "tetra/tet_complex.hpp"

#include "delfront/errors.hpp"

namespace delfront {

namespace {

std::array<VertexIndex, 3> sorted(std::array<VertexIndex, 3> n) {
  if (n[0] > n[1]) std::swap(n[0], n[1]);
  if (n[1] > n[2]) std::swap(n[1], n[2]);
  if (n[0] > n[1]) std::swap(n[0], n[1]);
  return n;
}

void check_num_slots(std::size_t slots) {
  if (slots > TetComplex::kMaxSlots)
    throw LimitError("stopped: a grid of more than 1,073,741,824 cells at a time cannot be made; ask for larger sizes");
}

std::uint32_t hash_face(const std::array<VertexIndex, 3>& key) {
  std::uint64_t h = key[0] * 0x9e3779b97f4a7c15ull;
  h = (h ^ (h >> 29) ^ key[1]) * 0xbf58476d1ce4e5b9ull;
  h = (h ^ (h >> 31) ^ key[2]) * 0x94d049bb133111ebull;
  return static_cast<std::uint32_t>(h >> 32);
}

/// Breadth-first over the live tets around v; `stop(t)` true ends the search at t. Clears its marks.
template <class Stop>
TetIndex scan_star(const TetComplex& c, VertexIndex v, std::vector<TetIndex>& out, Stop stop) {
  out.clear();
  const TetIndex first = c.vertex_tet[v];
  if (first == kNoIndex) return kNoIndex;
  TetIndex found = kNoIndex;
  out.push_back(first);
  c.flag[first] |= TetComplex::in_scan;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const TetIndex t = out[i];
    if (stop(t)) {
      found = t;
      break;
    }
    const std::uint32_t* n = &c.node[4 * t];
    for (unsigned f = 0; f < 4; ++f) {
      if (n[f] == v) continue;
      const TetIndex other = c.neigh[4 * t + f] >> 2;
      if (c.flag[other] & TetComplex::in_scan) continue;
      c.flag[other] |= TetComplex::in_scan;
      out.push_back(other);
    }
  }
  for (const TetIndex t : out) c.flag[t] &= static_cast<std::uint16_t>(~TetComplex::in_scan);
  return found;
}

}  // namespace

TetIndex TetComplex::new_tet() {
  if (!free_.empty()) {
    const TetIndex t = free_.back();
    free_.pop_back();
    flag[t] = 0;
    return t;
  }
  const std::size_t t = flag.size();
  check_num_slots(t + 1);
  flag.push_back(0);
  node.resize(node.size() + 4, kNoIndex);
  neigh.resize(neigh.size() + 4, kNoIndex);
  region.push_back(kOutside);
  return static_cast<TetIndex>(t);
}

void TetComplex::kill_tet(TetIndex t) {
  bury_tet(t);
  free_.push_back(t);
}

SlotStock TetComplex::take_slots(std::size_t count) {
  const std::size_t reused = std::min(count, free_.size());
  std::vector<TetIndex> used(free_.end() - static_cast<std::ptrdiff_t>(reused), free_.end());
  free_.resize(free_.size() - reused);
  const std::size_t first = num_slots(), total = first + count - reused;
  check_num_slots(total);
  flag.resize(total, dead);
  node.resize(4 * total);
  neigh.resize(4 * total);
  region.resize(total);
  return {std::move(used), static_cast<TetIndex>(first), static_cast<TetIndex>(total)};
}

void TetComplex::give_slots(SlotStock& stock) {
  while (stock.size() > 0) kill_tet(stock.take());
}

std::vector<VertexIndex> TetComplex::take_vertices(std::size_t count) {
  const std::size_t reused = std::min(count, free_vertices_.size());
  std::vector<VertexIndex> numbers(free_vertices_.end() - static_cast<std::ptrdiff_t>(reused), free_vertices_.end());
  free_vertices_.resize(free_vertices_.size() - reused);
  const std::size_t first = num_vertices(), total = first + count - reused;
  vertex.resize(total);
  vertex_tet.resize(total, kNoIndex);
  on_boundary.resize(total, 0);
  for (std::size_t v = total; v > first; --v) numbers.push_back(static_cast<VertexIndex>(v - 1));
  return numbers;
}

void TetComplex::give_vertices(std::span<const VertexIndex> numbers) {
  for (const VertexIndex v : numbers) set_vertex(v, {}, 0);
  free_vertices_.insert(free_vertices_.end(), numbers.begin(), numbers.end());
}

VertexIndex TetComplex::add_vertex(Point p, double h) {
  const auto v = static_cast<VertexIndex>(vertex.size());
  vertex.push_back({p.x, p.y, p.z, h});
  vertex_tet.push_back(kNoIndex);
  on_boundary.push_back(0);
  return v;
}

ExactPoint TetComplex::exact(VertexIndex v) const {
  if (!segment_points.empty()) {
    const auto found = segment_points.find(v);
    if (found != segment_points.end()) return found->second;
  }
  return ExactPoint::explicit_point(point(v));
}

int TetComplex::orient(VertexIndex a, VertexIndex b, VertexIndex c, VertexIndex d) const {
  if (segment_points.empty()) return orient3d(point(a), point(b), point(c), point(d));
  const ExactPoint pa = exact(a), pb = exact(b), pc = exact(c), pd = exact(d);
  if (pa.is_explicit() && pb.is_explicit() && pc.is_explicit() && pd.is_explicit())
    return orient3d(pa.approx, pb.approx, pc.approx, pd.approx);
  return orient3d(pa, pb, pc, pd);
}

void TetComplex::star(VertexIndex v, std::vector<TetIndex>& out) const {
  scan_star(*this, v, out, [](TetIndex) { return false; });
}

void TetComplex::edge_ring(TetIndex t, VertexIndex a, VertexIndex b, std::vector<TetIndex>& out) const {
  out.clear();
  const std::uint8_t* other = kOtherNodes[local_index(t, a)][local_index(t, b)];
  unsigned leave = other[0];                   // local index of p_i, whose face leads to tet i + 1
  VertexIndex ahead = node[4 * t + other[1]];  // p_i+1
  TetIndex at = t;
  do {
    out.push_back(at);
    const FaceRef enter = neigh[4 * at + leave];
    at = enter >> 2;
    leave = static_cast<unsigned>(local_index(at, ahead));
    ahead = node[enter];
  } while (at != t);
}

TetIndex TetComplex::find_edge(VertexIndex a, VertexIndex b, std::vector<TetIndex>& scratch) const {
  return scan_star(*this, a, scratch, [&](TetIndex t) { return has_vertex(t, b); });
}

FaceRef TetComplex::find_face(VertexIndex a, VertexIndex b, VertexIndex c, std::vector<TetIndex>& scratch) const {
  const TetIndex t =
      scan_star(*this, a, scratch, [&](TetIndex tet) { return has_vertex(tet, b) && has_vertex(tet, c); });
  if (t == kNoIndex) return kNoIndex;
  const int sum = local_index(t, a) + local_index(t, b) + local_index(t, c);
  return 4 * t + static_cast<unsigned>(6 - sum);
}

void TetComplex::match_face(FaceRef ref, bool constrained) {
  const std::array<VertexIndex, 3> key = sorted(face_nodes(ref));
  const std::size_t mask = face_table_.size() - 1;
  std::size_t at = hash_face(key) & mask;
  for (; face_table_[at] != kNoIndex; at = (at + 1) & mask) {
    OpenFace& open = open_faces_[face_table_[at]];
    if (open.key != key) continue;
    DELFRONT_CHECK(open.ref != kNoIndex);
    bond(ref, open.ref);
    set_constrained(ref, open.constrained);
    open.ref = kNoIndex;
    --num_open_;
    return;
  }
  face_table_[at] = static_cast<std::uint32_t>(open_faces_.size());
  open_faces_.push_back({key, ref, constrained});
  ++num_open_;
}

void TetComplex::collect_hole(const std::vector<TetIndex>& old_tets) {
  for (const TetIndex t : old_tets) flag[t] |= in_scan;
  for (const TetIndex t : old_tets) {
    for (unsigned f = 0; f < 4; ++f) {
      const VertexIndex v = node[4 * t + f];
      if (v != kGhost) vertex_tet[v] = kNoIndex;
      const FaceRef outer = neigh[4 * t + f];
      if (!(flag[outer >> 2] & in_scan)) match_face(outer, is_constrained(4 * t + f));
    }
  }
  for (const TetIndex t : old_tets) flag[t] = 0;
}

void TetComplex::replace(const std::vector<TetIndex>& old_tets, const std::vector<std::array<VertexIndex, 4>>& made,
                         std::vector<TetIndex>& new_tets) {
  std::size_t table = 16;
  while (table < 4 * (old_tets.size() + made.size())) table *= 2;
  face_table_.assign(table, kNoIndex);
  open_faces_.clear();
  num_open_ = 0;
  std::uint32_t colour = kOutside;
  for (const TetIndex t : old_tets) {
    if (is_ghost(t)) continue;
    colour = region[t];
    break;
  }
  collect_hole(old_tets);

  new_tets.clear();
  for (std::size_t i = 0; i < made.size(); ++i) {
    const TetIndex t = i < old_tets.size() ? old_tets[i] : new_tet();
    new_tets.push_back(t);
    std::array<VertexIndex, 4> n = made[i];
    for (unsigned k = 0; k < 3; ++k) {  // the ghost goes to place 3 by an even permutation
      if (n[k] != kGhost) continue;
      std::swap(n[k], n[3]);
      std::swap(n[(k + 1) % 3], n[(k + 2) % 3]);
      break;
    }
    set_nodes(t, n[0], n[1], n[2], n[3]);
    flag[t] = fresh;
    region[t] = n[3] == kGhost ? kOutside : colour;
    for (unsigned f = 0; f < 4; ++f) {
      if (n[f] != kGhost) vertex_tet[n[f]] = t;
      match_face(4 * t + f, false);
    }
  }
  for (std::size_t i = made.size(); i < old_tets.size(); ++i) kill_tet(old_tets[i]);
  DELFRONT_CHECK(num_open_ == 0);
}

}  // namespace delfront
