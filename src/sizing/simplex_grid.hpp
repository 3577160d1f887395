// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "sizing/packed_tree.hpp"

namespace delfront {

/// @brief The cells of a grid as triangles (in the plane) or tetrahedra, with their neighbours and boundary.
struct SimplexGrid {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  using Cell = std::array<std::uint32_t, 4>;

  int dimension = 3;
  std::vector<Point> points;                           ///< numbered as in the mesh; in the plane z = 0
  std::vector<Cell> cells;                             ///< positive, in curve order; in the plane the last is kNone
  std::vector<std::uint32_t> rank;                     ///< of each cell, in the order in which the mesh has them
  std::vector<Cell> neighbours;                        ///< across from the vertex of that place; kNone: boundary
  std::vector<std::array<std::uint32_t, 3>> boundary;  ///< faces with one cell; edges repeat their second vertex
  bool has_crowded_faces = false;                      ///< some face has more than two cells

  std::size_t num_corners() const { return static_cast<std::size_t>(dimension) + 1; }
  std::span<const std::uint32_t> corners(std::size_t cell) const { return {cells[cell].data(), num_corners()}; }
  /// @brief Area or volume of a cell.
  double measure(std::size_t cell) const;
  /// @brief Gradients of the barycentric coordinates of a cell.
  std::array<Point, 4> gradients(std::size_t cell) const;
  /// @brief Barycentric coordinates, exact at none but the first vertex; sum 1.
  std::array<double, 4> barycentric(std::size_t cell, Point p) const;
  Box box_of(std::size_t cell) const;
};

/// @brief Split all cells that fill space into simplices, by one rule over the grid: a cell from its vertex of the
/// lowest number, a face likewise, so that neighbours agree. Cells without volume are left out.
/// @param name  of the grid, for messages
/// @throws InputError  no cells that fill space: what there is instead
/// @par Cost  O(n log n)
SimplexGrid build_simplex_grid(const Mesh& mesh, const std::string& name, Context& context);

/// @brief Which cells each vertex has: offsets and values; by rank, which turning the grid does not change.
struct VertexCells {
  std::vector<std::uint32_t> offsets, cells;
  std::span<const std::uint32_t> operator[](std::size_t vertex) const {
    return {cells.data() + offsets[vertex], offsets[vertex + 1] - offsets[vertex]};
  }
};
VertexCells vertex_to_cells(const SimplexGrid& grid);

/// @brief Vertices joined to each by an edge: offsets and values.
struct VertexNeighbours {
  std::vector<std::uint32_t> offsets, ends;
  explicit VertexNeighbours(const SimplexGrid& grid);
  std::span<const std::uint32_t> operator[](std::size_t vertex) const {
    return {ends.data() + offsets[vertex], offsets[vertex + 1] - offsets[vertex]};
  }
};

/// @brief Every edge once, smaller vertex first, ascending.
std::vector<std::array<std::uint32_t, 2>> edges_of(const SimplexGrid& grid);

/// @brief Weights of the point of a triangle that is nearest to p, and that point; a segment repeats its end.
struct OnFace {
  std::array<double, 3> weight;
  Point at;
};
OnFace nearest_on_face(Point p, Point a, Point b, Point c);

}  // namespace delfront
