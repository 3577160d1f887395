// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "delfront/options.hpp"

namespace delfront {

/// @return the whole text as one finite number
/// @throws UsageError  anything else; `what` names it in the message ("length", "number")
double parse_number(const std::string& text, const char* what);

/// @return seconds, of "90", "90 s", "5min", "2h", "1d"
/// @throws UsageError  malformed, negative, or an unknown unit
double parse_duration(const std::string& text);

/// @return bytes, of "1000000", "500 MB", "20GB", "16GiB" (kB MB GB TB by 1000, KiB MiB GiB TiB by 1024)
/// @throws UsageError  malformed, negative, or an unknown unit
std::uint64_t parse_memory(const std::string& text);

/// @return "5%", "2 mm", "0.5": what parse_length reads back as the same length
std::string to_text(const Length& length);

/// @return metres a unit holds: m mm in ft; 0 for "auto", "" and anything else
double metres_per_unit(const std::string& unit);

}  // namespace delfront
