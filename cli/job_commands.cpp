// SPDX-License-Identifier: Apache-2.0
// delfront mesh, estimate, sizes: options from a job file, flags and --set become Options; run_job does the work.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "commands.hpp"
#include "delfront/cad.hpp"
#include "delfront/errors.hpp"
#include "delfront/geometry_text.hpp"
#include "delfront/job.hpp"
#include "guard.hpp"
#include "pipeline/facts_text.hpp"
#include "pipeline/option_table.hpp"
#include "pipeline/report_files.hpp"

namespace delfront::cli {

namespace {

const char* const kExamples =
    "Examples:\n"
    "  delfront mesh body.stl -o body.vtu                  the inside, at the surface's own resolution\n"
    "  delfront mesh body.stl -o body.vtu --growth 1.3     cells grow away from the surface\n"
    "  delfront mesh car.stl -o case/ --farfield box:10c   the outside, as an OpenFOAM case\n"
    "  delfront mesh case.toml -o wing.su2 -o wing.vtu --set size.hmax=0.5 --report wing.json\n"
    "  delfront mesh part.step -o part.su2 --report part.html   a page to read: quality, worst cells, warnings\n"
    "  delfront mesh case.toml --print-config              the whole configuration, to start a job file from\n"
    "\n"
    "LENGTH: 0.5 (model units), 5% (of the bounding box's diagonal), 20c (longest sides), 2mm, 1in, ...\n"
    "Model units are those of the coordinates in FILE, whatever they stand for; the grid keeps them unless\n"
    "--output-units rescales it. Lengths in m, mm, in, ft need --units, which says what a model unit is.\n"
    "'delfront info FILE' shows the box of the coordinates and guesses the unit. Angles are in degrees.";

bool is_job_file(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (is_geometry_file(path)) return false;
  return extension == ".toml" || extension == ".json";
}

const char* const kEstimateExamples =
    "The size field is summed up over the domain, as `mesh` would grid it with the same options.\n"
    "Examples:\n"
    "  delfront estimate case.toml\n"
    "  delfront estimate car.stl --farfield box:10c --growth 1.2 --report estimate.json";

const char* const kSizesExamples =
    "Writes hexahedra of an octree (in the plane quads) with the wanted size as the field h at its points.\n"
    "Examples:\n"
    "  delfront sizes case.toml -o sizes.vtu\n"
    "  delfront sizes car.stl --farfield box:10c --size \"0.05 + 0.1*abs(z)\" -o sizes.vtu";

struct Words {
  const char *name, *help, *footer;
};

Words words_of(JobKind kind) {
  if (kind == JobKind::estimate)
    return {"estimate", "Cells, memory and time of a job, before it is run", kEstimateExamples};
  if (kind == JobKind::sizes) return {"sizes", "Write the size field of a job, to look at", kSizesExamples};
  return {"mesh", "Grid what a surface bounds (FILE: surfaces, or one job file)", kExamples};
}

/// The commands that take a job: all have the same flags.
class JobCommand : public Command {
 public:
  JobCommand(CLI::App& parent, JobKind kind) : kind_(kind) {
    const Words words = words_of(kind);
    app = parent.add_subcommand(words.name, words.help);
    app->allow_extras();
    app->footer(words.footer);
    app->add_option("FILE", files_,
                    "surface files or smooth geometry (.geom.toml, .step, .iges, .brep, .egads), gridded together; or "
                    "a job file (.toml, .json)");
    for (const OptionRow& row : option_table())
      if (!row.flags.empty()) add_row_flag(row);
    for (const Shorthand& shorthand : shorthand_table()) add_shorthand(shorthand);
    app->add_option("--set", sets_, "any option by its key: --set size.hmax=5%; wins over everything else")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false)
        ->group("Job");
    app->add_flag("--print-config", print_config_, "print the whole effective configuration as TOML and stop")
        ->group("Job");
    add_common_flags();
  }

  int run(const std::string& command_line) override {
    Options options = effective_options();
    if (kind_ == JobKind::sizes && !is_typed("output.files")) name_size_file(options);
    if (kind_ != JobKind::grid && !is_typed("output.report")) options.output.report.clear();  // the job's is its grid's
    if (print_config_) {
      fmt::print("{}", print_config(options));
      return 0;
    }
    Terminal terminal = make_terminal();
    const auto& files = options.input.files;
    if (std::any_of(files.begin(), files.end(), [](const auto& file) { return needs_guard(file); }) ||
        needs_guard(options.size.background.file))
      if (const std::optional<int> ended = go_on_in_child(terminal)) return *ended;
    Context context;
    prepare(context, terminal);
    const JobResult result = run_job(options, context, command_line, kind_);
    terminal.clear_bar();
    if (!result.error.empty()) show_failure(result, terminal);
    if (result.exit_code == ExitCode::done || result.exit_code == ExitCode::gate_not_met)
      if (terminal.verbosity() >= 0)
        result.estimate ? fmt::print("{}", estimate_text(*result.estimate, options.limits.max_cells))
                        : print_summary(result, options);
    return static_cast<int>(result.exit_code);
  }

 private:
  bool is_typed(const std::string& key) const {
    const auto it = typed_.find(key);
    return it != typed_.end() && !it->second.empty();
  }

  /// The job's outputs are for its grid: sizes go beside them.
  static void name_size_file(Options& options) {
    namespace fs = std::filesystem;
    if (options.output.files.empty() && options.input.files.empty()) return;
    fs::path base =
        options.output.files.empty() ? fs::path(options.input.files[0]).filename() : fs::path(options.output.files[0]);
    if (!base.has_filename()) base = base.parent_path();
    options.output.files = {(base.parent_path() / (base.stem().string() + "_sizes.vtu")).string()};
    options.output.format.clear();
  }

  void add_row_flag(const OptionRow& row) {
    app->add_option(row.flags, typed_[row.key], row.help)
        ->type_name(row.metavar)
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false)
        ->group(group_of(row.key));
  }

  void add_shorthand(const Shorthand& shorthand) {
    if (shorthand.takes_value)
      app->add_option(shorthand.flags, shorthands_[shorthand.flags], shorthand.help)
          ->type_name(shorthand.metavar)
          ->expected(1)
          ->take_all()
          ->allow_extra_args(false)
          ->group("Domain");
    else
      app->add_flag(shorthand.flags, shorthand_flags_[shorthand.flags], shorthand.help)
          ->group(shorthand.flags == "--ascii" ? "Output" : "Sizes");
  }

  static std::string group_of(const std::string& key) {
    const std::string table = key.substr(0, key.find('.'));
    static const std::map<std::string, std::string> groups = {{"input", "Input"},   {"domain", "Domain"},
                                                              {"size", "Sizes"},    {"limits", "Limits"},
                                                              {"output", "Output"}, {"stop_after", "Job"}};
    const auto it = groups.find(table);
    return it == groups.end() ? "Job" : it->second;
  }

  /// Job file, then flags, then --set: the later wins.
  Options effective_options() const {
    Options options;
    std::vector<std::string> surfaces;
    bool has_job = false;
    for (const std::string& file : files_) {
      if (!is_job_file(file)) {
        surfaces.push_back(file);
        continue;
      }
      if (has_job) throw UsageError(fmt::format("'{}': one job file at a time", file));
      has_job = true;
      read_job_file(file, options);
    }
    if (!surfaces.empty() && !options.input.files.empty())
      throw UsageError(fmt::format("'{}': the job file already names its input, {}; give one or the other", surfaces[0],
                                   fmt::join(options.input.files, ", ")));
    if (!surfaces.empty()) options.input.files = surfaces;
    for (const OptionRow& row : option_table()) apply_flag(row, options);
    for (const Shorthand& shorthand : shorthand_table()) apply_shorthand(shorthand, options);
    for (const std::string& set : sets_) {
      const std::size_t equals = set.find('=');
      if (equals == std::string::npos)
        throw UsageError(fmt::format("--set {}: expected KEY=VALUE, e.g. --set size.hmax=5%", set));
      try {
        set_option(options, set.substr(0, equals), set.substr(equals + 1));
      } catch (const UsageError& e) {
        throw UsageError(fmt::format("--set {}: {}", set, e.what()));
      }
    }
    return options;
  }

  void apply_flag(const OptionRow& row, Options& options) const {
    const auto it = typed_.find(row.key);
    if (it == typed_.end() || it->second.empty()) return;
    JobValue value;
    if (row.takes == Takes::texts) {
      value = JobValue::list();
      for (const std::string& text : it->second) value.items.push_back(JobValue::of(text));
    } else {
      value = value_from_text(row.takes, it->second.back());
    }
    apply_value(options, row.key, value, [&row](int) { return row.flags.substr(0, row.flags.find(',')) + ": "; });
  }

  void apply_shorthand(const Shorthand& shorthand, Options& options) const {
    if (const auto it = shorthands_.find(shorthand.flags); it != shorthands_.end() && !it->second.empty())
      shorthand.apply(options, it->second.back());
    if (const auto it = shorthand_flags_.find(shorthand.flags); it != shorthand_flags_.end() && it->second)
      shorthand.apply(options, "");
  }

  static void show_failure(const JobResult& result, Terminal& terminal) {
    terminal.error(result.exit_code, result.error, result.places);
    if (result.exit_code == ExitCode::bad_input)
      for (const Finding& f : result.report.surface.findings)
        if (f.severity == Severity::error && result.error.find(f.message) == std::string::npos)
          terminal.detail(fmt::format("{}: {}{}", f.kind, f.message, f.remedy.empty() ? "" : "; try: " + f.remedy));
    if (!result.defects_file.empty())
      terminal.detail(fmt::format("every place is in {} (ParaView opens it)", result.defects_file));
    if (!result.partial_file.empty())
      terminal.detail(fmt::format("the grid as far as it came is in {}", result.partial_file));
  }

  /// Stages that ran more than once, added up.
  static std::vector<StageTime> summed(const std::vector<StageTime>& times) {
    std::vector<StageTime> result;
    for (const StageTime& time : times) {
      const auto it =
          std::find_if(result.begin(), result.end(), [&](const StageTime& t) { return t.stage == time.stage; });
      if (it == result.end())
        result.push_back(time);
      else
        it->seconds += time.seconds;
    }
    return result;
  }

  static std::vector<std::string> surface_warnings(const JobResult& result) {
    std::vector<std::string> warnings;
    for (const Finding& f : result.report.surface.findings)
      if (f.severity == Severity::warning) warnings.push_back(fmt::format("{}: {}", f.kind, f.message));
    return warnings;
  }

  static void print_geometry(const GeometryGrid& made) {
    const BrepAccuracy& a = made.rounds.last();
    fmt::print(
        "geometry       {} triangles, angles from {:.1f} (mean {:.1f}) degrees, at most {:.3g} off (mean {:.2g}), "
        "{:.1f} % of sides right, {} round{}\n",
        with_commas(a.triangles), a.min_angle_deg, a.mean_min_angle_deg, a.deviation.value, a.mean_deviation,
        100 * a.share_of_right_sides, made.rounds.rounds.size(), made.rounds.rounds.size() == 1 ? "" : "s");
    if (!made.rounds.stopped.empty()) fmt::print("               {}\n", made.rounds.stopped);
    if (!made.rounds.grid.bridges.empty()) print_bridges(made.rounds.grid);
  }

  static void print_bridges(const BrepGridReport& grid) {
    const auto widest = std::max_element(grid.bridges.begin(), grid.bridges.end(),
                                         [](const BrepBridge& a, const BrepBridge& b) { return a.width < b.width; });
    const auto faces = std::count_if(grid.faces.begin(), grid.faces.end(),
                                     [](const BrepFaceReport& face) { return face.triangles == 0; });
    fmt::print(
        "bridged        {} place{} narrower than hmin ({} whole face{}), the widest, {:.3g}, at ({:.6g}, {:.6g}, "
        "{:.6g}); surface.bridge = false keeps them\n",
        grid.bridges.size(), grid.bridges.size() == 1 ? "" : "s", faces, faces == 1 ? "" : "s", widest->width,
        widest->at.x, widest->at.y, widest->at.z);
  }

  static void print_summary(const JobResult& result, const Options& options) {
    fmt::print("{}", mesh_facts_text(result.mesh));
    const QualityReport& quality = result.report.quality;
    if (quality.num_cells) fmt::print("{}", quality_text(quality, 0));
    if (const LevelsReport& levels = result.report.levels; levels.refined.levels > 0)
      fmt::print("levels         {}: from {} coarse cells\n", levels.refined.levels, with_commas(levels.coarse_cells));
    const SurfaceGridReport& grid = result.report.surface_grid;
    if (grid.triangles)
      fmt::print("new surface    {} triangles (given: {}), angles from {:.1f} degrees, at most {:.3g} off\n",
                 grid.triangles, grid.triangles_given, grid.min_angle_deg, grid.largest_distance);
    for (const GeometryGrid& made : result.geometry) print_geometry(made);
    if (const FrontReport& front = result.report.front; front.sweeps > 0)
      fmt::print("front          {} sweeps, {} cavities left by them, {} cells in them made by Delaunay\n",
                 front.sweeps, front.cavities, with_commas(front.closed_by_delaunay));
    const RecoveryReport& recovery = result.report.recovery;
    if (recovery.steiner_left)
      fmt::print("boundary       {} Steiner points are left on it; the report lists them\n", recovery.steiner_left);
    for (const std::string& change : result.name_changes) fmt::print("changed        {}\n", change);
    for (const std::string& warning : surface_warnings(result)) fmt::print("warning        {}\n", warning);
    std::string times;
    for (const StageTime& stage : summed(result.stage_times))
      times += fmt::format("{} {:.2f} s, ", stage.stage, stage.seconds);
    fmt::print("time           {}in all {:.2f} s; peak memory {:.0f} MB", times, result.seconds,
               static_cast<double>(result.peak_memory) / 1e6);
    if (quality.num_cells) fmt::print(" ({} bytes a cell)", result.peak_memory / quality.num_cells);
    fmt::print("\n");
    if (!options.output.units.empty())
      fmt::print("units          the box in {}, as written; all other lengths in the input's unit, {:g} m\n",
                 options.output.units, result.scale.metres_per_unit);
    if (!result.files_written.empty()) fmt::print("written        {}\n", fmt::join(result.files_written, ", "));
    print_starter_files(result.starter);
    if (!options.output.report.empty())
      fmt::print("report         {}\n", fmt::join(report_files(options.output.report), ", "));
    if (!result.defects_file.empty()) fmt::print("defects        {}\n", result.defects_file);
  }

  std::vector<std::string> files_, sets_;
  std::map<std::string, std::vector<std::string>> typed_, shorthands_;
  std::map<std::string, bool> shorthand_flags_;
  bool print_config_ = false;
  JobKind kind_;
};

}  // namespace

std::unique_ptr<Command> make_job_command(CLI::App& app, JobKind kind) {
  return std::make_unique<JobCommand>(app, kind);
}

}  // namespace delfront::cli
