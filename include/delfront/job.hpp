// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delfront/brep.hpp"
#include "delfront/brep_sizes.hpp"
#include "delfront/cad.hpp"
#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/io.hpp"
#include "delfront/model.hpp"
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

/// @brief What a job is run for.
enum class JobKind : std::uint8_t {
  grid,      ///< the whole of it
  estimate,  ///< how many cells, how much memory and time; writes nothing but the report
  sizes,     ///< the size field on an octree, written to output.files (VTU)
};

/// @brief What a grid of the wanted sizes will take, from the integral of h^-3 (in the plane h^-2) over the domain.
struct Estimate {
  double cells = 0, points = 0;
  double measure = 0;                        ///< volume or area that is gridded
  double least_size = 0, greatest_size = 0;  ///< of the field, at samples
  double memory = 0;                         ///< bytes at the peak
  double seconds = 0;                        ///< of the whole run, on a core of about 2.5 GHz a thread
  bool is_at_least = false;                  ///< sizes are finer in places than was looked at
};

struct GeometryText;

/// @brief What an input of a job holds, for programs that have it in memory.
struct HeldInput {
  Mesh mesh;                                 ///< facets, lines or a grid; of smooth geometry its first, coarse grid
  std::string stem;                          ///< name of patches and lines that have none
  std::shared_ptr<const Brep> brep;          ///< smooth geometry; null: the mesh is all there is
  std::shared_ptr<const BrepLook> look;      ///< of the smooth geometry
  CadReport cad;                             ///< of a CAD file
  std::shared_ptr<const GeometryText> text;  ///< what a .geom.toml file says; null: the input is another kind
};

/// @brief Read an input file, of any kind that jobs take.
/// @param format  of facets and grids, instead of by extension
/// @throws as read_mesh, read_geometry, read_cad
HeldInput read_input(const std::string& path, Context& context, const std::string& format = "");

/// @brief What a program that calls has to say beside the options.
struct JobExtras {
  /// By their entry in options.input.files: these are not read.
  std::map<std::string, std::shared_ptr<const HeldInput>> held;
  /// The grid in the result is what is wanted: no output need be named, and nothing is left in files that nobody asked
  /// for.
  bool wants_result = false;
};

/// @brief The surface grid of a file of smooth geometry.
struct GeometryGrid {
  std::string file;
  BrepRounds rounds;  ///< with refine.levels: of the final sizes
};

/// @brief How a job ended and all that a front end may want to show.
struct JobResult {
  ExitCode exit_code = ExitCode::done;
  std::string error;          ///< empty where exit_code is `done`
  std::vector<Place> places;  ///< of the error
  std::string stage;          ///< the last stage that was begun

  std::vector<InputFile> inputs;
  LengthScale scale;                   ///< of the input, before any far field
  Mesh mesh;                           ///< empty where the run failed
  std::vector<GeometryGrid> geometry;  ///< one a file of smooth geometry that was gridded
  Report report;  ///< filled as far as the run came; `surface.findings` also where the surface was refused

  std::shared_ptr<const Mesh> partial;  ///< the grid as far as it came, where gridding failed; else null
  /// What the exact check of the finished grid found, where output.report is a page; null: it was not looked at.
  std::optional<std::vector<Finding>> grid_findings;
  std::map<std::string, std::string> colours;  ///< RRGGBB by the boundary's name, where CAD files give all of it one

  std::vector<std::string> failed_gates;   ///< sentences
  std::vector<Finding> gate_failures;      ///< their places
  std::vector<std::string> files_written;  ///< grids, each complete
  StarterFiles starter;                    ///< of options.output.solver
  std::vector<std::string> name_changes;   ///< names that a format could not hold, as sentences
  std::vector<std::string> warnings;       ///< everything logged at LogLevel::warning, and the report's warnings
  std::string defects_file;                ///< written where something was wrong; else empty
  std::string partial_file;                ///< the grid as far as it came, where gridding failed; else empty
  std::vector<StageTime> stage_times;
  double seconds = 0;
  std::uint64_t peak_memory = 0;  ///< bytes
  std::optional<Estimate> estimate;
};

/// @brief All ways of options.size that ask for sizes, but for hmin, hmax and the boundary's own, as one field.
/// @param options  lengths in model units
/// @param model    whose names sizes may be asked on
/// @param domain   box of all that will be gridded
/// @param is_kept  whether a place will be gridded (as GapSizes::is_kept); empty: not known
/// @return null where nothing of the kind is asked for
/// @throws UsageError  an entry that makes no sense: its place in the job file, what is wrong, what is allowed
/// @throws InputError  a file that cannot be read or has bad sizes
std::shared_ptr<const SizeField> build_job_size_field(const Options& options, const Model& model, const Box& domain,
                                                      Context& context, const std::function<bool(Point)>& is_kept = {});

/// @brief A whole job: read, check, enclose, grid, improve, gates, write, report.
///
/// Nothing is thrown: how the run ended stands in the result, and, where `options.output.report` names a file, in that
/// file too (NAME.html: a page, and the JSON as NAME.json), also when the run failed. Outputs are tried for writing
/// before any work. When the surface is refused, gridding fails or a gate is not met, a defects file is written to
/// `options.output.defects`, or beside the first output. Where gridding fails, the grid as far as it came is written
/// beside the first output as NAME_partial.vtu. Either one of an earlier run, under that name, is removed where this
/// run has none. Limits of `options.limits` are put into `context`.
/// @param command  what the user typed, for the report
/// @post  each of files_written is complete; no other output exists that was not there before
JobResult run_job(const Options& options, Context& context, const std::string& command = "",
                  JobKind kind = JobKind::grid, const JobExtras& extras = {});

/// @brief The report as JSON text, with the effective options; `command` is what the user typed.
std::string report_json(const JobResult& result, const Options& options, const std::string& command);

}  // namespace delfront
