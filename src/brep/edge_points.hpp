// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <set>
#include <vector>

#include "brep/face_grid.hpp"

namespace delfront {

/// @brief Divide all edges so that each side is as long as the sizes there: the integral of 1 / h over arc length,
/// rounded, in equal parts (F3). What bends along an edge, or on the faces beside it, counts. First sides in sharp
/// corners of faces may be longer (ranges_between_sharp_corners).
///
/// Vertices are numbered: corners first, then those within edges. Closed edges get three sides at least, open edges
/// that share both corners two.
/// @param long_sided    corners where first sides are longer
/// @param points        one an edge: where t is known already it stays
/// @param num_vertices  set to the number of all
/// @par Source  Löhner (2008), 2.6: sides along curves
void divide_edges(const Brep& brep, const WantedSize& size, const std::set<CornerId>& long_sided,
                  Array<EdgeId, EdgePoints>& points, std::size_t& num_vertices, Context& context);

/// @brief Points that divide a curve in equal parts of the integral of 1 / h over arc length.
/// @param sample  place and derivative by t; and where it is asked for, what bends there, 1 / length. That is no longer
///                asked for where sizes turn out to be far from what bends allow.
struct CurveSample {
  Point at, first;
  double curvature;
};
using SampleCurve = std::function<CurveSample(double t, bool wants_curvature)>;
std::vector<double> divide_curve(const SampleCurve& sample, std::array<double, 2> range, const WantedSize& size,
                                 std::size_t least);

}  // namespace delfront
