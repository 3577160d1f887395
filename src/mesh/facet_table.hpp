// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "delfront/mesh.hpp"
#include "mesh/bins.hpp"
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

/// @brief The facets and edges of a mesh, made bin by bin: a bin holds those whose smallest vertex lies in a range.
///
/// No table of all facets is ever there: only the numbers of the cells that each bin needs. Bins can be asked for in
/// any order and from several threads, each with a Scratch of its own. The order within a bin is that in which the
/// cells, then the stored facets, name the facets. Polygons and polyhedra have no sides here. The indices of the mesh
/// must be in range, and the mesh and the ranges must stay.
/// @par Cost  O(n); 4 to 12 bytes a tetrahedron, about 5 where vertices are numbered along a curve
class FacetSweep {
 public:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;  ///< smaller, larger vertex
  struct Scratch {
    std::vector<HalfFacet> halves;
    std::vector<std::uint32_t> next;    ///< of each half: the next one of the same facet, or kNone
    std::vector<std::uint32_t> firsts;  ///< the first half of each facet
    std::vector<HalfFacet> facet;
    std::vector<Edge> edges;
    std::vector<std::uint32_t> table;  ///< open addressing: first halves
    std::vector<std::uint32_t> rows;   ///< the larger ends of edges, some a vertex
    std::vector<std::uint8_t> row_sizes;
  };

  FacetSweep(const Mesh& mesh, const CellRange& cells, const CellRange& stored, int threads);
  std::size_t num_bins() const { return width_.num_bins; }

  /// @brief Calls visit(sides of cells, stored) for each facet of this bin: each of the two in ascending order.
  template <class Visit>
  void for_each_facet(std::size_t bin, Scratch& scratch, Visit&& visit) const;
  /// @brief Every edge of the cells in this bin once.
  std::span<const Edge> edges(std::size_t bin, Scratch& scratch) const;

 private:
  void collect_sides(std::size_t bin, std::vector<HalfFacet>& halves) const;
  void collect_stored(std::size_t bin, std::vector<HalfFacet>& halves) const;
  template <class Visit>
  void for_each_half_edge(std::size_t bin, Visit&& visit) const;
  void match_halves(std::size_t bin, Scratch& scratch) const;

  const CellRange& cells_;
  const CellRange& stored_;
  int dimension_;
  BinWidth width_;
  Bins cells_of_bin_, stored_of_bin_;
};

template <class Visit>
void FacetSweep::for_each_facet(std::size_t bin, Scratch& scratch, Visit&& visit) const {
  match_halves(bin, scratch);
  for (const std::uint32_t first : scratch.firsts) {
    scratch.facet.clear();
    std::size_t num_sides = 0;
    for (std::uint32_t i = first; i != VertexId::kNone; i = scratch.next[i]) {
      scratch.facet.push_back(scratch.halves[i]);
      num_sides += !scratch.halves[i].is_stored;
    }
    const std::span<const HalfFacet> facet(scratch.facet);
    visit(facet.first(num_sides), facet.subspan(num_sides));
  }
}

}  // namespace delfront
