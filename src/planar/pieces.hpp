// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>

#include "delfront/context.hpp"
#include "delfront/planar.hpp"

namespace delfront {

inline constexpr std::size_t kPiecesPerLimitCheck = std::size_t{1} << 16;

/// @brief How many pieces a line gets, looked at before any is made.
/// @param wanted  may be infinite, or no number
/// @throws LimitError  more than fit, or than the cells that are allowed could have as sides
std::size_t number_of_pieces(double wanted, const Context& context);

/// @brief What curves go through.
/// @throws InputError  too few points; two in a row are the same, or one is not finite
void check_curve_points(std::span<const Point2> through, bool closed);

}  // namespace delfront
