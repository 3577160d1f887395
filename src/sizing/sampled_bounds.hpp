// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <span>

#include "delfront/context.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief The same field with lower bounds and a largest value from samples: for functions of which nothing is known.
///
/// Values stay the field's own. Bounds come from a tree of boxes that is cut where the function is not linear, and
/// where many places lie; what lies between samples and shows at none of them is not seen, so the bounds may be
/// violated there. Samples are taken by the thread that calls, many at a time.
/// @param domain  where bounds are asked for; beyond it those of the nearest place of it are given
/// @param places  where detail is likely: the points of the model
/// @par Cost  some 1e5 samples at least; at most 27 in each of 1e5 boxes
std::shared_ptr<const SizeField> sample_bounds(std::shared_ptr<const SizeField> field, const Box& domain,
                                               std::span<const Point> places, Context& context);

}  // namespace delfront
