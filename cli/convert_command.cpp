// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>

#include "commands.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "guard.hpp"
#include "pipeline/convert_job.hpp"
#include "pipeline/facts_text.hpp"

namespace delfront::cli {

namespace {

class ConvertCommand : public Command {
 public:
  explicit ConvertCommand(CLI::App& parent) {
    app = parent.add_subcommand("convert", "Write a surface or a grid in another format");
    app->allow_extras();
    app->footer(
        "What the new format cannot hold (names, boundary kinds, fields) is changed or left out, and a warning says "
        "so.\n"
        "Examples:\n"
        "  delfront convert wing.vtu wing.su2\n"
        "  delfront convert wing.msh case/            (an OpenFOAM case)\n"
        "  delfront convert wing.vtu wing.msh --msh-version 2.2 --ascii");
    app->add_option("IN", in_, "file to read, or folder of an OpenFOAM case")->required();
    app->add_option("OUT", out_, "file to write; a name ending in / is an OpenFOAM case")->required();
    app->add_option("--from", from_, "type of IN, instead of by extension")->type_name("FORMAT");
    app->add_option("--format", to_, "type of OUT, instead of by extension")->type_name("FORMAT");
    app->add_flag("--ascii", is_ascii_, "write text instead of binary, where the format has both");
    app->add_flag("--compress", is_compressed_, "VTU, VTP, VTKHDF, XDMF: compressed");
    app->add_option("--msh-version", msh_version_, "version of MSH files; by default 4.1")->type_name("V");
    app->add_option("--solver", solver_,
                    "starter files for this solver beside OUT, naming every boundary; files that exist are kept")
        ->type_name("su2|openfoam");
    add_common_flags();
  }

  int run(const std::string&) override {
    Terminal terminal = make_terminal();
    if (needs_guard(in_, from_))
      if (const std::optional<int> ended = go_on_in_child(terminal)) return *ended;
    Context context;
    prepare(context, terminal);
    const WriteOptions how{.binary = !is_ascii_, .version = msh_version_, .compress = is_compressed_};
    std::vector<std::string> changes;
    StarterFiles starter;
    const Mesh mesh =
        convert_file(in_, out_, {.from = from_, .to = to_, .how = how, .solver = solver_}, changes, context, &starter);
    terminal.clear_bar();
    for (const std::string& change : changes) terminal.log(LogLevel::warning, change);
    for (const std::string& note : starter.notes) terminal.log(LogLevel::warning, note);
    if (terminal.verbosity() < 0) return 0;
    fmt::print("{}", mesh_facts_text(mesh));
    fmt::print("written        {}\n", out_);
    print_starter_files(starter);
    return 0;
  }

 private:
  std::string in_, out_, from_, to_, msh_version_, solver_;
  bool is_ascii_ = false, is_compressed_ = false;
};

}  // namespace

std::unique_ptr<Command> make_convert_command(CLI::App& app) { return std::make_unique<ConvertCommand>(app); }

}  // namespace delfront::cli
