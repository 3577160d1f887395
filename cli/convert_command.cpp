// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>

#include "commands.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "pipeline/geometry_job.hpp"

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
    app->add_flag("--compress", is_compressed_, "VTU and VTP: compressed");
    app->add_option("--msh-version", msh_version_, "version of MSH files; by default 4.1")->type_name("V");
    add_common_flags();
  }

  int run(const std::string&) override {
    if (!msh_version_.empty() && msh_version_ != "2.2" && msh_version_ != "4.1")
      throw UsageError(fmt::format("--msh-version {}: allowed are 2.2 and 4.1", msh_version_));
    Terminal terminal = make_terminal();
    Context context;
    prepare(context, terminal);
    std::error_code ignored;
    if (std::filesystem::equivalent(in_, out_, ignored))
      throw UsageError(fmt::format("{} is the input and would be overwritten; give OUT another name", out_));
    check_writable(out_);
    if (is_smooth_file(in_))
      throw UsageError(
          fmt::format("{} is smooth geometry, which has no cells yet: delfront mesh {} -o {} --stop-after "
                      "surface grids it",
                      in_, in_, out_));
    const Mesh mesh = read_mesh(in_, context, from_);
    const WriteOptions how{.binary = !is_ascii_, .version = msh_version_, .compress = is_compressed_};
    const std::vector<std::string> changes = write_mesh(mesh, out_, context, how, to_);
    terminal.clear_bar();
    for (const std::string& change : changes) terminal.log(LogLevel::warning, change);
    if (terminal.verbosity() < 0) return 0;
    print_mesh_facts(mesh);
    fmt::print("written        {}\n", out_);
    return 0;
  }

 private:
  std::string in_, out_, from_, to_, msh_version_;
  bool is_ascii_ = false, is_compressed_ = false;
};

}  // namespace

std::unique_ptr<Command> make_convert_command(CLI::App& app) { return std::make_unique<ConvertCommand>(app); }

}  // namespace delfront::cli
