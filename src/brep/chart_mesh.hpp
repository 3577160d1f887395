// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "brep/chart.hpp"
#include "planar/tri_complex.hpp"

namespace delfront {

/// @brief Triangles of a chart, seen in space: edges flipped and points moved by what they are there (F18).
///
/// An operation is done where all its triangles stay anticlockwise in the chart, exactly.
class ChartMesh {
 public:
  /// @param at          places in space of the vertices before first_free
  /// @pre complex.vertex_tri is filled
  ChartMesh(TriComplex& complex, const Chart& chart, std::vector<Point> at);

  /// @brief Triangles are not asked how they face at this vertex of the border.
  void forget_normal(VertexIndex v) { x_[v] = y_[v] = {}; }

  /// @brief Passes of moves, with flips before, between and after.
  void improve(int passes, const Context& context);

  const std::vector<Point>& at() const { return at_; }

 private:
  struct Star {
    double mean, worst;  ///< quality; squared sine of the smallest angle
  };
  std::size_t flip_all();
  bool flip(EdgeRef ref);
  double agreement(Point area, const std::array<VertexIndex, 3>& corners) const;
  bool move(VertexIndex v);
  bool is_small(TriIndex t) const;
  bool is_hopeless() const;
  std::size_t lift_angles(const Context& context);
  bool lift_angle(VertexIndex v);
  bool try_place(VertexIndex v, Point2 step, const Star& before, bool by_worst = false);
  bool collect_ring(VertexIndex v);
  Star measure(Point p, Point normal) const;
  bool is_positive() const;
  bool is_inside(TriIndex t) const { return !c_.is_dead(t) && !c_.is_ghost(t) && c_.tri[t].region != kOutside; }

  TriComplex& c_;
  const Chart& chart_;
  VertexIndex first_free_;
  std::vector<Point> at_, x_, y_;         ///< by vertex: place and tangents along the chart's axes
  std::vector<bool> is_calm_;             ///< by vertex: regular or tried in vain, and nothing has changed there since
  std::vector<std::uint8_t> is_changed_;  ///< by vertex: its sides are to be looked at
  std::vector<TriIndex> star_;
  std::vector<VertexIndex> vertices_;
  std::vector<Point> ring_;    ///< round the vertex that is looked at, anticlockwise
  std::vector<double> side2_;  ///< squared lengths of the ring's sides, each before its point
};

}  // namespace delfront
