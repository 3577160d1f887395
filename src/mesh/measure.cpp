// SPDX-License-Identifier: Apache-2.0
#include "mesh/measure.hpp"

#include <algorithm>
#include <limits>

namespace delfront {

namespace {
constexpr MeasureKind kKinds[kNumMeasures] = {
    {"min_dihedral", "deg", true, 0, 90, 18},  {"max_dihedral", "deg", false, 0, 180, 36},
    {"min_angle", "deg", true, 0, 90, 18},     {"max_angle", "deg", false, 0, 180, 36},
    {"mean_ratio", "", true, 0, 1, 20},        {"radius_ratio", "", true, 0, 1, 20},
    {"aspect_ratio", "", false, 1, 21, 20},    {"openfoam_aspect", "", false, 1, 21, 20},
    {"max_nonortho", "deg", false, 0, 90, 18}, {"skewness", "", false, 0, 4, 20},
    {"volume_ratio", "", false, 1, 21, 20},    {"edge_length", "", true, 0, 1, 20},
};
}  // namespace

const MeasureKind& kind_of(MeasureId id) { return kKinds[static_cast<std::size_t>(id)]; }

MeasureBuilder::MeasureBuilder(MeasureId id, std::size_t num_worst)
    : id_(id), num_worst_(num_worst), worst_is_low_(kind_of(id).worst_is_low) {
  const MeasureKind& kind = kind_of(id);
  min_ = std::numeric_limits<double>::infinity();
  max_ = -min_;
  worst_limit_ = worst_is_low_ ? min_ : max_;
  bins_.assign(kind.bins, 0);
  last_bin_ = static_cast<double>(kind.bins - 1);
  set_range(kind.histogram_low, kind.histogram_high);
}

void MeasureBuilder::set_range(double low, double high) {
  low_ = low;
  high_ = high;
  bin_scale_ = high > low ? static_cast<double>(bins_.size()) / (high - low) : 0;
}

bool MeasureBuilder::is_worse(const Worst& a, const Worst& b) const {
  if (a.value != b.value) return worst_is_low_ ? a.value < b.value : a.value > b.value;
  return a.id0 != b.id0 ? a.id0 < b.id0 : a.id1 < b.id1;
}

void MeasureBuilder::keep_worst(const Worst& worst) {
  const auto place =
      std::partition_point(worst_.begin(), worst_.end(), [&](const Worst& other) { return !is_worse(worst, other); });
  worst_.insert(place, worst);
  if (worst_.size() > num_worst_) worst_.pop_back();
  if (worst_.size() == num_worst_) worst_limit_ = worst_.back().value;
}

void MeasureBuilder::merge(const MeasureBuilder& other) {
  count_ += other.count_;
  sum_ += other.sum_;
  min_ = std::min(min_, other.min_);
  max_ = std::max(max_, other.max_);
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += other.bins_[i];
  for (const Worst& worst : other.worst_) keep_worst(worst);
}

Measure MeasureBuilder::take() const {
  const MeasureKind& kind = kind_of(id_);
  Measure measure;
  measure.name = kind.name;
  measure.unit = kind.unit;
  measure.worst_is_low = worst_is_low_;
  measure.histogram = bins_;
  measure.histogram_low = low_;
  measure.histogram_high = high_;
  if (count_ > 0) {
    measure.min = min_;
    measure.max = max_;
    measure.mean = sum_ / static_cast<double>(count_);
  }
  for (const Worst& worst : worst_) {
    Place place{{}, {worst.id0}};
    if (worst.id1 != kNoId) place.ids.push_back(worst.id1);
    measure.worst.push_back(std::move(place));
    measure.worst_values.push_back(worst.value);
  }
  return measure;
}

}  // namespace delfront
