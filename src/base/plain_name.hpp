// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace delfront {

/// @brief A name that any file and any terminal can show: bytes that are no UTF-8, and control characters, become '_'.
std::string plain_name(std::string_view name);

}  // namespace delfront
