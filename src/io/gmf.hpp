// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief Keyword numbers of binary Medit files (GMF), as libMeshb numbers them.
namespace gmf {
inline constexpr std::int32_t kDimension = 3, kVertices = 4, kCorners = 13, kRequiredVertices = 15, kEnd = 54,
                              kSolAtVertices = 62, kComments = 81;
inline constexpr std::size_t kCommentLength = 256;

/// @brief Keyword of the cells of a type with a reference each; Mesh orders their vertices likewise.
inline std::optional<std::int32_t> keyword(CellType type) {
  switch (type) {
    case CellType::line:
      return 5;
    case CellType::triangle:
      return 6;
    case CellType::quad:
      return 7;
    case CellType::tetrahedron:
      return 8;
    case CellType::prism:
      return 9;
    case CellType::hexahedron:
      return 10;
    case CellType::pyramid:
      return 49;
    default:
      return std::nullopt;
  }
}
}  // namespace gmf

}  // namespace delfront
