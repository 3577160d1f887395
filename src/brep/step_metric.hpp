// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "brep/chart.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief A chart's metric by whole sides instead of derivatives: along its main directions a step of length 1 is as
/// long in space as is wanted.
///
/// The two differ where lengths in the chart change within a side: where a surface's mapping is singular, or nearly,
/// derivatives ask for steps right across the face. Such steps are shortened until the chord is right; along a side
/// of the box the step that stays within it counts.
class StepMetric : public SizeField {
 public:
  /// @param by_derivatives  of the chart; not copied, as is the chart
  /// @param box             of parameters: no step leaves it
  StepMetric(const SizeField& by_derivatives, const Chart& chart, const ParameterBox& box)
      : inner_(by_derivatives), chart_(chart), box_(box) {}

  void metrics(std::span<const Point> at, std::span<Metric> metric) const override;
  void sizes(std::span<const Point> at, std::span<double> size) const override;
  bool is_isotropic() const override { return false; }
  double lower_bound(const Box& box) const override { return inner_.lower_bound(box); }

 private:
  Metric by_steps(Point2 from, Metric m) const;
  double step(Point2 from, Point place, Point2 direction, double first, double wanted) const;

  const SizeField& inner_;
  const Chart& chart_;
  ParameterBox box_;
};

}  // namespace delfront
