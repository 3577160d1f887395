// SPDX-License-Identifier: Apache-2.0
// Formulas of one cell or facet. Those of OpenFOAM follow the definitions that its checkMesh prints by
// (primitiveMeshTools, primitiveMeshFaceCentresAndAreas and primitiveMeshCellCentresAndVols of OpenFOAM v1912 to
// v2306).
#include "mesh/cell_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace delfront {

namespace {
constexpr double kTiny = 1e-150;  // keeps quotients of degenerate cells finite, as OpenFOAM's ROOTVSMALL does
constexpr double kDegrees = 180 / std::numbers::pi;

double degrees_of_cosine(double cosine) { return kDegrees * std::acos(std::clamp(cosine, -1.0, 1.0)); }
}  // namespace

FacetGeometry facet_geometry(std::span<const Point> p) {
  const std::size_t n = p.size();
  if (n == 2) return {0.5 * (p[0] + p[1]), {p[1].y - p[0].y, p[0].x - p[1].x, 0}};
  if (n == 3) return {(p[0] + p[1] + p[2]) / 3, 0.5 * cross(p[1] - p[0], p[2] - p[0])};
  Point middle;
  for (const Point& q : p) middle = middle + q / static_cast<double>(n);
  Point area, moment;
  double weight = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point &a = p[i], &b = p[(i + 1) % n];
    const Point normal = cross(b - a, middle - a);
    area = area + 0.5 * normal;
    weight += length(normal);
    moment = moment + length(normal) * (a + b + middle) / 3;
  }
  return {weight > 0 ? moment / weight : middle, area};
}

CellGeometry cell_geometry(std::span<const Point> p, const CellShape& shape, std::span<const FacetGeometry> facets) {
  if (p.size() == 4 && shape.num_facets == 4 && shape.num_corners == 1)
    return {0.25 * (p[0] + p[1] + p[2] + p[3]), dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6};
  Point middle, moment;
  for (const FacetGeometry& facet : facets) middle = middle + facet.centre / static_cast<double>(facets.size());
  double sum = 0;
  for (const FacetGeometry& facet : facets) {
    const double part = dot(facet.area, facet.centre - middle);
    sum += part;
    moment = moment + part * (0.75 * (facet.centre - middle));
  }
  return {std::abs(sum) > 0 ? middle + moment / sum : middle, sum / 3};
}

void measure_dihedrals(const CellShape& shape, std::span<const FacetGeometry> facets, CellQuality& quality) {
  Point unit[6];
  for (std::size_t f = 0; f < facets.size(); ++f) unit[f] = facets[f].area / std::max(length(facets[f].area), kTiny);
  double lowest = 1, highest = -1;
  for (int e = 0; e < shape.num_edges; ++e) {
    const double cosine = -dot(unit[shape.facets_of_edge[e][0]], unit[shape.facets_of_edge[e][1]]);
    lowest = std::min(lowest, cosine);
    highest = std::max(highest, cosine);
  }
  quality.min_angle = degrees_of_cosine(highest);
  quality.max_angle = degrees_of_cosine(lowest);
}

CellQuality measure_polygon(std::span<const Point> p) {
  const std::size_t n = p.size();
  CellQuality quality{180, 0, 0, 0, 0};
  double sum = 0, perimeter = 0, longest = 0, product = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const Point u = p[(i + 1) % n] - p[i], v = p[(i + n - 1) % n] - p[i];
    const double side = length(u);
    const double angle = degrees_of_cosine(dot(u, v) / std::max(side * length(v), kTiny));
    quality.min_angle = std::min(quality.min_angle, angle);
    quality.max_angle = std::max(quality.max_angle, angle);
    sum += side * side;
    perimeter += side;
    longest = std::max(longest, side);
    product *= side;
  }
  if (n != 3) return quality;
  const double area = 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
  const double inradius = 2 * area / std::max(perimeter, kTiny);
  quality.mean_ratio = 4 * std::sqrt(3.0) * area / std::max(sum, kTiny);
  quality.radius_ratio = 2 * inradius * 4 * area / std::max(product, kTiny);
  quality.aspect_ratio = longest / std::max(2 * std::sqrt(3.0) * inradius, kTiny);
  return quality;
}

double nonorthogonality(Point owner, Point neighbour, Point area) {
  const Point d = neighbour - owner;
  return degrees_of_cosine(dot(d, area) / std::max(length(d) * length(area), kTiny));
}

namespace {

/// Length of `off`, the way from where the line of centres meets the facet to its centre, over the extent of the
/// facet in that direction, but at least `least`.
double skewness(std::span<const Point> corners, Point centre, Point off, double least) {
  const double away = length(off);
  const Point direction = off / (away + kTiny);
  double extent = least + kTiny;
  for (const Point& p : corners) extent = std::max(extent, std::abs(dot(direction, p - centre)));
  return away / extent;
}

double away_from_zero(double x) { return x < 0 ? x - kTiny : x + kTiny; }

}  // namespace

double inner_skewness(std::span<const Point> corners, const FacetGeometry& facet, Point owner, Point neighbour) {
  const Point to_facet = facet.centre - owner, d = neighbour - owner;
  const Point off = to_facet - (dot(facet.area, to_facet) / away_from_zero(dot(facet.area, d))) * d;
  return skewness(corners, facet.centre, off, 0.2 * length(d));
}

double boundary_skewness(std::span<const Point> corners, const FacetGeometry& facet, Point owner) {
  const Point to_facet = facet.centre - owner;
  const Point normal = facet.area / std::max(length(facet.area), kTiny);
  const Point d = dot(normal, to_facet) * normal;
  const Point off = to_facet - d;
  return skewness(corners, facet.centre, off, 0.4 * length(d));
}

}  // namespace delfront
