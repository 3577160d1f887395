// SPDX-License-Identifier: Apache-2.0
#include "sizing/geometry_facets.hpp"

#include <algorithm>
#include <cmath>

#include "delfront/errors.hpp"
#include "fmt/format.h"
#include "geometry/angles.hpp"

namespace delfront {
namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

double PlaneTensor::largest() const {
  const double mean = 0.5 * (xx + yy), spread = std::hypot(0.5 * (xx - yy), xy);
  return std::abs(mean) + spread;
}

Facets::Facets(const Model& m) : model(m) {
  const std::size_t n = m.triangles.size();
  is_used.assign(n, false);
  normal.assign(n, {});
  area.assign(n, 0);
  diagonal_ = m.surface_box().diagonal();
  for (std::size_t t = 0; t < n; ++t) {
    const auto [a, b, c] = corners(t);
    // unit sides: a product of tiny lengths would vanish
    const double longest = std::max({distance(a, b), distance(b, c), distance(c, a)});
    if (!(longest > 0)) continue;
    const Point twice = cross((b - a) / longest, (c - a) / longest);
    const double size = length(twice);
    const auto& [va, vb, vc] = m.triangles[TriangleId(t)];
    if (!(size > 0) || va == vb || vb == vc || vc == va) continue;
    is_used[t] = true;
    normal[t] = twice / size;
    area[t] = 0.5 * size * longest * longest;
  }
  edges = SurfaceEdges(m.triangles, is_used);
  turn.assign(edges.size(), 0);
  is_crease.assign(edges.size(), true);
  is_line.assign(edges.size(), true);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto half = edges.half_edges(e);
    if (half.size() != 2) continue;
    const auto start_of = [&](std::uint32_t h) { return m.triangles[TriangleId(h / 3)][h % 3]; };
    if (start_of(half[0]) == start_of(half[1])) continue;  // orientations disagree
    turn[e] = angle_between(normal[half[0] / 3], normal[half[1] / 3]);
    is_crease[e] = turn[e] > m.feature_angle * kPi / 180;
    is_line[e] =
        is_crease[e] || m.patch_of_triangle[TriangleId(half[0] / 3)] != m.patch_of_triangle[TriangleId(half[1] / 3)];
  }
}

std::array<Point, 2> plane_frame(Point normal) {
  const bool is_x_least = std::abs(normal.x) <= std::abs(normal.y) && std::abs(normal.x) <= std::abs(normal.z);
  const Point axis = is_x_least                                 ? Point{1, 0, 0}
                     : std::abs(normal.y) <= std::abs(normal.z) ? Point{0, 1, 0}
                                                                : Point{0, 0, 1};
  Point u = cross(normal, axis);
  u = u / length(u);
  return {u, cross(normal, u)};
}

PatchCrossing cross_patch(const Facets& facets, std::uint32_t half_edge, double t, double largest, double cos_facing) {
  constexpr int kMostSteps = 20000;
  const Point from = facets.start(half_edge), along = facets.end(half_edge) - from;
  Point at = from + t * along;
  Point heading = cross(facets.normal[half_edge / 3], along);
  heading = heading / length(heading);
  PatchCrossing crossing;
  double travelled = 0;
  for (int step = 0; step < kMostSteps && travelled <= largest; ++step) {
    // leave the triangle through the side that the heading reaches first
    const std::uint32_t triangle = half_edge / 3;
    const Point normal = facets.normal[triangle];
    double first = std::numeric_limits<double>::infinity();
    std::uint32_t side = half_edge;
    for (std::uint32_t k = 1; k < 3; ++k) {
      const std::uint32_t other = 3 * triangle + (half_edge + k) % 3;
      const Point outward = cross(facets.end(other) - facets.start(other), normal);
      const double speed = dot(heading, outward);
      if (!(speed > 0)) continue;
      const double reach = std::max(0.0, dot(facets.start(other) - at, outward) / speed);
      if (reach < first) {
        first = reach;
        side = other;
      }
    }
    if (side == half_edge) return {};
    at = at + first * heading;
    travelled += first;
    const std::uint32_t edge = facets.edges.edge_of(side);
    Point outward = cross(facets.end(side) - facets.start(side), normal);
    outward = outward / length(outward);
    if (facets.is_line[edge]) {
      if (dot(heading, outward) >= cos_facing && travelled > 0) crossing = {travelled, at};
      break;
    }
    const auto pair = facets.edges.half_edges(edge);
    const std::uint32_t next = pair[0] == side ? pair[1] : pair[0];
    // unfold: the parts of the heading along and square to the side stay
    Point side_along = facets.end(side) - facets.start(side);
    side_along = side_along / length(side_along);
    const Point inward = cross(facets.normal[next / 3], facets.end(next) - facets.start(next));
    heading = dot(heading, side_along) * side_along + dot(heading, outward) * (inward / length(inward));
    heading = heading / length(heading);
    half_edge = next;
  }
  return crossing.distance <= largest ? crossing : PatchCrossing{};
}

void GeometrySources::append(GeometrySources&& other) {
  if (other.report.smallest < report.smallest) {
    report.smallest = other.report.smallest;
    report.smallest_at = other.report.smallest_at;
  }
  report.num_sources += other.report.num_sources;
  report.num_at_hmin += other.report.num_at_hmin;
  sources.insert(sources.end(), std::make_move_iterator(other.sources.begin()),
                 std::make_move_iterator(other.sources.end()));
}

void add_source(GeometrySources& to, const Simplex& shape, double h, double hmin, const std::string& group) {
  SizeSource source;
  source.shape = shape;
  source.law.kind = SizeLaw::Kind::step;
  source.law.delta0 = std::max(h, hmin);
  source.group = group;
  ++to.report.num_sources;
  if (h < hmin) ++to.report.num_at_hmin;
  if (source.law.delta0 < to.report.smallest) {
    to.report.smallest = source.law.delta0;
    Point middle;
    for (int k = 0; k < shape.num_corners; ++k) middle = middle + shape.corner[std::size_t(k)];
    to.report.smallest_at = middle / shape.num_corners;
  }
  to.sources.push_back(std::move(source));
}

void check_bounds(const std::string& word, double hmin, double hmax) {
  if (!(hmin >= 0) || std::isinf(hmin)) throw UsageError(fmt::format("{}: hmin must be positive, not {}", word, hmin));
  if (!(hmax > 0)) throw UsageError(fmt::format("{}: hmax must be positive, not {}", word, hmax));
  if (hmin > hmax) throw UsageError(fmt::format("{}: hmin {} exceeds hmax {}; exchange them?", word, hmin, hmax));
}

double usual_hmin(const Facets& facets, double hmin) { return hmin > 0 ? hmin : kUsualShare * facets.diagonal(); }

}  // namespace delfront
