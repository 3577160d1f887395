// SPDX-License-Identifier: Apache-2.0
#include "report/html.hpp"

#include <fmt/format.h>

#include "base/with_commas.hpp"

namespace delfront {

std::string html(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      case '\n':
      case '\t':
        result += c;
        break;
      default:
        if (const auto byte = static_cast<unsigned char>(c); byte < 0x20 || byte == 0x7f)
          result += "\xef\xbf\xbd";  // U+FFFD
        else
          result += c;
    }
  return result;
}

std::string number_text(const Json& value) {
  if (value.is_number_integer()) return with_commas(value.get<std::size_t>());
  return value.is_number() ? fmt::format("{:.4g}", value.get<double>()) : "–";
}

std::string count_text(const Json& value) { return value.is_number() ? with_commas(value.get<std::size_t>()) : "–"; }

std::string point_text(const Json& at) {
  std::string text;
  for (const Json& x : at)
    text += (text.empty() ? "(" : ", ") + (x.is_number() ? fmt::format("{:.6g}", x.get<double>()) : "–");
  return text.empty() ? "–" : text + ")";
}

std::string ids_text(const Json& ids) {
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, ids.size()); ++i)
    text += fmt::format("{}{}", text.empty() ? "" : " ", ids[i].get<std::uint64_t>());
  return ids.size() > kMost ? text + " …" : text;
}

std::string seconds_text(double seconds) {
  if (seconds < 100) return fmt::format("{:.2f} s", seconds);
  return seconds < 600 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

const Json& part_of(const Json& value, const char* key) {
  static const Json none = nullptr;
  if (!value.is_object()) return none;
  const auto it = value.find(key);
  return it == value.end() ? none : *it;
}

std::string text_of(const Json& value, const char* key) {
  const Json& text = part_of(value, key);
  return text.is_string() ? text.get<std::string>() : "";
}

std::string plural(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", with_commas(count), what, count == 1 ? "" : "s");
}

}  // namespace delfront
