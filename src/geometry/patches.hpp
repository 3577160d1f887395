// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <unordered_map>

#include "delfront/model.hpp"

namespace delfront {

/// @brief Names for patches, each once: constant time a name.
class PatchNames {
 public:
  /// @return `wanted` the first time, then wanted_2, wanted_3, …
  std::string take(const std::string& wanted);

 private:
  std::unordered_map<std::string, int> next_number_;  // of each name that is taken
};

/// @return `wanted` where no patch of the model has that name, else wanted_2, wanted_3, …
std::string unused_patch_name(const Model& model, const std::string& wanted);

}  // namespace delfront
