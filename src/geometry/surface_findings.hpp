// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/findings.hpp"
#include "delfront/surface_check.hpp"
#include "geometry/shells.hpp"
#include "geometry/surface.hpp"

namespace delfront {

// Each function looks for one family of things and appends what it finds; nothing found, nothing appended. Ids in
// places are those of the input's faces, counted from 0.

/// @brief "degenerate_triangles" and "duplicate_triangles": errors.
void find_bad_triangles(const Surface& surface, std::vector<Finding>& findings);

/// @brief "self_intersection", "overlapping_triangles", "t_junctions": errors, exact, pairs of triangles.
/// @par Cost  O(n log n + pairs of overlapping boxes)
void find_intersections(const Surface& surface, std::vector<Finding>& findings, Context& context);

/// @brief "degenerate_curves", "curves_through_facets", "crossing_curves", "points_on_facets", "points_on_curves":
/// errors, exact. Ids: edges of curves counted through from 0, vertices for points, faces of the input.
/// @par Cost  O(n log n + pairs of overlapping boxes); nothing without curves and points
void find_curve_defects(const Surface& surface, std::vector<Finding>& findings, Context& context);

/// @brief "open_edges": an error where the surface encloses nothing, else a warning; "encloses_nothing": an error.
/// @param shells  null where other errors forbid to compute them: then peeling decides
/// @return whether the surface encloses a region
bool find_openings(const Surface& surface, const SurfaceShells* shells, std::vector<Finding>& findings);

/// @brief Notes "non_manifold_edges", "pinched_vertices", "inconsistent_orientation", "non_orientable_shell".
void find_junctions(const Surface& surface, std::vector<Finding>& findings);

/// @brief Notes "components", "regions", "dangling_sheets".
void find_regions(const Surface& surface, const SurfaceShells& shells, std::vector<Finding>& findings);

/// @brief Warnings "sliver_triangles" (an angle under 1 degree), "small_dihedral_angles" (under 20 degrees on either
/// side of the surface), "thin_spots" (opposite facets nearer than half their mean edge, seen along the normal from the
/// centroid); fills the report's smallest angles.
void find_hard_places(const Surface& surface, const SurfaceShells* shells, SurfaceReport& report, Context& context);

/// @brief "(1.5, 2, 0)" @brief "1 edge", "7 edges"
std::string text_of(Point p);
std::string count_of(std::size_t count, const std::string& one, const std::string& many = "");

/// @brief Appends a place while there is room (kMaxPlaces).
void add_place(Finding& finding, Point at, std::vector<std::uint32_t> ids = {});
/// @brief Appends the outline of an edge, or of a triangle, while there is room (kMaxOutlines).
void add_edge_outline(Finding& finding, const Surface& surface, std::size_t edge);
void add_triangle_outline(Finding& finding, const Surface& surface, std::size_t t);
inline std::uint32_t face_id(const Surface& surface, std::size_t t) { return surface.model.input_face[TriangleId(t)]; }

}  // namespace delfront
