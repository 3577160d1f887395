// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "base/name_pattern.hpp"
#include "delfront/errors.hpp"
#include "fmt/format.h"
#include "sizing/geometry_facets.hpp"
#include "sizing/model_names.hpp"

namespace delfront {
namespace {

[[noreturn]] void fail_unmatched(const Model& model, const std::string& pattern) {
  throw UsageError(fmt::format("size on '{}': no patch, curve or corner has such a name{}", pattern,
                               say_names(pattern, names_on(model))));
}

}  // namespace

GeometrySources find_named_sizes(const Model& model, std::span<const NamedSize> sizes, Context& context) {
  constexpr double kNoSize = std::numeric_limits<double>::infinity();
  std::vector<double> on_patch(model.patches.size(), kNoSize), on_curve(model.curves.size(), kNoSize),
      on_corner(model.corners.size(), kNoSize);
  for (const NamedSize& wish : sizes) {
    if (!(wish.h > 0) || std::isinf(wish.h))
      throw UsageError(fmt::format("size on '{}': h must be positive, not {}", wish.pattern, wish.h));
    bool is_found = false;
    const auto match = [&](std::vector<double>& on, std::size_t i, const std::string& name) {
      if (!matches_pattern(name, wish.pattern)) return;
      is_found = true;
      on[i] = std::min(on[i], wish.h);
    };
    for (std::size_t i = 0; i < on_patch.size(); ++i) match(on_patch, i, model.patches[PatchId(i)].name);
    for (std::size_t i = 0; i < on_curve.size(); ++i) match(on_curve, i, model.curves[CurveId(i)].name);
    for (std::size_t i = 0; i < std::min(on_corner.size(), model.corner_names.size()); ++i)
      match(on_corner, i, model.corner_names[i]);
    if (!is_found) fail_unmatched(model, wish.pattern);
  }
  GeometrySources found;
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    if (t % 4096 == 0) context.check_limits();
    const PatchId patch = model.patch_of_triangle[TriangleId(t)];
    if (std::isinf(on_patch[patch.index()])) continue;
    const auto& [a, b, c] = model.triangles[TriangleId(t)];
    add_source(found, simplex({model.points[a], model.points[b], model.points[c]}), on_patch[patch.index()], 0,
               model.patches[patch].name);
  }
  for (std::size_t i = 0; i < model.curves.size(); ++i) {
    const Curve& curve = model.curves[CurveId(i)];
    if (std::isinf(on_curve[i])) continue;
    for (std::size_t k = 0; k + 1 < curve.vertices.size(); ++k)
      add_source(found, simplex(model.points[curve.vertices[k]], model.points[curve.vertices[k + 1]]), on_curve[i], 0,
                 curve.name);
  }
  for (std::size_t i = 0; i < model.corners.size(); ++i)
    if (!std::isinf(on_corner[i]))
      add_source(found, simplex(model.points[model.corners[i]]), on_corner[i], 0, model.corner_names[i]);
  return found;
}

double usual_hmin(const Model& model) {
  return kUsualShare * (model.triangles.empty() ? model.bounding_box() : model.surface_box()).diagonal();
}

AccuracyNumbers accuracy_numbers(const std::string& word) {
  if (word == "coarse") return {10, 2e-2, 0.7, 0.5, 1.3, 0.1, 2e-3};
  if (word == "fine") return {36, 1e-3, 2, 2, 1.15, 0.025, 2.5e-4};
  return {18, 4e-3, 1, 1, 1.2, 0.05, 1e-3};
}

GeometrySources find_automatic_sizes(const Model& model, const AutomaticSizes& wish, Context& context) {
  check_bounds("automatic sizes", wish.hmin, std::numeric_limits<double>::infinity());
  GeometrySources found = find_named_sizes(model, wish.named, context);
  const double hmin = wish.hmin > 0 ? wish.hmin : usual_hmin(model);
  if (wish.cells_per_turn) {
    CurvatureSizes curvature;
    curvature.cells_per_turn = wish.cells_per_turn;
    curvature.hmin = hmin;
    found.append(find_curvature_sizes(model, curvature, context));
  }
  GapSizes gap;
  gap.hmin = hmin;
  gap.side = wish.side;
  gap.is_kept = wish.is_kept;
  if (wish.gap_cells) {
    gap.cells = *wish.gap_cells;
    found.append(find_gap_sizes(model, gap, context));
  }
  if (wish.line_cells) {
    gap.cells = *wish.line_cells;
    found.append(find_line_gap_sizes(model, gap, context));
  }
  merge_close_sources(found);
  return found;
}

}  // namespace delfront
