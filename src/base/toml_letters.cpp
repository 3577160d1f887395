// SPDX-License-Identifier: Apache-2.0
#include "base/toml_letters.hpp"

#include <algorithm>
#include <cstddef>

namespace delfront {
namespace {

bool is_letter_beyond(char c) { return static_cast<unsigned char>(c) >= 0x80; }

/// The first letter after a backslash and white space, which the parser looks at as white space too.
std::size_t after_backslash(std::string_view toml, std::size_t at) {
  return std::min(toml.find_first_not_of(" \t\r\n", at + 1), toml.size());
}

/// @return where a text that begins with this quote ends, one past its last quote
/// @param stray  set to a letter that follows a backslash in it
std::size_t end_of_text(std::string_view toml, std::size_t at, std::size_t& stray) {
  const char quote = toml[at];
  const bool is_long = toml.substr(at, 3) == std::string_view(quote == '"' ? "\"\"\"" : "'''");
  at += is_long ? 3 : 1;
  while (at < toml.size()) {
    if (quote == '"' && toml[at] == '\\') {
      if (const std::size_t next = after_backslash(toml, at); next < toml.size() && is_letter_beyond(toml[next]))
        stray = std::min(stray, next);
      at += 2;
      continue;
    }
    if (!is_long && (toml[at] == quote || toml[at] == '\n')) return at + 1;  // a line's end: not valid, said later
    if (is_long && toml[at] == quote && toml.substr(at, 3) == std::string_view(quote == '"' ? "\"\"\"" : "'''")) {
      at += 3;
      while (at < toml.size() && toml[at] == quote) ++at;  // up to two belong to the text
      return at;
    }
    ++at;
  }
  return toml.size();
}

}  // namespace

int find_stray_letter(std::string_view toml) {
  std::size_t at = toml.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0;  // a mark of the encoding
  std::size_t stray = toml.size();
  while (at < stray) {
    const char c = toml[at];
    if (is_letter_beyond(c)) stray = at;
    if (c == '#')
      at = std::min(toml.find('\n', at), toml.size());
    else if (c == '"' || c == '\'')
      at = end_of_text(toml, at, stray);
    else
      ++at;
  }
  if (stray == toml.size()) return 0;
  return 1 + static_cast<int>(std::count(toml.begin(), toml.begin() + static_cast<std::ptrdiff_t>(stray), '\n'));
}

}  // namespace delfront
