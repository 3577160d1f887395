// SPDX-License-Identifier: Apache-2.0
#include "surface/working_size.hpp"

#include <algorithm>

#include "delfront/geometry_sizes.hpp"
#include "delfront/size_sources.hpp"

namespace delfront {
namespace {

constexpr double kSidesPerTurn = 8;  ///< with fewer, triangles lie too far off the surface to tell sheets apart
constexpr double kGuardGrowth = 1.5;

}  // namespace

void WorkingSize::lower(const BoundarySizes& places, Context& context) {
  lowered_ = places.points.empty() ? nullptr : build_boundary_size_field(places, context);
}

void WorkingSize::sizes(std::span<const Point> at, std::span<double> size) const {
  asked_.sizes(at, size);
  if (guard_) {
    for (std::size_t i = 0; i < at.size(); ++i) {
      double needed = size[i];
      guard_->lower_sizes({&at[i], 1}, {&needed, 1});
      size[i] = std::max(needed, kGuardShare * size[i]);
    }
  }
  if (lowered_) lowered_->lower_sizes(at, size);
}

double WorkingSize::lower_bound(const Box& box) const {
  double bound = asked_.lower_bound(box);
  if (guard_) bound = std::min(bound, std::max(guard_->lower_bound(box), kGuardShare * bound));
  if (lowered_) bound = std::min(bound, lowered_->lower_bound(box));
  return bound;
}

std::shared_ptr<const SizeField> build_bend_guard(const Model& model, const SizeField& asked, Context& context) {
  CurvatureSizes wish;
  wish.cells_per_turn = kSidesPerTurn;
  // bends that need no less than is asked for anywhere, or that would be cut off below a share of it, say nothing
  std::vector<double> sizes(model.points.size());
  evaluate_sizes(asked, model.points, sizes, context);
  const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
  wish.hmin = WorkingSize::kGuardShare * *least;
  wish.hmax = std::max(*most, wish.hmin);
  GeometrySources found = find_curvature_sizes(model, wish, context);
  merge_close_sources(found);
  if (found.sources.empty()) return nullptr;
  SourceFieldOptions options;
  options.growth = kGuardGrowth;
  return build_source_size_field(std::move(found.sources), options, context);
}

}  // namespace delfront
