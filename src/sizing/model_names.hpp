// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "delfront/model.hpp"

namespace delfront {

/// @brief The names of a model's patches, curves and corners, in this order; no empty ones.
std::vector<std::string> names_on(const Model& model);

/// @return for messages: "; did you mean 'wing'?; there are: wing, tip and 3 more"
std::string say_names(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace delfront
