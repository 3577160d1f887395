// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief How a cell type is divided, by local nodes: its corners, the middles of its edges (in the order of
/// CellShape), of its quads, and its own.
struct ChildTable {
  using Cell = std::array<std::uint8_t, 8>;  ///< local nodes in VTK's order; as many as the child's type has vertices
  struct Node {
    int num_corners = 0;
    std::array<std::uint8_t, 8> corners{};  ///< whose mean it is
  };
  static constexpr int kMaxNodes = 27;

  CellType type = CellType::tetrahedron;
  int num_corners = 0, num_edges = 0, num_quads = 0;
  bool has_centre = false;  ///< quads and hexahedra
  int num_nodes = 0;
  std::array<Node, kMaxNodes> nodes{};
  std::vector<Cell> children;  ///< of the same type; of a tetrahedron the corners only
  std::vector<Cell> tets;      ///< of a pyramid
  /// Of a tetrahedron: the inner diagonals, and the four children round each.
  std::array<std::array<std::uint8_t, 2>, 3> diagonals{};
  std::array<std::array<Cell, 4>, 3> around_diagonal{};

  /// @return children of the same type
  std::size_t num_children() const { return children.size() + (type == CellType::tetrahedron ? 4 : 0); }
};

/// @return for lines, triangles, quads, tetrahedra, pyramids, prisms, hexahedra; no nodes for the other types
const ChildTable& child_table(CellType type);

}  // namespace delfront
