// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "delfront/model.hpp"

namespace delfront {

/// @return `wanted` where no patch of the model has that name, else wanted_2, wanted_3, …
std::string unused_patch_name(const Model& model, const std::string& wanted);

}  // namespace delfront
