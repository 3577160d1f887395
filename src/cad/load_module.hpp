// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cad/cad_data.hpp"

namespace delfront::cad {

/// @brief The module, loaded at the first call and kept; null where there is none that fits.
/// @param[out] why  where null: what was looked for and what to do; else which it is
const ModuleInfo* find_module(std::string& why);

}  // namespace delfront::cad
