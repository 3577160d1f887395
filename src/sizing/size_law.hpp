// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "delfront/size_sources.hpp"

namespace delfront {

/// @brief The largest function below a law whose slope is nowhere above k: g(d) = min over d' <= d of f(d') + k (d -
/// d').
///
/// Distances to a closed set have slope 1 (along the line to the nearest place), so that g(distance) is the largest
/// field of slope k below f(distance). With k infinite g = f. Monotone and, for finite k, continuous.
class LimitedLaw {
 public:
  LimitedLaw() = default;
  /// @pre check_law(law)  @param slope  > 0, may be infinite
  LimitedLaw(const SizeLaw& law, double slope);

  /// @return the size at distance r >= 0; the law's own size_at to the bit where its slope is below k
  double operator()(double r) const;

  /// @return a distance beyond which no computed size is below `size`; -1 where that holds everywhere. A little (1e-6)
  /// more than the least such distance.
  double reach(double size) const;

  /// @return what the slope of the law does not exceed from 0 to r; infinite where nothing is known
  double steepest(double r) const;

  /// @return what no size exceeds
  double largest() const;
  double delta0() const { return law_.delta0; }

 private:
  void limit_polynomial();
  double inverse(double size) const;

  SizeLaw law_;
  double slope_ = 0;                  ///< infinite: no limit
  std::vector<double> leave_, meet_;  ///< from r = leave_[i] to meet_[i] (or on) it is a straight line of slope k
  std::vector<double> value_at_leave_;
};

/// @return the real roots > 0 of sum c_i x^i, ascending, each once; roots without a change of sign may be missing
std::vector<double> positive_roots(std::vector<double> coefficients);

}  // namespace delfront
