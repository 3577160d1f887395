// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cad/cad_data.hpp"

namespace delfront::cad {

/// @brief A module's data as smooth geometry: loops in order, parameter curves that are missing or wrong found by
/// projection, degenerate edges where a loop jumps along a point, tolerances raised to what they are.
/// @param[in,out] report  repairs and what is suspicious are added
/// @throws InputError  an entity that cannot be used, with its number and place
Brep build_cad(const Result& data, CadReport& report, Context& context);

}  // namespace delfront::cad
