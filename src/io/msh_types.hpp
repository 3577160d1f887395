// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief Gmsh's number of a linear cell type; nullopt for polygons and polyhedra, which MSH lacks.
/// Gmsh orders the vertices of all of them as Mesh does.
inline std::optional<int> msh_number(CellType type) {
  switch (type) {
    case CellType::vertex:
      return 15;
    case CellType::line:
      return 1;
    case CellType::triangle:
      return 2;
    case CellType::quad:
      return 3;
    case CellType::tetrahedron:
      return 4;
    case CellType::hexahedron:
      return 5;
    case CellType::prism:
      return 6;
    case CellType::pyramid:
      return 7;
    default:
      return std::nullopt;
  }
}

inline std::optional<CellType> type_from_msh(std::int64_t number) {
  for (int i = 0; i < kNumCellTypes; ++i)
    if (const auto known = msh_number(static_cast<CellType>(i)); known && *known == number)
      return static_cast<CellType>(i);
  return std::nullopt;
}

}  // namespace delfront
