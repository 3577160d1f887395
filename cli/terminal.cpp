// SPDX-License-Identifier: Apache-2.0
#include "terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace delfront::cli {

using Json = nlohmann::ordered_json;

namespace {

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

/// 950, 12.3k, 4.56M
std::string short_count(double value) {
  if (value < 1e4) return fmt::format("{:.0f}", value);
  if (value < 1e6) return fmt::format("{:.1f}k", value / 1e3);
  return fmt::format("{:.2f}M", value / 1e6);
}

std::string short_time(double seconds) {
  if (seconds < 60) return fmt::format("{:.0f} s", std::ceil(seconds));
  if (seconds < 3600) return fmt::format("{:.0f} min {:02.0f} s", std::floor(seconds / 60), std::fmod(seconds, 60));
  return fmt::format("{:.1f} h", seconds / 3600);
}

/// "12.3k of 45.6k points, 1.20M/s, 3 s left": as much of it as is known.
std::string counts(const Progress& p, double seconds_in_stage) {
  const auto done = static_cast<double>(p.done), total = static_cast<double>(p.total);
  std::string text = p.total ? fmt::format("{} of {} {}", short_count(done), short_count(total), p.unit)
                             : fmt::format("{} {}", short_count(done), p.unit);
  if (seconds_in_stage < 0.5 || p.done == 0) return text;
  const double rate = done / seconds_in_stage;
  text += fmt::format(", {}/s", rate < 10 ? fmt::format("{:.1f}", rate) : short_count(rate));
  const bool has_sweeps = p.stage == "improve";  // its count restarts with each, and how many come is not known
  if (p.total > p.done && !has_sweeps) text += fmt::format(", {} left", short_time((total - done) / rate));
  return text;
}

void put_json(const Json& json) {
  fmt::print(stderr, "{}\n", json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

Terminal::Terminal(ProgressStyle style, int verbosity) : style_(style), verbosity_(verbosity) {
  if (style_ == ProgressStyle::automatic) style_ = isatty(STDERR_FILENO) ? ProgressStyle::bar : ProgressStyle::plain;
  if (verbosity_ < 0 && style_ != ProgressStyle::json) style_ = ProgressStyle::none;
}

void Terminal::attach(Context& context) {
  context.on_progress = [this](const Progress& progress) { show(progress); };
  context.on_log = [this](LogLevel level, const std::string& message) { log(level, message); };
}

void Terminal::show(const Progress& progress) {
  if (style_ == ProgressStyle::none) return;
  const Clock::time_point now = Clock::now();
  const bool is_new_stage = progress.stage != stage_;
  const double pause = style_ == ProgressStyle::plain ? 2.0 : 0.1;
  // A new stage shows at once, except in plain lines: those are for stages that last.
  if (is_new_stage) begin_stage(progress);
  if (!(is_new_stage && style_ != ProgressStyle::plain) && seconds_between(last_shown_, now) < pause) return;
  last_shown_ = now;
  if (style_ == ProgressStyle::bar) show_bar(progress);
  if (style_ == ProgressStyle::plain) show_plain(progress);
  if (style_ == ProgressStyle::json) show_json(progress);
}

void Terminal::begin_stage(const Progress& progress) {
  stage_ = progress.stage;
  stage_start_ = Clock::now();
}

void Terminal::show_bar(const Progress& p) {
  constexpr std::size_t kWidth = 24;
  std::string bar;
  if (p.total) {
    const double part = std::clamp(static_cast<double>(p.done) / static_cast<double>(p.total), 0.0, 1.0);
    const auto full = static_cast<std::size_t>(std::lround(part * static_cast<double>(kWidth)));
    bar = fmt::format("[{}{}] {:3.0f}%  ", std::string(full, '#'), std::string(kWidth - full, '.'), 100 * part);
  }
  const std::string line =
      fmt::format("{:<14} {}{}", p.stage, bar, counts(p, seconds_between(stage_start_, Clock::now())));
  fmt::print(stderr, "\r\033[K{}", line.substr(0, 100));
  std::fflush(stderr);
  has_bar_ = true;
}

void Terminal::show_plain(const Progress& p) {
  fmt::print(stderr, "delfront: {}: {}\n", p.stage, counts(p, seconds_between(stage_start_, Clock::now())));
}

void Terminal::show_json(const Progress& p) {
  put_json({{"event", "progress"},
            {"stage", p.stage},
            {"done", p.done},
            {"total", p.total},
            {"unit", p.unit},
            {"seconds", seconds_between(start_, Clock::now())}});
}

void Terminal::clear_bar() {
  if (has_bar_) fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  has_bar_ = false;
}

void Terminal::log(LogLevel level, const std::string& message) {
  if (level != LogLevel::warning && verbosity_ < 1) return;
  if (verbosity_ < 0) return;
  const char* name = level == LogLevel::warning ? "warning" : level == LogLevel::info ? "info" : "debug";
  if (style_ == ProgressStyle::json) return put_json({{"event", "log"}, {"level", name}, {"message", message}});
  clear_bar();
  fmt::print(stderr, "delfront: {}: {}\n", name, message);
}

void Terminal::error(ExitCode code, const std::string& message, const std::vector<Place>& places) {
  constexpr std::size_t kShown = 5;
  if (style_ == ProgressStyle::json) {
    Json list = Json::array();
    for (std::size_t i = 0; i < std::min(places.size(), kMaxJsonPlaces); ++i)
      list.push_back({{"at", {places[i].at.x, places[i].at.y, places[i].at.z}}, {"ids", places[i].ids}});
    return put_json(
        {{"event", "error"}, {"exit_code", static_cast<int>(code)}, {"message", message}, {"places", list}});
  }
  clear_bar();
  fmt::print(stderr, "delfront: error: {}\n", message);
  for (std::size_t i = 0; i < std::min(places.size(), kShown); ++i) {
    const Place& place = places[i];
    fmt::print(stderr, "  at ({:g}, {:g}, {:g})", place.at.x, place.at.y, place.at.z);
    for (std::size_t k = 0; k < place.ids.size(); ++k) fmt::print(stderr, "{} {}", k ? "," : " ids", place.ids[k]);
    fmt::print(stderr, "\n");
  }
  if (places.size() > kShown) fmt::print(stderr, "  and {} more places\n", places.size() - kShown);
}

void Terminal::detail(const std::string& message) {
  if (verbosity_ < 0) return;
  if (style_ == ProgressStyle::json) return put_json({{"event", "detail"}, {"message", message}});
  fmt::print(stderr, "  {}\n", message);
}

ProgressStyle parse_progress_style(const std::string& name) {
  if (name == "auto") return ProgressStyle::automatic;
  if (name == "bar") return ProgressStyle::bar;
  if (name == "plain") return ProgressStyle::plain;
  if (name == "json") return ProgressStyle::json;
  if (name == "none") return ProgressStyle::none;
  throw UsageError(fmt::format("--progress {}: allowed are auto, bar, plain, json, none", name));
}

}  // namespace delfront::cli
