// SPDX-License-Identifier: Apache-2.0
#include "mesh/measure.hpp"

#include <algorithm>
#include <limits>

namespace delfront {

namespace {
constexpr std::size_t kNumWorst = 10;

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

MeasureBuilder::MeasureBuilder(MeasureId id) {
  const MeasureKind& kind = kind_of(id);
  measure_.name = kind.name;
  measure_.unit = kind.unit;
  measure_.worst_is_low = kind.worst_is_low;
  measure_.min = std::numeric_limits<double>::infinity();
  measure_.max = -measure_.min;
  measure_.histogram.assign(kind.bins, 0);
  set_range(kind.histogram_low, kind.histogram_high);
}

void MeasureBuilder::set_range(double low, double high) {
  measure_.histogram_low = low;
  measure_.histogram_high = high;
  bin_scale_ = high > low ? static_cast<double>(measure_.histogram.size()) / (high - low) : 0;
}

void MeasureBuilder::add(double value, std::uint32_t id0, std::uint32_t id1) {
  ++count_;
  sum_ += value;
  measure_.min = std::min(measure_.min, value);
  measure_.max = std::max(measure_.max, value);
  const double last = static_cast<double>(measure_.histogram.size() - 1);
  const double bin = (value - measure_.histogram_low) * bin_scale_;
  ++measure_.histogram[bin > 0 ? static_cast<std::size_t>(std::min(bin, last)) : 0];
  const bool is_worse =
      worst_.size() < kNumWorst || (measure_.worst_is_low ? value < worst_.back().value : value > worst_.back().value);
  if (is_worse) keep_worst(value, id0, id1);
}

void MeasureBuilder::keep_worst(double value, std::uint32_t id0, std::uint32_t id1) {
  const auto place = std::find_if(worst_.begin(), worst_.end(), [&](const Worst& other) {
    return measure_.worst_is_low ? value < other.value : value > other.value;
  });
  worst_.insert(place, {value, id0, id1});
  if (worst_.size() > kNumWorst) worst_.pop_back();
}

Measure MeasureBuilder::take() {
  if (count_ == 0) measure_.min = measure_.max = 0;
  measure_.mean = count_ > 0 ? sum_ / static_cast<double>(count_) : 0;
  for (const Worst& worst : worst_) {
    Place place{{}, {worst.id0}};
    if (worst.id1 != kNoId) place.ids.push_back(worst.id1);
    measure_.worst.push_back(std::move(place));
    measure_.worst_values.push_back(worst.value);
  }
  return std::move(measure_);
}

}  // namespace delfront
