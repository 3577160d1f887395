// SPDX-License-Identifier: Apache-2.0
#include "base/toml_letters.hpp"

#include <algorithm>
#include <cstddef>

namespace delfront {
namespace {

/// @return where a text that begins with this quote ends, one past its last quote
std::size_t end_of_text(std::string_view toml, std::size_t at) {
  const char quote = toml[at];
  const bool is_long = toml.substr(at, 3) == std::string_view(quote == '"' ? "\"\"\"" : "'''");
  at += is_long ? 3 : 1;
  while (at < toml.size()) {
    if (quote == '"' && toml[at] == '\\') {
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
  while (at < toml.size()) {
    const char c = toml[at];
    if (static_cast<unsigned char>(c) >= 0x80)
      return 1 + static_cast<int>(std::count(toml.begin(), toml.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    if (c == '#')
      at = std::min(toml.find('\n', at), toml.size());
    else if (c == '"' || c == '\'')
      at = end_of_text(toml, at);
    else
      ++at;
  }
  return 0;
}

}  // namespace delfront
