// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <memory>

#include "pipeline/prepare.hpp"
#include "planar/prepare.hpp"
#include "sizing/facet_surface.hpp"
#include "spatial/bvh.hpp"

namespace delfront {

/// @brief Where the kept regions are: inside where a line meets their border an odd number of times.
/// @par Cost  that of a tree over the border; then O(log n) a box and the border along a line a place
class KeptDomain {
 public:
  explicit KeptDomain(const Prepared& prepared);
  /// Crossings of lines in the plane are told in rounded arithmetic: for sums and pictures.
  explicit KeptDomain(const PlanarPrepared& prepared);

  bool is_planar() const { return !surface_; }
  const Box& box() const { return tree().box_of_all(); }
  std::size_t num_border() const { return tree().num_items(); }  ///< triangles of the border; in the plane segments
  bool is_crossed(const Box& box) const;
  bool is_inside(Point p) const;

 private:
  const Bvh& tree() const { return surface_ ? surface_->tree() : segment_tree_; }

  std::unique_ptr<FacetSurface> surface_;  ///< null in the plane
  std::vector<std::array<Point, 2>> segments_;
  Bvh segment_tree_;
};

}  // namespace delfront
