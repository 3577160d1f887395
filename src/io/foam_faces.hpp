// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

/// @brief A face of a polyMesh: corners as cell `owner` has them, outward.
struct FoamFace {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t owner = kNone;
  std::uint32_t neighbour = kNone;  ///< kNone: boundary
  std::uint32_t local = 0;          ///< which face of the owner
  std::uint32_t group = kNone;      ///< group of the stored face there
  bool is_flipped = false;          ///< the stored face points towards the owner
  bool is_slave = false;            ///< of a baffle: the side that the stored face points to
};

/// @brief What an OpenFOAM mesh is made of: cells numbered over the volume blocks, internal faces in upper-triangular
/// order, boundary faces in no order yet.
struct FoamFaces {
  std::vector<const CellBlock*> blocks;  ///< volume blocks
  std::vector<std::size_t> first_cell;   ///< of each block, and the total
  std::vector<FoamFace> internal;        ///< sorted by (owner, neighbour)
  std::vector<FoamFace> boundary;
  std::vector<bool> is_baffle;  ///< by group: inner faces with the same region on both sides, made double
  std::size_t num_loose = 0;    ///< stored faces that are no face of a cell

  std::size_t num_cells() const { return first_cell.back(); }
  /// @brief The region (group index) of a cell, or -1.
  std::int64_t region_of(std::size_t cell) const;
  std::vector<VertexId> corners(const FoamFace& face) const;
};

/// @brief Match the faces of all volume cells and the stored faces.
/// @throws InputError  a face with more than two cells
/// @par Cost  O(n log k), k = faces at a vertex; 16 bytes a half-face
FoamFaces build_foam_faces(const Mesh& mesh, Context& context);

}  // namespace delfront
