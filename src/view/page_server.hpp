// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "view/local_server.hpp"

namespace delfront {

/// @brief 128 random bits as 32 hexadecimal digits. @throws IoError  the system gives none
std::string make_token();

/// @brief What is served under /TOKEN/: the page, `grid` (its data), `progress` (JSON). No file of the machine has a
/// path here, so that none can be asked for.
struct Served {
  std::string token;
  int port = 0;
  std::string_view page;
  std::shared_ptr<const std::string> grid;      ///< null: none yet (404)
  std::shared_ptr<const std::string> progress;  ///< null: no job, and so is the answer
};

/// @return 403 for another Host (a page of another site that has its name point here) or token, 404 for other paths
Response answer_request(const Served& served, const Request& request);

}  // namespace delfront
