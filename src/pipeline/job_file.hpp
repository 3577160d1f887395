// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "pipeline/job_value.hpp"

namespace delfront {

/// @brief A TOML text as a tree of values with lines.
/// @param name  of the file, for messages
/// @throws UsageError  not TOML (line and reason)
JobValue parse_toml(const std::string& text, const std::string& name);

/// @brief The same of a JSON text; a value's line is the one on which it ends.
/// @throws UsageError  not JSON (line and reason), a key given twice
JobValue parse_json(const std::string& text, const std::string& name);

/// @return the bytes of a file
/// @throws InputError  missing, a folder, unreadable
std::string read_text_file(const std::string& path);

}  // namespace delfront
