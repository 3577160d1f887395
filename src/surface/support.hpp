// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "spatial/bvh.hpp"
#include "surface/line_points.hpp"
#include "surface/parts.hpp"

namespace delfront {

/// @brief The given triangles of one region: what new points are put on, with normals that vary smoothly over them.
class SurfaceSupport {
 public:
  SurfaceSupport(const SurfaceParts& parts, const SurfaceRegion& region);

  struct Foot {
    std::uint32_t triangle = kNoTriangle;  ///< of the region's
    Point at, normal;                      ///< the normal is interpolated from those at corners
    double distance = std::numeric_limits<double>::infinity();
    bool found() const { return triangle != kNoTriangle; }
  };
  static constexpr double kAgree = 0.5;  ///< cosine of the largest angle between normals that mean the same sheet

  /// @brief The nearest place, nearer than `limit`, where the surface faces as `normal` does.
  Foot project(Point p, Point normal, double limit = std::numeric_limits<double>::infinity()) const;
  /// @brief The same, from the triangle of a place near by: the place that lies right under p on the same sheet, where
  /// a short walk finds it.
  Foot project(Point p, Point normal, std::uint32_t near, double limit) const;

  std::size_t size() const { return normal_.size(); }
  const std::array<Point, 3>& corners(std::uint32_t t) const { return tree_.corners(t); }
  Point normal(std::uint32_t t) const { return normal_[t]; }
  /// @brief Euler characteristic of the region, closed: both sides of lines that run through it are one.
  long euler() const { return euler_; }
  double area() const { return area_; }
  double mean_side() const { return mean_side_; }

 private:
  void link(const SurfaceParts& parts, const SurfaceRegion& region);
  Foot foot(std::uint32_t t, Point p) const;
  std::uint32_t walk(Point p, std::uint32_t from) const;

  TriangleTree tree_;
  std::vector<Point> normal_;
  std::vector<std::array<Point, 3>> corner_normal_;
  std::vector<std::array<std::uint32_t, 3>> neighbour_;  ///< over side k to k + 1, or kNoTriangle
  long euler_ = 0;
  double area_ = 0, mean_side_ = 0;
};

/// @brief The border of a region in new points, as the front starts from it. Points are numbered within the region.
struct RegionBorder {
  std::vector<std::uint32_t> point;  ///< of LinePoints
  std::vector<Point> at;
  std::vector<std::array<std::uint32_t, 2>> side;  ///< the region lies to the left
  std::vector<Point> side_normal;
  std::vector<Point> normal;   ///< by point
  std::vector<bool> is_vague;  ///< by point: the normals there differ much, the mean says little
};

RegionBorder find_border(const SurfaceParts& parts, const SurfaceRegion& region, const LinePoints& lines,
                         const LineDivision& division);

}  // namespace delfront
