// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace delfront {

/// @brief The line of the first letter outside of ASCII that stands neither in a text nor in a comment of a TOML file,
/// or in a text right after a backslash (and white space); 0: none. TOML has no such letters, and toml++ 3.3 runs into
/// undefined behaviour on many of them.
/// @par Cost  O(n)
int find_stray_letter(std::string_view toml);

}  // namespace delfront
