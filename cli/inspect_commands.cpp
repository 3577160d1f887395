// SPDX-License-Identifier: Apache-2.0
// delfront check and delfront info: look at a surface or a grid and say what it is.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "delfront/cad.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "guard.hpp"
#include "pipeline/inspect.hpp"
#include "pipeline/report_json.hpp"

namespace delfront::cli {

namespace {

using Json = nlohmann::ordered_json;

/// What is written must not stand where the file to look at stands.
void check_output(const std::string& path, const std::string& input) {
  if (path.empty() || path == "-") return;
  check_writable(path);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored) && std::filesystem::equivalent(path, input, ignored))
    throw UsageError(path + " is the input and would be overwritten; give the output another name");
}

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

class CheckCommand : public Command {
 public:
  explicit CheckCommand(CLI::App& parent) {
    app = parent.add_subcommand("check", "Every defect of a surface or a grid, with its place; quality of a grid");
    app->allow_extras();
    app->footer(
        "Exit code: 0 usable, 3 not (a surface that cannot bound a volume, an invalid grid), 5 a gate not met.\n"
        "Examples:\n"
        "  delfront check body.stl --defects defects.vtp\n"
        "  delfront check body.vtu --require \"min_dihedral > 8, max_nonortho < 70\" --json body.json");
    app->add_option("FILE", file_, "surface, grid, or folder of an OpenFOAM case")->required();
    app->add_option("--require", require_, "gates for a grid: \"min_dihedral > 8, max_nonortho < 70\"")
        ->type_name("GATES");
    app->add_option("--defects", defects_, "write all places to this file (.vtp)")->type_name("FILE");
    app->add_option("--json", json_, "write the findings as JSON; - for stdout")->type_name("FILE");
    app->add_option("--format", format_, "file type, instead of by extension")->type_name("FORMAT");
    add_common_flags();
  }

  int run(const std::string&) override {
    Terminal terminal = make_terminal();
    if (needs_guard(file_, format_))
      if (const std::optional<int> ended = go_on_in_child(terminal)) return *ended;
    Context context;
    prepare(context, terminal);
    for (const std::string& path : {defects_, json_}) check_output(path, file_);
    if (!defects_.empty() && defects_ == json_) throw UsageError("--defects and --json name the same file");
    const Inspected it = inspect_file(file_, format_, context);
    const bool is_valid_grid = it.is_grid && it.is_usable();
    const std::vector<std::string> failed =
        is_valid_grid ? failed_gates(it.quality, require_) : std::vector<std::string>();
    terminal.clear_bar();
    if (!it.is_grid && !require_.empty())
      terminal.log(LogLevel::warning, "--require is for grids; " + file_ + " is a surface");
    if (terminal.verbosity() >= 0 && json_ != "-") fmt::print("{}", check_text(it));
    if (!defects_.empty())
      write_defects(findings_with_gates(it, failed.empty() ? "" : require_, context), defects_, context);
    if (!json_.empty()) {
      Json json = facts_json(file_, it);
      json["failed_gates"] = failed;
      write_json(json_, dump(json));
    }
    if (!it.is_usable()) {
      terminal.error(ExitCode::bad_input, verdict(it), {});
      return static_cast<int>(ExitCode::bad_input);
    }
    for (const std::string& gate : failed) terminal.error(ExitCode::gate_not_met, "gate not met: " + gate, {});
    return static_cast<int>(failed.empty() ? ExitCode::done : ExitCode::gate_not_met);
  }

 private:
  std::string verdict(const Inspected& it) const {
    const std::string hint =
        defects_.empty() ? "; --defects FILE.vtp shows all places" : "; all places are in " + defects_;
    return verdict_text(file_, it) + hint;
  }

  std::string file_, require_, defects_, json_, format_;
};

class InfoCommand : public Command {
 public:
  explicit InfoCommand(CLI::App& parent) {
    app = parent.add_subcommand("info", "Facts about a file: size, patches, units, closed or not");
    app->allow_extras();
    app->footer(
        "Exit code: 0, or 3 where it cannot be gridded as it is (then: delfront check FILE).\n"
        "Example:\n  delfront info body.stl --json body.json");
    app->add_option("FILE", file_, "surface, grid, or folder of an OpenFOAM case")->required();
    app->add_option("--json", json_, "write the facts as JSON; - for stdout")->type_name("FILE");
    app->add_option("--format", format_, "file type, instead of by extension")->type_name("FORMAT");
    add_common_flags();
  }

  int run(const std::string&) override {
    Terminal terminal = make_terminal();
    if (needs_guard(file_, format_))
      if (const std::optional<int> ended = go_on_in_child(terminal)) return *ended;
    Context context;
    prepare(context, terminal);
    check_output(json_, file_);
    const Inspected it = inspect_file(file_, format_, context);
    terminal.clear_bar();
    if (terminal.verbosity() >= 0 && json_ != "-") fmt::print("{}", facts_text(file_, it));
    if (!json_.empty()) write_json(json_, dump(facts_json(file_, it)));
    if (it.is_usable()) return static_cast<int>(ExitCode::done);
    terminal.error(ExitCode::bad_input, verdict(it), {});
    return static_cast<int>(ExitCode::bad_input);
  }

 private:
  std::string verdict(const Inspected& it) const {
    if (it.cad.free_edges == 0 || it.cad.solids > 0)
      return fmt::format("{} cannot be used as it is; 'delfront check' shows where", file_);
    return fmt::format(
        "{} is an open sheet with {} free edge{}: it bounds no volume; its surface can be gridded (delfront mesh "
        "--stop-after surface)",
        file_, it.cad.free_edges, it.cad.free_edges == 1 ? "" : "s");
  }

  std::string file_, json_, format_;
};

}  // namespace

std::unique_ptr<Command> make_check_command(CLI::App& app) { return std::make_unique<CheckCommand>(app); }
std::unique_ptr<Command> make_info_command(CLI::App& app) { return std::make_unique<InfoCommand>(app); }

}  // namespace delfront::cli
