// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace delfront {

/// @brief Version by SemVer; equal to the one in CMakeLists.txt (scripts/lint compares them).
inline constexpr const char* kVersion = "0.1.0";

}  // namespace delfront
