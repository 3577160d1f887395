// SPDX-License-Identifier: Apache-2.0
#include "pipeline/job_leavings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "delfront/surface_check.hpp"
#include "pipeline/job_checks.hpp"
#include "pipeline/planar_job.hpp"
#include "pipeline/quantities.hpp"
#include "pipeline/report_json.hpp"

namespace delfront {

namespace fs = std::filesystem;

namespace {

/// The first output's name with this ending instead of its type.
std::string beside_output(const Options& options, const char* ending) {
  fs::path base = !options.output.files.empty()  ? options.output.files.front()
                  : !options.input.files.empty() ? options.input.files.front()
                                                 : "curves";
  if (!base.has_filename()) base = base.parent_path();
  if (options.output.files.empty()) base = base.filename();  // beside the input may be no place for us: where we are
  return (base.parent_path() / (base.stem().string() + ending)).string();
}

/// What the run found out about its surface; looked at now where it was refused before anyone could.
std::vector<Finding> surface_findings(Run& run) {
  SurfaceReport& report = run.result.report.surface;
  if (run.result.exit_code != ExitCode::bad_input || run.inputs.empty() || !report.findings.empty() ||
      is_planar_job(run.inputs))
    return report.findings;
  try {
    Context quiet;
    report = check_surface(build_model(run.inputs, quiet), quiet);
  } catch (const Error&) {
    // the input is too broken to look at: the places of the error itself are what there is
  }
  return report.findings;
}

/// Findings stand in the input's units, the grid beside them perhaps in others.
void scale_to_output(const Options& options, std::vector<Finding>& findings) {
  if (options.output.units.empty()) return;
  const double factor = metres_per_unit(options.input.units) / metres_per_unit(options.output.units);
  for (Finding& finding : findings) {
    for (Place& place : finding.places) place.at = factor * place.at;
    for (Outline& outline : finding.outlines)
      for (Point& p : outline.corners) p = factor * p;
  }
}

std::vector<Finding> all_findings(Run& run) {
  const JobResult& result = run.result;
  std::vector<Finding> findings = surface_findings(run);
  if (result.exit_code == ExitCode::gate_not_met) {
    findings.insert(findings.end(), result.gate_failures.begin(), result.gate_failures.end());
    scale_to_output(run.options, findings);
    return findings;
  }
  std::vector<Place> places = result.places;
  std::erase_if(places, [](const Place& place) { return !is_finite(place.at); });
  if (!places.empty() && !has_errors(findings))
    findings.push_back({outcome_name(result.exit_code), Severity::error, places.size(), result.error, "", places});
  return findings;
}

/// Marks near the beginning of what we leave, which nothing else has.
constexpr const char* kDefectsMark = "\"kind_id\"";
constexpr const char* kPartialMark = "\"region:unfinished\"";

bool has_mark(const std::string& path, const char* mark) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  std::string head(1 << 14, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.find("<VTKFile") != std::string::npos && head.find(mark) != std::string::npos;
}

/// An earlier run's file under a name that this run would have used must not pass for this run's.
void remove_stale(const std::string& path, const char* mark, Run& run) {
  if (find_same_file(path, run.options.input.files) || find_same_file(path, run.options.output.files) ||
      !has_mark(path, mark))
    return;
  std::error_code error;
  fs::remove(path, error);
  if (error) run.result.warnings.push_back(fmt::format("{} is of an earlier run; it could not be removed", path));
}

/// Whether the run came to a verdict; where it was stopped halfway, what an earlier one left is still right.
bool has_verdict(ExitCode code) {
  return code == ExitCode::done || code == ExitCode::gate_not_met || code == ExitCode::bad_input ||
         code == ExitCode::meshing_failed;
}

/// A program that takes the result, and named no output, has it all in memory.
bool has_no_place(const Run& run) { return run.extras.wants_result && run.options.output.files.empty(); }

}  // namespace

void leave_defects(Run& run) {
  JobResult& result = run.result;
  const bool is_asked_for = !run.options.output.defects.empty();
  if (result.exit_code == ExitCode::usage || result.exit_code == ExitCode::cannot_write) return;
  if (!is_asked_for && has_no_place(run)) {
    surface_findings(run);
    return;
  }
  if (!has_verdict(result.exit_code) && !is_asked_for) return;
  const std::string path = is_asked_for ? run.options.output.defects : beside_output(run.options, "_defects.vtp");
  const std::vector<Finding> findings = all_findings(run);
  const auto has_places = [](const Finding& f) { return !f.places.empty(); };
  const bool is_shown = is_asked_for
                            ? !findings.empty()
                            : has_errors(findings) && std::any_of(findings.begin(), findings.end(), has_places);
  if (!is_shown) return remove_stale(path, kDefectsMark, run);
  try {
    if (find_same_file(path, run.options.input.files))
      throw UsageError(path + " is an input; --defects FILE names another place");
    Context quiet;  // neither the limit nor the signal that ended the run may end this
    write_defects(findings, path, quiet);
    result.defects_file = path;
  } catch (const Error& e) {
    result.warnings.push_back(fmt::format("no defects file: {}", e.what()));
  }
}

void leave_partial_grid(Run& run) {
  JobResult& result = run.result;
  if (!has_verdict(result.exit_code) || has_no_place(run)) return;
  const std::string path = beside_output(run.options, "_partial.vtu");
  if (result.exit_code != ExitCode::meshing_failed || !result.partial || result.partial->top_dimension() < 2)
    return remove_stale(path, kPartialMark, run);
  try {
    if (find_same_file(path, run.options.input.files) || find_same_file(path, run.options.output.files))
      throw UsageError(path + " is an input, or the name of a grid");
    Context quiet;
    write_mesh(*result.partial, path, quiet);
    result.partial_file = path;
  } catch (const Error& e) {
    result.warnings.push_back(fmt::format("no partial grid: {}", e.what()));
  }
}

}  // namespace delfront
