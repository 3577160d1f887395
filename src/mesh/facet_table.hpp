// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "delfront/mesh.hpp"
#include "mesh/cell_shape.hpp"

namespace delfront {

/// @brief All cells of one dimension, numbered through over the blocks in the order in which they are stored.
class CellRange {
 public:
  struct Part {
    const CellBlock* block;
    std::size_t first;  ///< number of the block's first cell
  };

  CellRange(const Mesh& mesh, int dimension);
  std::size_t size() const { return size_; }
  std::span<const Part> parts() const { return parts_; }
  const Part& part_of(std::size_t cell) const;
  std::span<const VertexId> operator[](std::size_t cell) const;

 private:
  std::vector<Part> parts_;
  std::size_t size_ = 0;
};

/// @brief One side of one cell (a face in 3-D, an edge in 2-D), or one stored facet.
///
/// a is the smallest vertex; then the smaller and, around the facet, the following ones: (a, b, c) of a triangle,
/// (a, b, opposite of a, other neighbour of a) of a quad, (a, b) of an edge, the rest kNone. Facets are the same where
/// a, b, c, d are; they run the same way where is_forward is the same too.
struct HalfFacet {
  std::uint32_t a, b, c, d;
  std::uint32_t cell;        ///< number in the CellRange of the cells, or of the facets where is_stored
  std::uint8_t local_facet;  ///< in CellShape::facets; 0 where stored
  bool is_forward, is_stored;

  int num_vertices() const { return c == VertexId::kNone ? 2 : d == VertexId::kNone ? 3 : 4; }
  bool is_same_facet(const HalfFacet& o) const { return a == o.a && b == o.b && c == o.c && d == o.d; }
};

/// @brief Every side of every cell and every stored facet, the same ones beside each other: first those of cells in
/// the order of the cells, then the stored ones.
///
/// Polygons and polyhedra have no sides here. The indices of the mesh must be in range.
/// @par Cost  O(n): counting sort by the smallest vertex, then small sorts; 24 bytes a side
std::vector<HalfFacet> build_facet_table(const Mesh& mesh, const CellRange& cells, const CellRange& stored);

/// @brief Calls visit(sides of cells, stored) for each facet of a table from build_facet_table.
template <class Visit>
void for_each_facet(std::span<const HalfFacet> table, Visit&& visit) {
  for (std::size_t first = 0; first < table.size();) {
    std::size_t end = first, stored = first;
    for (; end < table.size() && table[end].is_same_facet(table[first]); ++end)
      if (!table[end].is_stored) stored = end + 1;
    visit(table.subspan(first, stored - first), table.subspan(stored, end - stored));
    first = end;
  }
}

/// @brief Every edge of the cells once, as (smaller vertex, larger vertex), sorted.
std::vector<std::pair<std::uint32_t, std::uint32_t>> find_edges(const Mesh& mesh, const CellRange& cells);

}  // namespace delfront
