// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "delfront/model.hpp"

namespace delfront {

struct RefineGridOptions {
  int levels = 1;                 ///< times every edge is halved, at least 1
  const Model* model = nullptr;   ///< the true geometry, in the grid's units; null: new points stay in the middle
  double feature_angle_deg = 40;  ///< edges of the grid and of the model that turn by more are features
  /// Of the volume that a child cell has, at each corner, with points in the middle, this much must be left when they
  /// are on the geometry: else they go back. 0: positive is enough.
  double least_volume_share = 0.25;
};

/// @brief What refine_grid did, over all levels.
struct RefineGridReport {
  int levels = 0;
  std::size_t num_points = 0, num_cells = 0;     ///< of the finest grid; cells of the highest dimension
  std::size_t points_on_surface = 0;             ///< new points put on triangles of the model …
  std::size_t points_on_features = 0;            ///< … and on its feature edges and curves
  std::size_t halved = 0, reversed = 0;          ///< of all these: only halfway there; back in the middle
  std::vector<Place> reversed_places;            ///< of both; ids: the point. At most kMaxPlaces
  double largest_move = 0;                       ///< model units
  std::size_t boundary_points = 0;               ///< new points that were looked for on the model …
  std::size_t out_of_reach = 0;                  ///< … and have nothing of it within half the length of their edge
  double farthest = 0;                           ///< distance of the model from one of those, among the farthest …
  Point farthest_at;                             ///< … and that point
  std::vector<std::string> groups_not_in_model;  ///< boundary groups whose points stay in the middle for their name
};

/// @brief Halve every edge: each cell becomes cells of half its size, conforming to its neighbours (F19).
///
/// A line becomes 2, a triangle or a quad 4, a hexahedron or a prism 8, a tetrahedron 8 (the inner ones around the
/// shortest diagonal, as the points finally stand), a pyramid 6 pyramids and 4 tetrahedra. The children stand in the
/// order of their parents. Old points keep their numbers and places; after them come the middles of edges, ordered by
/// their lower, then their higher end, then those of quads, then those of cells. Groups, names, kinds, entities of
/// vertices and the fields of cells are those of the parents; fields of vertices are interpolated linearly. A pyramid's
/// tetrahedra take its values of a cell field of the same name, NaN where only one of the two blocks has that field.
///
/// With a model, new points of boundary faces go to the nearest place of its triangles: of the patches that are called
/// like the group of the faces; of all where no group is called like a patch (but for far fields, symmetry planes and
/// the like). New points of feature edges (beyond the feature angle, between groups, where other than two faces meet,
/// on curves) go to the nearest feature edge or curve of the model, where one runs alike within half the edge's length;
/// else to the surface. In the plane, lines go to the model's curves. Where a child would be inverted or squashed, the
/// points of it that were moved go half the way back, then all of it; so a valid grid stays valid.
/// @param mesh  a valid grid (see check()): in the plane, in space, or a surface
/// @throws UsageError    levels below 1, options out of range
/// @throws InputError    polygons or polyhedra; stored faces or lines that no cell has; a model out of a plane grid's
/// plane
/// @throws MeshingError  a cell so warped or flat that its children cannot be positive with points in the middle
/// @throws LimitError    context.max_cells, or more points than 2^32 - 2
/// @par Threads  the same bytes for any number
/// @par Cost  O(new cells); peak memory is that of both grids and 4 bytes an edge
Mesh refine_grid(const Mesh& mesh, const RefineGridOptions& options, RefineGridReport& report, Context& context);

/// @brief What of the model did not take effect, in sentences.
/// @param geometry  what to call the model
std::vector<std::string> warnings_of(const RefineGridReport& report, const std::string& geometry);

/// @brief Cells of the highest dimension that so many levels make of a grid.
std::size_t num_cells_after(const Mesh& mesh, int levels);

/// @brief Lines in the plane as a model whose curves are called like the lines' groups: the geometry of a plane grid.
/// @param stem  name of lines without a group
Model model_of_lines(const Mesh& lines, const std::string& stem);

}  // namespace delfront
