// SPDX-License-Identifier: Apache-2.0
#include "pipeline/refine_job.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "delfront/errors.hpp"
#include "delfront/grid_check.hpp"

namespace delfront {

static std::string first_error(const std::vector<Finding>& findings) {
  for (const Finding& f : findings)
    if (f.severity == Severity::error) return f.message;
  return "";
}

void check_refine_options(const RefineGridOptions& options, const std::string& levels,
                          const std::string& feature_angle) {
  if (options.levels < 1)
    throw UsageError(
        fmt::format("{} {}: expected how many times to halve the edges, 1 or more", levels, options.levels));
  if (!(options.feature_angle_deg >= 0 && options.feature_angle_deg <= 180))
    throw UsageError(fmt::format("{} {:g}: expected degrees from 0 to 180", feature_angle, options.feature_angle_deg));
}

void check_grid_to_refine(const Mesh& mesh, const std::string& name, Context& context) {
  if (mesh.top_dimension() < 2)
    throw InputError(fmt::format("{} has neither faces nor volume cells; there is no grid to refine", name));
  context.check_limits();
  const std::vector<Finding> findings = check(mesh);
  if (has_errors(findings))
    throw InputError(fmt::format("{} is not a valid grid: {}; 'delfront check {}' shows all that is wrong", name,
                                 first_error(findings), name),
                     findings.front().places);
}

Model geometry_to_refine_on(const Mesh& grid, Mesh geometry, const std::string& name, Context& context) {
  const std::string stem = std::filesystem::path(name).stem().string();
  if (grid.dimension != 2) return build_model({{std::move(geometry), stem}}, context);
  if (geometry.num_cells(CellType::line) == 0)
    throw InputError(
        fmt::format("{} has no lines, which the geometry of a grid in the plane consists of; give e.g. airfoil "
                    "coordinates (.dat) or lines as VTP",
                    name));
  return model_of_lines(geometry, stem);
}

Mesh refine_and_check(const Mesh& coarse, const RefineGridOptions& options, RefineGridReport& report,
                      Context& context) {
  Mesh fine = refine_grid(coarse, options, report, context);
  const StageTimer timer(context, "check");
  context.progress("check", 0, 1, "grid");
  const std::vector<Finding> findings = check(fine);
  if (has_errors(findings))
    throw MeshingError(fmt::format("the refined grid is not valid and was not written: {}", first_error(findings)),
                       findings.front().places);
  context.progress("check", 1, 1, "grid");
  return fine;
}

}  // namespace delfront
