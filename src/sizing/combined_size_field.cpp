// SPDX-License-Identifier: Apache-2.0
// The minimum of several fields, clamped; for fields with directions the intersection of their metrics.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

namespace {

constexpr std::size_t kPart = 1 << 12;  ///< places between looks at the limits

class CombinedSizeField final : public SizeField {
 public:
  CombinedSizeField(std::vector<std::shared_ptr<const SizeField>> parts, double hmin, double hmax)
      : parts_(std::move(parts)), hmin_(hmin), hmax_(hmax) {
    is_isotropic_ = std::all_of(parts_.begin(), parts_.end(), [](const auto& part) { return part->is_isotropic(); });
  }

  /// The least of the parts' least sizes; that of the intersection is at most sqrt(2) below it.
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    DELFRONT_CHECK(at.size() == size.size());
    parts_[0]->sizes(at, size);
    for (std::size_t k = 1; k < parts_.size(); ++k) parts_[k]->lower_sizes(at, size);
    for (double& h : size) h = std::clamp(h, hmin_, hmax_);
  }

  void lower_sizes(std::span<const Point> at, std::span<double> size) const override {
    if (hmin_ > 0) return SizeField::lower_sizes(at, size);  // a part may be below it
    for (const auto& part : parts_) part->lower_sizes(at, size);
    if (std::isfinite(hmax_))
      for (double& h : size) h = std::min(h, hmax_);
  }

  void metrics(std::span<const Point> at, std::span<Metric> metric) const override {
    if (is_isotropic_) return SizeField::metrics(at, metric);
    parts_[0]->metrics(at, metric);
    std::vector<Metric> other(at.size());
    for (std::size_t k = 1; k < parts_.size(); ++k) {
      parts_[k]->metrics(at, other);
      for (std::size_t i = 0; i < at.size(); ++i) metric[i] = intersection(metric[i], other[i]);
    }
    for (Metric& m : metric) m = clamped(m, hmin_, hmax_);
  }

  bool is_isotropic() const override { return is_isotropic_; }

  double lower_bound(const Box& box) const override {
    double low = hmax_;
    for (const auto& part : parts_) {
      if (!(low > hmin_)) break;
      low = std::min(low, part->lower_bound(box));
    }
    return std::max(low, hmin_);
  }

  double largest() const override {
    double largest = hmax_;
    for (const auto& part : parts_) largest = std::min(largest, part->largest());
    return std::max(largest, hmin_);
  }

 private:
  std::vector<std::shared_ptr<const SizeField>> parts_;
  double hmin_, hmax_;
  bool is_isotropic_ = true;
};

}  // namespace

void evaluate_sizes(const SizeField& field, std::span<const Point> at, std::span<double> size, const Context& context) {
  DELFRONT_CHECK(at.size() == size.size());
  parallel_ranges(context.threads, at.size(), kPart, [&](std::size_t first, std::size_t last) {
    context.check_limits();
    field.sizes(at.subspan(first, last - first), size.subspan(first, last - first));
  });
}

std::unique_ptr<SizeField> combine_size_fields(std::vector<std::shared_ptr<const SizeField>> parts, double hmin,
                                               double hmax) {
  if (!(hmin >= 0 && hmin <= hmax && hmax > 0))
    throw UsageError(fmt::format("hmin = {} and hmax = {}: need 0 <= hmin <= hmax and hmax > 0", hmin, hmax));
  std::erase(parts, nullptr);
  if (parts.empty()) throw UsageError("no size field to combine");
  return std::make_unique<CombinedSizeField>(std::move(parts), hmin, hmax);
}

}  // namespace delfront
