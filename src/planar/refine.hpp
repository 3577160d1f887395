// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/size_field.hpp"
#include "planar/constrain.hpp"
#include "planar/kernel.hpp"

namespace delfront {

/// @brief Where points are proposed.
/// @par Source  frontal: Rebay (1993); circumcentres: Chew (1993), Ruppert (1995)
enum class PointPlacement : std::uint8_t { frontal, circumcentres };

/// @brief Insert points where triangles are larger than the field asks (T3); boundary and embedded lines stay.
///
/// Afterwards circumradii are at most 0.75 of the wanted size but where the given boundary stands in the way, and no
/// two points are nearer than 0.72 of it: angles of 28 degrees in a field of one size, away from the boundary.
/// @pre complex.h holds the sizes of the vertices; triangles that are not gridded have the colour kOutside
/// @param placement  over the sides of a front, or at the centres of circles that are too large
/// @param counts  if not null: what the kernel did
RefineReport refine_complex(PlanarGrid& grid, const SizeField& size, Context& context,
                            PointPlacement placement = PointPlacement::frontal, PlanarCounts* counts = nullptr);

}  // namespace delfront
