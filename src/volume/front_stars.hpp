// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "volume/front_store.hpp"

namespace delfront {

/// @brief Fill cavities that no single point sees by stars of several points, one star after the other (F17).
///
/// A star is the tets of one point, of the cavity or new, and all faces that it sees past all others; of those that
/// come into question the one that leaves the fewest faces is taken, until none is left. New points are tried between
/// faces and between edges that lie opposite, and where the faces' planes have their kernel. What comes to no end is
/// taken back.
/// @param[in] faces  all faces of the front
/// @return the faces that are left: of cavities at which that came to no end
std::vector<std::uint32_t> fill_by_stars(FrontStore& front, const std::vector<std::uint32_t>& faces,
                                         FrontReport& report, Context& context);

}  // namespace delfront
