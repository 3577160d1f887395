// SPDX-License-Identifier: Apache-2.0
#include "sizing/within_domain.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace delfront {

namespace {

class WithinDomain final : public SizeField {
 public:
  WithinDomain(std::shared_ptr<const SizeField> field, const Box& domain) : field_(std::move(field)), domain_(domain) {}

  void sizes(std::span<const Point> at, std::span<double> size) const override {
    std::vector<Point> moved;
    field_->sizes(within(at, moved), size);
  }
  void lower_sizes(std::span<const Point> at, std::span<double> size) const override {
    std::vector<Point> moved;
    field_->lower_sizes(within(at, moved), size);
  }
  void metrics(std::span<const Point> at, std::span<Metric> metric) const override {
    std::vector<Point> moved;
    field_->metrics(within(at, moved), metric);
  }
  bool is_isotropic() const override { return field_->is_isotropic(); }
  double lower_bound(const Box& box) const override {
    return field_->lower_bound(box.is_empty() ? box : Box{nearest(box.low), nearest(box.high)});
  }
  double largest() const override { return field_->largest(); }

 private:
  Point nearest(Point p) const {
    for (int k = 0; k < 3; ++k) p[k] = std::clamp(p[k], domain_.low[k], domain_.high[k]);
    return p;
  }

  /// The given places where all are within the domain; else others, which `moved` holds.
  std::span<const Point> within(std::span<const Point> at, std::vector<Point>& moved) const {
    if (std::all_of(at.begin(), at.end(), [this](const Point& p) { return nearest(p) == p; })) return at;
    for (const Point& p : at) moved.push_back(nearest(p));
    return moved;
  }

  std::shared_ptr<const SizeField> field_;
  Box domain_;
};

}  // namespace

std::shared_ptr<const SizeField> ask_within(std::shared_ptr<const SizeField> field, const Box& domain) {
  return std::make_shared<WithinDomain>(std::move(field), domain);
}

}  // namespace delfront
