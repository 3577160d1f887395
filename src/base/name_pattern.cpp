// SPDX-License-Identifier: Apache-2.0
#include "base/name_pattern.hpp"

#include <cstddef>

namespace delfront {

bool matches_pattern(std::string_view name, std::string_view pattern) {
  // Greedy with one place to come back to: the last star, which then takes one character more.
  std::size_t n = 0, p = 0, star = std::string_view::npos, star_takes_to = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_takes_to = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++star_takes_to;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace delfront
