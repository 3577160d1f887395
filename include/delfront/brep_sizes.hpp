// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "delfront/brep.hpp"
#include "delfront/geometry_sizes.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief Lengths of a geometry that do not change when it is turned, as the diagonal of its box does.
struct BrepExtent {
  double whole = 0;   ///< diameter of the smallest ball round it; of a box its diagonal
  double body = 0;    ///< the same without a far field that is part of the geometry; without one: the whole
  Point body_centre;  ///< of that ball
};

/// @brief By samples. A far field is the few largest faces, each eight times as large as all others together.
/// @par Cost  O(samples), some hundred a face
BrepExtent measure_extent(const Brep& brep);

/// @brief What smooth geometry asks for by itself: curvature, lines that come close, gaps (S9 to S11).
struct BrepSizes {
  CurvatureSizes curvature;  ///< its bounds are not used; hmin and hmax below are
  double line_cells = 1;     ///< between lines across a face; 0: not looked at
  double gap_cells = 1;      ///< between faces; 0: not looked at
  GapSizes::Side gap_side = GapSizes::Side::behind;
  double hmin = 0;                     ///< > 0: of all, where the next two say nothing else
  double line_hmin = 0, gap_hmin = 0;  ///< 0: hmin
  double hmax = 0;                     ///< > 0: what is not smaller gives no source
};

/// @brief A first, coarse grid of a Brep, to find sizes from. It has no crossings checked.
struct BrepLook {
  BrepExtent extent;
  Model grid;
  BrepGridReport report;  ///< with parameters
};

/// @brief Sides of a twentieth of the body's extent at most, growing away from it, and no side turns by over 40
/// degrees.
/// @throws as grid_brep()
BrepLook look_at_brep(const Brep& brep, Context& context);

/// @brief Sources on the true geometry, for build_source_size_field().
///
/// *Curvature*: of surfaces and edges, on pieces of the look's triangles that are cut until it is even on them.
/// *Lines*: from places on each edge, across each face it bounds, to the nearest edge that faces it; edges with a
/// common corner of over 15 degrees are no gap. *Gaps*: rays from places on faces along the normal and 30 degrees round
/// it, to the first face; one that faces them is the other side; faces with a common edge (or one face, folded) at over
/// 15 degrees are no gap. In sharper corners and wedges sizes go down to 4 hmin.
/// @throws UsageError  wishes out of range
/// @par Source  Löhner (2008), 3.2.8
GeometrySources find_brep_sizes(const Brep& brep, const BrepLook& look, const BrepSizes& wish, Context& context);

/// @brief What a surface grid has to reach (S13). Places where sides are about hmin already do not count.
struct BrepGoals {
  double deviation = std::numeric_limits<double>::infinity();  ///< of the grid from the surface
  double turn_deg = 180;                                       ///< between neighbours on one face
  double angle_deg = 20;  ///< of triangles, but for those by corners of faces that are sharper than 30 degrees
  double hmin = 0;
  int rounds = 4;  ///< of gridding at most
};

/// @brief How well a grid describes its geometry.
struct BrepAccuracy {
  struct Worst {
    double value = 0;
    Point at;
    std::size_t num_beyond = 0;  ///< over (angles: under) the goal
  };
  struct Patch {
    std::string name;
    std::size_t triangles = 0;
    double min_angle_deg = 180, largest_deviation = 0;
  };
  std::size_t triangles = 0, points = 0;
  Worst deviation, turn_deg;
  Worst angle_deg{180, {}, 0};  ///< the smallest, away from sharp corners
  double mean_deviation = 0;    ///< over triangles' middles, by area
  double min_angle_deg = 180;   ///< everywhere
  double mean_min_angle_deg = 0;
  std::vector<std::size_t> angles;  ///< smallest ones of triangles, by 5 degrees from 0 to 60
  double share_of_right_sides = 0;  ///< between 0.7 and 1.4 of the size at their middle
  double mean_side = 0;             ///< over the size at its middle
  std::vector<Patch> patches;
  std::vector<std::uint32_t> faces_beyond;  ///< of the Brep, rising: with places beyond the goals
  bool is_reached() const { return deviation.num_beyond + turn_deg.num_beyond + angle_deg.num_beyond == 0; }
};

/// @param report  of grid_brep(), with parameters
/// @param lowered  null, or gets places where sizes should be lower, and what they should be
/// @par Cost  O(triangles): some evaluations of the surface each
BrepAccuracy measure_brep_grid(const Brep& brep, const Model& grid, const BrepGridReport& report, const SizeField& size,
                               const BrepGoals& goals, BoundarySizes* lowered, const Context& context);

/// @brief All rounds of a surface grid.
struct BrepRounds {
  std::vector<BrepAccuracy> rounds;  ///< the last is that of the grid
  BrepGridReport grid;
  std::string stopped;  ///< why there were no more rounds though the goals are not reached; empty: they are
  const BrepAccuracy& last() const { return rounds.back(); }
};

/// @brief Grid, measure, lower sizes where the goals are missed, grid again (S13).
///
/// Ends when the goals are reached, after goals.rounds grids, or where a round helps no more; that is no error.
/// @throws as grid_brep(), where no round has a grid
/// @par Source  Löhner (2008), 3.2.8
Model grid_brep_to_goals(const Brep& brep, std::shared_ptr<const SizeField> size, const BrepOptions& options,
                         const BrepGoals& goals, BrepRounds& report, Context& context);

}  // namespace delfront
