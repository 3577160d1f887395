// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

#include "delfront/metric.hpp"
#include "delfront/point.hpp"

namespace delfront {

/// @brief A symmetric 3 by 3 matrix.
struct Symmetric3 {
  double xx = 1, xy = 0, xz = 0, yy = 1, yz = 0, zz = 1;

  Point operator*(const Point& p) const {
    return {xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z, xz * p.x + yz * p.y + zz * p.z};
  }
  Symmetric3 operator+(const Symmetric3& o) const {
    return {xx + o.xx, xy + o.xy, xz + o.xz, yy + o.yy, yz + o.yz, zz + o.zz};
  }
  Symmetric3 scaled(double f) const { return {f * xx, f * xy, f * xz, f * yy, f * yz, f * zz}; }
  double determinant() const { return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz); }
  Symmetric3 inverse() const {
    return Symmetric3{yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy,
                      xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy}
        .scaled(1 / determinant());
  }
  double norm() const { return std::sqrt(xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz)); }
};

/// @brief The root of a metric: maps an edge of the wanted length, in any direction, to one of length 1.
inline Symmetric3 root_of(const Metric& metric) {
  const MetricAxes axes = metric_axes(metric);
  Symmetric3 root{0, 0, 0, 0, 0, 0};
  for (unsigned i = 0; i < 3; ++i) {
    const Point& e = axes.direction[i];
    root = root + Symmetric3{e.x * e.x, e.x * e.y, e.x * e.z, e.y * e.y, e.y * e.z, e.z * e.z}.scaled(
                      std::sqrt(axes.value[i]));
  }
  return root;
}

/// @brief Side of the cube with the volume that one of size 1 by 1 by 1 in the metric has. @param root  of the metric
inline double mean_size(const Symmetric3& root) { return 1 / std::cbrt(root.determinant()); }

/// @brief Space as a face of the front sees it (F7.1): stretched about an origin so that the wanted length is one and
/// the same in all directions, by a matrix of determinant 1. Without directions nothing is changed, bit for bit.
///
/// What is good, near or long is measured in it; what is valid is decided in space itself.
class FrontFrame {
 public:
  FrontFrame() = default;
  /// @param root  of the metric, times any factor
  FrontFrame(const Point& origin, const Symmetric3& root)
      : is_stretched_(true), origin_(origin), to_(root.scaled(mean_size(root))), from_(to_.inverse()) {}

  bool is_stretched() const { return is_stretched_; }
  /// @brief Of differences of places.
  Point along(const Point& d) const { return is_stretched_ ? to_ * d : d; }
  Point to_frame(const Point& p) const { return is_stretched_ ? origin_ + to_ * (p - origin_) : p; }
  Point from_frame(const Point& p) const { return is_stretched_ ? origin_ + from_ * (p - origin_) : p; }
  /// @brief Half sides of the box in space round a ball of radius 1.
  Point reach() const {
    if (!is_stretched_) return {1, 1, 1};
    return {std::hypot(from_.xx, from_.xy, from_.xz), std::hypot(from_.xy, from_.yy, from_.yz),
            std::hypot(from_.xz, from_.yz, from_.zz)};
  }
  /// @brief How many times roundings of coordinates may be as large, beside distances, as without a stretch.
  double condition() const { return is_stretched_ ? 4 * to_.norm() * from_.norm() : 1; }

 private:
  bool is_stretched_ = false;
  Point origin_;
  Symmetric3 to_, from_;
};

}  // namespace delfront
