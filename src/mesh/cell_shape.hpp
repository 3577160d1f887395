// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief A side of a cell by its local vertices: outward in 3-D, anticlockwise (along the border) in 2-D.
struct LocalFacet {
  int num_vertices = 0;
  std::array<int, 4> vertices{};
};

/// @brief Topology of a cell type with a fixed number of vertices, in the vertex order of CellType.
struct CellShape {
  int num_facets = 0;
  std::array<LocalFacet, 6> facets{};
  int num_edges = 0;
  std::array<std::array<int, 2>, 12> edges{};
  std::array<std::array<int, 2>, 12> facets_of_edge{};  ///< 3-D only: the two facets that meet there
  int num_corners = 0;
  /// A tetrahedron (3-D) or triangle (2-D, first three) at each corner; all are positive for a valid cell.
  std::array<std::array<int, 4>, 8> corners{};
};

/// @return triangle, quad, tetrahedron, pyramid, prism, hexahedron; all counts 0 for the other types
const CellShape& shape_of(CellType type);

}  // namespace delfront
