// SPDX-License-Identifier: Apache-2.0
#include "pipeline/surface_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "sizing/asked_sizes.hpp"

namespace delfront {
namespace {

constexpr double kLargestShare = 0.1;  ///< of the diagonal, where sizes are asked for that have no largest

/// The asked sizes between bounds.
class BoundedSize : public SizeField {
 public:
  BoundedSize(std::shared_ptr<const SizeField> asked, double hmin, double hmax)
      : asked_(std::move(asked)), hmin_(hmin), hmax_(hmax) {}

  void sizes(std::span<const Point> at, std::span<double> size) const override {
    std::fill(size.begin(), size.end(), hmax_);
    if (asked_) asked_->lower_sizes(at, size);
    for (double& h : size) h = std::max(h, hmin_);
  }
  double lower_bound(const Box& box) const override {
    return std::max(hmin_, asked_ ? std::min(hmax_, asked_->lower_bound(box)) : hmax_);
  }
  double largest() const override { return hmax_; }

 private:
  std::shared_ptr<const SizeField> asked_;
  double hmin_, hmax_;
};

double mean_side(const Model& model, const std::vector<bool>& is_kept) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    if (is_kept[model.patch_of_triangle[TriangleId(t)].index()]) continue;
    const auto& v = model.triangles[TriangleId(t)];
    for (std::size_t k = 0; k < 3; ++k) sum += distance(model.points[v[k]], model.points[v[(k + 1) % 3]]);
    count += 3;
  }
  return count ? sum / double(count) : 1;
}

double largest_size(const Model& model, const SizeOptions& size, const SizeField* asked,
                    const std::vector<bool>& is_kept) {
  if (size.hmax) return size.hmax->value;
  if (asked && has_field_everywhere(size)) return std::numeric_limits<double>::infinity();
  if (!asked) return size.steeper * mean_side(model, is_kept);  // of a coarse grid, where there are levels
  Box box;
  for (std::size_t t = 0; t < model.triangles.size(); ++t)
    if (!is_kept[model.patch_of_triangle[TriangleId(t)].index()])
      for (const VertexId v : model.triangles[TriangleId(t)]) box.add(model.points[v]);
  return size.steeper * kLargestShare * box.diagonal();
}

/// By patch: keeps its triangles.
std::vector<bool> kept_patches(const Model& model, const Options& options) {
  std::vector<bool> is_kept;
  for (const Patch& patch : model.patches) is_kept.push_back(patch.kind == "farfield");
  for (const PatchId p : options.surface.kept) is_kept[p.index()] = true;
  return is_kept;
}

void warn_of_fallbacks(const SurfaceGridReport& report, Context& context) {
  for (const SurfaceFallback::Kind kind : {SurfaceFallback::Kind::remeshed, SurfaceFallback::Kind::kept}) {
    std::size_t count = 0;
    const SurfaceFallback* first = nullptr;
    for (const SurfaceFallback& f : report.fallbacks) {
      if (f.kind != kind) continue;
      if (count++ == 0) first = &f;
    }
    if (!first) continue;
    context.warn(
        fmt::format("{} of {} pieces of the surface {}: the front came to no end there (the first in '{}' at "
                    "{:g} {:g} {:g}: {}); smaller sizes there may help",
                    count, report.regions,
                    kind == SurfaceFallback::Kind::kept ? "keep their given triangles"
                                                        : "were gridded by changing their given triangles",
                    first->patch, first->at.x, first->at.y, first->at.z, first->why));
  }
}

}  // namespace

std::shared_ptr<const SizeField> surface_sizes(const Model& model, const Options& options,
                                               std::shared_ptr<const SizeField> asked) {
  const double hmin = options.size.hmin ? options.size.hmin->value : 0;
  const double hmax = std::max(hmin, largest_size(model, options.size, asked.get(), kept_patches(model, options)));
  return std::make_shared<BoundedSize>(std::move(asked), hmin, hmax);
}

void regrid_as_asked(Model& model, const Options& options, const SizeField& size, SurfaceGridReport& report,
                     Context& context) {
  if (options.surface.method == "keep" || model.triangles.empty()) return;
  SurfaceOptions how = options.surface;
  how.kept.clear();
  const std::vector<bool> is_kept = kept_patches(model, options);
  for (std::size_t p = 0; p < is_kept.size(); ++p)
    if (is_kept[p]) how.kept.push_back(PatchId(p));
  model = regrid_surface(model, size, how, report, context);
  warn_of_fallbacks(report, context);
}

}  // namespace delfront
