// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace delfront {

/// @brief Whether a name fits a pattern: * stands for any text, ? for one character, the rest for itself.
/// @par Cost  O(name * pattern) at worst
bool matches_pattern(std::string_view name, std::string_view pattern);

}  // namespace delfront
