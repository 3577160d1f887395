// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "sizing/geometry_facets.hpp"

namespace delfront {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void note_high(SurfaceAccuracy::Worst& worst, double value, Point at, double limit) {
  if (value > limit) ++worst.num_beyond;
  if (value > worst.value) {
    worst.value = value;
    worst.at = at;
  }
}

void note_low(SurfaceAccuracy::Worst& worst, double value, Point at, double limit) {
  if (value < limit) ++worst.num_beyond;
  if (value < worst.value) {
    worst.value = value;
    worst.at = at;
  }
}

/// A quadratic surface leaves its triangle by half the sum of l_i l_j e_ij . S e_ij: an eighth of one side's term at
/// its middle, an eighteenth of the sum in the middle of the triangle.
double deviation_of(const Facets& facets, const Curvature& curvature, std::size_t t) {
  const auto [u, v] = plane_frame(facets.normal[t]);
  PlaneTensor s = curvature.tensor[t];
  // as cautious as the curvature itself where the triangle's own says more than its neighbourhood
  const double own = s.largest(), kept = own > 0 ? curvature.largest[t] / own : 0;
  double sum = 0, side = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point e = facets.corner(t, (k + 1) % 3) - facets.corner(t, k);
    const double a = dot(e, u), b = dot(e, v);
    const double term = kept * (s.xx * a * a + 2 * s.xy * a * b + s.yy * b * b);
    sum += term;
    side = std::max(side, std::abs(term));
  }
  return std::max(side / 8, std::abs(sum) / 18);
}

}  // namespace

SurfaceAccuracy measure_surface_accuracy(const Model& grid, const SurfaceLimits& limits, Context& context) {
  const Facets facets(grid);
  const Curvature curvature = compute_curvature(facets);
  SurfaceAccuracy found;
  found.line_distance.value = found.side.value = kInfinity;
  for (std::size_t e = 0; e < facets.edges.size(); ++e) {
    if (e % 256 == 0) context.check_limits();
    const auto [a, b] = facets.ends(e);
    const Point middle = 0.5 * (a + b);
    note_low(found.side, distance(a, b), middle, limits.side);
    if (!facets.is_crease[e]) note_high(found.angle_deg, facets.turn[e] * kDegrees, middle, limits.angle_deg);
    if (!facets.is_line[e]) continue;
    const double cos_facing = std::cos(GapSizes{}.facing_deg / kDegrees);
    for (const std::uint32_t half : facets.edges.half_edges(e)) {
      const PatchCrossing crossing = cross_patch(facets, half, 0.5, facets.diagonal(), cos_facing);
      if (crossing.found()) note_low(found.line_distance, crossing.distance, middle, limits.line_distance);
    }
  }
  for (std::size_t t = 0; t < facets.num_triangles(); ++t) {
    if (!facets.is_used[t]) continue;
    const auto [a, b, c] = facets.corners(t);
    note_high(found.deviation, deviation_of(facets, curvature, t), (a + b + c) / 3, limits.deviation);
  }
  return found;
}

}  // namespace delfront
