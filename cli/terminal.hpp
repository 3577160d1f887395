// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/errors.hpp"

namespace delfront::cli {

/// @brief How progress is shown: a bar on a terminal, plain lines elsewhere, JSON lines for front ends.
enum class ProgressStyle { automatic, bar, plain, json, none };

/// @brief All that a run says while it runs, on stderr.
///
/// With ProgressStyle::json, stderr holds nothing but JSON objects, one a line, each with an "event":
/// "progress" (stage, done, total, unit, seconds), "log" (level, message), "error" (exit_code, message, places),
/// "detail" (message).
class Terminal {
 public:
  /// @param verbosity  -1 errors only, 0 progress and warnings, 1 everything
  Terminal(ProgressStyle style, int verbosity);

  /// @brief Send progress and messages of a context here. The terminal must outlive the runs.
  void attach(Context& context);
  void show(const Progress& progress);
  void log(LogLevel level, const std::string& message);
  /// @brief "delfront: error: …", then the first places.
  void error(ExitCode code, const std::string& message, const std::vector<Place>& places);
  /// @brief A line that belongs to the error before it.
  void detail(const std::string& message);
  /// @brief Remove a bar that stands there.
  void clear_bar();
  /// @brief The same, of one that another process may have left.
  void clear_bar_of_others();
  int verbosity() const { return verbosity_; }

 private:
  using Clock = std::chrono::steady_clock;
  void begin_stage(const Progress& progress);
  void show_bar(const Progress& progress);
  void show_plain(const Progress& progress);
  void show_json(const Progress& progress);

  ProgressStyle style_;
  int verbosity_;
  static constexpr std::size_t kMaxJsonPlaces = 100;
  std::string stage_;
  Clock::time_point start_ = Clock::now(), stage_start_ = start_, last_shown_ = start_;
  bool has_bar_ = false;
};

/// @throws UsageError  no such style
ProgressStyle parse_progress_style(const std::string& name);

}  // namespace delfront::cli
