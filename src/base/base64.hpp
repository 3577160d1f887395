// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace delfront {

/// @brief As RFC 4648 has it, padded.
std::string to_base64(std::string_view bytes);

}  // namespace delfront
