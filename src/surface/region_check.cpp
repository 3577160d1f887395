// SPDX-License-Identifier: Apache-2.0
#include "surface/region_check.hpp"

#include <algorithm>
#include <cmath>

#include "base/hilbert.hpp"

namespace delfront {
namespace {

constexpr double kFarShare = 0.6;  ///< of the longest side: the distance from the surface that is a fault

void give_up(RegionGrid& grid, const char* why, Point at) {
  if (!grid.gave_up.empty()) return;
  grid.gave_up = why;
  grid.gave_up_at = at;
}

/// Directed sides: each once, and its opposite too, except for the border's.
void check_sides(const RegionBorder& border, RegionGrid& grid) {
  std::vector<std::uint64_t> open, sides;
  sides.reserve(3 * grid.triangles.size());
  for (const auto& t : grid.triangles)
    for (std::size_t k = 0; k < 3; ++k) sides.push_back(std::uint64_t(t[k]) << 32 | t[(k + 1) % 3]);
  std::sort(sides.begin(), sides.end());
  const auto place = [&](std::uint64_t side) { return grid.points[side >> 32]; };
  const auto twice = std::adjacent_find(sides.begin(), sides.end());
  if (twice != sides.end()) return give_up(grid, "a side is used twice", place(*twice));
  for (const auto& [a, b] : border.side) open.push_back(std::uint64_t(a) << 32 | b);
  std::sort(open.begin(), open.end());
  for (const std::uint64_t side : open)
    if (!std::binary_search(sides.begin(), sides.end(), side))
      return give_up(grid, "a side of the border is open", place(side));
  for (const std::uint64_t side : sides) {
    if (std::binary_search(open.begin(), open.end(), side)) continue;
    if (!std::binary_search(sides.begin(), sides.end(), side << 32 | side >> 32))
      return give_up(grid, "a side has one triangle", place(side));
  }
}

void check_topology(const SurfaceSupport& support, const RegionBorder& border, RegionGrid& grid) {
  std::vector<std::uint64_t> distinct = grid.border_sides;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const long faces = long(grid.triangles.size()), halves = long(border.side.size());
  const long edges = (3 * faces - halves) / 2 + long(distinct.size());
  if (long(grid.points.size()) - edges + faces != support.euler())
    give_up(grid, "the grid has another topology than the surface", grid.points[0]);
}

}  // namespace

RegionFit check_region(const SurfaceSupport& support, const RegionBorder& border, RegionGrid& grid) {
  RegionFit fit;
  if (!grid.gave_up.empty()) return fit;
  check_sides(border, grid);
  check_topology(support, border, grid);
  for (const auto& t : grid.triangles) {
    if (!grid.gave_up.empty()) return fit;
    const Point a = grid.points[t[0]], b = grid.points[t[1]], c = grid.points[t[2]];
    const Point twice = cross(b - a, c - a), middle = (a + b + c) / 3.0;
    const double longest = std::max({distance(a, b), distance(b, c), distance(c, a)}), size = length(twice);
    if (!(size > 1e-9 * longest * longest)) {
      give_up(grid, "a triangle has no area", middle);
      continue;
    }
    std::uint32_t near = kNoTriangle;
    for (const std::uint32_t p : t)
      if (p < grid.triangle_of_point.size() && grid.triangle_of_point[p] != kNoTriangle)
        near = grid.triangle_of_point[p];
    const SurfaceSupport::Foot foot = support.project(middle, twice / size, near, kFarShare * longest);
    if (!foot.found()) give_up(grid, "a triangle faces away from the surface, or lies far from it", middle);
    if (foot.found() && foot.distance > fit.distance) fit = {foot.distance, middle};
  }
  return fit;
}

}  // namespace delfront
