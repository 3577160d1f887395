// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace delfront {

// Pieces of a page: everything that came from a file or from what was typed goes through html().

using Json = nlohmann::ordered_json;

/// @brief Text between tags or in a quoted attribute: & < > " ' escaped, control characters replaced.
/// @param text  UTF-8
std::string html(std::string_view text);

/// @brief A number as the terminal shows it, four digits; a dash for null.
std::string number_text(const Json& value);
/// @brief A count with commas.
std::string count_text(const Json& value);
/// @brief "(x, y, z)", six digits.
std::string point_text(const Json& at);
/// @brief Numbers of cells or facets with blanks between, the first few; not escaped, for they are numbers.
std::string ids_text(const Json& ids);
/// @brief 0.12 s, 85 s, 12 min.
std::string seconds_text(double seconds);
/// @return value[key], or null where there is none
const Json& part_of(const Json& value, const char* key);
/// @return the text value[key]; empty where there is none
std::string text_of(const Json& value, const char* key);
/// @return "1 cell", "2 cells"
std::string plural(std::size_t count, const std::string& what);

}  // namespace delfront
