// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/options.hpp"

namespace delfront {

/// @brief Read a job file into `options`: TOML, or JSON with the same tree where the name ends in .json.
///
/// Keys that the file does not name keep their values. Paths in it are relative to the folder the file lies in.
/// @throws UsageError  the file cannot be read; not TOML / JSON, unknown key, wrong type or value: the key, its line,
/// what is allowed, and the
///                     nearest right name
void read_job_file(const std::string& path, Options& options);

/// @brief Set one option as `--set key=value` does: set_option(options, "size.hmax", "5%").
///
/// The value is read as TOML reads it; a text needs no quotes. Tables and lists work too.
/// @throws UsageError  as read_job_file
void set_option(Options& options, const std::string& key, const std::string& value);

/// @return the whole configuration as a TOML job file, defaults included, one comment a key; reading it gives the
///         same options again
std::string print_config(const Options& options);

/// @brief An input file as the report names it.
struct InputFile {
  std::string path;
  std::uint64_t bytes = 0;
  std::string hash;  ///< "fnv1a64:" and 16 hexadecimal digits, of the bytes; empty for a folder
  std::size_t num_points = 0, num_cells = 0;
};

/// @brief How a job ended and all that a front end may want to show.
struct JobResult {
  ExitCode exit_code = ExitCode::done;
  std::string error;          ///< empty where exit_code is `done`
  std::vector<Place> places;  ///< of the error
  std::string stage;          ///< the last stage that was begun

  std::vector<InputFile> inputs;
  LengthScale scale;  ///< of the input, before any far field
  Mesh mesh;          ///< empty where the run failed
  Report report;      ///< filled as far as the run came; `surface.findings` also where the surface was refused

  std::vector<std::string> failed_gates;   ///< sentences
  std::vector<std::string> files_written;  ///< grids, each complete
  std::vector<std::string> name_changes;   ///< names that a format could not hold, as sentences
  std::vector<std::string> warnings;       ///< everything logged at LogLevel::warning, and the report's warnings
  std::string defects_file;                ///< written where something was wrong; else empty
  std::string partial_file;                ///< the grid as far as it came, where gridding failed; else empty
  std::vector<StageTime> stage_times;
  double seconds = 0;
  std::uint64_t peak_memory = 0;  ///< bytes
};

/// @brief A whole job: read, check, enclose, grid, improve, gates, write, report.
///
/// Nothing is thrown: how the run ended stands in the result, and, where `options.output.report` names a file, in that
/// file too, also when the run failed. Outputs are tried for writing before any work. When the surface is refused,
/// gridding fails or a gate is not met, a defects file is written to `options.output.defects`, or beside the first
/// output. Where gridding fails, the grid as far as it came is written beside the first output as NAME_partial.vtu.
/// Either one of an earlier run, under that name, is removed where this run has none. Limits of `options.limits` are
/// put into `context`.
/// @param command  what the user typed, for the report
/// @post  each of files_written is complete; no other output exists that was not there before
JobResult run_job(const Options& options, Context& context, const std::string& command = "");

/// @brief The report as JSON text, with the effective options; `command` is what the user typed.
std::string report_json(const JobResult& result, const Options& options, const std::string& command);

}  // namespace delfront
