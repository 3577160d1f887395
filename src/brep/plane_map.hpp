// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "delfront/brep.hpp"

namespace delfront {

/// @brief An almost flat part of a surface seen from straight above: a plane that knows nothing of how its parameters
/// run.
///
/// For faces whose mapping folds over itself or is crowded although what they are in space is simple. Places are found
/// by Newton's method from the nearest of a net; where the mapping folds any of the parameters of a place will do.
class PlaneMap {
 public:
  struct Place {
    Point2 uv;
    Point at, x, y;  ///< tangents along the plane's axes
  };

  /// @param up  unit normal of the plane
  PlaneMap(const SmoothSurface& surface, const ParameterBox& box, Point up);

  /// @brief Whether the surface nowhere turns far from the plane, its folds apart.
  bool is_flat() const { return is_flat_; }
  Point2 to_plane(Point2 uv) const { return flatten(surface_.at(uv)); }
  Point2 to_uv(Point2 xy) const;
  Place place(Point2 xy) const;

 private:
  Point2 flatten(Point p) const { return {dot(p - origin_, x_) / unit_, dot(p - origin_, y_) / unit_}; }

  const SmoothSurface& surface_;
  ParameterBox box_;
  Point origin_, x_, y_, up_;
  double unit_ = 1;  ///< of lengths: charts are about 1 wide
  bool is_flat_ = true;
  std::vector<Point2> net_uv_, net_;  ///< of what faces up: beyond a fold there is nothing that it has not too
};

}  // namespace delfront
