// SPDX-License-Identifier: Apache-2.0
#include "base/nearest_name.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace delfront {

namespace {

std::string folded(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z')
      result.push_back(static_cast<char>(c - 'A' + 'a'));
    else
      result.push_back(c == '-' ? '_' : c);
  }
  return result;
}

/// Damerau-Levenshtein distance, neighbours swapped at most once (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      next[j] = std::min({replace, row[j] + 1, next[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) next[j] = std::min(next[j], before[j - 2] + 1);
    }
    std::swap(before, row);
    std::swap(row, next);
  }
  return row[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view wrong, std::span<const std::string> known) {
  const std::string typed = folded(wrong);
  if (typed.empty()) return "";
  std::string best;
  std::size_t best_cost = 0;
  for (const std::string& name : known) {
    const std::string candidate = folded(name);
    std::size_t cost = edit_distance(typed, candidate);
    std::size_t allowed = std::max<std::size_t>(1, std::max(typed.size(), candidate.size()) / 3);
    if (typed.size() >= 3 && candidate.starts_with(typed)) {
      cost = std::min<std::size_t>(cost, 2);
      allowed = std::max<std::size_t>(allowed, 2);
    }
    if (cost > allowed || (!best.empty() && cost >= best_cost)) continue;
    best = name;
    best_cost = cost;
  }
  return best;
}

}  // namespace delfront
