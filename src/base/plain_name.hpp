// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace delfront {

/// @brief A name that any file and any terminal can show: bytes that are no UTF-8, and control characters, become '_'.
std::string plain_name(std::string_view name);

/// @brief The warning that a file has such names.
std::string say_plain_names(const std::string& path, std::size_t num_changed);

}  // namespace delfront
