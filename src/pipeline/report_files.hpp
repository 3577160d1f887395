// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/job.hpp"

namespace delfront {

/// @return what is written for a report of that name: nothing; the JSON; or the page, and the JSON beside it
std::vector<std::string> report_files(const std::string& report);

/// @brief Write the report of a run, each file whole or not at all, the page last. Nothing is written where one of them
/// would be over a file of the same run, which is refused before the work.
/// @throws IoError
void write_report_files(const Options& options, const std::string& command, const JobResult& result);

}  // namespace delfront
