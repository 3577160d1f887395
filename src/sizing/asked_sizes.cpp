// SPDX-License-Identifier: Apache-2.0
#include "sizing/asked_sizes.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "delfront/geometry_sizes.hpp"

namespace delfront {

double largest_size(const BoundarySizes& boundary) {
  double largest = 0;
  for (const double h : boundary.size) largest = std::max(largest, h);
  return largest;
}

double steeper_growth(double growth, double times) {
  constexpr double kSteepest = 0.5;  ///< beyond, sizes differ by half and more from one cell to the next
  if (times == 1) return growth;
  const double slope = (growth - 1) / growth;
  return 1 / (1 - std::min(times * slope, std::max(slope, kSteepest)));
}

double growth_asked(const SizeOptions& options) {
  return options.growth.value_or(options.accuracy.empty() ? kDefaultGrowth : accuracy_numbers(options.accuracy).growth);
}

double growth_of_boundary(const SizeOptions& options) { return steeper_growth(growth_asked(options), options.steeper); }

bool has_field_everywhere(const SizeOptions& options) {
  return !options.expression.delta.empty() || !options.background.file.empty() || !options.solution.file.empty() ||
         !options.fields.empty();
}

std::unique_ptr<SizeField> build_asked_size_field(BoundarySizes boundary, const SizeOptions& options, double largest,
                                                  Context& context) {
  boundary.growth = growth_of_boundary(options);
  if (options.hmin) boundary.hmin = options.hmin->value;
  if (options.hmax)
    boundary.hmax = options.hmax->value;
  else if (!options.growth && !has_field_everywhere(options))
    boundary.hmax = std::max(largest, boundary.hmin);
  return build_boundary_size_field(boundary, context);
}

LongEdges find_long_edges(std::span<const std::array<Point, 2>> edges, const SizeOptions& options,
                          const SizeField* asked, const Context& context) {
  constexpr double kMuchLonger = 1.5;
  LongEdges found;
  if (!options.hmax && !asked) return found;
  std::vector<Point> middles;
  for (const auto& [a, b] : edges) middles.push_back(0.5 * (a + b));
  std::vector<double> sizes(edges.size(), std::numeric_limits<double>::infinity());
  if (asked) evaluate_sizes(*asked, middles, sizes, context);
  double worst = kMuchLonger;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    double size = options.hmax ? std::min(sizes[i], options.hmax->value) : sizes[i];
    if (options.hmin) size = std::max(size, options.hmin->value);
    const double length = distance(edges[i][0], edges[i][1]);
    if (!(length > kMuchLonger * size)) continue;
    ++found.count;
    if (!(length / size > worst)) continue;
    worst = length / size;
    found.length = length;
    found.size = size;
    found.at = middles[i];
  }
  return found;
}

void add_size_field(Mesh& mesh, const SizeField& size, const Context& context) {
  Field h{"h", Field::On::vertices, CellType::vertex, 1, std::vector<double>(mesh.points.size())};
  evaluate_sizes(size, mesh.points, h.values, context);
  mesh.fields.push_back(std::move(h));
  if (size.is_isotropic()) return;
  std::vector<Metric> metrics(mesh.points.size());
  size.metrics(mesh.points, metrics);
  Field metric{"metric", Field::On::vertices, CellType::vertex, 6, {}};
  metric.values.reserve(6 * metrics.size());
  for (const Metric& m : metrics) metric.values.insert(metric.values.end(), {m.xx, m.yy, m.zz, m.xy, m.yz, m.xz});
  mesh.fields.push_back(std::move(metric));
}

std::shared_ptr<const SizeField> combine_with_asked(std::shared_ptr<const SizeField> of_boundary,
                                                    std::shared_ptr<const SizeField> asked,
                                                    const SizeOptions& options) {
  return combine_size_fields({std::move(of_boundary), std::move(asked)}, options.hmin ? options.hmin->value : 0,
                             options.hmax ? options.hmax->value : std::numeric_limits<double>::infinity());
}

}  // namespace delfront
