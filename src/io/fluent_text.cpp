// SPDX-License-Identifier: Apache-2.0
#include "io/fluent_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace delfront {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::int64_t parse_hexadecimal(std::string_view word, bool& is_number) {
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value, 16);
  is_number = !word.empty() && error == std::errc() && stop == word.data() + word.size();
  return value;
}

}  // namespace

/// Behind the parenthesis that closes `depth` open ones; strings may hold parentheses.
std::size_t FluentText::end_of_parenthesis(std::size_t from, int depth) const {
  const std::string_view bytes = cursor_.bytes();
  for (std::size_t i = from; i < bytes.size(); ++i) {
    if (bytes[i] == '"') {
      i = bytes.find('"', i + 1);
      if (i == std::string_view::npos) break;
    } else if (bytes[i] == '(') {
      ++depth;
    } else if (bytes[i] == ')' && --depth == 0) {
      return i + 1;
    }
  }
  cursor_.fail_at(from, "a parenthesis is not closed; the file is truncated");
}

bool FluentText::next(FluentSection& section) {
  if (cursor_.at_end()) return false;
  section = {};
  section.begin = cursor_.position();
  if (cursor_.bytes()[section.begin] != '(')
    cursor_.fail_at(section.begin, "a section of a Fluent mesh begins with '('; this is none, or it is damaged");
  const std::string_view rest = cursor_.bytes().substr(section.begin + 1);
  int index = -1;
  std::size_t skipped = 0;
  while (skipped < rest.size() && is_blank(rest[skipped])) ++skipped;
  const auto [stop, error] =
      std::from_chars(rest.data() + skipped, rest.data() + std::min(rest.size(), skipped + 12), index);
  if (error != std::errc() || index < 0) cursor_.fail_at(section.begin, "a section begins with its number");
  section.form = index >= 2000 ? index / 1000 : 0;
  section.index = index >= 2000 ? index % 1000 : index;
  cursor_.move_to(section.begin + 1 + static_cast<std::size_t>(stop - rest.data()));
  read_head(section);
  return true;
}

void FluentText::read_head(FluentSection& section) {
  const std::string_view bytes = cursor_.bytes();
  std::size_t at = cursor_.position();
  while (at < bytes.size() && is_blank(bytes[at])) ++at;
  if (at < bytes.size() && bytes[at] == '"') {
    const std::size_t quote = bytes.find('"', at + 1);
    if (quote == std::string_view::npos) cursor_.fail_at(at, "a text has no end; the file is truncated");
    section.text = bytes.substr(at + 1, quote - at - 1);
    return cursor_.move_to(quote + 1);
  }
  if (at >= bytes.size() || bytes[at] != '(') return;  // "(2 3)"
  const std::size_t close = bytes.find(')', at);
  if (close == std::string_view::npos) cursor_.fail_at(at, "the head of a section has no end; the file is truncated");
  std::string_view head = bytes.substr(at + 1, close - at - 1);
  while (!head.empty() && section.words.size() < 64) {
    while (!head.empty() && is_blank(head.front())) head.remove_prefix(1);
    std::size_t length = 0;
    while (length < head.size() && !is_blank(head[length])) ++length;
    if (length == 0) break;
    section.words.push_back(head.substr(0, length));
    bool is_number = false;
    const std::int64_t value = parse_hexadecimal(section.words.back(), is_number);
    section.numbers.push_back(is_number ? value : -1);
    head.remove_prefix(length);
  }
  at = close + 1;
  while (at < bytes.size() && is_blank(bytes[at])) ++at;
  if (at < bytes.size() && bytes[at] == '(') section.body = ++at;
  cursor_.move_to(at);
}

void FluentText::skip(const FluentSection& section) {
  if (section.form == 0) {
    cursor_.move_to(end_of_parenthesis(section.begin, 0));
    return;
  }
  const std::string mark = "End of Binary Section";
  const std::size_t found = cursor_.bytes().find(mark, cursor_.position());
  if (section.body == 0) return cursor_.move_to(end_of_parenthesis(section.begin, 0));
  if (found == std::string_view::npos)
    cursor_.fail_at(section.begin, "a binary section has no end; the file is truncated");
  const std::size_t close = cursor_.bytes().find(')', found);
  cursor_.move_to(close == std::string_view::npos ? cursor_.bytes().size() : close + 1);
}

std::int64_t FluentText::hexadecimal(const char* what) {
  const std::string_view bytes = cursor_.bytes();
  std::size_t at = cursor_.position();
  while (at < bytes.size() && is_blank(bytes[at])) ++at;
  std::size_t end = at;
  while (end < bytes.size() && !is_blank(bytes[end]) && bytes[end] != ')') ++end;
  bool is_number = false;
  const std::int64_t value = parse_hexadecimal(bytes.substr(at, end - at), is_number);
  if (!is_number)
    cursor_.fail_at(at, fmt::format("'{}' should be a hexadecimal number ({})",
                                    bytes.substr(at, std::min<std::size_t>(end - at, 40)), what));
  cursor_.move_to(end);
  return value;
}

}  // namespace delfront
