// SPDX-License-Identifier: Apache-2.0
// The whole run in the plane on one screen: Delaunay of the points, segments, regions, sizes, points, improvement.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/report_name.hpp"
#include "planar/front.hpp"
#include "planar/improve.hpp"
#include "planar/kernel.hpp"
#include "planar/prepare.hpp"
#include "planar/refine.hpp"
#include "planar/smooth.hpp"
#include "planar/split.hpp"
#include "planar/to_mesh.hpp"
#include "sizing/asked_sizes.hpp"
#include "sizing/size_fit.hpp"

namespace delfront {

namespace {

constexpr double kHigherGoal = 1.1;   ///< angles worked for after a front, of those asked for
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

std::shared_ptr<const SizeField> build_size_field(const PlanarGrid& grid, const SizeOptions& options, double largest,
                                                  const std::shared_ptr<const SizeField>& asked, Context& context) {
  std::shared_ptr<const SizeField> of_boundary =
      build_asked_size_field(measure_boundary(grid), options, largest, context);
  return asked ? combine_with_asked(std::move(of_boundary), asked, options) : of_boundary;
}

/// The field's size at every vertex, so that all sizes keep the growth.
void set_vertex_sizes(TriComplex& complex, const SizeField& field, const Context& context) {
  std::vector<Point> places;
  places.reserve(complex.point.size());
  for (const Point2 p : complex.point) places.push_back({p.x, p.y, 0});
  complex.h.resize(places.size());
  evaluate_sizes(field, places, complex.h, context);
}

/// A boundary that is kept has its points and no others, whatever sizes are asked for.
/// @return whether there are such segments
bool warn_of_long_segments(PlanarGrid& grid, const SizeOptions& options, const SizeField* asked,
                           const Context& context) {
  std::vector<std::array<Point, 2>> segments;
  for (const PlanarPiece& piece : grid.pieces) {
    const Point2 a = grid.complex.point[piece.a], b = grid.complex.point[piece.b];
    segments.push_back({Point{a.x, a.y, 0}, Point{b.x, b.y, 0}});
  }
  const LongEdges found = find_long_edges(segments, options, asked, context);
  if (found.count > 0)
    grid.warnings.push_back(
        fmt::format("{} segments of the boundary are longer than the sizes asked for there, the "
                    "worst {:g} where {:g} is asked for (at {:g} {:g}): the boundary is kept as "
                    "given; --boundary split divides it",
                    found.count, found.length, found.size, found.at.x, found.at.y));
  return found.count > 0;
}

/// Only the front makes stretched triangles; the other methods use the least size over all directions.
bool is_stretched(const Options& options, const SizeField& size) {
  return options.planar.method == "front" && !size.is_isotropic();
}

/// Points that circles ask for make short pieces, which lower the sizes beside them: then their neighbours are too
/// long. Circles are looked at in the first rounds only: at sharp corners they and the sizes could lower each other for
/// ever.
void split_boundary(PlanarPrepared& prepared, const Options& options, double largest,
                    const std::shared_ptr<const SizeField>& asked, Context& context) {
  constexpr int kRoundsOfCircles = 2;
  constexpr int kLastRound = 12;  // halving may go on from neighbour to neighbour; then sizes stay as they are
  const bool in_metric = is_stretched(options, *prepared.size);
  for (int round = 0;; ++round) {
    // circles say nothing of stretched triangles
    const bool by_circles = !in_metric && round < kRoundsOfCircles;
    const std::size_t count = split_segments(prepared.grid, *prepared.size, in_metric, by_circles, context);
    // Short pieces across the direction of long triangles must not bound sizes along it.
    if (in_metric || round == kLastRound || (round >= kRoundsOfCircles && count == 0)) return;
    prepared.size = build_size_field(prepared.grid, options.size, largest, asked, context);
  }
}

PointPlacement placement_of(const std::string& method) {
  return method == "delaunay" ? PointPlacement::circumcentres : PointPlacement::frontal;
}

/// One part of improvement after another: counts are added, the worst angle before is the first's.
void add_up(const ImproveReport& part, ImproveReport& all) {
  const ImproveReport before = all;
  all = part;
  all.passes += before.passes;
  all.edge_swaps += before.edge_swaps;
  all.points_moved += before.points_moved;
  all.points_removed += before.points_removed;
  all.points_added += before.points_added;
  if (before.passes > 0) all.min_dihedral_before_deg = before.min_dihedral_before_deg;
}

/// What a front leaves is smoothed first, and worked on for a higher goal than asked for, since triangles just above it
/// keep their neighbours below; triangles that are to be stretched are left alone, since angles say nothing
/// of them.
void improve_grid(PlanarGrid& grid, const Options& options, const SizeField& size, VertexIndex first_free,
                  Report& report, Context& context) {
  const bool is_front = options.planar.method == "front";
  grid.complex.index_vertices();
  if (!options.improve.enabled) return;
  if (is_stretched(options, size)) {
    grid.warnings.push_back("the sizes ask for stretched triangles: improvement, which goes by angles, was left out");
    return;
  }
  PlanarImproveOptions goals{
      .min_angle = options.planar.min_angle, .max_passes = options.improve.max_passes, .first_free = first_free};
  if (is_front) {
    add_up(smooth_complex(grid, {.first_free = first_free}, context), report.improve);
    PlanarImproveOptions higher = goals;
    higher.min_angle *= kHigherGoal;
    add_up(improve_complex(grid, higher, context), report.improve);
  }
  add_up(improve_complex(grid, goals, context), report.improve);
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

PlanarPrepared prepare_planar(const PlanarDomain& domain, const Options& options,
                              const std::shared_ptr<const SizeField>& asked, Context& context) {
  check_domain(domain);
  PlanarPrepared prepared;
  PlanarGrid& grid = prepared.grid;
  grid = triangulate(domain, options.domain, context);
  const double largest = largest_size(measure_boundary(grid));
  prepared.size = build_size_field(grid, options.size, largest, asked, context);
  if (options.planar.boundary == "split") split_boundary(prepared, options, largest, asked, context);
  if (options.planar.boundary == "keep")
    prepared.is_kept_too_long = warn_of_long_segments(grid, options.size, asked.get(), context);
  set_vertex_sizes(grid.complex, *prepared.size, context);
  return prepared;
}

Outcome generate_planar(const PlanarDomain& domain, const Options& options, Context& context,
                        std::shared_ptr<const SizeField> asked) {
  check_floating_point_mode();
  return fill_planar(prepare_planar(domain, options, asked, context), domain, options, context);
}

Outcome fill_planar(PlanarPrepared prepared, const PlanarDomain& domain, const Options& options, Context& context) {
  Outcome outcome;
  Report& report = outcome.report;
  PlanarGrid& grid = prepared.grid;
  const std::shared_ptr<const SizeField>& size = prepared.size;
  if (options.planar.method == "front")
    report.front = fill_by_front(grid, *size, context);
  else
    report.refine = refine_complex(grid, *size, context, placement_of(options.planar.method));
  improve_grid(grid, options, *size, static_cast<VertexIndex>(domain.points.size()), report, context);
  report.warnings = grid.warnings;
  outcome.mesh = to_mesh(grid, domain);
  if (options.output.sizes) add_size_field(outcome.mesh, *size, context);
  grid = {};
  const StageTimer timer(context, "measure");
  if (is_page_name(options.output.report) && !is_stretched(options, *size))
    report.size_fit = measure_size_fit(outcome.mesh, *size, context);
  report.quality = measure_quality(outcome.mesh, context);
  return outcome;
}

}  // namespace delfront
