// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief How a format numbers the faces of cells: corners of faces 1, 2, … of each type; -1 ends. Sides of cells in
/// the plane are the same in all of them.
struct LocalFaces {
  using Corners = std::array<int, 4>;
  std::span<const Corners> tetrahedron, pyramid, prism, hexahedron;

  std::span<const Corners> of(CellType type) const {
    static constexpr Corners kTriangle[] = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}};
    static constexpr Corners kQuad[] = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}};
    switch (type) {
      case CellType::tetrahedron:
        return tetrahedron;
      case CellType::pyramid:
        return pyramid;
      case CellType::prism:
        return prism;
      case CellType::hexahedron:
        return hexahedron;
      case CellType::triangle:
        return kTriangle;
      case CellType::quad:
        return kQuad;
      default:
        return {};
    }
  }
};

}  // namespace delfront
