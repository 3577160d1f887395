// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace delfront {

/// @return whether a report of this name is a page to read: .html or .htm, in capitals too
bool is_page_name(const std::string& path);

/// @return the name of the JSON beside a page: run.html, run.json; else the path itself
std::string json_name(const std::string& path);

}  // namespace delfront
