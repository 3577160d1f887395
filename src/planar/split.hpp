// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/size_field.hpp"
#include "planar/constrain.hpp"

namespace delfront {

/// @brief Divide the segments of kept regions to the sizes of the field, and where a vertex stands in their circles.
///
/// Points by size stand at equal parts of the integral of 1/h along a piece, each at most sqrt(2) sizes long; then
/// pieces are halved that have a vertex in the circle over them, though not below a tenth of the size. Points are
/// rounded; that the triangles beside the piece stay positive is decided exactly, and a piece where they would not is
/// left as it is. At a corner under 60 degrees the halves meet at powers of two of the distance on both sides, so that
/// halving there ends.
/// @param in_metric   lengths are those of the field's metric: for triangles that are stretched
/// @param by_circles  else only lengths count
/// @return points put on segments
/// @par Source  concentric shells: Ruppert (1995)
std::size_t split_segments(PlanarGrid& grid, const SizeField& size, bool in_metric, bool by_circles, Context& context);

}  // namespace delfront
