// SPDX-License-Identifier: Apache-2.0
// delfront refine: every edge of a grid halved, with new boundary points on the true geometry.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/report_name.hpp"
#include "commands.hpp"
#include "delfront/errors.hpp"
#include "delfront/grid_check.hpp"
#include "delfront/io.hpp"
#include "delfront/refine_grid.hpp"
#include "delfront/version.hpp"
#include "guard.hpp"
#include "io/grid_files.hpp"
#include "pipeline/facts_text.hpp"
#include "pipeline/job_checks.hpp"
#include "pipeline/option_table.hpp"
#include "pipeline/refine_job.hpp"
#include "pipeline/report_files.hpp"
#include "pipeline/report_json.hpp"
#include "report/page.hpp"

namespace delfront::cli {

namespace {

const char* const kFooter =
    "Tetrahedra, hexahedra and prisms become 8, pyramids 6 and 4 tetrahedra, triangles and quads 4. Names, kinds and\n"
    "fields come along. With --geometry new boundary points are put on the facets of the patch that is called like\n"
    "theirs (on all, where no name is the same), those of edges on its feature edges; where a cell would be inverted\n"
    "they go back, and the report lists them.\n"
    "Examples:\n"
    "  delfront refine wing.vtu -o fine.vtu --levels 1 --geometry wing.stl\n"
    "  delfront refine body.msh -o case/ --levels 2 --report refined.json\n"
    "  delfront refine naca0012.su2 -o fine.su2 --geometry naca0012.dat";

/// Limits are read as those of jobs are.
const std::vector<std::string> kLimits = {"limits.time", "limits.memory", "limits.max_cells"};

class RefineCommand : public Command {
 public:
  explicit RefineCommand(CLI::App& parent) {
    app = parent.add_subcommand("refine", "Halve every edge of a grid, with new boundary points on the true geometry");
    app->allow_extras();
    app->footer(kFooter);
    app->add_option("IN", in_, "grid to refine, or folder of an OpenFOAM case")->required();
    app->add_option("-o,--output", outputs_, "grid to write, repeatable; a name ending in / is an OpenFOAM case")
        ->type_name("OUT")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false)
        ->required();
    app->add_option("--levels", options_.levels, "times every edge is halved; by default once")->type_name("N");
    app->add_option("--geometry", geometry_, "surface (in the plane: lines) on which new boundary points belong")
        ->type_name("FILE");
    app->add_option("--feature-angle", options_.feature_angle_deg,
                    "angle between facets from which an edge is a feature; by default 40 degrees")
        ->type_name("DEG");
    app->add_option("--report", report_,
                    "what was done, as JSON; - for stdout; NAME.html: a page to read, with NAME.json beside it")
        ->type_name("FILE");
    app->add_option("--from", from_, "type of IN, instead of by extension")->type_name("FORMAT");
    app->add_option("--format", to_, "type of OUT, instead of by extension")->type_name("FORMAT");
    app->add_flag("--ascii", is_ascii_, "write text instead of binary, where the format has both");
    app->add_flag("--compress", is_compressed_, "VTU, VTKHDF, XDMF: compressed");
    for (const OptionRow& row : option_table())
      if (std::find(kLimits.begin(), kLimits.end(), row.key) != kLimits.end())
        app->add_option(row.flags, limits_[row.key], row.help)->type_name(row.metavar)->group("Limits");
    add_common_flags();
  }

  int run(const std::string& command_line) override {
    check_report();
    Terminal terminal = make_terminal();
    if (needs_guard(in_, from_) || needs_guard(geometry_))
      if (const std::optional<int> ended = go_on_in_child(terminal)) return *ended;
    Context context;
    Facts facts;
    facts.command = command_line;
    try {
      work(terminal, context, facts);
    } catch (const Error& e) {
      facts.exit_code = e.exit_code;
      facts.error = e.what();
      facts.places = e.places;
      report_failure(terminal, facts, context);
      throw;
    } catch (const std::bad_alloc&) {
      facts.exit_code = ExitCode::limit_reached;
      facts.error = "out of memory";
      report_failure(terminal, facts, context);
      throw;
    }
    if (!report_.empty()) write_report(facts, context);
    if (terminal.verbosity() >= 0 && report_ != "-") print(facts);
    return static_cast<int>(ExitCode::done);
  }

 private:
  /// What a run knows of itself, however it ends.
  struct Facts {
    std::string command, error;
    ExitCode exit_code = ExitCode::done;
    std::vector<Place> places;
    Mesh fine;
    nlohmann::ordered_json cells_before = nullptr, cells = nullptr;
    RefineGridReport report;
    QualityReport quality;                         ///< where there is to be a report
    std::optional<std::vector<Finding>> findings;  ///< of the grid, where that is to be a page
    std::vector<std::string> warnings, files_written;
  };

  void work(Terminal& terminal, Context& context, Facts& facts) {
    check_words();
    prepare(context, terminal);
    set_limits(context);
    const Mesh coarse = read_grid(context);
    facts.cells_before = count_cells(coarse);
    const Model model = geometry_.empty() ? Model() : read_geometry(coarse, context);
    if (!geometry_.empty()) options_.model = &model;
    facts.fine = refine_and_check(coarse, options_, facts.report, context);
    facts.cells = count_cells(facts.fine);
    if (!report_.empty()) measure(context, facts);
    facts.warnings = all_warnings(facts.report);
    write(context, facts);
    terminal.clear_bar();
    for (const std::string& warning : facts.warnings) terminal.log(LogLevel::warning, warning);
  }

  void measure(Context& context, Facts& facts) const {
    const StageTimer timer(context, "measure");
    facts.quality = measure_quality(facts.fine, context);
    if (is_page_name(report_)) facts.findings = check(facts.fine);
  }

  /// That there is no report either is said, and the error stays what it was.
  void report_failure(Terminal& terminal, const Facts& facts, const Context& context) const {
    terminal.clear_bar();
    if (report_.empty()) return;
    try {
      write_report(facts, context);
    } catch (const Error& e) {
      terminal.log(LogLevel::warning, fmt::format("no report: {}", e.what()));
    }
  }

  void check_report() const {
    if (report_ == "-") return;
    for (const std::string& file : report_files(report_)) {
      refuse_to_overwrite_inputs({file});
      for (const std::string& out : outputs_)
        if (find_same_file(file, files_written_as(out, to_)))
          throw UsageError(fmt::format("-o and --report name the same file, {}", file));
      check_writable(file);
    }
  }

  void write_report(const Facts& facts, const Context& context) const {
    const std::string json = report_json(facts, context);
    write_json(json_name(report_), json);
    if (is_page_name(report_)) write_text_file(report_, report_page(json, "", facts.fine));
  }

  void check_words() const {
    check_refine_options(options_, "--levels", "--feature-angle");
    for (const std::string& out : outputs_) {
      format_of(out, to_, true);
      refuse_to_overwrite_inputs(files_written_as(out, to_));
      check_writable(out);
    }
  }

  void refuse_to_overwrite_inputs(const std::vector<std::string>& written) const {
    refuse_to_overwrite(in_, from_, written);
    refuse_to_overwrite(geometry_, "", written);
  }

  void set_limits(Context& context) const {
    Options options;
    for (const OptionRow& row : option_table()) {
      const auto typed = limits_.find(row.key);
      if (typed == limits_.end() || typed->second.empty()) continue;
      apply_value(options, row.key, value_from_text(row.takes, typed->second),
                  [&row](int) { return row.flags + ": "; });
    }
    context.limit_advice = "refine fewer times (--levels)";
    context.time_limit = options.limits.time;
    context.memory_limit = options.limits.memory;
    context.max_cells = options.limits.max_cells;
  }

  Mesh read_grid(Context& context) const {
    const StageTimer timer(context, "read");
    Mesh mesh = read_mesh(in_, context, from_);
    check_grid_to_refine(mesh, in_, context);
    return mesh;
  }

  Model read_geometry(const Mesh& grid, Context& context) const {
    const StageTimer timer(context, "read");
    return geometry_to_refine_on(grid, read_mesh(geometry_, context), geometry_, context);
  }

  void write(Context& context, Facts& facts) const {
    const StageTimer timer(context, "write");
    const WriteOptions how{.binary = !is_ascii_, .version = "", .compress = is_compressed_};
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      context.progress("write", i, outputs_.size(), "files");
      for (const std::string& change : write_mesh(facts.fine, outputs_[i], context, how, to_))
        facts.warnings.push_back(fmt::format("{}: {}", outputs_[i], change));
      facts.files_written.push_back(outputs_[i]);
    }
    context.progress("write", outputs_.size(), outputs_.size(), "files");
  }

  std::vector<std::string> all_warnings(const RefineGridReport& report) const {
    std::vector<std::string> warnings = warnings_of(report, geometry_);
    if (!geometry_.empty() && report.points_on_surface + report.points_on_features + report.out_of_reach == 0)
      warnings.push_back(fmt::format("no new point had to be moved: the boundary of {} is {} already", in_, geometry_));
    if (!report.reversed_places.empty() && report_.empty()) warnings.back() += "; --report FILE lists them";
    return warnings;
  }

  static nlohmann::ordered_json count_cells(const Mesh& mesh) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const CellBlock& block : mesh.blocks) json[name_of(block.type)] = block.size();
    return json;
  }

  std::string report_json(const Facts& facts, const Context& context) const {
    using Json = nlohmann::ordered_json;
    Json stages = Json::array();
    for (const StageTime& time : context.stage_times)
      stages.push_back({{"stage", time.stage}, {"seconds", time.seconds}});
    Json json = {{"command", facts.command},
                 {"version", kVersion},
                 {"outcome", outcome_name(facts.exit_code)},
                 {"exit_code", static_cast<int>(facts.exit_code)},
                 {"error", facts.error.empty() ? Json(nullptr) : Json(facts.error)},
                 {"places", to_json(facts.places, kMaxPlaces)},
                 {"input", in_},
                 {"geometry", geometry_},
                 {"threads", context.threads},
                 {"cells_before", facts.cells_before},
                 {"cells", facts.cells},
                 {"warnings", facts.warnings},
                 {"stages", stages},
                 {"seconds", context.seconds_since_start()},
                 {"peak_memory_bytes", peak_resident_memory()},
                 {"files_written", facts.files_written}};
    json.update(to_json(facts.report));
    json["quality"] = to_json(facts.quality);
    json["grid_findings"] = facts.findings ? to_json(*facts.findings) : Json(nullptr);
    json["boundaries"] = groups_json(facts.fine, 2);
    json["regions"] = groups_json(facts.fine, 3);
    json["curves"] = groups_json(facts.fine, 1);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  }

  void print(const Facts& facts) const {
    const RefineGridReport& report = facts.report;
    fmt::print("{}", mesh_facts_text(facts.fine));
    if (!geometry_.empty())
      fmt::print(
          "moved          {} points to the surface, {} to features, by {:.4g} at most; {} halfway, {} put back\n",
          with_commas(report.points_on_surface), with_commas(report.points_on_features), report.largest_move,
          with_commas(report.halved), with_commas(report.reversed));
    fmt::print("written        {}\n", fmt::join(outputs_, ", "));
    if (!report_.empty()) fmt::print("report         {}\n", fmt::join(report_files(report_), ", "));
  }

  std::string in_, geometry_, report_, from_, to_;
  std::vector<std::string> outputs_;
  std::map<std::string, std::string> limits_;
  bool is_ascii_ = false, is_compressed_ = false;
  RefineGridOptions options_;
};

}  // namespace

std::unique_ptr<Command> make_refine_command(CLI::App& app) { return std::make_unique<RefineCommand>(app); }

}  // namespace delfront::cli
