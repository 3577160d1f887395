// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "planar/kernel.hpp"

namespace delfront {

namespace {

constexpr double kLargest = 0x1p100;  ///< of a coordinate, as the predicates want

void check_points(std::span<const Point2> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!(std::abs(points[i].x) <= kLargest && std::abs(points[i].y) <= kLargest))
      throw InputError(
          fmt::format("point {} at ({:g}, {:g}) is not finite, or over 2^100", i, points[i].x, points[i].y),
          {{{points[i].x, points[i].y, 0}, {static_cast<std::uint32_t>(i)}}});
}

void collect_hull(const TriComplex& complex, Triangulation2& result) {
  TriIndex first = 0;
  while (!complex.is_ghost(first)) ++first;
  TriIndex ghost = first;
  do {  // a ghost (a, b, infinity) has the hull on its right: its edge runs b -> a anticlockwise round the hull
    result.hull.push_back(complex.tri[ghost].node[1]);
    ghost = complex.tri[ghost].neigh[1] >> 2;
  } while (ghost != first);
}

}  // namespace

Triangulation2 delaunay2(std::span<const Point2> points, Context& context) {
  check_floating_point_mode();
  check_points(points);
  TriComplex complex;
  complex.point.assign(points.begin(), points.end());
  PlanarKernel kernel(complex);
  Triangulation2 result;
  result.duplicates = build_delaunay(complex, kernel, context);
  std::vector<std::uint32_t> number(complex.tri.size(), Triangulation2::kNone);
  std::uint32_t count = 0;
  for (TriIndex t = 0; t < complex.tri.size(); ++t)
    if (!complex.is_ghost(t)) number[t] = count++;
  result.triangles.reserve(count);
  result.neighbours.reserve(count);
  for (TriIndex t = 0; t < complex.tri.size(); ++t) {
    if (complex.is_ghost(t)) continue;
    const Triangle& s = complex.tri[t];
    result.triangles.push_back({s.node[0], s.node[1], s.node[2]});
    result.neighbours.push_back({number[s.neigh[0] >> 2], number[s.neigh[1] >> 2], number[s.neigh[2] >> 2]});
  }
  collect_hull(complex, result);
  return result;
}

}  // namespace delfront
