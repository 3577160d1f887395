// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>

namespace delfront {

/// @return 1234567 as "1,234,567"
std::string with_commas(std::size_t value);

}  // namespace delfront
