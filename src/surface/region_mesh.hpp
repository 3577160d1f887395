// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delfront/size_field.hpp"
#include "surface/front.hpp"
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

  RegionGrid take();
  double smallest_angle() const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Ring {
    std::vector<std::uint32_t> triangles, points;  ///< in order round the point, anticlockwise
  };

  void link();
  bool flip(std::uint32_t side);
  void bond(std::uint32_t side, std::uint32_t other);
  bool ring(std::uint32_t p);
  bool smooth_point(std::uint32_t p);
  double worst_of_ring(Point at) const;
  bool is_joined(std::uint32_t p, std::uint32_t q);
  std::uint32_t point(std::uint32_t side) const { return grid_.triangles[side / 3][side % 3]; }
  Point at(std::uint32_t p) const { return grid_.points[p]; }
  static std::uint32_t next(std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
  static std::uint32_t before(std::uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }
  Point ring_normal() const;

  const SurfaceSupport& support_;
  RegionGrid grid_;
  std::vector<std::uint32_t> other_;    ///< by side 3 t + k (from corner k to k + 1): the same side of its neighbour
  std::vector<std::uint32_t> side_at_;  ///< by point: a side that begins there; of the border: its first one
  Ring ring_;
  Point ring_normal_;
};

/// @brief Quality of a triangle: twice its area over the sum of squared sides, scaled to 1 for equal sides; signed by
/// the normal.
double triangle_quality(Point a, Point b, Point c, Point normal);

}  // namespace delfront
