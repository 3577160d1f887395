// SPDX-License-Identifier: Apache-2.0
#include "base/report_name.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace delfront {

bool is_page_name(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return suffix == ".html" || suffix == ".htm";
}

std::string json_name(const std::string& path) {
  return is_page_name(path) ? std::filesystem::path(path).replace_extension(".json").string() : path;
}

}  // namespace delfront
