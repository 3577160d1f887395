// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/brep.hpp"

namespace delfront {

/// @brief An edge of a loop with a parameter curve that may lie whole periods off.
struct LoosePart {
  BrepUse use;
  std::string name;  ///< of the edge, for messages
};

/// @brief Parameter curves moved by whole periods so that each begins where the one before ends, poles filled in by
/// degenerate edges (added to the Brep), the loop turned so that it runs anticlockwise (a hole: clockwise).
/// @throws InputError  it does not close; what and where, without the file's place
std::vector<BrepUse> place_loop(Brep& brep, const SmoothSurface& surface, std::vector<LoosePart> parts, bool is_hole);

/// @brief Moved by whole periods so that it lies within the outer loop; left where it is if none does that.
void move_hole_into(const Brep& brep, const SmoothSurface& surface, const std::vector<BrepUse>& outer,
                    std::vector<BrepUse>& hole);

}  // namespace delfront
