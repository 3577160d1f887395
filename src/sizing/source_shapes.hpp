// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>

#include "delfront/size_sources.hpp"

namespace delfront {

/// @brief A shape at its place and time, prepared for many distances. All kinds share one record, so that a list of
/// mixed shapes is one array.
class PlacedShape {
 public:
  PlacedShape() = default;
  /// @pre check_shape(shape)
  explicit PlacedShape(const SourceShape& shape, const Motion& motion = {}, double time = 0);

  /// @return distance, 0 inside
  double distance(Point p) const;
  const Box& box() const { return box_; }
  /// @return number of corners of a point, line or triangle; 0 of other shapes
  int corners(Point corner[3]) const;

 private:
  enum class Kind : std::uint8_t { point, segment, triangle, box, ball, frustum, facets };
  void place_simplex(const Simplex& simplex, const Motion& motion, double time);
  double distance_to_triangle(Point from_corner) const;
  double distance_to_box(Point from_centre) const;
  double distance_to_frustum(Point from_end) const;

  // In the order of use: a point or line is within the first 64 bytes.
  Point at_;  ///< corner, centre, end; of facets where the centre of their box is now
  Kind kind_ = Kind::point;
  Point u_;               ///< edge, axis, first direction of a box or of facets
  double a_ = 0;          ///< inverse squared length of u; radius; half side; of facets 1 where they stand still
  Point v_, w_;           ///< edges, directions
  double b_ = 0, c_ = 0;  ///< inverse squared lengths of v, w; second radius, length; half sides
  Point g_, h_;           ///< contravariant basis; corners of a box; of facets the centre of their own box
  Box box_;
  std::shared_ptr<const FacetSurface> facets_;
};

}  // namespace delfront
