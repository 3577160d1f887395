// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "delfront/mesh.hpp"
#include "refine/mid_points.hpp"
#include "refine/true_geometry.hpp"

namespace delfront {

/// @brief A new point that belongs to the geometry: where it would stand without it, and where it should.
struct MovedPoint {
  std::uint32_t point;
  Point middle, target;
  bool on_feature;
  int halves = 2;  ///< of the way to the target that it has gone: 2, 1 or 0

  Point place() const { return halves == 2 ? target : middle + (0.5 * halves) * (target - middle); }
};

/// @brief What became of the new points of the boundary.
struct BoundaryPlaces {
  std::vector<MovedPoint> moved;            ///< ascending; those that are there already are left out
  std::size_t num_looked_at = 0;            ///< whose group the geometry may have
  std::vector<std::uint32_t> out_of_reach;  ///< of these, ascending: nothing of the geometry within half of their edge
};

/// @brief Where the new points of boundary faces (in the plane: lines) and of curves belong.
/// @param points  of the finer grid: the new ones in the middle
BoundaryPlaces find_boundary_places(const Mesh& coarse, const MidPoints& mids, const Array<VertexId, Point>& points,
                                    const TrueGeometry& geometry, int threads);

/// @brief Entities of the finer grid's vertices: those of old points stay; new points get that of the cell, face or
/// line of the lowest dimension that they lie in, as its other vertices tell.
void carry_entities(const Mesh& coarse, const MidPoints& mids, Mesh& fine, int threads);

}  // namespace delfront
