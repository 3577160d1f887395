// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "spatial/box_octree.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief What lies in a region and belongs to no face: an edge of an embedded curve, or a point (a == b).
struct FrontObstacle {
  VertexIndex a, b;  ///< a <= b
  std::uint32_t region = TetComplex::kOutside;
  std::uint32_t tets = 0;  ///< that have it (and one where a face of the boundary has): pending while there are none

  bool is_point() const { return a == b; }
  bool is_pending() const { return tets == 0; }
};

/// @brief The curves' edges and lone points of a complex, each until a tet has it (F1, D5): from then on the faces of
/// the front at it keep others off, and all around it is filled in the end.
///
/// They never move, so one tree does for all time. Workers may ask and count at once, each for what lies in its slab.
class FrontObstacles {
 public:
  /// @pre the complex still has its tets
  explicit FrontObstacles(const TetComplex& complex);

  bool empty() const { return obstacles_.empty(); }
  std::size_t size() const { return obstacles_.size(); }
  const FrontObstacle& operator[](std::size_t i) const { return obstacles_[i]; }
  std::size_t num_pending() const;
  /// @brief Where one lies: nothing else of those of other slabs may be looked at.
  const Box& box(std::size_t i) const { return box_[i]; }

  /// @brief visit(i) for all, pending or not, whose boxes touch this one, and some a little beyond.
  template <class Visit>
  void for_each_overlap(const Box& box, Visit&& visit) const {
    if (!empty()) tree_.for_each_overlap(box, visit);
  }

  /// @brief A tet of these nodes comes, or goes.
  void count_tet(const std::array<VertexIndex, 4>& nodes, bool comes) {
    if (!empty()) count(nodes, comes);
  }

 private:
  void add_all(const TetComplex& complex);
  void find_regions(const TetComplex& complex);
  void count(const std::array<VertexIndex, 4>& nodes, bool comes);
  std::size_t find(VertexIndex a, VertexIndex b) const;
  bool is_end(VertexIndex v) const { return v < is_end_.size() && is_end_[v] != 0; }

  std::vector<FrontObstacle> obstacles_;  ///< sorted by (a, b)
  std::vector<Box> box_;
  std::vector<std::uint8_t> is_end_;  ///< by vertex
  BoxOctree tree_;
};

/// @brief Points with their numbers.
struct NumberedPoint {
  VertexIndex id;
  Point at;
};

/// @brief Whether a closed segment (a point, where both ends are one) has more in common with a closed positive tet
/// than a corner, or the segment itself as an edge. Exact; corners in common are told by their numbers.
bool is_met_by_tet(const std::array<NumberedPoint, 2>& segment, const std::array<NumberedPoint, 4>& tet);

}  // namespace delfront
