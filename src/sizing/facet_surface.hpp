// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "delfront/errors.hpp"
#include "delfront/size_sources.hpp"
#include "spatial/bvh.hpp"

namespace delfront {

/// @brief Triangles in a tree; a solid's inside is decided by exact predicates.
class FacetSurface {
 public:
  FacetSurface(std::vector<std::array<Point, 3>> triangles, bool is_solid);

  double distance(Point p) const;
  /// @brief Whether an odd number of triangles lies above p; exact, also for surfaces that are not taken as solids.
  bool is_inside(Point p) const;
  const Bvh& tree() const { return tree_.bvh(); }
  const Box& box() const { return tree().box_of_all(); }

 private:
  TriangleTree tree_;
  bool is_solid_;
  double scale_ = 1;  ///< a power of two that brings the largest coordinate to about 1, for the predicates
};

}  // namespace delfront
