// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/job.hpp"
#include "delfront/options.hpp"

namespace delfront {

/// @brief What is wrong with the options as a whole, and with the places of the outputs.
/// @throws UsageError  the key and where it was set
/// @throws IoError     an output that cannot be written
void check_job(const Options& options, const JobExtras& extras);

/// @brief That lengths can be turned into the output's unit; of CAD once it is read, for it may say its own.
/// @throws UsageError
void check_output_units(const Options& options);

/// @brief Lengths in percent, in longest sides or in units become model units, so that nobody after us has to ask.
/// @throws UsageError  a unit while that of the model is not known, hmin above hmax
void resolve_lengths(Options& options, const LengthScale& scale);

/// @return the job files that options were read from, by where they were set ("case.toml:12")
std::vector<std::string> job_files(const Options& options);

/// @brief That nothing written is a file of an input (files_read_as), under whatever name.
/// @param input  may be empty
/// @throws UsageError  which would be overwritten
void refuse_to_overwrite(const std::string& input, const std::string& input_format,
                         const std::vector<std::string>& written);

/// @return the first of `others` that writing `path` would destroy, or nullptr
const std::string* find_same_file(const std::string& path, const std::vector<std::string>& others);

}  // namespace delfront
