// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

struct Mesh;

/// @brief Where something is wrong: a place in space and, where known, the ids of the entities there.
struct Place {
  Point at;
  std::vector<std::uint32_t> ids;  ///< of what `Finding::kind` or the message names, input numbering
};

/// @brief What the command line returns for each way a run can end (interface.md).
enum class ExitCode : int {
  done = 0,
  internal_error = 1,
  usage = 2,
  bad_input = 3,
  meshing_failed = 4,
  gate_not_met = 5,
  limit_reached = 6,
  cannot_write = 7,
  interrupted = 130,
};

/// @brief Base of all errors a caller can do something about. The message says what, where, and what to try.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message, std::vector<Place> where = {})
      : std::runtime_error(message), exit_code(code), places(std::move(where)) {}
  ExitCode exit_code;
  std::vector<Place> places;
};

/// @brief Wrong options or a wrong job file: names the key, its line, what is allowed.
struct UsageError : Error {
  explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};
/// @brief Input that cannot be read, is invalid, or cannot bound what was asked for.
struct InputError : Error {
  explicit InputError(const std::string& message, std::vector<Place> where = {})
      : Error(ExitCode::bad_input, message, std::move(where)) {}
};
/// @brief Gridding failed after all recovery steps; carries the places for the viewer.
struct MeshingError : Error {
  explicit MeshingError(const std::string& message, std::vector<Place> where = {},
                        std::shared_ptr<const Mesh> so_far = nullptr)
      : Error(ExitCode::meshing_failed, message, std::move(where)), partial(std::move(so_far)) {}
  std::shared_ptr<const Mesh> partial;  ///< the grid as far as it came, to look at; null where there is none
};
/// @brief A file cannot be written (permission, missing folder, disk full).
struct IoError : Error {
  explicit IoError(const std::string& message) : Error(ExitCode::cannot_write, message) {}
};
/// @brief A limit of time, memory or cells was reached.
struct LimitError : Error {
  explicit LimitError(const std::string& message) : Error(ExitCode::limit_reached, message) {}
};
/// @brief The user (or the caller's token) stopped the run.
struct Cancelled : Error {
  Cancelled() : Error(ExitCode::interrupted, "interrupted; nothing was written") {}
};
/// @brief A defect of ours, found by DELFRONT_CHECK.
struct InternalError : Error {
  explicit InternalError(const std::string& message) : Error(ExitCode::internal_error, message) {}
};

[[noreturn]] void fail_check(const char* condition, const char* file, int line);

/// @brief An invariant that is always checked, in every build; cheap ones only.
#define DELFRONT_CHECK(condition) \
  (static_cast<bool>(condition) ? void(0) : ::delfront::fail_check(#condition, __FILE__, __LINE__))

}  // namespace delfront
