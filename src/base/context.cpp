// SPDX-License-Identifier: Apache-2.0
#include "delfront/context.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cfenv>
#include <cstdio>
#include <limits>

namespace delfront {

namespace {

std::string text_of_bytes(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  return value < 1e9 ? fmt::format("{:.4g} MB", value / 1e6) : fmt::format("{:.4g} GB", value / 1e9);
}

}  // namespace

void fail_check(const char* condition, const char* file, int line) {
  const std::string path = file;
  const std::string name = path.substr(path.find_last_of('/') + 1);
  throw InternalError(
      fmt::format("internal error: '{}' does not hold ({}:{}); please report this with the input file and the command",
                  condition, name, line));
}

void Context::check_limits() const {
  if (cancel && cancel->load(std::memory_order_relaxed)) throw Cancelled();
  if (time_limit > 0 && seconds_since_start() > time_limit)
    throw LimitError(fmt::format("stopped: the time limit of {:g} s is reached; {} or allow more time (--time-limit)",
                                 time_limit, limit_advice));
  if (memory_limit == 0) return;
  if (const std::uint64_t held = resident_memory(); held > memory_limit)
    throw LimitError(
        fmt::format("stopped: the memory limit of {} is passed, {} are held; {} or allow more memory (--memory-limit)",
                    text_of_bytes(memory_limit), text_of_bytes(held), limit_advice));
}

void Context::check_cells(std::uint64_t cells) const {
  if (max_cells > 0 && cells > max_cells)
    throw LimitError(
        fmt::format("stopped: the limit of {} cells is passed, the grid has {} so far; {} or allow more cells "
                    "(--max-cells)",
                    max_cells, cells, limit_advice));
}

Context Context::for_a_piece() const {
  Context piece = *this;
  piece.on_progress = nullptr;
  piece.on_log = nullptr;
  piece.max_cells = 0;
  piece.stage_times.clear();
  piece.is_timed = false;
  return piece;
}

double Context::seconds_since_start() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

StageTimer::StageTimer(Context& context, std::string stage)
    : context_(context),
      stage_(std::move(stage)),
      start_(std::chrono::steady_clock::now()),
      is_part_(std::exchange(context.is_timed, true)) {}

StageTimer::~StageTimer() {
  if (is_part_) return;
  context_.is_timed = false;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  context_.stage_times.push_back({stage_, seconds});
}

void check_floating_point_mode() {
  volatile double tiny = std::numeric_limits<double>::min();
  const double half = tiny / 2;
  if (std::fegetround() != FE_TONEAREST || half == 0)
    throw InternalError(
        "the floating-point mode was changed (rounding, or flush to zero, e.g. by -ffast-math in the calling "
        "program); exact predicates need round-to-nearest and denormals");
}

std::uint64_t resident_memory() {
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (!file) return 0;
  unsigned long long total = 0, resident = 0;
  const int read = std::fscanf(file, "%llu %llu", &total, &resident);
  std::fclose(file);
  return read == 2 ? resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

std::uint64_t peak_resident_memory() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024 : 0;
}

}  // namespace delfront
