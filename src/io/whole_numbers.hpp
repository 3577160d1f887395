// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace delfront {

/// @brief Whether a real is a whole number that 64 bits hold.
inline bool is_whole(double value) { return std::abs(value) < 9e18 && value == std::trunc(value); }

/// @brief Reals that stand where whole numbers belong.
/// @param fail  throws, given what is wrong
template <class Fail>
std::vector<std::int64_t> to_whole(const std::vector<double>& reals, const Fail& fail) {
  std::vector<std::int64_t> values;
  values.reserve(reals.size());
  for (const double value : reals) {
    if (!is_whole(value))
      fail(fmt::format("value {} is {}, and a whole number should stand there", values.size(), value));
    values.push_back(static_cast<std::int64_t>(value));
  }
  return values;
}

}  // namespace delfront
