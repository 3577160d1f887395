// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/findings.hpp"
#include "delfront/model.hpp"

namespace delfront {

/// @brief A connected set of triangles (over shared edges).
struct SurfaceComponent {
  std::size_t num_triangles = 0;
  bool is_closed = false;    ///< every edge has two or more triangles, and a side is enclosed
  double signed_volume = 0;  ///< positive: triangles point outwards; of closed components
  double area = 0;
  int inside_of = -1;  ///< index of the innermost closed component around it, -1: none
  Box box;
};

/// @brief What a look at a surface gives: facts for `delfront info`, findings for `delfront check`.
struct SurfaceReport {
  std::size_t num_vertices = 0, num_triangles = 0, num_edges = 0;
  Box box;
  double area = 0, volume = 0;
  double min_edge = 0, max_edge = 0, mean_edge = 0;
  double min_angle_deg = 0;     ///< smallest corner angle of any triangle
  double min_dihedral_deg = 0;  ///< smallest angle between two neighbouring triangles, through the solid
  bool is_closed = false;       ///< every edge has exactly two triangles
  bool is_manifold = false;
  bool is_oriented = false;       ///< every edge is run once in each direction
  bool can_bound_volume = false;  ///< valid PLC, curves and points with it, that encloses at least one bounded region
  std::size_t reoriented = 0;     ///< triangles that were turned to make closed shells consistent
  std::vector<SurfaceComponent> components;
  std::string likely_unit;  ///< "m", "mm", "in", "" and why, e.g. "mm (longest side 355.6)"
  std::vector<Finding> findings;
};

/// @brief Everything that can be wrong with a surface, exactly: open edges, non-manifold edges and vertices,
/// orientation, duplicates, degenerate triangles, self-intersections (exact, over a BVH), nesting, thin spots; curves
/// and points that meet facets or each other outside of common vertices.
/// @par Cost  O(n log n + pairs that overlap in boxes)
SurfaceReport check_surface(const Model& model, Context& context);

/// @brief Turn the triangles of closed, orientable shells so that every shell is consistent and points outwards.
/// Shells that already are consistent keep their orientation (a hole's shell points inwards on purpose).
/// @return triangles turned
std::size_t orient_shells(Model& model, Context& context);

}  // namespace delfront
