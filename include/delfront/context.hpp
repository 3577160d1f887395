// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "delfront/errors.hpp"

namespace delfront {

/// @brief One line of what is going on; `total` is 0 where it is not known beforehand.
struct Progress {
  std::string stage;  ///< "read", "check", "tetrahedralize", "recover", "refine", "improve", "write"
  std::uint64_t done = 0;
  std::uint64_t total = 0;
  std::string unit;  ///< "points", "faces", "cells", …
};

enum class LogLevel { debug, info, warning };

/// @brief How long a stage took; filled by StageTimer.
struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// @brief What every entry of the library takes: threads, progress, cancelling, limits, messages. No global state.
///
/// Callbacks are called from the thread that called the library. The library prints nothing itself.
class Context {
 public:
  int threads = 1;
  std::function<void(const Progress&)> on_progress;
  std::function<void(LogLevel, const std::string&)> on_log;
  std::atomic<bool>* cancel = nullptr;  ///< set it to true from anywhere (a signal handler) to stop the run
  double time_limit = 0;                ///< seconds from construction, 0: none
  std::uint64_t memory_limit = 0;       ///< bytes of resident memory, 0: none
  std::uint64_t max_cells = 0;          ///< 0: none
  /// What messages about limits advise, where sizes are not what decides (refinement of a grid).
  std::string limit_advice = "ask for larger sizes (--hmax, --growth)";
  std::vector<StageTime> stage_times;  ///< in the order the stages ended
  bool is_timed = false;               ///< a stage is under way

  void log(LogLevel level, const std::string& message) const {
    if (on_log) on_log(level, message);
  }
  void warn(const std::string& message) const { log(LogLevel::warning, message); }

  /// @brief Report progress and give the run a place to stop.
  /// @throws Cancelled, LimitError
  void progress(const std::string& stage, std::uint64_t done, std::uint64_t total, const std::string& unit) {
    check_limits();
    if (on_progress) on_progress({stage, done, total, unit});
  }
  /// @brief A cancellation point: call it every few milliseconds of work.
  /// @throws Cancelled, LimitError
  void check_limits() const;
  /// @throws LimitError where the number of cells passes max_cells
  void check_cells(std::uint64_t cells) const;
  double seconds_since_start() const;

  /// @brief For a piece of the work that is no stage of its own: the same threads, time, memory and way to cancel, but
  /// it says nothing, and its cells are no cells of the grid.
  Context for_a_piece() const;

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// @brief Adds the time of a scope to `context.stage_times`; within the scope of another it counts as part of that.
class StageTimer {
 public:
  StageTimer(Context& context, std::string stage);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  Context& context_;
  std::string stage_;
  std::chrono::steady_clock::time_point start_;
  bool is_part_;
};

/// @brief Round to nearest and no flush to zero, as the predicates need; call once at entry.
/// @throws InternalError where the caller changed the floating-point mode
void check_floating_point_mode();

/// @return resident memory of this process now and at its peak, bytes (Linux; 0 elsewhere)
std::uint64_t resident_memory();
std::uint64_t peak_resident_memory();

}  // namespace delfront
