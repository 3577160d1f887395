// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>

#include "delfront/metric.hpp"
#include "planar/tri_complex.hpp"

namespace delfront {

/// @brief What a front asks of sizes at a place: the root of the metric, which maps an edge of the wanted length, in
/// any direction, to one of length 1. Symmetric; 1/h times the identity for a size h.
struct FrontMetric {
  double xx = 1, xy = 0, yy = 1;

  static FrontMetric isotropic(double h) { return {1 / h, 0, 1 / h}; }
  /// @par Source  (M + sqrt(det M) I) / sqrt(trace M + 2 sqrt(det M)), by Cayley and Hamilton
  static FrontMetric root_of(const Metric& m) {
    const double root = std::sqrt(std::fmax(m.xx * m.yy - m.xy * m.xy, 0));
    const double f = 1 / std::sqrt(m.xx + m.yy + 2 * root);
    return {f * (m.xx + root), f * m.xy, f * (m.yy + root)};
  }
  static FrontMetric mean_of(const FrontMetric& a, const FrontMetric& b) {
    return {0.5 * (a.xx + b.xx), 0.5 * (a.xy + b.xy), 0.5 * (a.yy + b.yy)};
  }
  /// @brief Side of the square with the area that one of size 1 by 1 in the metric has.
  double size() const { return 1 / std::sqrt(xx * yy - xy * xy); }
  Point2 map(Point2 d) const { return {xx * d.x + xy * d.y, xy * d.x + yy * d.y}; }
  FrontMetric scaled(double f) const { return {f * xx, f * xy, f * yy}; }
};

/// @brief The plane as a side of the front sees it: its middle at the origin, its ends on the x axis at +-length/2,
/// what is to be gridded above, the wanted length 1.
struct FrontFrame {
  Point2 middle;
  double length = 0;                      ///< of the side, in the metric
  double xx = 1, xy = 0, yx = 0, yy = 1;  ///< from the plane to the frame

  FrontFrame(Point2 a, Point2 b, const FrontMetric& metric) : middle(0.5 * (a + b)) {
    const Point2 along = metric.map(b - a);
    length = std::sqrt(squared_length(along));
    const double c = along.x / length, s = along.y / length;
    xx = c * metric.xx + s * metric.xy;
    xy = c * metric.xy + s * metric.yy;
    yx = c * metric.xy - s * metric.xx;
    yy = c * metric.yy - s * metric.xy;
  }

  Point2 to_frame(Point2 p) const {
    const double dx = p.x - middle.x, dy = p.y - middle.y;
    return {xx * dx + xy * dy, yx * dx + yy * dy};
  }
  Point2 from_frame(Point2 p) const {
    const double f = 1 / (xx * yy - xy * yx);
    return middle + Point2{f * (yy * p.x - xy * p.y), f * (xx * p.y - yx * p.x)};
  }
};

}  // namespace delfront
