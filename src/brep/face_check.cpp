// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "brep/face_grid.hpp"

namespace delfront {
namespace {

constexpr double kSharp = 1.5;        ///< radians along a side
constexpr double kLowShare = 4;       ///< of the tolerance of edges: triangles as low as that face as they may
constexpr double kWellMapped = 1e-4;  ///< sine between tangents from where their cross product is good enough

Point normal_of(const SmoothSurface& surface, Point2 uv) {
  const SurfaceTangents s = surface.tangents(uv);
  const Point n = cross(s.u, s.v);
  const double size = length(n);
  return size > kWellMapped * length(s.u) * length(s.v) && size > 0 ? n / size : surface.normal(uv);
}

/// Whether the surface bends at a point so sharply that its normal there says nothing of triangles of that length.
bool is_sharper(const SmoothSurface& surface, const FacePoint& point, double side) {
  return largest_curvature(surface.derivatives(point.uv)) * side > kSharp;
}

/// The same place as uv, as many periods on as brings it nearest to another.
Point2 unwrapped(Point2 uv, Point2 near, const std::array<double, 2>& period) {
  if (period[0] > 0) uv.x += period[0] * std::round((near.x - uv.x) / period[0]);
  if (period[1] > 0) uv.y += period[1] * std::round((near.y - uv.y) / period[1]);
  return uv;
}

/// Where a loop runs back over itself there is nothing between its sides: no triangle has them.
void check_border(const std::vector<std::uint64_t>& sides, FaceGrid& grid) {
  const auto is_side = [&](std::uint32_t a, std::uint32_t b) {
    return std::binary_search(sides.begin(), sides.end(), std::uint64_t(a) << 32 | b);
  };
  for (const auto& loop : grid.loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const FacePoint &p = grid.points[loop[i]], &q = grid.points[loop[(i + 1) % loop.size()]];
      if (p.vertex == q.vertex || is_side(p.vertex, q.vertex) || is_side(q.vertex, p.vertex)) continue;
      grid.is_border_wrong = true;
      return grid.fail("its border runs back over itself, with nothing in between: take out the edges that do", p.at);
    }
}

/// Sides between points of the border, which a seam has twice: each may be there once in each direction.
void check_sides(FaceGrid& grid) {
  std::vector<std::uint64_t> sides;
  const auto vertex = [&](std::uint32_t p) { return grid.points[p].vertex; };
  for (const auto& t : grid.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = vertex(t[k]), b = vertex(t[(k + 1) % 3]);
      if (a == kNoVertex || b == kNoVertex) continue;
      if (a == b) grid.fail("a side joins a point to itself across a seam", grid.points[t[k]].at);
      sides.push_back(std::uint64_t(a) << 32 | b);
    }
  std::sort(sides.begin(), sides.end());
  const auto twice = std::adjacent_find(sides.begin(), sides.end());
  if (twice == sides.end()) {
    if (grid.is_mapped) check_border(sides, grid);  // else seams are no sides
    return;
  }
  for (const FacePoint& p : grid.points)
    if (p.vertex == *twice >> 32) return grid.fail("a side is used twice", p.at);
}

Point2 middle_of(const SmoothSurface& surface, const FaceGrid& grid, const std::array<std::uint32_t, 3>& t,
                 Point middle) {
  const std::array<double, 2> period = surface.period();
  std::size_t known = 0;
  while (known < 2 && grid.points[t[known]].is_pole) ++known;
  const Point2 a = grid.points[t[known]].uv;
  for (const std::uint32_t p : t)
    if (grid.points[p].is_pole) return surface.closest(middle, a);
  const Point2 b = unwrapped(grid.points[t[1]].uv, a, period), c = unwrapped(grid.points[t[2]].uv, a, period);
  return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
}

}  // namespace

void check_face_grid(const BrepFace& face, double most_angle, double tolerance, FaceGrid& grid) {
  if (!grid.gave_up.empty()) return;
  if (grid.triangles.empty()) return grid.fail("there are no triangles", grid.points[0].at);
  check_sides(grid);
  const SmoothSurface& surface = *face.surface;
  std::vector<Point> normal(grid.points.size());
  for (std::size_t i = 0; i < normal.size(); ++i)
    if (!grid.points[i].is_pole) {
      const Point n = normal_of(surface, grid.points[i].uv);
      normal[i] = grid.facing(n);
      grid.is_folded = grid.is_folded || dot(n, grid.up) < 0;
    }
  const double least_allowed = std::cos(most_angle);
  double least = 1;
  Point worst_at;
  for (const auto& t : grid.triangles) {
    const Point a = grid.points[t[0]].at, b = grid.points[t[1]].at, c = grid.points[t[2]].at;
    const Point twice = cross(b - a, c - a), middle = (a + b + c) / 3.0;
    const double size = length(twice);
    if (!(size > 0)) return grid.fail("a triangle has no area", middle);
    const SurfaceTangents there = surface.tangents(middle_of(surface, grid, t, middle));
    const Point n = grid.facing(cross(there.u, there.v));
    const double longest = std::max({distance(a, b), distance(b, c), distance(c, a)});
    for (const std::uint32_t p : t) {
      if (grid.points[p].is_pole || dot(twice, normal[p]) >= least * size) continue;
      if (dot(twice, normal[p]) < least_allowed * size &&
          (size < kLowShare * tolerance * longest ||
           (dot(twice, n) > 0 && (grid.points[p].is_vague || is_sharper(surface, grid.points[p], longest)))))
        continue;
      least = dot(twice, normal[p]) / size;
      worst_at = middle;
    }
    const double away = length(n) > 0 ? std::abs(dot(there.at - middle, n)) / length(n) : distance(there.at, middle);
    grid.largest_distance = std::max(grid.largest_distance, away);
  }
  grid.largest_angle = std::acos(std::clamp(least, -1.0, 1.0));
  if (grid.largest_angle > most_angle) grid.fail("a triangle faces away from the surface", worst_at);
}

}  // namespace delfront
