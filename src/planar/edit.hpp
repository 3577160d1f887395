// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "planar/tri_complex.hpp"

namespace delfront {

/// @brief Squared sine of the smallest angle, 0 for a triangle that is flat or turned: 0.75 at best.
inline double squared_sine(Point2 a, Point2 b, Point2 c) {
  const Point2 u = b - a, v = c - b, w = a - c;
  const double area2 = cross(u, v);
  if (!(area2 > 0)) return 0;
  const double u2 = squared_length(u), v2 = squared_length(v), w2 = squared_length(w);
  // The smallest angle lies between the two longest sides.
  const double shortest = std::min({u2, v2, w2});
  const double product = shortest == u2 ? v2 * w2 : shortest == v2 ? u2 * w2 : u2 * v2;
  return product > 0 ? area2 * area2 / product : 0;
}

using Corners = std::array<VertexIndex, 3>;

/// @brief Puts other triangles in the place of some that are connected and have the same border.
///
/// Bonds, constrained edges on the border and inside (where the edge still exists), vertex_tri and the colour are kept.
/// Nothing is allocated once the work arrays have grown.
class Replacer {
 public:
  explicit Replacer(TriComplex& complex) : c_(complex) {}
  /// @pre all of `corners` are positive, and cover just what `old` covers; `old` has no ghosts
  void replace(std::span<const TriIndex> old, std::span<const Corners> corners);

 private:
  struct Side {
    VertexIndex low, high;
    EdgeRef ref;
    bool operator<(const Side& other) const {
      return low != other.low ? low < other.low : high != other.high ? high < other.high : ref < other.ref;
    }
  };
  void add_side(EdgeRef ref);
  void bond_sides();

  TriComplex& c_;
  std::vector<Side> sides_;
  std::vector<std::pair<VertexIndex, VertexIndex>> kept_;
};

/// @brief Triangles and ring of vertices round a vertex inside, anticlockwise. Needs vertex_tri.
/// @return false where a ghost stands there
bool collect_star(const TriComplex& complex, VertexIndex v, std::vector<TriIndex>& triangles,
                  std::vector<VertexIndex>& ring);

/// @brief Put vertex m, whose place stands in the complex, on a constrained edge: its two triangles become four.
/// @return the edge from its origin to m, or kNoTri (and nothing done) where a triangle would not be positive
EdgeRef split_edge(TriComplex& complex, EdgeRef ref, VertexIndex m);

/// @brief Flip edges that are not Delaunay, from these on, until all are (Lawson). @return flips made
std::size_t make_delaunay(TriComplex& complex, std::vector<EdgeRef>& edges);

}  // namespace delfront
