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

 private:
  enum class Kind : std::uint8_t { point, segment, triangle, box, ball, frustum, facets };
  void place_simplex(const Simplex& simplex, const Motion& motion, double time);
  double distance_to_triangle(Point from_corner) const;
  double distance_to_box(Point from_centre) const;
  double distance_to_frustum(Point from_end) const;

  Kind kind_ = Kind::point;
  double a_ = 0, b_ = 0, c_ = 0;  ///< inverse squared lengths of edges; radius; radii and length
  Point at_, u_, v_, w_, g_, h_;  ///< corner, edges, contravariant basis; centre, axes; origin of facets, their frame
  Box box_;
  std::shared_ptr<const FacetSurface> facets_;
};

}  // namespace delfront
