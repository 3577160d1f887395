// SPDX-License-Identifier: Apache-2.0
// Distance to triangles, and inside by the parity of the triangles above a place.
//
// A line goes up from the place, moved by an infinitely small amount: it meets a triangle where the place, seen from
// above, lies on the left of an odd number of the triangle's edges that span its y ("crossing number"). Each edge is
// judged exactly and from its lower end, so the triangles at an edge agree about it and no line slips through.
#include "sizing/facet_surface.hpp"

#include <algorithm>
#include <cmath>

#include "fmt/format.h"
#include "predicates/predicates.hpp"

namespace delfront {
namespace {

bool is_before(Point a, Point b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// @throws InputError  an edge that an odd number of triangles share
void check_closed(const std::vector<std::array<Point, 3>>& triangles) {
  std::vector<std::array<Point, 2>> edges;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<Point, 2> edge = {t[k], t[(k + 1) % 3]};
      if (edge[0] == edge[1]) continue;
      if (is_before(edge[1], edge[0])) std::swap(edge[0], edge[1]);
      edges.push_back(edge);
    }
  std::sort(edges.begin(), edges.end(),
            [](const auto& e, const auto& f) { return e[0] == f[0] ? is_before(e[1], f[1]) : is_before(e[0], f[0]); });
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if ((j - i) % 2 == 0) continue;
    const Point p = edges[i][0], q = edges[i][1];
    throw InputError(
        fmt::format("surface of a region: {} triangle(s) at the edge ({}, {}, {}) to ({}, {}, {}); it must "
                    "be closed to have an inside: mend it, or take it as a source",
                    j - i, p.x, p.y, p.z, q.x, q.y, q.z),
        {{0.5 * (p + q), {}}});
  }
}

}  // namespace

FacetSurface::FacetSurface(std::vector<std::array<Point, 3>> triangles, bool is_solid)
    : tree_(std::move(triangles)), is_solid_(is_solid) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(box().low[k]), std::abs(box().high[k])});
  if (largest > 0) scale_ = std::ldexp(1.0, -std::ilogb(largest));
}

double FacetSurface::distance(Point p) const {
  if (is_solid_ && is_inside(p)) return 0;
  return tree_.nearest(p).distance;
}

bool FacetSurface::is_inside(Point p) const {
  if (!box().overlaps({p, p})) return false;
  const Point top{p.x, p.y, box().high.z};
  const Point q = scale_ * p;
  bool inside = false;
  tree_.bvh().for_each_overlap({p, top}, [&](std::uint32_t t) {
    Point corner[3];
    for (std::size_t k = 0; k < 3; ++k) corner[k] = scale_ * tree_.corners(t)[k];
    bool is_met = false;
    for (int k = 0; k < 3; ++k) {
      Point a = corner[k], b = corner[(k + 1) % 3];
      if ((a.y > q.y) == (b.y > q.y)) continue;
      if (a.y > b.y) std::swap(a, b);
      if (orient2d(&a.x, &b.x, &q.x) > 0) is_met = !is_met;
    }
    if (!is_met) return;
    const int turn = orient2d(&corner[0].x, &corner[1].x, &corner[2].x);
    // Below the triangle: on the side its normal, turned up, comes from.
    if (turn * orient3d(corner[0], corner[1], corner[2], q) < 0) inside = !inside;
  });
  return inside;
}

std::shared_ptr<const FacetSurface> build_facet_surface(std::vector<std::array<Point, 3>> triangles, bool is_solid) {
  if (triangles.empty()) throw InputError("surface of sizes: it has no triangles");
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (Point& p : triangles[t]) {
      if (!is_finite(p))
        throw InputError(fmt::format("surface of sizes: triangle {} has a corner at ({}, {}, {}); all must be numbers",
                                     t, p.x, p.y, p.z),
                         {{p, {static_cast<std::uint32_t>(t)}}});
      p = p + Point{};  // -0 is 0
    }
  if (is_solid) check_closed(triangles);
  return std::make_shared<const FacetSurface>(std::move(triangles), is_solid);
}

}  // namespace delfront
