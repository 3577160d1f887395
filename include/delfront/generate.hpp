// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/delaunay.hpp"
#include "delfront/findings.hpp"
#include "delfront/grid_check.hpp"
#include "delfront/mesh.hpp"
#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "delfront/refine_grid.hpp"
#include "delfront/size_field.hpp"
#include "delfront/surface_check.hpp"
#include "delfront/surface_grid.hpp"

namespace delfront {

/// @brief What boundary recovery did (T2); "left" is what could not be undone, each with its place.
struct RecoveryReport {
  std::size_t missing_edges = 0, missing_faces = 0;  ///< of the Delaunay tetrahedrization of the surface's vertices
  std::size_t steiner_points = 0;                    ///< put on surface edges on the way
  std::size_t steiner_moved = 0;                     ///< moved into the volume again, so that the surface is unchanged
  std::size_t steiner_left = 0;                      ///< still on the surface: its triangles there are subdivided
  std::size_t curve_edges = 0;                       ///< edges of the model's curves in the regions ...
  std::size_t curve_edges_inside = 0;                ///< ... of these: no edges of triangles
  std::size_t curve_edges_split = 0;                 ///< ... of these: kept as collinear pieces
  std::size_t curve_points_left = 0;                 ///< still on curves inside, where they divide edges
  std::size_t embedded_points = 0;                   ///< on no triangle and no curve
  std::vector<Place> left;
  std::vector<std::string> left_why;  ///< one a place of `left`: why its triangles had to stay divided
};

/// @brief What refinement did (T3).
struct RefineReport {
  std::size_t points_inserted = 0;
  std::size_t points_in_core = 0;  ///< of these, on the lattice of the uniform core
  std::size_t candidates = 0;      ///< proposed, before the filters
  std::size_t rounds = 0;
  KernelCounts kernel;
};

/// @brief What an advancing front did (F1-F17), in the plane or in the volume. Embedded edges and points are in its
/// grid; those that no sweep reached are in the cavities that are closed by constrained Delaunay.
struct FrontReport {
  std::size_t sides_processed = 0;  ///< edges or faces of the front, some more than once
  std::size_t cells = 0, points = 0;
  std::size_t rounds = 0, sweeps = 0;
  std::size_t sides_left = 0;          ///< by the last sweep
  std::size_t cavities = 0;            ///< closed ones that they made
  std::size_t cells_emptied = 0;       ///< round these and embedded edges in them, to be filled anew ...
  std::size_t cells_refilled = 0;      ///< ... by cells to one point in each
  std::size_t cavities_by_stars = 0;   ///< others of them, by cells to several points
  std::size_t cavities_left = 0;       ///< even then, closed by constrained Delaunay ...
  std::size_t closed_by_delaunay = 0;  ///< ... with so many cells
  std::vector<Place> delaunay_places;  ///< volume: one in each of these cavities, widest first; at most kMaxPlaces
  double crossing_share = 0;           ///< of the time of steps, in crossing tests (F12)
  std::string gave_up;                 ///< why there is no front; refinement took its place
};

/// @brief What improvement did (T5).
struct ImproveReport {
  std::size_t passes = 0;
  std::size_t face_swaps = 0, edge_swaps = 0, points_moved = 0, points_removed = 0, points_added = 0;
  double min_dihedral_before_deg = 0, min_dihedral_after_deg = 0;
  std::size_t below_goal = 0;         ///< cells still under the goal …
  std::size_t below_goal_forced = 0;  ///< … of these: all four vertices on the boundary
};

/// @brief What gridding with larger sizes and halving every edge afterwards did (F19).
struct LevelsReport {
  std::size_t coarse_cells = 0, coarse_points = 0;
  RefineGridReport refined;  ///< its levels: 0 where the job asks for none
};

struct Report {
  SurfaceReport surface;
  SurfaceGridReport surface_grid;  ///< where the surface was gridded anew
  RecoveryReport recovery;
  RefineReport refine;
  FrontReport front;
  ImproveReport improve;  ///< of the coarse grid, where there are levels
  LevelsReport levels;
  QualityReport quality;
  std::optional<SizeFit> size_fit;  ///< where output.report is a page, sizes are not stretched, and there is a grid
  std::vector<std::string> warnings;
};

struct Outcome {
  Mesh mesh;
  Report report;
};

/// @brief The whole run on one screen: a model to a tetrahedral grid whose boundary is the model's triangles.
/// @param asked  a field that lowers the sizes which come from the boundary and options.size; null: none. Ways to ask
/// in
///               options.size that need more than the boundary (sources, formulas, files, …) are built into such a
///               field by build_job_size_field.
/// @param geometry  where options.refine.levels is not 0: on whose surface new boundary points are put; null: the
/// given model's, which moves them only where options.surface makes a coarser surface of it
/// @throws InputError    the surface cannot bound a volume (places and reasons)
/// @throws MeshingError  gridding failed after all recovery steps
/// @throws LimitError, Cancelled
/// @par Threads  the same grid for any number
Outcome generate(Model model, const Options& options, Context& context,
                 std::shared_ptr<const SizeField> asked = nullptr, const Model* geometry = nullptr);

}  // namespace delfront
