// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "delfront/point.hpp"

namespace delfront {

/// @brief How many tetrahedra or facets are measured at a time.
inline constexpr int kLanes = 4;
/// @brief One value a lane.
struct alignas(32) LaneValues {
  double lane[kLanes];
};
/// @brief One point a lane.
struct LanePoints {
  LaneValues x, y, z;
  void set(int lane, Point p) {
    x.lane[lane] = p.x;
    y.lane[lane] = p.y;
    z.lane[lane] = p.z;
  }
};

/// @brief What measure_quality says of a tetrahedron; angles in degrees, lengths squared.
struct TetLanes {
  LaneValues volume, min_dihedral, max_dihedral, mean_ratio, radius_ratio, aspect_ratio, openfoam_aspect;
  LaneValues shortest_squared, longest_squared;
};
/// @brief Four tetrahedra at once. Each lane's values depend on that lane alone.
void measure_tets(const LanePoints (&corners)[4], TetLanes& result);

/// @brief What measure_quality says of a facet between two tetrahedra.
struct FacetLanes {
  LaneValues cosine;    ///< of the angle between the line of centres and the normal, in [-1, 1]
  LaneValues nonortho;  ///< that angle, degrees
  LaneValues skewness;
  LaneValues volume_ratio;  ///< infinite where one of them has no volume
};
/// @brief Four facets at once, each between two tetrahedra.
/// @param[in] points  the facet's corners, outward from the owner; the apex of the owner; the apex of the neighbour
void measure_tet_facets(const LanePoints (&points)[5], FacetLanes& result);

}  // namespace delfront
