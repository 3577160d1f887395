// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "delfront/planar.hpp"

namespace delfront {

/// @brief A rectangle along the axes.
struct Box2 {
  Point2 low, high;
};

/// @brief A regular triangulation, and the points that are in no triangle since heavier ones hide them, rising.
struct RegularTriangulation2 {
  Triangulation2 triangulation;
  std::vector<std::uint32_t> hidden;
};

/// @brief Regular (power, weighted Delaunay) triangulation: the lower hull of the points lifted to |p|^2 - weight (T4).
///
/// As regular() in space: exact, ties decided by the points' coordinates alone. Of points at one place the lowest of
/// the heaviest is used, the others are duplicates.
/// @param weights  one a point, in square units; |weight| <= 2^200
/// @throws InputError  fewer than three points, all on one line, a coordinate not finite or over 2^90, a weight that is
///                     not finite or too large; not as many weights as points
/// @throws LimitError  as regular()
/// @par Cost     about 4 microseconds a point
RegularTriangulation2 regular2(std::span<const Point2> points, std::span<const double> weights, Context& context);

/// @brief The Dirichlet (Voronoi) tessellation of a point set in the plane: convex polygons, anticlockwise.
struct DirichletCells2 {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<Point2> vertices;              ///< circumcentres; where clipped, places on the box too
  std::vector<std::uint64_t> cell_offsets;   ///< num_points + 1 places in the next two
  std::vector<std::uint32_t> cell_vertices;  ///< round each cell; none for unbounded ones
  std::vector<std::uint32_t>
      cell_neighbours;                     ///< the point across the side from this vertex to the next; kNone: the box
  std::vector<double> areas;               ///< one a cell; infinite for unbounded ones
  std::vector<std::uint8_t> is_unbounded;  ///< one a cell
  /// (point, the earlier one at the same place): the cell of the former is empty.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;

  std::size_t num_cells() const { return areas.size(); }
  std::span<const std::uint32_t> cell(std::size_t i) const {
    return {cell_vertices.data() + cell_offsets[i], cell_vertices.data() + cell_offsets[i + 1]};
  }
};

/// @brief Dirichlet tessellation in the plane (T6; eq. 3.30); as dirichlet() in space.
/// @throws InputError  a box that is empty, flat, not finite, or over 2^90; without a box as delaunay2(); with one, no
///                     points, or a coordinate not finite or over 2^90
/// @par Cost     about 2 microseconds a point
DirichletCells2 dirichlet2(std::span<const Point2> points, Context& context, const std::optional<Box2>& box = {});

/// @brief The bounded cells as polygons of a 2-D mesh, with cell fields "point" (its number) and "area".
Mesh mesh_of(const DirichletCells2& cells);

}  // namespace delfront
