// SPDX-License-Identifier: Apache-2.0
// The whole run in the plane on one screen: Delaunay of the points, segments, regions, sizes, points, improvement.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planar/improve.hpp"
#include "planar/kernel.hpp"
#include "planar/refine.hpp"
#include "planar/split.hpp"
#include "planar/to_mesh.hpp"
#include "sizing/asked_sizes.hpp"

namespace delfront {

namespace {

constexpr double kLargest = 0x1p100;  ///< of a coordinate, as the predicates want

void check_domain(const PlanarDomain& domain) {
  std::vector<Place> places;
  for (std::size_t i = 0; i < domain.points.size(); ++i) {
    const Point2 p = domain.points[VertexId(i)];
    if (!(std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest))
      places.push_back({{p.x, p.y, 0}, {static_cast<std::uint32_t>(i)}});
  }
  if (!places.empty())
    throw InputError(fmt::format("{} points have a coordinate that is not finite, or over 2^100; the first is point {}",
                                 places.size(), places[0].ids[0]),
                     places);
  if (domain.curve_of_segment.size() != domain.segments.size())
    throw InputError(fmt::format("{} segments, but {} curves of segments: one each is needed", domain.segments.size(),
                                 domain.curve_of_segment.size()));
  for (std::size_t i = 0; i < domain.segments.size(); ++i)
    if (domain.segments[i][0].index() >= domain.points.size() ||
        domain.segments[i][1].index() >= domain.points.size() ||
        domain.curve_of_segment[i].index() >= domain.curves.size())
      throw InputError(fmt::format("segment {} names a point or a curve that does not exist", i));
}

PlanarGrid triangulate(const PlanarDomain& domain, const DomainOptions& options, Context& context) {
  const StageTimer timer(context, "triangulate");
  PlanarGrid grid;
  grid.complex.point.assign(domain.points.begin(), domain.points.end());
  PlanarKernel kernel(grid.complex);
  const auto duplicates = build_delaunay(grid.complex, kernel, context);
  std::vector<VertexIndex> same_as(domain.points.size());
  for (VertexIndex v = 0; v < same_as.size(); ++v) same_as[v] = v;
  for (const auto& [v, first] : duplicates) same_as[v] = first;
  if (!duplicates.empty())
    grid.warnings.push_back(fmt::format("{} points lie on others; they are taken as one", duplicates.size()));
  insert_segments(domain, same_as, grid, context);
  colour_regions(domain, options, grid);
  return grid;
}

double nearest_neighbour(const TriComplex& c, VertexIndex v) {
  double nearest = 1e300;
  const EdgeRef first = c.first_edge(v);
  EdgeRef ref = first;
  do {
    if (const VertexIndex w = c.target(ref); w != kInfinity)
      nearest = std::min(nearest, std::sqrt(squared_length(c.point[w] - c.point[v])));
    ref = c.turn_left(ref);
  } while (ref != first);
  return nearest;
}

/// At each point of the boundary the mean length of its segments there; at points that stand free the nearest one's
/// distance where that is less than what the field would have.
BoundarySizes measure_boundary(const PlanarGrid& grid) {
  const TriComplex& c = grid.complex;
  std::vector<double> sum(c.point.size(), 0);
  std::vector<std::uint32_t> count(c.point.size(), 0);
  for (const PlanarPiece& piece : grid.pieces) {
    const EdgeRef ref = c.find_edge(piece.a, piece.b);
    if (c.tri[ref >> 2].region == kOutside && c.tri[c.across(ref) >> 2].region == kOutside) continue;
    const double length = std::sqrt(squared_length(c.point[piece.b] - c.point[piece.a]));
    for (const VertexIndex v : {piece.a, piece.b}) {
      sum[v] += length;
      ++count[v];
    }
  }
  BoundarySizes sizes;
  for (VertexIndex v = 0; v < c.point.size(); ++v) {
    if (c.vertex_tri[v] == kNoTri) continue;
    const bool is_free = count[v] == 0;
    if (is_free && c.tri[c.vertex_tri[v]].region == kOutside) continue;
    const double h = is_free ? nearest_neighbour(c, v) : sum[v] / count[v];
    sizes.points.push_back({c.point[v].x, c.point[v].y, 0});
    sizes.size.push_back(h);
  }
  return sizes;
}

/// The lesser of two fields; of one alone where there is no other.
class LesserField : public SizeField {
 public:
  LesserField(const std::unique_ptr<SizeField>& one, const SizeField* two) : one_(one), two_(two) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    one_->sizes(at, size);
    if (!two_) return;
    std::vector<double> other(at.size());
    two_->sizes(at, other);
    for (std::size_t i = 0; i < at.size(); ++i) size[i] = std::min(size[i], other[i]);
  }
  double lower_bound(const Box& box) const override {
    const double low = one_->lower_bound(box);
    return two_ ? std::min(low, two_->lower_bound(box)) : low;
  }

 private:
  const std::unique_ptr<SizeField>& one_;  ///< may be built anew
  const SizeField* two_;
};

/// The field's size at every vertex, so that all sizes keep the growth.
void set_vertex_sizes(TriComplex& complex, const SizeField& field) {
  std::vector<Point> places;
  places.reserve(complex.point.size());
  for (const Point2 p : complex.point) places.push_back({p.x, p.y, 0});
  complex.h.resize(places.size());
  field.sizes(places, complex.h);
}

}  // namespace

std::vector<Finding> check_planar_domain(const PlanarDomain& domain, Context& context) {
  check_floating_point_mode();
  std::vector<Finding> findings;
  try {
    check_domain(domain);
    DomainOptions all;
    all.keep = "all";
    for (const std::string& warning : triangulate(domain, all, context).warnings)
      findings.push_back({"lines", Severity::warning, 1, warning, "", {}});
  } catch (const InputError& e) {
    findings.push_back(
        {"invalid_lines", Severity::error, std::max<std::size_t>(e.places.size(), 1), e.what(), "", e.places});
  }
  return findings;
}

Outcome generate_planar(const PlanarDomain& domain, const Options& options, Context& context, const SizeField* size) {
  check_floating_point_mode();
  check_domain(domain);
  Outcome outcome;
  Report& report = outcome.report;
  PlanarGrid grid = triangulate(domain, options.domain, context);
  BoundarySizes sizes = measure_boundary(grid);
  const double largest = largest_size(sizes);
  auto by_boundary = build_asked_size_field(std::move(sizes), options.size, largest, context);
  const LesserField both(by_boundary, size);
  if (options.planar.boundary == "split") {
    split_segments(grid, both, context);
    by_boundary = build_asked_size_field(measure_boundary(grid), options.size, largest, context);
  }
  const SizeField& field = size ? static_cast<const SizeField&>(both) : *by_boundary;
  set_vertex_sizes(grid.complex, field);
  report.refine = refine_complex(grid, field, context);
  if (options.improve.enabled)
    report.improve = improve_complex(grid,
                                     {.min_angle = options.planar.min_angle,
                                      .max_passes = options.improve.max_passes,
                                      .first_free = static_cast<VertexIndex>(domain.points.size())},
                                     context);
  else
    grid.complex.index_vertices();
  report.warnings = grid.warnings;
  outcome.mesh = to_mesh(grid, domain);
  grid = {};
  const StageTimer timer(context, "measure");
  report.quality = measure_quality(outcome.mesh, context);
  return outcome;
}

}  // namespace delfront
