// SPDX-License-Identifier: Apache-2.0
#include "pipeline/surface_job.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sizing/asked_sizes.hpp"

namespace delfront {
namespace {

constexpr double kLargestShare = 0.1;  ///< of the diagonal, where sizes are asked for that have no largest

/// The asked sizes between bounds.
class BoundedSize : public SizeField {
 public:
  BoundedSize(const SizeField* asked, double hmin, double hmax) : asked_(asked), hmin_(hmin), hmax_(hmax) {}

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
  const SizeField* asked_;
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

void regrid_as_asked(Model& model, const Options& options, const SizeField* asked, SurfaceGridReport& report,
                     Context& context) {
  if (options.surface.method == "keep" || model.triangles.empty()) return;
  SurfaceOptions how = options.surface;
  std::vector<bool> is_kept(model.patches.size(), false);
  for (const PatchId p : how.kept) is_kept[p.index()] = true;
  for (std::size_t p = 0; p < model.patches.size(); ++p)
    if (model.patches[PatchId(p)].kind == "farfield") {
      is_kept[p] = true;
      how.kept.push_back(PatchId(p));
    }
  const double hmin = options.size.hmin ? options.size.hmin->value : 0;
  const double hmax = std::max(hmin, largest_size(model, options.size, asked, is_kept));
  model = regrid_surface(model, BoundedSize(asked, hmin, hmax), how, report, context);
  warn_of_fallbacks(report, context);
}

}  // namespace delfront
