// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "surface/front.hpp"
#include "surface/support.hpp"

namespace delfront {

/// @brief Whether a grid covers its region once: sides used twice, or once on the border; the topology of what was
/// given; no triangle that lies far from the surface or faces away from it. Says so in grid.gave_up.
/// @return the largest distance of a triangle's middle from the surface
struct RegionFit {
  double distance = 0;
  Point at;
};
RegionFit check_region(const SurfaceSupport& support, const RegionBorder& border, RegionGrid& grid);

}  // namespace delfront
