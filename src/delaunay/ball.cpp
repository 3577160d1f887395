// SPDX-License-Identifier: Apache-2.0
#include "delaunay/ball.hpp"

#include <algorithm>
#include <bit>

namespace delfront {

namespace {

// Nodes 1, 2, 3 of the new tet are x, z, y: the edge opposite x is y -> z, and so on.
constexpr unsigned kFaceOfEdge[3] = {2, 1, 3};  // edges x -> y (opposite z), y -> z (opposite x), z -> x (opposite y)

}  // namespace

void Ball::number_vertices() {
  is_small_ = faces.size() <= kTableFaces && number_few();
  if (!is_small_) number_many();
}

/// Through a table by hash that is never cleared: the first pass writes what the second one reads. No branch depends on
/// which vertices are new, which no processor can guess.
/// @return false where there are more than the tables hold, or two have the same place
bool Ball::number_few() {
  face_of_slot_.reserve(3 * kTableFaces);
  std::uint32_t* const face_of_slot = face_of_slot_.data();
  Face* const all = faces.data();
  const auto n = static_cast<std::uint32_t>(faces.size());
  for (std::uint32_t i = 0; i < n; ++i)
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t at = place_of(all[i].node[k]);
      few_[at] = all[i].node[k];
      few_slot_[at] = kNewSlot;
    }
  std::uint32_t count = 0;
  bool is_clear = true;
  for (std::uint32_t i = 0; i < n; ++i)
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t at = place_of(all[i].node[k]);
      is_clear &= few_[at] == all[i].node[k];
      const bool is_new = few_slot_[at] == kNewSlot;
      const std::uint32_t slot = is_new ? count : few_slot_[at];
      face_of_slot[count] = 4 * i + k;
      count += is_new;
      few_slot_[at] = static_cast<std::uint8_t>(slot);
      all[i].slot[k] = slot;
    }
  face_of_slot_.resize(count);
  return is_clear && count <= kTableVertices;
}

std::uint32_t Ball::find(VertexIndex v) const {
  std::uint32_t at = (v * kHash) >> many_shift_;
  while (many_[at].vertex != v && many_[at].vertex != kNone)
    at = (at + 1) & (static_cast<std::uint32_t>(many_.size()) - 1);
  return at;
}

void Ball::number_many() {
  // A ball has faces / 2 + 2 vertices; anything else is refused later, but has to fit.
  const std::uint32_t places = std::bit_ceil(std::max<std::uint32_t>(static_cast<std::uint32_t>(faces.size()), 16) * 4);
  many_shift_ = static_cast<std::uint32_t>(32 - std::countr_zero(places));
  many_.clear();
  many_.resize(places, {kNone, 0});
  face_of_slot_.clear();
  for (std::uint32_t i = 0; i < faces.size(); ++i)
    for (unsigned k = 0; k < 3; ++k) {
      Numbered& numbered = many_[find(faces[i].node[k])];
      if (numbered.vertex == kNone) {
        numbered = {faces[i].node[k], static_cast<std::uint32_t>(face_of_slot_.size())};
        face_of_slot_.push_back(4 * i + k);
      }
      faces[i].slot[k] = numbered.slot;
    }
}

bool Ball::has_vertex(VertexIndex v) const {
  if (!is_small_) return many_[find(v)].vertex == v;
  const std::uint32_t slot = few_slot_[place_of(v)];  // perhaps of an earlier ball
  if (slot >= face_of_slot_.size()) return false;
  const std::uint32_t first = face_of_slot_[slot];
  return faces[first >> 2].node[first & 3] == v;
}

void Ball::write_tets(TetComplex& complex, VertexIndex v, const std::vector<TetIndex>& made, std::uint32_t region) {
  for (const std::uint32_t first : face_of_slot_)
    if (const VertexIndex u = faces[first >> 2].node[first & 3]; u != kGhost) complex.vertex_tet[u] = made[first >> 2];
  for (std::size_t i = 0; i < faces.size(); ++i) {
    Face& face = faces[i];
    if (face.node[0] == kGhost || face.node[2] == kGhost) {  // the ghost becomes node 3
      const std::ptrdiff_t first = face.node[0] == kGhost ? 2 : 1;
      std::rotate(face.node, face.node + first, face.node + 3);
      std::rotate(face.slot, face.slot + first, face.slot + 3);
    }
    const TetIndex t = made[i];
    complex.set_nodes(t, v, face.node[0], face.node[2], face.node[1]);
    complex.flag[t] = static_cast<std::uint16_t>(TetComplex::fresh | (face.constrained ? 1 : 0));
    complex.region[t] = face.node[1] == kGhost ? TetComplex::kOutside : region;
    complex.bond(4 * t, face.outer);
  }
  is_small_ ? bond_by_table(complex, made) : bond_by_hash(complex, made);
}

/// The face of tet (v, x, z, y) over the directed edge a -> b of its outer face meets the one over b -> a.
void Ball::bond_by_table(TetComplex& complex, const std::vector<TetIndex>& made) {
  const auto n = static_cast<std::uint32_t>(faces.size());
  const Face* const all = faces.data();
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t x = all[i].slot[0], y = all[i].slot[1], z = all[i].slot[2];
    edge_[kTable * x + y] = static_cast<std::uint8_t>(4 * i + kFaceOfEdge[0]);
    edge_[kTable * y + z] = static_cast<std::uint8_t>(4 * i + kFaceOfEdge[1]);
    edge_[kTable * z + x] = static_cast<std::uint8_t>(4 * i + kFaceOfEdge[2]);
  }
  const TetIndex* const tet = made.data();
  const auto other_side = [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t other = edge_[kTable * b + a];
    return 4 * tet[other >> 2] + (other & 3);
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t x = all[i].slot[0], y = all[i].slot[1], z = all[i].slot[2];
    FaceRef* const neigh = &complex.neigh[4 * tet[i]];
    neigh[kFaceOfEdge[0]] = other_side(x, y);
    neigh[kFaceOfEdge[1]] = other_side(y, z);
    neigh[kFaceOfEdge[2]] = other_side(z, x);
  }
}

/// For balls of any size: open addressing by the undirected edge.
void Ball::bond_by_hash(TetComplex& complex, const std::vector<TetIndex>& made) {
  constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  const std::size_t size = std::bit_ceil(4 * faces.size()), mask = size - 1;
  edge_hash_.assign(size, {kEmpty, kNoIndex});
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (unsigned k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(faces[i].slot[k], faces[i].slot[(k + 1) % 3]);
      const std::uint64_t key = std::uint64_t{a} << 32 | b;
      const FaceRef ref = 4 * made[i] + kFaceOfEdge[k];
      std::size_t at = static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ull >> 32) & mask;
      while (edge_hash_[at].first != kEmpty && edge_hash_[at].first != key) at = (at + 1) & mask;
      if (edge_hash_[at].first == key)
        complex.bond(edge_hash_[at].second, ref);
      else
        edge_hash_[at] = {key, ref};
    }
  }
}

}  // namespace delfront
