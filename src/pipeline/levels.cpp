// SPDX-License-Identifier: Apache-2.0
#include "pipeline/levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/size_survey.hpp"
#include "planar/prepare.hpp"
#include "sizing/asked_sizes.hpp"

namespace delfront {

double coarsening(const Options& options) { return std::ldexp(1, options.refine.levels); }

Options coarse_options(const Options& options) {
  Options coarse = options;
  if (options.refine.levels == 0) return coarse;
  const double factor = coarsening(options);
  const auto scale = [factor](std::optional<Length>& length) {
    if (length) length->value *= factor;
  };
  scale(coarse.size.hmin);
  scale(coarse.size.hmax);
  scale(coarse.domain.enclose.h);
  for (PlanarCurveOptions& curve : coarse.planar.curves) scale(curve.h);
  coarse.size.steeper = factor;
  coarse.refine = {};
  coarse.output.sizes = false;
  return coarse;
}

std::shared_ptr<const SizeField> coarse_sizes(std::shared_ptr<const SizeField> asked, const Options& options,
                                              const Box& domain, Context& context) {
  if (!asked || options.refine.levels == 0) return asked;
  const double growth = growth_of(options.size), factor = coarsening(options);
  const double steeper = steeper_growth(growth, factor);
  const bool is_too_steep = factor * (growth - 1) / growth > (steeper - 1) / steeper * (1 + 1e-9);
  std::shared_ptr<const SizeField> coarse = scale_sizes(std::move(asked), factor);
  return is_too_steep && coarse->is_isotropic() ? limit_growth(std::move(coarse), domain, steeper, context) : coarse;
}

CoarseLimit::CoarseLimit(Context& context, const Options& options, bool is_planar)
    : context_(context), max_cells_(context.max_cells), limit_advice_(context.limit_advice) {
  if (options.refine.levels == 0 || max_cells_ == 0) return;
  const std::uint64_t children = std::uint64_t{1} << ((is_planar ? 2 : 3) * options.refine.levels);
  context_.max_cells = std::max<std::uint64_t>(1, max_cells_ / children);
  context_.limit_advice = fmt::format(
      "these are cells of the coarse grid, each of which becomes {} (refine.levels): {}", children, limit_advice_);
}

void CoarseLimit::end() {
  context_.max_cells = max_cells_;
  context_.limit_advice = limit_advice_;
}

void refine_levels(Outcome& outcome, const Options& options, const Model* geometry, Context& context) {
  if (options.refine.levels == 0) return;
  LevelsReport& report = outcome.report.levels;
  report.coarse_cells = outcome.mesh.num_cells_of_dimension(outcome.mesh.top_dimension());
  report.coarse_points = outcome.mesh.points.size();
  RefineGridOptions how;
  how.levels = options.refine.levels;
  how.model = geometry;
  how.feature_angle_deg = options.input.feature_angle;
  outcome.mesh = refine_grid(outcome.mesh, how, report.refined, context);
  for (Field& field : outcome.mesh.fields) {
    if (field.name != "h" && field.name != "metric") continue;
    const double factor = field.name == "h" ? 1 / coarsening(options) : std::pow(coarsening(options), 2);
    for (double& value : field.values) value *= factor;
  }
  for (std::string& warning :
       warnings_of(report.refined, options.refine.geometry.empty() ? "the geometry" : options.refine.geometry))
    outcome.report.warnings.push_back(std::move(warning));
  context.log(
      LogLevel::info,
      fmt::format(
          "{} coarse cells became {}: every edge was halved {}; a boundary that is kept as given is that "
          "of the coarse grid, each of its {} became {}",
          report.coarse_cells, report.refined.num_cells, how.levels == 1 ? "once" : fmt::format("{} times", how.levels),
          outcome.mesh.dimension == 2 ? "lines" : "triangles", 1 << ((outcome.mesh.dimension - 1) * how.levels)));
}

Outcome generate_planar_in_levels(const PlanarDomain& domain, const Options& options, Context& context,
                                  std::shared_ptr<const SizeField> asked, const Model* geometry) {
  check_floating_point_mode();
  Box box;
  for (const Point2 p : domain.points) box.add(Point{p.x, p.y, 0});
  Options coarse = coarse_options(options);
  coarse.output.sizes = options.output.sizes;
  asked = coarse_sizes(std::move(asked), options, box, context);
  Outcome outcome;
  {
    CoarseLimit limit(context, options, true);
    PlanarPrepared prepared = prepare_planar(domain, coarse, asked, context);
    limit.end();
    refuse_too_many_cells(prepared, coarse.size, options.refine.levels, context);
    const CoarseLimit again(context, options, true);
    outcome = fill_planar(std::move(prepared), domain, coarse, context);
  }
  if (options.refine.levels == 0) return outcome;
  outcome.report.size_fit.reset();  // that of the coarse grid
  refine_levels(outcome, options, geometry, context);
  const StageTimer timer(context, "measure");
  outcome.report.quality = measure_quality(outcome.mesh, context);
  return outcome;
}

}  // namespace delfront
