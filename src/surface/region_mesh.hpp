// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delfront/size_field.hpp"
#include "surface/front.hpp"
#include "surface/linked_triangles.hpp"
#include "surface/support.hpp"

namespace delfront {

/// @brief Triangles of one region that are edited: flips, smoothing, splits, collapses, each guarded by the normals of
/// the surface beneath. Sides of the border stay, as do its points.
class RegionMesh {
 public:
  RegionMesh(const SurfaceSupport& support, RegionGrid grid);

  /// @brief Flip sides whose opposite angles are over 180 degrees together, to the end or for some passes.
  /// @return flips done
  std::size_t flip_to_delaunay(int passes);
  /// @brief Move each inner point towards the middle of its neighbours and put it on the surface, where the smallest
  /// angle round it rises. @return points moved
  std::size_t smooth(int passes);

  /// @brief Divide a side at a point of the grid that nothing uses yet.
  void split(std::uint32_t side, std::uint32_t p) { links_.split(side, p); }
  std::uint32_t add_point(Point at, std::uint32_t foot);
  /// @brief Move point v into its neighbour u, where no triangle turns over and the topology stays. A point of the
  /// border moves along the border alone.
  /// @param longest  new sides may be no longer
  bool collapse(std::uint32_t v, std::uint32_t u, double longest = std::numeric_limits<double>::infinity());

  std::size_t num_sides() const { return links_.num_sides(); }
  bool is_alive(std::uint32_t side) const { return !links_.is_gone(side / 3); }
  bool is_inner(std::uint32_t p) { return links_.ring(p, ring_); }
  std::size_t num_points() const { return grid_.points.size(); }
  const std::vector<Point>& points() const { return grid_.points; }
  bool is_border(std::uint32_t side) const { return links_.other(side) == kNone; }
  std::array<std::uint32_t, 2> ends(std::uint32_t side) const {
    return {links_.point(side), links_.point(links_.next(side))};
  }
  Point place(std::uint32_t p) const { return grid_.points[p]; }
  std::uint32_t foot(std::uint32_t p) const { return grid_.triangle_of_point[p]; }
  /// @brief Of the triangles on both sides.
  Point normal(std::uint32_t side) const;
  /// @brief Neighbours of a point of the border along it; the point itself where it is gone.
  std::array<std::uint32_t, 2> along_border(std::uint32_t p);

  /// @brief The grid without triangles that are gone and points that nothing uses.
  RegionGrid take();

 private:
  static constexpr std::uint32_t kNone = LinkedTriangles::kNone;

  bool may_collapse(std::uint32_t v, std::uint32_t u, double longest);
  bool flip(std::uint32_t side);
  bool smooth_point(std::uint32_t p);
  double worst_of_ring(Point at) const;
  bool is_joined(std::uint32_t p, std::uint32_t q);
  Point at(std::uint32_t p) const { return grid_.points[p]; }
  Point ring_normal() const;

  const SurfaceSupport& support_;
  RegionGrid grid_;  ///< without its triangles until take()
  LinkedTriangles links_;
  TriangleRing ring_;
  Point ring_normal_;
};

/// @brief Quality of a triangle: twice its area over the sum of squared sides, scaled to 1 for equal sides; signed by
/// the normal.
double triangle_quality(Point a, Point b, Point c, Point normal);

}  // namespace delfront
