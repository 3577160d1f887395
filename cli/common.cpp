// SPDX-License-Identifier: Apache-2.0
// What the commands share: common flags, tables on stdout.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <thread>

#include "commands.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "guard.hpp"
#include "interrupt.hpp"
#include "pipeline/report_json.hpp"

namespace delfront::cli {

void Command::add_common_flags() {
  app->add_option("-j,--threads", common_.threads, "threads; by default all; the grid is the same for any number")
      ->type_name("N")
      ->group("Run");
  app->add_option("--progress", common_.progress, "auto, bar, plain, json (lines on stderr) or none")
      ->type_name("STYLE")
      ->group("Run");
  app->add_flag("-v,--verbose", common_.is_verbose, "say more")->group("Run");
  app->add_flag("-q,--quiet", common_.is_quiet, "say nothing but errors")->group("Run");
}

Terminal Command::make_terminal() const {
  if (common_.threads < 0) throw UsageError(fmt::format("-j {}: expected a number of threads", common_.threads));
  return Terminal(parse_progress_style(common_.progress), common_.is_quiet ? -1 : common_.is_verbose ? 1 : 0);
}

void Command::prepare(Context& context, Terminal& terminal) const {
  const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  context.threads = common_.threads > 0 ? common_.threads : all;
  context.cancel = stop_on_interrupt();
  terminal.attach(context);
  watch_reading(context);
}

std::string format_list() {
  std::string result;
  for (const FormatInfo& format : formats()) {
    const char* can = format.can_read && format.can_write ? "read, write" : format.can_read ? "read" : "write";
    result += fmt::format("  {:<10} {:<16} {:<12} {}\n", format.name,
                          fmt::format("{}", fmt::join(format.extensions, " ")), can, format.title);
  }
  return result;
}

void print_starter_files(const StarterFiles& starter) {
  if (!starter.written.empty()) fmt::print("starter files  {}\n", fmt::join(starter.written, ", "));
  if (!starter.kept.empty()) fmt::print("kept           {}\n", fmt::join(starter.kept, ", "));
}

void write_json(const std::string& path, const std::string& text) {
  if (path == "-")
    fmt::print("{}", text);
  else
    write_text_file(path, text);
}

}  // namespace delfront::cli
