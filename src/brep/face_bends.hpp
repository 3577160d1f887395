// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "brep/wanted_size.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief Adds the places of a face where it bends more than sides of the wanted size can follow, with the size that
/// they ask for: nose of a blade, say, with no edge along it, which a front that comes from afar strides over.
///
/// Lines of constant parameter are halved where normals turn, and lie as close to each other as the sizes found ask
/// for.
/// @param box  parameters of the face's border
/// @par Cost  O(lines); a few thousand evaluations of the surface where nothing bends, 1e6 at most
void find_bends(const SmoothSurface& surface, const ParameterBox& box, const WantedSize& wanted, BoundarySizes& found);

}  // namespace delfront
