// SPDX-License-Identifier: Apache-2.0
#include "base/plain_name.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace delfront {
namespace {

/// Bytes of the character that `text` begins with; 0: it is none (Unicode 15, table 3-7).
std::size_t length_of_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xbf) {
    return byte(i) >= low && byte(i) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return follows(1) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    const bool is_second = follows(1, first == 0xe0 ? 0xa0 : 0x80, first == 0xed ? 0x9f : 0xbf);
    return is_second && follows(2) ? 3 : 0;
  }
  if (first < 0xf0 || first > 0xf4) return 0;
  return follows(1, first == 0xf0 ? 0x90 : 0x80, first == 0xf4 ? 0x8f : 0xbf) && follows(2) && follows(3) ? 4 : 0;
}

/// Of ASCII, and U+0080 to U+009F.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 2) return first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
  return character.size() == 1 && (first < 0x20 || first == 0x7f);
}

}  // namespace

std::string plain_name(std::string_view name) {
  std::string plain;
  while (!name.empty()) {
    const std::size_t length = length_of_character(name);
    const std::string_view character = name.substr(0, length == 0 ? 1 : length);
    if (length == 0 || is_control(character))
      plain += '_';
    else
      plain += character;
    name.remove_prefix(character.size());
  }
  return plain;
}

std::string say_plain_names(const std::string& path, std::size_t num_changed) {
  return fmt::format("{}: {} control characters, or bytes that are no text (UTF-8): they are '_' here", path,
                     num_changed == 1 ? "1 name holds" : fmt::format("{} names hold", num_changed));
}

}  // namespace delfront
