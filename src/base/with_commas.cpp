// SPDX-License-Identifier: Apache-2.0
#include "base/with_commas.hpp"

namespace delfront {

std::string with_commas(std::size_t value) {
  const std::string digits = std::to_string(value);
  std::string result;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) result += ',';
    result += digits[i];
  }
  return result;
}

}  // namespace delfront
