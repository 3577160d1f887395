// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/point.hpp"

namespace delfront {

/// @brief A flat facet of any shape: rings around it and in it, edges and points inside, seeds of holes.
struct FacetOutline {
  std::vector<Point> points;
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< of the rings and inside, in any order; two
                                                    ///< equal points are no edge, and left out
  std::vector<Point> holes;                         ///< a place in each
  Point normal;                                     ///< from which side it is seen; of any length but 0
};

struct FacetTriangles {
  /// An edge of the facet, or the part of one between points on it.
  struct Piece {
    std::uint32_t a, b, edge;
  };
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Piece> pieces;
};

/// @brief Constrained Delaunay triangles of what a facet's edges enclose, anticlockwise seen from its normal.
///
/// Seen along the axis that the normal is nearest to, so that the facet may be warped a little. Every edge is a side of
/// a triangle, or a row of sides where points lie on it; every point is a corner.
/// @pre coordinates are finite and at most 2^100
/// @throws InputError  edges that cross, equal points, nothing enclosed, an edge or a point outside of the rings or in
/// a hole
/// @par Cost  O(n log n)
FacetTriangles triangulate_facet(const FacetOutline& facet, Context& context);

}  // namespace delfront
