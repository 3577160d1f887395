// SPDX-License-Identifier: Apache-2.0
// Quantities as people type them: a number and, perhaps after a blank, a unit.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "delfront/errors.hpp"
#include "pipeline/quantities.hpp"

namespace delfront {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

/// The number in front and what follows it; independent of the locale.
std::pair<double, std::string> split_quantity(const std::string& text, const char* what) {
  std::string_view rest = trimmed(text);
  if (rest.size() > 1 && rest[0] == '+' && rest[1] != '-') rest.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error == std::errc::result_out_of_range)
    throw UsageError(fmt::format("{} '{}' does not fit a double-precision number", what, text));
  if (error != std::errc()) throw UsageError(fmt::format("{} '{}' does not begin with a number", what, text));
  if (!std::isfinite(value)) throw UsageError(fmt::format("{} '{}' is not finite", what, text));
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return {value, std::string(trimmed(rest))};
}

double not_negative(double value, const std::string& text, const char* what) {
  if (value < 0) throw UsageError(fmt::format("{} '{}' is negative", what, text));
  return value;
}

}  // namespace

double parse_number(const std::string& text, const char* what) {
  const auto [value, rest] = split_quantity(text, what);
  if (!rest.empty()) throw UsageError(fmt::format("{} '{}': '{}' after the number", what, text, rest));
  return value;
}

Length parse_length(const std::string& text) {
  const auto [value, unit] = split_quantity(text, "length");
  for (const char* known : {"", "m", "mm", "in", "ft", "%", "c"})
    if (unit == known) return {value, unit};
  throw UsageError(
      fmt::format("length '{}': unknown unit '{}'; allowed are none (model units), m, mm, in, ft, % (of the bounding "
                  "box's diagonal) and c (longest side)",
                  text, unit));
}

double resolve_length(const Length& length, const LengthScale& scale) {
  if (length.unit.empty()) return length.value;
  if (length.unit == "%") return length.value / 100 * scale.diagonal;
  if (length.unit == "c") return length.value * scale.longest_side;
  const double metres = metres_per_unit(length.unit);
  if (metres == 0) throw UsageError(fmt::format("length '{}' has an unknown unit", to_text(length)));
  if (scale.metres_per_unit <= 0)
    throw UsageError(
        fmt::format("length '{}' needs the unit of the model, which the input does not say; say it with "
                    "--units (input.units), or give the length in model units or percent",
                    to_text(length)));
  return length.value * metres / scale.metres_per_unit;
}

std::string to_text(const Length& length) {
  const bool is_word = !length.unit.empty() && length.unit != "%" && length.unit != "c";
  return fmt::format("{}{}{}", length.value, is_word ? " " : "", length.unit);
}

double metres_per_unit(const std::string& unit) {
  if (unit == "m") return 1;
  if (unit == "mm") return 0.001;
  if (unit == "in") return 0.0254;
  if (unit == "ft") return 0.3048;
  return 0;
}

double parse_duration(const std::string& text) {
  const auto [value, unit] = split_quantity(text, "time");
  const double seconds = not_negative(value, text, "time");
  if (unit.empty() || unit == "s") return seconds;
  if (unit == "min") return seconds * 60;
  if (unit == "h") return seconds * 3600;
  if (unit == "d") return seconds * 86400;
  throw UsageError(fmt::format("time '{}': unknown unit '{}'; allowed are s, min, h, d", text, unit));
}

std::uint64_t parse_memory(const std::string& text) {
  const auto [value, unit] = split_quantity(text, "memory");
  double factor = unit.empty() || unit == "B" ? 1 : 0;
  double decimal = 1e3, binary = 1024;
  for (const char prefix : {'k', 'M', 'G', 'T'}) {
    if (unit == fmt::format("{}B", prefix) || (prefix == 'k' && unit == "KB")) factor = decimal;
    if (unit == fmt::format("{}iB", prefix == 'k' ? 'K' : prefix)) factor = binary;
    decimal *= 1e3;
    binary *= 1024;
  }
  if (factor == 0)
    throw UsageError(
        fmt::format("memory '{}': unknown unit '{}'; allowed are B, kB, MB, GB, TB, KiB, MiB, GiB, TiB", text, unit));
  const double bytes = not_negative(value, text, "memory") * factor;
  if (bytes > 1e18) throw UsageError(fmt::format("memory '{}' is more than any machine has", text));
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace delfront
