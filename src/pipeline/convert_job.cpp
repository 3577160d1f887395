// SPDX-License-Identifier: Apache-2.0
#include "pipeline/convert_job.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "io/grid_files.hpp"
#include "pipeline/geometry_job.hpp"
#include "pipeline/job_checks.hpp"

namespace delfront {

void check_write_options(const WriteOptions& options) {
  if (!options.version.empty() && options.version != "2.2" && options.version != "4.1")
    throw UsageError(fmt::format("version {} of MSH (--msh-version): allowed are 2.2 and 4.1", options.version));
}

static void check_starter_solver(const ConvertOptions& options, const std::string& out) {
  if (options.solver.empty()) return;
  const std::vector<std::string>& known = starter_solvers();
  if (std::find(known.begin(), known.end(), options.solver) == known.end())
    throw UsageError(fmt::format("--solver {}: allowed are {}", options.solver, fmt::join(known, ", ")));
  if (format_of(out, options.to, true).name != options.solver)
    throw UsageError(fmt::format("--solver {}: {} is not a grid of that solver; give OUT as {}", options.solver, out,
                                 options.solver == "openfoam" ? "a name ending in /, an OpenFOAM case" : "grid.su2"));
}

Mesh convert_file(const std::string& in, const std::string& out, const ConvertOptions& options,
                  std::vector<std::string>& changes, Context& context, StarterFiles* starter) {
  check_write_options(options.how);  // before the input is read
  check_starter_solver(options, out);
  refuse_to_overwrite(in, options.from, files_written_as(out, options.to));
  check_writable(out);
  if (is_smooth_file(in))
    throw UsageError(fmt::format(
        "{} is smooth geometry, which has no cells yet: delfront mesh {} -o {} --stop-after surface grids it", in, in,
        out));
  Mesh mesh = read_mesh(in, context, options.from);
  StarterFiles made;
  changes = write_for_solver(mesh, out, options, context, made);
  if (starter) *starter = std::move(made);
  return mesh;
}

std::vector<std::string> write_for_solver(const Mesh& mesh, const std::string& out, const ConvertOptions& options,
                                          Context& context, StarterFiles& starter) {
  check_write_options(options.how);
  check_starter_solver(options, out);
  std::vector<std::string> changes = write_mesh(mesh, out, context, options.how, options.to);
  if (!options.solver.empty()) starter = write_starter_files(mesh, out, options.solver, context, options.to);
  return changes;
}

}  // namespace delfront
