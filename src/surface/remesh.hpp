// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/size_field.hpp"
#include "surface/front.hpp"

namespace delfront {

/// @brief A region's given triangles, changed until its border has the new points and no others, and its sides have the
/// wanted lengths: long ones are split, short ones collapsed, sides flipped, points moved along the surface.
///
/// What takes the place of the front where that fails. `gave_up` says why there is no grid.
/// @par Source  Botsch & Kobbelt (2004), A remeshing approach to multiresolution modeling
RegionGrid remesh_region(const SurfaceParts& parts, const SurfaceRegion& region, const SurfaceSupport& support,
                         const RegionBorder& border, const LinePoints& lines, const LineDivision& division,
                         const SizeField& size);

}  // namespace delfront
