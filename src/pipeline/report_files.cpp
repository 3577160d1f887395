// SPDX-License-Identifier: Apache-2.0
#include "pipeline/report_files.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/report_name.hpp"
#include "io/grid_files.hpp"
#include "pipeline/job_checks.hpp"
#include "pipeline/report_json.hpp"
#include "report/page.hpp"

namespace delfront {

std::vector<std::string> report_files(const std::string& report) {
  if (report.empty()) return {};
  if (!is_page_name(report)) return {report};
  return {json_name(report), report};
}

/// What the run reads and what it writes else.
static std::vector<std::string> other_files(const Options& options) {
  std::vector<std::string> files;
  const auto add = [&](const std::vector<std::string>& more) { files.insert(files.end(), more.begin(), more.end()); };
  for (const std::string& input : options.input.files) add(files_read_as(input));
  for (const std::string& output : options.output.files) add(files_written_as(output, options.output.format));
  add(files_read_as(options.refine.geometry));
  const std::vector<std::string> jobs = job_files(options);
  files.insert(files.end(), jobs.begin(), jobs.end());
  std::erase(files, "");
  return files;
}

void write_report_files(const Options& options, const std::string& command, const JobResult& result) {
  const std::vector<std::string> files = report_files(options.output.report), others = other_files(options);
  if (files.empty() || std::any_of(files.begin(), files.end(),
                                   [&](const std::string& file) { return find_same_file(file, others) != nullptr; }))
    return;
  const std::string json = report_json(result, options, command);
  write_text_file(files.front(), json);
  if (files.size() < 2) return;
  const Mesh& shown = result.partial ? *result.partial : result.mesh;
  write_text_file(files.back(), report_page(json, options_json(Options()).dump(), shown));
}

}  // namespace delfront
