// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace delfront {

/// @brief How far a job is, from the lines that `--progress json` writes to a file or a pipe.
class JobProgress {
 public:
  /// @param path  a file, which need not be there yet; "-": stdin
  explicit JobProgress(std::string path);
  ~JobProgress();
  JobProgress(const JobProgress&) = delete;
  JobProgress& operator=(const JobProgress&) = delete;

  /// @brief Take what has been written since, without waiting; a pipe has to be emptied, or the job waits.
  void update();
  /// @return {"stages": [the last progress event of each, in order], "messages": [...], "error": event or null,
  /// "has_begun", "has_ended"}; a pipe that was closed has ended, a file only with an error
  nlohmann::ordered_json state() const;

 private:
  bool is_readable() const;
  void take_line(const std::string& line);

  std::string path_, rest_;
  int file_ = -1;
  bool has_begun_ = false, has_ended_ = false;
  nlohmann::ordered_json stages_ = nlohmann::ordered_json::array(), messages_ = nlohmann::ordered_json::array(), error_;
};

}  // namespace delfront
