// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

/// @brief A face of cells, or a side of cells in the plane.
struct Facet {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::array<VertexId, 4> corners;  ///< as the first cell has them: outward, or along its turn
  int num_corners = 0;
  std::uint32_t first = kNone, second = kNone;  ///< cells, numbered over the blocks of the top dimension
  std::int64_t group = -1;                      ///< of the stored face there

  std::span<const VertexId> ring() const { return {corners.data(), static_cast<std::size_t>(num_corners)}; }
};

struct Facets {
  std::vector<Facet> all;     ///< in the order of the cells that have them first
  std::size_t num_loose = 0;  ///< stored faces that are no face of a cell
};

/// @brief All facets of the cells of `mesh.dimension`, and which stored face each is.
/// @throws InputError  a facet of three cells
/// @pre no polygons or polyhedra  @par Cost  O(n) expected; about 100 bytes a facet
Facets build_facets(const Mesh& mesh, Context& context);

}  // namespace delfront
