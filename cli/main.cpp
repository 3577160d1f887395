// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <csignal>
#include <new>

#include "commands.hpp"
#include "delfront/errors.hpp"
#include "delfront/version.hpp"
#include "pipeline/option_table.hpp"

namespace delfront::cli {

namespace {

const char* const kDescription =
    "delfront: from a closed surface to a solver-ready tetrahedral grid.\n"
    "\n"
    "First steps:\n"
    "  delfront info  body.stl                     look first: size, patches, closed or not\n"
    "  delfront check body.stl                     every defect with its place\n"
    "  delfront mesh  body.stl -o body.vtu         grid the inside\n"
    "  delfront mesh  part.step -o part.su2        the same from CAD, sizes from its shape\n"
    "  delfront mesh  car.stl  -o case/ --farfield box:10c   grid the outside, for OpenFOAM\n"
    "  delfront check body.vtu                     quality of a grid, with its worst cells\n"
    "  delfront convert body.vtu body.su2          another file format\n"
    "  delfront refine body.vtu -o fine.vtu        every edge halved\n"
    "  delfront view body.vtu                      look at it in the browser";

std::string footer() {
  return "File formats, by extension:\n" + format_list() +
         "  CAD        .step .stp .iges .igs .brep .brp .egads   read by mesh, info, check, estimate, sizes\n"
         "  text       .geom.toml                                the same: smooth geometry as text\n"
         "\n"
         "Exit codes: 0 done, 1 defect of ours, 2 usage or job file, 3 bad input, 4 gridding failed,\n"
         "            5 gate not met, 6 limit reached, 7 cannot write, 130 interrupted.\n"
         "More on a command: delfront COMMAND --help";
}

/// What CLI11 did not know: an unknown flag or command, said with the nearest right name.
[[noreturn]] void fail_unknown(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names, positionals;
  const bool is_flag = word.size() > 1 && word[0] == '-';
  if (is_flag)
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  else
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  for (const CLI::Option* option : app.get_options())
    if (option->get_positional()) positionals.push_back("one " + option->get_name(true));
  if (!is_flag && names.empty())  // behind a command: one file too many
    throw UsageError(fmt::format("'{}' is one argument too many: {} only; see delfront {} --help", word,
                                 fmt::join(positionals, ", "), app.get_name()));
  const std::string flag = word.substr(0, word.find('='));
  const std::string planned = planned_note(flag);
  const std::string what = is_flag ? "option" : "command";
  if (!planned.empty()) throw UsageError(fmt::format("{} '{}'{}", what, flag, planned));
  const std::string help = is_flag ? fmt::format("see delfront {} --help", app.get_name())
                                   : fmt::format("commands are {}", fmt::join(names, ", "));
  throw UsageError(fmt::format("unknown {} '{}'{}; {}", what, flag, did_you_mean(flag, names), help));
}

std::string joined(int argc, char** argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) line += (i ? " " : "") + std::string(argv[i]);
  return line;
}

int parse_and_run(int argc, char** argv) {
  CLI::App app{kDescription, "delfront"};
  app.footer(footer());
  app.set_version_flag("--version", fmt::format("delfront {}", kVersion));
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.allow_extras();
  std::vector<std::unique_ptr<Command>> commands;
  commands.push_back(make_job_command(app, JobKind::grid));
  commands.push_back(make_job_command(app, JobKind::estimate));
  commands.push_back(make_job_command(app, JobKind::sizes));
  commands.push_back(make_check_command(app));
  commands.push_back(make_info_command(app));
  commands.push_back(make_convert_command(app));
  commands.push_back(make_refine_command(app));
  commands.push_back(make_view_command(app));
  app.require_subcommand(0, 1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help, --version
  } catch (const CLI::ParseError& e) {
    throw UsageError(e.what());
  }
  for (const auto& command : commands)
    if (command->app->parsed()) {
      const std::vector<std::string> unknown = command->app->remaining();
      if (!unknown.empty()) fail_unknown(*command->app, unknown[0]);
      return command->run(joined(argc, argv));
    }
  if (!app.remaining().empty()) fail_unknown(app, app.remaining()[0]);
  fmt::print("{}", app.help());
  return static_cast<int>(ExitCode::usage);
}

}  // namespace

/// Errors that come before or outside a job; those of a job are shown by the mesh command.
int run(int argc, char** argv) {
  Terminal terminal(ProgressStyle::none, 0);
  try {
    return parse_and_run(argc, argv);
  } catch (const Error& e) {
    terminal.error(e.exit_code, e.what(), e.places);
    return static_cast<int>(e.exit_code);
  } catch (const std::bad_alloc&) {
    terminal.error(ExitCode::limit_reached, "out of memory", {});
    return static_cast<int>(ExitCode::limit_reached);
  } catch (const std::exception& e) {
    terminal.error(ExitCode::internal_error, fmt::format("unexpected error: {}", e.what()), {});
    return static_cast<int>(ExitCode::internal_error);
  }
}

}  // namespace delfront::cli

int main(int argc, char** argv) {
  // A closed pipe and a file that grows past its limit are failed writes (exit 7), not a silent end.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  return delfront::cli::run(argc, argv);
}
