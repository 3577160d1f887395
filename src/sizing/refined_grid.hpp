// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "delfront/point.hpp"
#include "sizing/simplex_grid.hpp"

namespace delfront {

/// @brief Triangles or tetrahedra, refined one into four or eight, with a conforming closure.
///
/// Kept are the regular cells alone, and which edges have a middle node. The halves and quarters that close the grid
/// around a regular cell with some split edges are made when asked for (pieces()), and never refined.
/// Edges of a regular cell that are split, after close(): none, one (halves), or in space the three of one face
/// (quarters); and no part of these is split again.
class RefinedGrid {
 public:
  using Cell = SimplexGrid::Cell;

  /// @param cells  positive; in the plane the last vertex is kNone
  RefinedGrid(int dimension, std::vector<Point> points, std::vector<double> size, std::vector<Cell> cells);

  int dimension() const { return dimension_; }
  std::size_t num_corners() const { return static_cast<std::size_t>(dimension_) + 1; }
  const std::vector<Point>& points() const { return points_; }
  std::vector<double>& size() { return size_; }
  const std::vector<double>& size() const { return size_; }
  const std::vector<Cell>& cells() const { return cells_; }

  /// @brief Split these cells, then what the closure asks for; new nodes get the mean of their edge's ends.
  /// @return of each cell before, its first cell after; others follow at the end: see `parent_of`
  struct Refinement {
    std::size_t refined = 0;
    /// Of each cell now, the one that it was or came from.
    std::vector<std::uint32_t> parent_of;
  };
  Refinement refine(std::vector<char> is_marked);

  /// @brief What a regular cell is in the conforming grid: itself, two halves or four quarters.
  void pieces(std::size_t cell, std::vector<Cell>& into) const;

 private:
  using EdgeKey = std::uint64_t;
  static EdgeKey key_of(std::uint32_t a, std::uint32_t b) {
    return a < b ? (EdgeKey{a} << 32 | b) : (EdgeKey{b} << 32 | a);
  }
  std::uint32_t middle(std::uint32_t a, std::uint32_t b) const;
  std::uint32_t split_edge(std::uint32_t a, std::uint32_t b);
  /// @brief Marks of the cell's edges, bit e of local edge e; `is_deep` where a part of a split edge or face is split.
  unsigned split_edges(const Cell& cell, bool& is_deep) const;
  bool needs_split(const Cell& cell, bool& has_changed);
  void split(const Cell& cell, std::vector<Cell>& into);
  void split_tet(const Cell& cell, std::vector<Cell>& into);

  int dimension_;
  std::vector<Point> points_;
  std::vector<double> size_;
  std::vector<Cell> cells_;
  std::unordered_map<EdgeKey, std::uint32_t> middle_of_;
};

}  // namespace delfront
