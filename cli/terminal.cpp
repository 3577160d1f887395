// SPDX-License-Identifier: Apache-2.0
#include "terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

namespace delfront::cli {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t kColumns = 100;
constexpr std::size_t kMostIds = 8;  ///< of a place; the defects file has all

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

/// "1 file", "12.3k points"
std::string count_of(double value, const std::string& unit) {
  const bool is_plural = value != 1 || !unit.ends_with('s');
  return fmt::format("{} {}", short_count(value), is_plural ? unit : unit.substr(0, unit.size() - 1));
}

/// "12.3k of 45.6k points, 1.20M/s, 3 s left": as much of it as is known. At the start only how much there is to do:
/// "0 of 1 files" reads like a failure where it is the last line of a stage.
std::string counts(const Progress& p, double seconds_in_stage) {
  const auto done = static_cast<double>(p.done), total = static_cast<double>(p.total);
  if (p.done == 0 && p.total > 0) return count_of(total, p.unit);
  std::string text =
      p.total ? fmt::format("{} of {}", short_count(done), count_of(total, p.unit)) : count_of(done, p.unit);
  if (seconds_in_stage < 0.5 || p.done == 0) return text;
  const double rate = done / seconds_in_stage;
  text += fmt::format(", {}/s", rate < 10 ? fmt::format("{:.1f}", rate) : short_count(rate));
  const bool has_sweeps = p.stage == "improve";  // its count restarts with each, and how many come is not known
  if (p.total > p.done && !has_sweeps) text += fmt::format(", {} left", short_time((total - done) / rate));
  return text;
}

std::size_t num_columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;  // what continues a UTF-8 character takes no column
  }));
}

/// Words of `text` on lines of at most kColumns, the later ones with this indent. `column` is where the first begins.
std::string wrapped(std::string_view text, std::size_t column, const std::string& indent) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    const std::size_t width = num_columns(word);
    if (begin > 0 && column + 1 + width > kColumns) {
      result.append("\n").append(indent);
      column = indent.size();
    } else if (begin > 0) {
      result += ' ';
      ++column;
    }
    result += word;
    column += width;
    begin = end + 1;
  }
  return result;
}

/// A message as a person reads it: short ones as they are; of long ones what is wrong on the first line, and each part
/// behind a "; " (where, what to try) on one of its own.
std::string broken(const std::string& prefix, const std::string& message) {
  std::string result = prefix;
  for (std::size_t begin = 0; begin <= message.size();) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    std::string_view line = std::string_view(message).substr(begin, end - begin);
    const std::size_t blanks = std::min(line.find_first_not_of(' '), line.size());
    const std::string indent(blanks + 2, ' ');
    std::size_t column = begin == 0 ? num_columns(prefix) : blanks;
    if (begin > 0) result.append("\n").append(blanks, ' ');
    line.remove_prefix(blanks);
    if (column + num_columns(line) <= kColumns) {
      result += line;
      line = {};
    }
    while (!line.empty()) {
      const std::size_t part = std::min(line.find("; "), line.size());
      const bool is_last = part == line.size();
      result += wrapped(line.substr(0, is_last ? part : part + 1), column, std::string(blanks + 4, ' '));
      line.remove_prefix(is_last ? part : part + 2);
      column = indent.size();
      if (!line.empty()) result.append("\n").append(indent);
    }
    begin = end + 1;
  }
  return result;
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

void Terminal::clear_bar_of_others() {
  has_bar_ = style_ == ProgressStyle::bar;
  clear_bar();
}

void Terminal::log(LogLevel level, const std::string& message) {
  if (level != LogLevel::warning && verbosity_ < 1) return;
  if (verbosity_ < 0) return;
  const char* name = level == LogLevel::warning ? "warning" : level == LogLevel::info ? "info" : "debug";
  if (style_ == ProgressStyle::json) return put_json({{"event", "log"}, {"level", name}, {"message", message}});
  clear_bar();
  fmt::print(stderr, "{}\n", broken(fmt::format("delfront: {}: ", name), message));
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
  fmt::print(stderr, "{}\n", broken("delfront: error: ", message));
  for (std::size_t i = 0; i < std::min(places.size(), kShown); ++i) {
    const Place& place = places[i];
    fmt::print(stderr, "  at ({:g}, {:g}, {:g})", place.at.x, place.at.y, place.at.z);
    const std::size_t shown = std::min(place.ids.size(), kMostIds);
    for (std::size_t k = 0; k < shown; ++k) fmt::print(stderr, "{} {}", k ? "," : " ids", place.ids[k]);
    if (shown < place.ids.size()) fmt::print(stderr, " and {} more", place.ids.size() - shown);
    fmt::print(stderr, "\n");
  }
  if (places.size() > kShown) fmt::print(stderr, "  and {} more places\n", places.size() - kShown);
}

void Terminal::detail(const std::string& message) {
  if (verbosity_ < 0) return;
  if (style_ == ProgressStyle::json) return put_json({{"event", "detail"}, {"message", message}});
  fmt::print(stderr, "{}\n", broken("  ", message));
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
