// SPDX-License-Identifier: Apache-2.0
#include "sizing/asked_sizes.hpp"

#include <algorithm>
#include <limits>

namespace delfront {

double largest_size(const BoundarySizes& boundary) {
  double largest = 0;
  for (const double h : boundary.size) largest = std::max(largest, h);
  return largest;
}

bool has_field_everywhere(const SizeOptions& options) {
  return !options.expression.delta.empty() || !options.background.file.empty() || !options.solution.file.empty();
}

std::unique_ptr<SizeField> build_asked_size_field(BoundarySizes boundary, const SizeOptions& options, double largest,
                                                  Context& context) {
  boundary.growth = options.growth.value_or(kDefaultGrowth);
  if (options.hmin) boundary.hmin = options.hmin->value;
  if (options.hmax)
    boundary.hmax = options.hmax->value;
  else if (!options.growth && !has_field_everywhere(options))
    boundary.hmax = std::max(largest, boundary.hmin);
  return build_boundary_size_field(boundary, context);
}

void add_size_field(Mesh& mesh, const SizeField& size, const Context& context) {
  Field h{"h", Field::On::vertices, CellType::vertex, 1, std::vector<double>(mesh.points.size())};
  evaluate_sizes(size, mesh.points, h.values, context);
  mesh.fields.push_back(std::move(h));
}

std::shared_ptr<const SizeField> combine_with_asked(std::shared_ptr<const SizeField> of_boundary,
                                                    std::shared_ptr<const SizeField> asked,
                                                    const SizeOptions& options) {
  return combine_size_fields({std::move(of_boundary), std::move(asked)}, options.hmin ? options.hmin->value : 0,
                             options.hmax ? options.hmax->value : std::numeric_limits<double>::infinity());
}

}  // namespace delfront
