// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace delfront {

/// @brief The files that write_mesh makes for this path: the path itself, then what stands beside it (UGRID's .mapbc,
/// the .h5 of an .xdmf). Of a path in no known format that alone.
std::vector<std::string> files_written_as(const std::string& path, const std::string& format = "");

/// @brief The files that read_mesh may take for this path, there or not: also Medit's solutions. Of a path in no known
/// format that alone.
std::vector<std::string> files_read_as(const std::string& path, const std::string& format = "");

}  // namespace delfront
