// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "planar/front_metric.hpp"
#include "planar/side_grid.hpp"

namespace delfront {

/// @brief 4 sqrt(3) area over the sum of squared lengths: 1 for the regular triangle, 0 for a flat one.
/// @param length  of the side from (-length/2, 0) to (length/2, 0)  @param p  the apex
inline double front_quality(double length, Point2 p) {
  return 6.928203230275509 * length * p.y / (3 * length * length + 4 * squared_length(p));
}

/// @brief What stands round a side of the front, gathered once (F13, F14): sides that overlap the place where its
/// triangle will be, and the points on them that the side sees, in its frame.
class FrontNeighbours {
 public:
  struct Side {
    Point2 a, b;        ///< in the plane
    Point2 at_a, at_b;  ///< in the frame
    VertexIndex from, to;
  };
  struct Candidate {
    Point2 at;  ///< in the frame
    double quality;
    VertexIndex v;
  };

  /// @brief Gather everything up to `reach` (in the frame) from the side's middle, above it.
  /// @post candidates() are the points there, best first (F15)
  void gather(const SideGrid& grid, const FrontSide& side, const FrontFrame& frame, double reach);

  const std::vector<Candidate>& candidates() const { return candidates_; }
  const std::vector<Side>& sides() const { return sides_; }

  /// @brief Whether the side's triangle with the apex at p crosses or touches nothing of the front but at shared ends.
  /// Exact (F12).
  /// @param apex  the front's point at p; kInfinity for a new one
  /// @pre p lies within the reach gathered
  bool is_free(Point2 p, VertexIndex apex) const;

  /// @brief Whether the triangle to a point of the front would open a side that passes another point nearer than
  /// `distance` (in the frame): what would be left between them could only become a sliver.
  bool passes_near(const Candidate& apex, double distance) const;

  /// @brief Whether a new point would stand nearer than this (in the frame) to a point or a side (3.28).
  bool is_near(Point2 at, double to_points, double to_sides) const;

 private:
  bool meets(const Side& other, Point2 p, VertexIndex apex) const;

  FrontSide own_;
  double length_ = 0;  ///< of the own side in its frame
  std::vector<Side> sides_;
  std::vector<Candidate> candidates_;
};

}  // namespace delfront
