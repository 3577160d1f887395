// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/job.hpp"
#include "terminal.hpp"

namespace delfront::cli {

/// @brief Flags that every command has.
struct CommonFlags {
  bool is_verbose = false, is_quiet = false;
  std::string progress = "auto";
  int threads = 0;  ///< 0: all that the machine has
};

/// @brief One command: its flags, and what it does. `run` returns the exit code or throws delfront::Error.
class Command {
 public:
  Command() = default;
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  virtual ~Command() = default;
  virtual int run(const std::string& command_line) = 0;

  CLI::App* app = nullptr;

 protected:
  void add_common_flags();
  Terminal make_terminal() const;
  /// @brief A context that shows its progress on `terminal` and stops on Ctrl-C.
  void prepare(Context& context, Terminal& terminal) const;

  CommonFlags common_;
};

std::unique_ptr<Command> make_job_command(CLI::App& app, JobKind kind);
std::unique_ptr<Command> make_check_command(CLI::App& app);
std::unique_ptr<Command> make_info_command(CLI::App& app);
std::unique_ptr<Command> make_convert_command(CLI::App& app);
std::unique_ptr<Command> make_refine_command(CLI::App& app);
std::unique_ptr<Command> make_view_command(CLI::App& app);

/// @return names of the formats that can be read (or written), one a line with their extensions
std::string format_list();

/// @brief "starter files  a, b" and "kept  c", where there are any.
void print_starter_files(const StarterFiles& starter);

/// @brief Text to a file, or to stdout for "-". @throws IoError
void write_json(const std::string& path, const std::string& text);

}  // namespace delfront::cli
