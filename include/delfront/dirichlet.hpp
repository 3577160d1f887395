// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "delfront/point.hpp"

namespace delfront {

/// @brief The Dirichlet (Voronoi) tessellation of a point set: cell i is what lies nearer to point i than to any other.
///
/// Faces are convex polygons, each stored once for the two cells it divides; neighbouring faces and cells have their
/// vertices in common, so the bounded cells form a conforming grid.
struct DirichletCells {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<Point> vertices;                           ///< circumcentres; where clipped, places on the box too
  std::vector<std::uint64_t> face_offsets;               ///< num_faces + 1 places in face_vertices
  std::vector<std::uint32_t> face_vertices;              ///< in order round each face
  std::vector<std::array<std::uint32_t, 2>> face_cells;  ///< normal from the first to the second; kNone: the box
  std::vector<std::uint64_t> cell_offsets;               ///< num_points + 1 places in cell_faces
  std::vector<std::uint32_t> cell_faces;                 ///< faces of each cell
  std::vector<double> volumes;                           ///< one a cell; infinite for unbounded ones
  std::vector<std::uint8_t> is_unbounded;                ///< one a cell; of such cells only the bounded faces are held
  /// (point, the lowest one at the same place): the cell of the former is empty.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;

  std::size_t num_cells() const { return volumes.size(); }
  std::size_t num_faces() const { return face_cells.size(); }
  std::span<const std::uint32_t> face(std::size_t f) const {
    return {face_vertices.data() + face_offsets[f], face_vertices.data() + face_offsets[f + 1]};
  }
  std::span<const std::uint32_t> faces_of(std::size_t cell) const {
    return {cell_faces.data() + cell_offsets[cell], cell_faces.data() + cell_offsets[cell + 1]};
  }
};

/// @brief Dirichlet tessellation (T6; eq. 3.30) by the dual of the Delaunay tetrahedrization.
///
/// Circumcentres of tets on one sphere are one vertex (decided exactly), so that a lattice has cubes for cells.
/// Without a box the cells of points on the convex hull are unbounded: marked, volume infinite. With one, all cells are
/// cut off at its sides; points may lie in it, on its sides, or outside (their cells are what is left, perhaps
/// nothing). Coordinates of vertices are rounded: a face is plane, and a cell convex, to about 1e-14 of the box; cut
/// vertices nearer than that to a side are moved onto it.
/// @throws InputError  a box that is empty, not finite, or over 2^90; without a box as delaunay(); with one, no points,
///                     or a coordinate not finite or over 2^90
/// @throws LimitError  as delaunay()
/// @par Threads  context.threads for the tetrahedrization, one for the rest; the same result for any number
/// @par Cost     about 10 microseconds a point
/// @par Source   Dirichlet (1850), Voronoi (1908); Löhner (2008), eq. 3.30
DirichletCells dirichlet(std::span<const Point> points, Context& context, const std::optional<Box>& box = {});

/// @brief The bounded cells as polyhedra, with cell fields "point" (its number) and "volume": write_mesh() makes VTU of
/// it.
Mesh mesh_of(const DirichletCells& cells);

}  // namespace delfront
