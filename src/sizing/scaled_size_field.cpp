// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "delfront/errors.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

namespace {

class ScaledSizeField final : public SizeField {
 public:
  ScaledSizeField(std::shared_ptr<const SizeField> field, double factor) : field_(std::move(field)), factor_(factor) {}

  void sizes(std::span<const Point> at, std::span<double> size) const override {
    field_->sizes(at, size);
    for (double& h : size) h *= factor_;
  }

  /// The field says early that it has nothing lower: it is asked in its own lengths.
  void lower_sizes(std::span<const Point> at, std::span<double> size) const override {
    std::vector<double> own(size.begin(), size.end());
    for (double& h : own) h /= factor_;
    field_->lower_sizes(at, own);
    for (std::size_t i = 0; i < own.size(); ++i) size[i] = std::min(size[i], own[i] * factor_);
  }

  void metrics(std::span<const Point> at, std::span<Metric> metric) const override {
    field_->metrics(at, metric);
    const double share = 1 / (factor_ * factor_);
    for (Metric& m : metric) m = {share * m.xx, share * m.xy, share * m.xz, share * m.yy, share * m.yz, share * m.zz};
  }

  bool is_isotropic() const override { return field_->is_isotropic(); }
  double lower_bound(const Box& box) const override { return field_->lower_bound(box) * factor_; }
  double largest() const override { return field_->largest() * factor_; }

 private:
  std::shared_ptr<const SizeField> field_;
  double factor_;
};

}  // namespace

std::shared_ptr<const SizeField> scale_sizes(std::shared_ptr<const SizeField> field, double factor) {
  if (!(factor > 0 && std::isfinite(factor)))
    throw UsageError(fmt::format("sizes times {}: the factor must be positive and finite", factor));
  return std::make_shared<ScaledSizeField>(std::move(field), factor);
}

}  // namespace delfront
