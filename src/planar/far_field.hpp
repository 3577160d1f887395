// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/planar.hpp"

namespace delfront {

/// @brief Add an outer boundary around a domain: a circle ("circle" or "sphere", options.size its radius) or a box.
///
/// Its centre is that of the domain's box, unless the corners are given (z is not used). Its segments are about
/// options.h long; by default as long as cells are that have grown there from the body's segments.
/// @param scale  of the input, for lengths in % and c
/// @return the new curve, of kind "farfield"; invalid for shape "none"
/// @throws UsageError  a length that is not positive
/// @throws InputError  the domain is not strictly inside (the place is given)
CurveId add_far_field(PlanarDomain& domain, const EncloseOptions& options, const SizeOptions& sizes,
                      const LengthScale& scale, Context& context);

}  // namespace delfront
