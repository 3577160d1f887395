// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief The faces of a cavity and the ring of new tets around a point: numbers their vertices and bonds the tets.
///
/// Balls of up to kTableVertices vertices (nearly all: 16 on average) are bonded through a table of directed edges that
/// stays in the first level of cache; larger ones through a hash table.
class Ball {
 public:
  struct Face {
    VertexIndex node[3];    ///< normal into the cavity
    std::uint32_t slot[3];  ///< the nodes' numbers in the ball
    FaceRef outer;          ///< the same face from outside
    bool constrained;
  };
  FlatArray<Face> faces;

  /// @brief Number the vertices of the faces, into their slots.
  void number_vertices();
  bool has_vertex(VertexIndex v) const;
  /// @brief Bond tets made[i] = (v, x, z, y) over faces[i] = (x, y, z) among themselves.
  void bond(TetComplex& complex, const std::vector<TetIndex>& made);

 private:
  static constexpr std::uint32_t kTableVertices = 31, kTableFaces = 58, kTable = 32;
  static constexpr VertexIndex kNone = 0xfffffffeu;

  struct Numbered {
    VertexIndex vertex;
    std::uint32_t slot;
  };
  std::uint32_t find(VertexIndex v) const {
    std::uint32_t at = (v * 0x9e3779b1u) >> shift_;
    while (numbered_[at].vertex != v && numbered_[at].vertex != kNone) at = (at + 1) & (num_places_ - 1);
    return at;
  }
  void bond_by_hash(TetComplex& complex, const std::vector<TetIndex>& made);

  FlatArray<Numbered> numbered_;  ///< hash table of the ball's vertices, at most half full
  std::uint32_t num_places_ = 0, shift_ = 0;
  std::uint32_t num_vertices_ = 0;
  std::uint8_t edge_[kTable][kTable] = {};  ///< 4 * face + place of the edge's face in its tet
  std::vector<std::pair<std::uint64_t, FaceRef>> edge_hash_;
};

}  // namespace delfront
