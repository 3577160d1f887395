// SPDX-License-Identifier: Apache-2.0
// Sizes that follow from the model: on names, from curvature, gaps and lines.
#include <fmt/format.h>

#include "delfront/errors.hpp"
#include "delfront/geometry_sizes.hpp"
#include "delfront/surface_check.hpp"
#include "pipeline/job_sizes.hpp"
#include "pipeline/option_table.hpp"

namespace delfront {

namespace {

void report_sources(const GeometrySources& found, const std::string& key, Context& context) {
  if (found.sources.empty()) return;
  const GeometrySizeReport& r = found.report;
  context.log(LogLevel::info, fmt::format("{}: sizes from {:g} (at {:g} {:g} {:g}), {} places{}", key, r.smallest,
                                          r.smallest_at.x, r.smallest_at.y, r.smallest_at.z, r.num_sources,
                                          r.num_at_hmin ? fmt::format(", {} of them at hmin", r.num_at_hmin) : ""));
}

template <class Find>
void add_found(const Options& options, const std::string& key, GeometrySources& all, Context& context,
               const Find& find) {
  GeometrySources found = with_place(options, key, find);
  report_sources(found, key, context);
  all.append(std::move(found));
}

/// Of facets: nothing by itself, and with automatic alone what shape needs.
bool asks_automatic(const SizeOptions& size) { return size.automatic.value_or(!size.accuracy.empty()); }

AccuracyNumbers usual_numbers(const SizeOptions& size) {
  AccuracyNumbers numbers = accuracy_numbers(size.accuracy);
  if (size.accuracy.empty()) numbers.cells_per_turn = AutomaticSizes().cells_per_turn.value();
  return numbers;
}

CurvatureSizes curvature_wish(const SizeOptions& size, const Model& model) {
  CurvatureSizes wish;
  if (size.curvature > 0) wish.cells_per_turn = size.curvature;
  if (size.angle > 0) wish.angle_deg = size.angle;
  if (size.deviation) wish.deviation = size.deviation->value;
  if (asks_automatic(size) && !wish.cells_per_turn && !wish.angle_deg && !wish.deviation) {
    wish.cells_per_turn = usual_numbers(size).cells_per_turn;
    wish.hmin = usual_hmin(model);
  }
  if (size.angle_form == "tangent") wish.form = CurvatureSizes::Form::tangent;
  if (size.hmin) wish.hmin = size.hmin->value;
  return wish;
}

/// The side of the surface that is gridded; where it may be both, both are looked at.
GapSizes::Side gridded_side(const DomainOptions& domain) {
  return domain.keep.empty() && domain.keep_points.empty() ? GapSizes::Side::behind : GapSizes::Side::both;
}

GapSizes gap_wish(const Options& options, const GapOptions& asked, double usual_cells,
                  const std::function<bool(Point)>& is_kept = {}) {
  GapSizes wish;
  wish.cells = asked.cells > 0 ? asked.cells : usual_cells;
  if (options.size.hmin) wish.hmin = options.size.hmin->value;
  if (asked.hmin) wish.hmin = asked.hmin->value;
  wish.side = gridded_side(options.domain);
  wish.is_kept = is_kept;
  return wish;
}

/// New surfaces lie on the given one too: where that does not hold what is asked of surfaces, it is said (S13).
void warn_of_coarse_facets(const Model& model, const CurvatureSizes& wish, Context& context) {
  SurfaceLimits limits;
  if (wish.angle_deg) limits.angle_deg = *wish.angle_deg;
  if (wish.cells_per_turn) limits.angle_deg = std::min(limits.angle_deg, 360 / *wish.cells_per_turn);
  if (wish.deviation) limits.deviation = *wish.deviation;
  const SurfaceAccuracy found = measure_surface_accuracy(model, limits, context);
  const auto warn = [&](const SurfaceAccuracy::Worst& worst, const char* what, double limit) {
    if (worst.num_beyond == 0) return;
    context.warn(
        fmt::format("{} {} {:.4g}, the worst {:.4g} at {:g} {:g} {:g}: the grid's surface is never closer to the "
                    "true one than the given facets; finer ones there would hold it",
                    worst.num_beyond, what, limit, worst.value, worst.at.x, worst.at.y, worst.at.z));
  };
  warn(found.angle_deg, "edges of the given surface turn by more than the asked degrees,", limits.angle_deg);
  warn(found.deviation, "given facets are farther from the surface they stand for than", limits.deviation);
}

/// Curvature, gaps and lines: of many facets, so sources that say nearly the same are merged.
GeometrySources find_surface_sizes(const Options& options, const Model& model,
                                   const std::function<bool(Point)>& is_kept, Context& context) {
  const SizeOptions& size = options.size;
  const CurvatureSizes curvature = curvature_wish(size, model);
  const bool asks_curvature = curvature.cells_per_turn || curvature.angle_deg || curvature.deviation;
  const bool asks_gap = size.gap.cells > 0 || asks_automatic(size);
  const bool asks_lines = size.proximity.cells > 0 || asks_automatic(size);
  GeometrySources all;
  if (!asks_curvature && !asks_gap && !asks_lines) return all;
  Model turned = model;  // sides are told by normals
  turned.feature_angle = options.input.feature_angle;
  if (!turned.triangles.empty()) orient_shells(turned, context);
  if (asks_curvature)
    add_found(options, "size.curvature", all, context,
              [&] { return find_curvature_sizes(turned, curvature, context); });
  if (asks_curvature && !turned.triangles.empty()) warn_of_coarse_facets(turned, curvature, context);
  const AccuracyNumbers usual = usual_numbers(size);
  if (asks_gap)
    add_found(options, "size.gap", all, context,
              [&] { return find_gap_sizes(turned, gap_wish(options, size.gap, usual.gap_cells, is_kept), context); });
  if (asks_lines)
    add_found(options, "size.proximity", all, context, [&] {
      return find_line_gap_sizes(turned, gap_wish(options, size.proximity, usual.line_cells), context);
    });
  merge_close_sources(all);
  return all;
}

}  // namespace

std::vector<SizeSource> geometry_sources(const Options& options, const Model& model,
                                         const std::function<bool(Point)>& is_kept, Context& context) {
  GeometrySources found;
  for (const SizeOnOptions& on : options.size.on) {
    const std::string key = "size.on." + toml_key(on.name);
    if (!on.h) throw usage_error(options, key, "h is missing, the size there");
    const NamedSize named{on.name, on.h->value};
    add_found(options, key, found, context, [&] { return find_named_sizes(model, {&named, 1}, context); });
  }
  found.append(find_surface_sizes(options, model, is_kept, context));
  return std::move(found.sources);
}

}  // namespace delfront
