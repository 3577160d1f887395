// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "delfront/brep_shapes.hpp"
#include "delfront/geometry_text.hpp"

namespace delfront {

/// @throws InputError  an axis or x without length, x not square to the axis; without the file's place
SpaceFrame build_frame(const TextFrame& frame);

/// @brief A whole shape, its faces named after it.
/// @throws InputError  lengths that are not positive; without the file's place
Brep build_shape(const TextShape& shape);

/// @brief Add all that a Brep holds to another.
void append_brep(Brep& to, Brep from);

}  // namespace delfront
