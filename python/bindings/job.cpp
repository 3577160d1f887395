// SPDX-License-Identifier: Apache-2.0
// Jobs: a dict becomes options by the table of all options, functions become size fields.
#include "delfront/job.hpp"

#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "core.hpp"
#include "delfront/size_expression.hpp"
#include "pipeline/option_table.hpp"
#include "pipeline/report_json.hpp"
#include "runner.hpp"

namespace delfront::python {

using namespace nb::literals;

namespace {

/// A job file, if any, then what the dict says: the later wins.
Options options_of(const std::string& file, const nb::dict& job) {
  Options options;
  if (!file.empty()) read_job_file(file, options);
  apply_value(options, "", job_value(job), [](int) { return std::string(); });
  return options;
}

// --- functions of the caller as size fields -------------------------------------------------------------------------

void check_values(std::span<const Point> at, std::span<const double> size) {
  for (std::size_t i = 0; i < at.size(); ++i)
    if (!(size[i] > 0))
      throw Error(ExitCode::usage,
                  fmt::format("the size function gives {:g} at ({:g}, {:g}, {:g}); sizes are positive, or infinite "
                              "where it has no opinion",
                              size[i], at[i].x, at[i].y, at[i].z),
                  {{at[i], {}}});
}

/// Takes Python's lock, from whatever thread it is called.
void call_function(const nb::object& function, std::span<const Point> at, std::span<double> size, Runner& runner) {
  const nb::gil_scoped_acquire acquired;
  if (!acquired.is_valid()) throw Cancelled();
  try {
    const auto* const first = reinterpret_cast<const double*>(at.data());
    const nb::object result = function(array_of(std::vector<double>(first, first + 3 * at.size()), 3));
    const auto values = nb::cast<GivenArray<double, 1>>(result);
    if (values.size() != at.size())
      throw UsageError(fmt::format("the size function gives {} values for {} points", values.size(), at.size()));
    std::copy_n(values.data(), size.size(), size.begin());
  } catch (const Error&) {
    throw;
  } catch (...) {
    runner.stop_with(std::current_exception());
    throw Cancelled();
  }
}

std::shared_ptr<const SizeField> field_of(nb::object function, Runner& runner) {
  const auto release = [](nb::object* held) {
    const nb::gil_scoped_acquire acquired;
    delete held;
  };
  const std::shared_ptr<nb::object> held(new nb::object(std::move(function)), release);
  Context quiet;
  return build_callback_size_field(
      [held, &runner](std::span<const Point> at, std::span<double> size) {
        call_function(*held, at, size, runner);
        check_values(at, size);
      },
      std::numeric_limits<double>::min(), quiet);
}

// --- results --------------------------------------------------------------------------------------------------------

std::vector<Finding> all_findings(const JobResult& result) {
  std::vector<Finding> findings = result.report.surface.findings;
  findings.insert(findings.end(), result.gate_failures.begin(), result.gate_failures.end());
  return findings;
}

nb::object partial_of(const JobResult& result) {
  return result.partial && result.partial->top_dimension() >= 0 ? nb::cast(Mesh(*result.partial))
                                                                : nb::object(nb::none());
}

nb::dict to_python(JobResult result, const Options& options, const std::string& command) {
  nb::dict d;
  d["report"] = text_of(report_json(result, options, command));
  d["exit_code"] = static_cast<int>(result.exit_code);
  d["error"] = text_of(result.error);
  const nb::tuple places = places_tuple(result.places);
  d["places"] = places[0];
  d["ids"] = places[1];
  d["findings"] = findings_list(all_findings(result));
  d["warnings"] = texts_list(result.warnings);
  d["name_changes"] = texts_list(result.name_changes);
  d["failed_gates"] = texts_list(result.failed_gates);
  d["files_written"] = texts_list(result.files_written);
  d["partial"] = partial_of(result);
  d["quality"] = result.report.quality.num_cells ? nb::cast(std::move(result.report.quality)) : nb::object(nb::none());
  const bool has_mesh = result.mesh.top_dimension() >= 0;
  d["mesh"] = has_mesh ? nb::cast(std::move(result.mesh)) : nb::object(nb::none());
  return d;
}

JobKind kind_of(const std::string& name) {
  return name == "estimate" ? JobKind::estimate : name == "sizes" ? JobKind::sizes : JobKind::grid;
}

/// What is said of a job file's grid is not meant for an estimate, nor for sizes.
void leave_out_outputs(Options& options, JobKind kind) {
  if (kind != JobKind::grid) options.output = {};
}

nb::dict run(const std::string& file, const nb::dict& job,
             const std::map<std::string, std::shared_ptr<HeldInput>>& held, const nb::list& functions,
             const std::string& kind_name, const std::string& command, const Hooks& hooks) {
  const JobKind kind = kind_of(kind_name);
  Options options = options_of(file, job);
  leave_out_outputs(options, kind);
  JobExtras extras;
  extras.wants_result = true;
  for (const auto& [name, input] : held) extras.held[name] = input;
  Runner runner(hooks);
  for (const nb::handle function : functions) options.size.fields.push_back(field_of(nb::borrow(function), runner));
  JobResult result;
  runner.run([&](Context& context) { result = run_job(options, context, command, kind, extras); });
  options.size.fields.clear();
  return to_python(std::move(result), options, command);
}

}  // namespace

void add_job(nb::module_& module) {
  module.def("run_job", &run, "file"_a, "job"_a, "held"_a, "functions"_a, "kind"_a, "command"_a, "hooks"_a,
             "A whole job; how it ended stands in the result.");
  module.def(
      "config",
      [](const std::string& file, const nb::dict& job) { return text_of(print_config(options_of(file, job))); },
      "file"_a, "job"_a, "The whole configuration as a job file; wrong keys and values are errors.");
}

}  // namespace delfront::python
