// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>

#include "io/grid_parts.hpp"

namespace delfront {

/// @brief For formats that name a face by a cell and the number of the face there: which cell has each stored face.
class FaceOwners {
 public:
  struct Owner {
    std::int64_t element = 0;  ///< the format's number of the cell
    int face = 0;              ///< from 1
    bool is_same_turn = false;
  };

  /// @brief Faces (sides in the plane) of `mesh` are to be found. @param look_outwards  how the format's faces are
  /// turned
  FaceOwners(const Mesh& mesh, bool look_outwards);
  bool is_empty() const { return stored_.empty(); }
  /// @brief The cell has these faces, local corners each, -1 for none. Best is the cell that a stored face points out
  /// of.
  void offer(std::int64_t element, std::span<const VertexId> cell, std::span<const std::array<int, 4>> faces);
  /// @return null where no cell has that face
  const Owner* find(std::span<const VertexId> corners) const;

 private:
  std::unordered_map<FacetKey, std::pair<const CellBlock*, std::size_t>, FacetKeyHash> stored_;
  std::unordered_map<FacetKey, Owner, FacetKeyHash> owner_of_;
  bool look_outwards_;
};

}  // namespace delfront
