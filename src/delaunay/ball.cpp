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
  // A ball has faces / 2 + 2 vertices; anything else is refused later, but has to fit.
  num_places_ = std::bit_ceil(std::max<std::uint32_t>(static_cast<std::uint32_t>(faces.size()), 16) * 4);
  shift_ = static_cast<std::uint32_t>(32 - std::countr_zero(num_places_));
  numbered_.clear();
  numbered_.resize(num_places_, {kNone, 0});
  num_vertices_ = 0;
  for (Face& face : faces)
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t at = find(face.node[k]);
      if (numbered_[at].vertex == kNone) numbered_[at] = {face.node[k], num_vertices_++};
      face.slot[k] = numbered_[at].slot;
    }
}

bool Ball::has_vertex(VertexIndex v) const { return numbered_[find(v)].vertex == v; }

/// The face of tet (v, x, z, y) over the directed edge a -> b of its outer face meets the one over b -> a.
void Ball::bond(TetComplex& complex, const std::vector<TetIndex>& made) {
  if (faces.size() > kTableFaces || num_vertices_ > kTableVertices) return bond_by_hash(complex, made);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::uint32_t* s = faces[i].slot;
    for (unsigned k = 0; k < 3; ++k)
      edge_[s[k] % kTable][s[(k + 1) % 3] % kTable] = static_cast<std::uint8_t>(4 * i + kFaceOfEdge[k]);
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::uint32_t* s = faces[i].slot;
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned other = edge_[s[(k + 1) % 3] % kTable][s[k] % kTable];
      complex.neigh[4 * made[i] + kFaceOfEdge[k]] = 4 * made[other >> 2] + (other & 3);
    }
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
