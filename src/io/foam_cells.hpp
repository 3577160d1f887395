// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief The faces of a polyMesh: corners by offsets; a face's normal leaves its owner.
struct FoamFaceList {
  std::vector<VertexId> corners;
  std::vector<std::size_t> offsets = {0};
  std::vector<std::uint32_t> owner;      ///< one a face
  std::vector<std::uint32_t> neighbour;  ///< one an inner face: these come first

  std::size_t size() const { return offsets.size() - 1; }
  std::span<const VertexId> operator[](std::size_t face) const {
    return {corners.data() + offsets[face], offsets[face + 1] - offsets[face]};
  }
};

/// @brief Append the cells of a polyMesh: tetrahedra, pyramids, prisms, hexahedra where their faces are those, else
/// polyhedra.
/// @param group  one a cell, perhaps invalid
/// @param path   for messages
/// @pre every cell has a face, and ids are in range
/// @throws InputError  a cell is not closed
void add_foam_cells(const FoamFaceList& faces, std::span<const GroupId> group, const std::string& path, Mesh& mesh);

}  // namespace delfront
