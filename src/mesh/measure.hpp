// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "delfront/grid_check.hpp"

namespace delfront {

/// @brief What a measure is called and how it is shown; the histogram's ends also take what lies beyond them.
struct MeasureKind {
  const char* name;
  const char* unit;
  bool worst_is_low;
  double histogram_low, histogram_high;
  std::size_t bins;
};

/// @brief Every measure there is, in the order in which they are reported.
enum class MeasureId : std::uint8_t {
  min_dihedral,
  max_dihedral,
  min_angle,
  max_angle,
  mean_ratio,
  radius_ratio,
  aspect_ratio,
  openfoam_aspect,
  max_nonortho,
  skewness,
  volume_ratio,
  edge_length,
};
inline constexpr std::size_t kNumMeasures = 12;
const MeasureKind& kind_of(MeasureId id);

/// @brief Takes the values of one measure one by one; keeps sums, histogram and the worst (of equal ones those with the
/// lowest ids, so that only the rounding of the sum depends on the order).
class MeasureBuilder {
 public:
  static constexpr std::size_t kNumWorst = 10;
  explicit MeasureBuilder(MeasureId id, std::size_t num_worst = kNumWorst);
  /// @brief Other ends for the histogram, before the first value.
  void set_range(double low, double high);
  /// @param id0, id1  of the cell, or of the two cells or points
  void add(double value, std::uint32_t id0, std::uint32_t id1 = kNoId) {
    ++count_;
    sum_ += value;
    min_ = value < min_ ? value : min_;
    max_ = value > max_ ? value : max_;
    const double bin = (value - low_) * bin_scale_;
    ++bins_[bin > 0 ? static_cast<std::size_t>(bin < last_bin_ ? bin : last_bin_) : 0];
    if (worst_is_low_ ? value <= worst_limit_ : value >= worst_limit_) keep_worst({value, id0, id1});
  }
  /// @brief Take over what another builder of the same measure and range was given.
  void merge(const MeasureBuilder& other);
  bool is_empty() const { return count_ == 0; }
  /// @brief The measure; `at` of the worst is left for the caller to fill in.
  Measure take() const;

  static constexpr std::uint32_t kNoId = 0xffffffffu;

 private:
  struct Worst {
    double value;
    std::uint32_t id0, id1;
  };
  bool is_worse(const Worst& a, const Worst& b) const;
  void keep_worst(const Worst& worst);

  MeasureId id_;
  std::size_t num_worst_;
  bool worst_is_low_;
  std::size_t count_ = 0;
  double sum_ = 0, min_, max_;
  double low_ = 0, high_ = 0, bin_scale_ = 0, last_bin_ = 0;
  double worst_limit_;  ///< what is better than this is not among the worst
  std::vector<std::size_t> bins_;
  std::vector<Worst> worst_;
};

}  // namespace delfront
