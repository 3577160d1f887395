// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief The faces of a cavity, and the tets that join them to a point in it.
///
/// Balls of up to kTableVertices vertices (nearly all: 16 on average) are numbered and bonded through tables that stay
/// in the first level of cache; larger ones through hash tables.
class Ball {
 public:
  struct Face {
    VertexIndex node[3];    ///< normal into the cavity
    FaceRef outer;          ///< the same face from outside
    std::uint32_t slot[3];  ///< the nodes' numbers in the ball
    bool constrained;
  };
  FlatArray<Face> faces;

  /// @brief Number the vertices of the faces, into their slots.
  void number_vertices();
  bool has_vertex(VertexIndex v) const;
  /// @brief Write the tets made[i] = (v, x, z, y) over faces[i] = (x, y, z), bonded outwards and among themselves.
  void write_tets(TetComplex& complex, VertexIndex v, const std::vector<TetIndex>& made, std::uint32_t region);

 private:
  static constexpr std::uint32_t kTableVertices = 31, kTableFaces = 58, kTable = 32;
  static constexpr std::uint32_t kPlaceBits = 11, kPlaces = 1 << kPlaceBits;
  static constexpr std::uint8_t kNewSlot = 255;
  static constexpr VertexIndex kNone = 0xfffffffeu;
  static constexpr std::uint32_t kHash = 0x9e3779b1u;

  struct Numbered {
    VertexIndex vertex;
    std::uint32_t slot;
  };
  bool number_few();
  void number_many();
  static std::uint32_t place_of(VertexIndex v) { return (v * kHash) >> (32 - kPlaceBits); }
  std::uint32_t find(VertexIndex v) const;
  void bond_by_table(TetComplex& complex, const std::vector<TetIndex>& made);
  void bond_by_hash(TetComplex& complex, const std::vector<TetIndex>& made);

  bool is_small_ = false;
  VertexIndex few_[kPlaces] = {};  ///< a small ball's vertices by hash, and their slots
  std::uint8_t few_slot_[kPlaces] = {};
  FlatArray<Numbered> many_;  ///< the same for a large ball, at most a quarter full
  std::uint32_t many_shift_ = 0;
  FlatArray<std::uint32_t> face_of_slot_;
  std::uint8_t edge_[kTable * kTable] = {};  ///< by directed edge: 4 * face + place of the edge's face in its tet
  std::vector<std::pair<std::uint64_t, FaceRef>> edge_hash_;
};

}  // namespace delfront
