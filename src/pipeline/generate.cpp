// SPDX-License-Identifier: Apache-2.0
// The whole run on one screen: look, recover the boundary, sizes, points, improvement, levels.
#include "delfront/generate.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "base/report_name.hpp"
#include "improve/improve.hpp"
#include "pipeline/levels.hpp"
#include "pipeline/prepare.hpp"
#include "pipeline/size_survey.hpp"
#include "sizing/asked_sizes.hpp"
#include "sizing/size_fit.hpp"
#include "volume/front.hpp"
#include "volume/refine.hpp"
#include "volume/to_mesh.hpp"

namespace delfront {

namespace {

/// Scratch of a stage that the allocator keeps would add to the peak of the next one.
void give_back_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

/// Cells that are stretched as asked have small angles, which improvement would undo.
void improve(TetComplex& complex, const SizeField& size, const Options& options, Report& report, Context& context) {
  if (!options.improve.enabled) return;
  if (makes_stretched_cells(options, &size) && report.front.gave_up.empty())
    context.warn("the sizes ask for stretched cells: improvement, which goes by angles, was left out");
  else
    report.improve = improve_complex(complex, size, options.improve, context);
}

}  // namespace

Outcome generate(Model model, const Options& all_options, Context& context, std::shared_ptr<const SizeField> asked,
                 const Model* geometry) {
  check_floating_point_mode();
  const Options options = coarse_options(all_options);  // the same without levels
  Outcome outcome;
  Report& report = outcome.report;
  const bool is_new_surface = all_options.refine.levels > 0 && options.surface.method != "keep";
  const Model given = is_new_surface && !geometry ? model : Model();  // the true geometry of a coarser surface
  if (is_new_surface && !geometry) geometry = &given;
  asked = coarse_sizes(std::move(asked), all_options, model.bounding_box(), context);
  Prepared prepared = prepare_volume(model, options, std::move(asked), report, context);
  if (!makes_stretched_cells(options, prepared.size.get()))  // least sizes say little about stretched cells
    refuse_too_many_cells(prepared, options.size, all_options.refine.levels, context);
  CoarseLimit limit(context, all_options, false);
  auto [grid, size] = std::move(prepared);
  const bool is_front = options.volume.method == "front";
  if (is_front) report.front = fill_by_front(grid, *size, context);
  if (!is_front || !report.front.gave_up.empty())
    report.refine = refine_complex(grid.complex, *size, options.volume, context);
  give_back_free_memory();
  improve(grid.complex, *size, options, report, context);
  const bool wants_fit = is_page_name(all_options.output.report) && !makes_stretched_cells(options, size.get());
  if (!all_options.output.sizes && !wants_fit) size.reset();
  give_back_free_memory();
  outcome.mesh = to_mesh(std::move(grid), model, context.threads);
  limit.end();
  refine_levels(outcome, all_options, geometry, context);
  if (size) size = scale_sizes(size, 1 / coarsening(all_options));
  if (all_options.output.sizes) add_size_field(outcome.mesh, *size, context);
  const StageTimer timer(context, "measure");
  if (wants_fit) report.size_fit = measure_size_fit(outcome.mesh, *size, context);
  size.reset();
  give_back_free_memory();
  report.quality = measure_quality(outcome.mesh, context);
  return outcome;
}

}  // namespace delfront
