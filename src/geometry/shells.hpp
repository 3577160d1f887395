// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "geometry/surface.hpp"

namespace delfront {

inline constexpr std::uint32_t kNoShell = 0xffffffffu;

/// @brief What a region of space sees of one component of the surface: a connected set of sides of triangles.
struct Shell {
  std::uint32_t component = 0;
  bool is_outer = false;  ///< seen from outside of the component; every other shell encloses a region
  double volume = 0;      ///< enclosed, model units cubed; of an outer shell minus the sum of the component's others
  std::size_t num_sides = 0;
};

/// @brief Components of a valid surface, their shells, and which component lies in which shell.
///
/// A connected surface with s shells cuts space into s parts, so a component encloses s - 1 regions. Each region is
/// bounded by one inner shell and by the outer shells of the components that lie in it.
struct SurfaceShells {
  std::vector<std::uint32_t> component;      ///< by triangle, over shared edges
  std::vector<std::uint32_t> shell_of_side;  ///< 2 t: the side the normal of triangle t points to, 2 t + 1: the other
  std::vector<Shell> shells;
  std::vector<std::uint32_t> parent_shell;  ///< by component: the innermost inner shell around it, or kNoShell

  std::uint32_t front(std::size_t t) const { return shell_of_side[2 * t]; }
  std::uint32_t back(std::size_t t) const { return shell_of_side[2 * t + 1]; }
  /// @brief Regions on both sides are the same: a sheet, a baffle.
  bool is_sheet(std::size_t t) const { return front(t) == back(t); }
  /// @brief Bounded regions: inner shell and volume without the components inside it.
  struct Region {
    std::uint32_t shell = kNoShell;
    double volume = 0;
  };
  std::vector<Region> regions() const;
};

/// @brief Components over shared edges; triangles without edges are of none (kNoTriangle).
std::vector<std::uint32_t> find_components(const Surface& surface, std::uint32_t& num_components);

/// @brief Components, shells and nesting, all decided by exact predicates.
/// @pre the surface is a PLC: no triangle degenerate, doubled or crossing another
/// @par Cost  O(n log n + components * triangles on one ray)
SurfaceShells find_shells(const Surface& surface, Context& context);

/// @brief The half-edges of an edge in the order in which their triangles come up when turning by the right-hand rule
/// about the edge, from the end with the lower id to the other.
/// @pre no two of the triangles overlap
std::vector<std::uint32_t> sort_about_edge(const Surface& surface, std::size_t edge);

/// @brief Does the half-edge run from the end with the lower id to the other? If so its triangle's front is the side
/// that comes next when turning about the edge.
inline bool runs_up(const Surface& surface, std::uint32_t half_edge) {
  return surface.start(half_edge) == surface.edges.ends(surface.edges.edge_of(half_edge))[0];
}

/// @brief By triangle: must it be turned so that every closed component is consistent? (see orient_shells)
std::vector<bool> find_triangles_to_turn(const Surface& surface, const SurfaceShells& shells);

}  // namespace delfront
