// SPDX-License-Identifier: Apache-2.0
#include "sizing/asked_sizes.hpp"

#include <algorithm>

namespace delfront {

double largest_size(const BoundarySizes& boundary) {
  double largest = 0;
  for (const double h : boundary.size) largest = std::max(largest, h);
  return largest;
}

std::unique_ptr<SizeField> build_asked_size_field(BoundarySizes boundary, const SizeOptions& options, double largest,
                                                  Context& context) {
  boundary.growth = options.growth.value_or(kDefaultGrowth);
  if (options.hmin) boundary.hmin = options.hmin->value;
  if (options.hmax)
    boundary.hmax = options.hmax->value;
  else if (!options.growth)
    boundary.hmax = std::max(largest, boundary.hmin);
  return build_boundary_size_field(boundary, context);
}

}  // namespace delfront
