// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "delfront/point.hpp"
#include "mesh/cell_shape.hpp"

namespace delfront {

/// @brief Centre and area vector of a facet.
struct FacetGeometry {
  Point centre, area;
};
/// @brief Centre and volume of a cell.
struct CellGeometry {
  Point centre;
  double volume = 0;
};

/// @brief As OpenFOAM's primitiveMeshTools: a triangle's own; else the area-weighted mean over the triangles between
/// each edge and the mean of the corners.
FacetGeometry facet_geometry(std::span<const Point> corners);
/// @brief As OpenFOAM's primitiveMeshTools: volume-weighted mean over the pyramids between each facet and the mean of
/// the facets' centres; for a tetrahedron that is the mean of its corners.
CellGeometry cell_geometry(std::span<const Point> corners, const CellShape& shape,
                           std::span<const FacetGeometry> facets);

/// @brief Shape of one cell; angles in degrees.
struct CellQuality {
  double min_angle = 0, max_angle = 0;  ///< dihedral angles in 3-D, corner angles in 2-D
  double mean_ratio = 0, radius_ratio = 0, aspect_ratio = 0;
};
/// @brief Smallest and largest angle between neighbouring facets, inside, for any 3-D cell.
void measure_dihedrals(const CellShape& shape, std::span<const FacetGeometry> facets, CellQuality& quality);
/// @brief Corner angles of a polygon in space, and of a triangle the ratios too.
CellQuality measure_polygon(std::span<const Point> corners);

/// @brief Angle between the line of two cell centres and a facet's area vector, degrees (OpenFOAM's non-orthogonality).
double nonorthogonality(Point owner, Point neighbour, Point area);
/// @brief OpenFOAM's face skewness of an inner facet.
double inner_skewness(std::span<const Point> corners, const FacetGeometry& facet, Point owner, Point neighbour);
/// @brief OpenFOAM's face skewness of a boundary facet.
double boundary_skewness(std::span<const Point> corners, const FacetGeometry& facet, Point owner);

}  // namespace delfront
