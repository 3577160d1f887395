// SPDX-License-Identifier: Apache-2.0
#include "io/nastran_text.hpp"

#include <fmt/format.h>

#include <charconv>

namespace delfront {

namespace {

constexpr std::size_t kMostFields = 4096;  // of one entry; those that are read here have 11 at most

std::string_view field_at(std::string_view line, std::size_t begin, std::size_t width) {
  return begin < line.size() ? trimmed(line.substr(begin, width)) : std::string_view();
}

bool is_continuation(std::string_view line) {
  if (line.empty()) return false;
  return line[0] == '+' || line[0] == '*' || line[0] == ',' ||
         line.substr(0, 8).find_first_not_of(" \t") == std::string_view::npos;
}

}  // namespace

NastranText::NastranText(std::string_view bytes, const std::string& path) : cursor_(bytes, path) {
  // What stands above BEGIN BULK is for the solver.
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    const std::string_view line = trimmed(bytes.substr(at, end - at));
    if (starts_with_ignoring_case(line, "BEGIN BULK") || starts_with_ignoring_case(line, "BEGIN,BULK")) {
      cursor_.move_to(end + 1);
      return;
    }
    at = end + 1;
  }
}

/// Without its line end.
std::string_view NastranText::take_line() {
  const std::size_t begin = cursor_.position();
  cursor_.skip_line();
  std::string_view line = cursor_.bytes().substr(begin, cursor_.position() - begin);
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

void NastranText::add_fields(std::string_view line, NastranEntry& entry) {
  const bool is_free = line.find(',') != std::string_view::npos;
  const std::string_view head = line.substr(0, is_free ? line.find(',') : std::size_t{8});
  const bool is_large = head.find('*') != std::string_view::npos;
  const std::size_t most = is_large ? 4 : 8;
  const std::size_t wanted = entry.fields.size() + most;
  if (wanted > kMostFields) fail(entry, fmt::format("{} has more than {} fields", entry.name, kMostFields));
  if (is_free) {
    std::size_t at = std::min(line.find(','), line.size() - 1) + 1;
    for (std::size_t i = 0; i < most && at <= line.size(); ++i) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      entry.fields.push_back(trimmed(line.substr(at, end - at)));
      at = end + 1;
    }
  } else if (const std::size_t tab = line.find('\t'); tab != std::string_view::npos) {
    std::size_t at = tab + 1;
    for (std::size_t i = 0; i < most && at <= line.size(); ++i) {
      const std::size_t end = std::min(line.find('\t', at), line.size());
      entry.fields.push_back(trimmed(line.substr(at, end - at)));
      at = end + 1;
    }
  } else {
    const std::size_t width = is_large ? 16 : 8;
    for (std::size_t i = 0; i < most; ++i) entry.fields.push_back(field_at(line, 8 + i * width, width));
  }
  entry.fields.resize(wanted);
}

bool NastranText::next(NastranEntry& entry, std::vector<std::string_view>& comments) {
  entry = {};
  std::string_view line;
  while (cursor_.position() < cursor_.bytes().size()) {
    entry.position = cursor_.position();
    line = take_line();
    if (line.starts_with('$')) {
      comments.push_back(line);
    } else if (!trimmed(line).empty() && !is_continuation(line)) {
      break;  // a continuation without its entry says nothing
    }
    line = {};
  }
  if (line.empty()) return false;
  std::string_view name = line.substr(0, std::min(line.find_first_of(",\t"), std::size_t{8}));
  for (const char c : trimmed(name))
    if (c != '*') entry.name += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  if (entry.name.starts_with("ENDDATA")) return false;
  add_fields(line, entry);
  for (;;) {  // comments may stand between an entry and what continues it
    const std::size_t before = cursor_.position();
    line = before < cursor_.bytes().size() ? take_line() : std::string_view();
    if (line.starts_with('$')) {
      comments.push_back(line);
    } else if (!trimmed(line).empty() && is_continuation(line)) {
      add_fields(line, entry);
    } else {
      cursor_.move_to(before);
      return true;
    }
  }
}

void NastranText::fail(const NastranEntry& entry, const std::string& message) const {
  cursor_.fail_at(entry.position, message);
}

std::int64_t NastranText::integer(const NastranEntry& entry, std::size_t i, const char* what) const {
  std::string_view text = i < entry.fields.size() ? entry.fields[i] : std::string_view();
  const std::string_view whole = text;
  if (text.starts_with('+')) text.remove_prefix(1);
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || stop != text.data() + text.size())
    fail(entry, fmt::format("{}: '{}' in field {} should be a whole number ({})", entry.name, whole.substr(0, 40),
                            i + 2, what));
  return value;
}

double NastranText::real(const NastranEntry& entry, std::size_t i, const char* what, double blank) const {
  const std::string_view text = i < entry.fields.size() ? entry.fields[i] : std::string_view();
  if (text.empty()) return blank;
  double value = 0;
  if (parse_number(text, value)) return value;
  // "1.5-3" is 1.5e-3.
  const std::size_t sign = text.find_last_of("+-");
  if (sign != std::string_view::npos && sign > 0 && text.size() < 40) {
    const std::string with_e = fmt::format("{}e{}", text.substr(0, sign), text.substr(sign));
    if (parse_number(with_e, value)) return value;
  }
  fail(entry, fmt::format("{}: '{}' in field {} should be a number ({})", entry.name, text.substr(0, 40), i + 2, what));
}

namespace {

/// "1.5e-05" as "1.5-5", "3" as "3.".
std::string as_nastran(std::string text) {
  std::string exponent;
  if (const std::size_t e = text.find('e'); e != std::string::npos) {
    std::size_t first = e + 2;
    while (first + 1 < text.size() && text[first] == '0') ++first;
    exponent = text[e + 1] + text.substr(first);
    text.resize(e);
  }
  if (text.find('.') == std::string::npos) text += '.';
  return text + exponent;
}

}  // namespace

std::string nastran_real(double value) {
  constexpr std::size_t kWidth = 16;
  if (std::string text = as_nastran(fmt::format("{}", value)); text.size() <= kWidth) return text;
  for (int digits = 16; digits > 0; --digits) {
    if (std::string text = as_nastran(fmt::format("{:.{}g}", value, digits)); text.size() <= kWidth) return text;
    if (std::string text = as_nastran(fmt::format("{:.{}e}", value, digits - 1)); text.size() <= kWidth) return text;
  }
  return "0.";
}

}  // namespace delfront
