// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief Cell types in the order of a UGRID header, behind the number of nodes.
inline constexpr std::array<CellType, 6> kUgridTypes = {CellType::triangle, CellType::quad,  CellType::tetrahedron,
                                                        CellType::pyramid,  CellType::prism, CellType::hexahedron};

/// @brief Where vertex k of a UGRID cell stands in Mesh's order; its pyramids have the apex third.
inline std::size_t ugrid_place(CellType type, std::size_t k) {
  constexpr std::array<std::size_t, 5> kPyramid = {0, 3, 4, 1, 2};
  return type == CellType::pyramid ? kPyramid[k] : k;
}
/// @brief The same for a boundary face, which points into the grid there and out of it here.
inline std::size_t turned_place(CellType type, std::size_t k) {
  return k == 0 ? 0 : static_cast<std::size_t>(num_vertices(type)) - k;
}

}  // namespace delfront
