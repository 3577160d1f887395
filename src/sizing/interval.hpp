// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "sizing/expression_operations.hpp"

namespace delfront {

/// @brief All numbers that a subexpression may give, as rounded in evaluation; no number at all: low > high.
struct Interval {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool may_be_nan = false;

  bool is_empty() const { return !(low <= high); }
  bool holds(double value) const { return low <= value && value <= high; }
  bool is_point() const { return low == high; }
};

/// @brief Bounds of what an operation of one argument gives. @param n  exponent of power_of_integer
Interval unary_range(Operation operation, int n, const Interval& a);
/// @param is_same  both arguments are one and the same value, not only equal intervals
Interval binary_range(Operation operation, const Interval& a, const Interval& b, bool is_same);
Interval choice_range(const Interval& condition, const Interval& a, const Interval& b);

}  // namespace delfront
