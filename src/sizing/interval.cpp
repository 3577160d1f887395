// SPDX-License-Identifier: Apache-2.0
// Interval arithmetic over the values that evaluation gives, roundings included. Sums, products, quotients, roots and
// everything made of them are rounded monotonically, so that ends computed by the same rounded operation bound all
// rounded values between them: nothing is widened there. Functions of the C library are only nearly monotone (a few
// units in the last place), so their ends are widened by kSlack, far more than the errors that glibc documents.
#include "sizing/interval.hpp"

#include <initializer_list>

namespace delfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSlack = 16 * std::numeric_limits<double>::epsilon();
constexpr double kPi = 3.14159265358979323846;
/// Beyond it the place within a period is not worth finding.
constexpr double kLargestAngle = 1e8;

Interval everything(bool may_be_nan) { return {-kInfinity, kInfinity, may_be_nan}; }

double call(Operation operation, int n, double a) {
  double result = kNaN;
  with_unary(operation, n, [&](auto f) { result = f(a); });
  return result;
}

double call(Operation operation, double a, double b) {
  double result = kNaN;
  with_binary(operation, [&](auto f) { result = f(a, b); });
  return result;
}

double widened_down(double a) {
  return std::isfinite(a) ? a - std::abs(a) * kSlack - 8 * std::numeric_limits<double>::denorm_min()
         : a > 0          ? std::numeric_limits<double>::max()
                          : a;
}
double widened_up(double a) { return -widened_down(-a); }

/// Widened, but not beyond the least and the greatest value that the function has.
Interval widened(double low, double high, bool may_be_nan, double least = -kInfinity, double greatest = kInfinity) {
  return {std::max(widened_down(low), least), std::min(widened_up(high), greatest), may_be_nan};
}

Interval increasing(Operation operation, const Interval& a, double least = -kInfinity, double greatest = kInfinity) {
  return widened(call(operation, 0, a.low), call(operation, 0, a.high), a.may_be_nan, least, greatest);
}

/// The part of `a` within [least, greatest], where the function is defined.
Interval in_domain(Interval a, double least, double greatest) {
  a.may_be_nan = a.may_be_nan || a.low < least || a.high > greatest;
  a.low = std::max(a.low, least);
  a.high = std::min(a.high, greatest);
  return a;
}

Interval absolute(const Interval& a) {
  if (a.low >= 0) return a;
  if (a.high <= 0) return {-a.high, -a.low, a.may_be_nan};
  return {0, std::max(-a.low, a.high), a.may_be_nan};
}

/// Whether offset + k period, k whole, may lie in `a`.
bool may_hold_multiple(const Interval& a, double offset, double period) {
  constexpr double kDoubt = 1e-6;  // kLargestAngle times the rounding of the quotient, and to spare
  const double from = (a.low - offset) / period - kDoubt, to = (a.high - offset) / period + kDoubt;
  return std::floor(to) >= std::ceil(from);
}

bool is_small_angle(const Interval& a) { return a.low >= -kLargestAngle && a.high <= kLargestAngle; }

/// sin and cos: a peak every 2 pi from `peak`, a dip half a turn later.
Interval wave(Operation operation, const Interval& a, double peak) {
  const bool may_be_nan = a.may_be_nan || std::isinf(a.low) || std::isinf(a.high);
  if (!is_small_angle(a)) return {-1, 1, may_be_nan};
  const double first = call(operation, 0, a.low), last = call(operation, 0, a.high);
  Interval result = widened(std::min(first, last), std::max(first, last), may_be_nan, -1, 1);
  if (may_hold_multiple(a, peak, 2 * kPi)) result.high = 1;
  if (may_hold_multiple(a, peak + kPi, 2 * kPi)) result.low = -1;
  return result;
}

Interval tangent(const Interval& a) {
  const bool may_be_nan = a.may_be_nan || std::isinf(a.low) || std::isinf(a.high);
  if (!is_small_angle(a) || may_hold_multiple(a, kPi / 2, kPi)) return everything(may_be_nan);
  return increasing(Operation::tan, a);
}

Interval quotient(const Interval& a, const Interval& b) {
  const bool both_infinite = std::max(-a.low, a.high) == kInfinity && std::max(-b.low, b.high) == kInfinity;
  const bool may_be_nan = a.may_be_nan || b.may_be_nan || both_infinite;
  if (both_infinite) return everything(true);
  if (b.holds(0)) {
    const bool nan_too = may_be_nan || a.holds(0);
    // 0 counts as +0 in a divisor, also where it ends an interval of negative numbers
    if (b.low < 0) return everything(nan_too);
    if (a.low >= 0) return {a.low == 0 ? 0 : a.low / plus_zero(b.high), kInfinity, nan_too};
    if (a.high <= 0) return {-kInfinity, a.high == 0 ? 0 : a.high / plus_zero(b.high), nan_too};
    return everything(nan_too);
  }
  const double ends[4] = {a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high};
  return {*std::min_element(ends, ends + 4), *std::max_element(ends, ends + 4), may_be_nan};
}

Interval integer_power_range(const Interval& a, int n) {
  const int positive = n < 0 ? -n : n;
  const auto power = [&](double value) { return call(Operation::power_of_integer, positive, value); };
  const Interval base = positive % 2 == 0 ? absolute(a) : a;
  const Interval result{power(base.low), power(base.high), a.may_be_nan};
  return n < 0 ? quotient({1, 1, false}, result) : result;
}

Interval sum(const Interval& a, const Interval& b) {
  const bool may_be_nan = a.may_be_nan || b.may_be_nan || (a.low == -kInfinity && b.high == kInfinity) ||
                          (a.high == kInfinity && b.low == -kInfinity);
  const double low = a.low + b.low, high = a.high + b.high;
  return {is_nan(low) ? -kInfinity : low, is_nan(high) ? kInfinity : high, may_be_nan};
}

Interval product(const Interval& a, const Interval& b) {
  const bool a_infinite = std::max(-a.low, a.high) == kInfinity, b_infinite = std::max(-b.low, b.high) == kInfinity;
  const bool may_be_nan = a.may_be_nan || b.may_be_nan || (a.holds(0) && b_infinite) || (b.holds(0) && a_infinite);
  double low = kInfinity, high = -kInfinity;
  for (const double end : {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high}) {
    const double value = is_nan(end) ? 0 : end;  // 0 times infinity: beside it are products of 0 and of large numbers
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return {low, high, may_be_nan};
}

/// The exponent times the logarithm is least and greatest at corners.
Interval power_range(const Interval& a, const Interval& b) {
  const bool may_be_nan = a.may_be_nan || b.may_be_nan;
  if (a.low < 0) return everything(true);
  double low = kInfinity, high = -kInfinity;
  for (const double base : {a.low, a.high})
    for (const double exponent : {b.low, b.high}) {
      const double value = call(Operation::power, base, exponent);
      low = std::min(low, value);
      high = std::max(high, value);
    }
  return widened(low, high, may_be_nan, 0);
}

Interval angle_range(const Interval& y, const Interval& x) {
  const bool may_be_nan = x.may_be_nan || y.may_be_nan;
  const bool meets_cut = x.low <= 0 && y.holds(0);
  if (meets_cut) return {-widened_up(kPi), widened_up(kPi), may_be_nan};
  double low = kInfinity, high = -kInfinity;
  for (const double end_y : {y.low, y.high})
    for (const double end_x : {x.low, x.high}) {
      const double value = call(Operation::atan2, end_y, end_x);
      low = std::min(low, value);
      high = std::max(high, value);
    }
  return widened(low, high, may_be_nan);
}

Interval modulo_range(const Interval& a, const Interval& b) {
  const bool may_be_nan = a.may_be_nan || b.may_be_nan || b.holds(0) || std::max(-a.low, a.high) == kInfinity;
  const bool is_finite_divisor = b.is_point() && b.low > 0 && b.low < kInfinity;
  if (is_finite_divisor && !may_be_nan && a.high - a.low < b.low) {
    // less than a period: the remainder either rises all the way or falls back once
    const double first = floor_modulo(a.low, b.low), last = floor_modulo(a.high, b.low);
    if (first < last || a.is_point()) return {first, last, false};
  }
  return {std::min(b.low, 0.0), std::max(b.high, 0.0), may_be_nan};
}

Interval truth_range(bool may_be_false, bool may_be_true, bool may_be_nan) {
  if (!may_be_false && !may_be_true) return {kInfinity, -kInfinity, true};
  return {truth(!may_be_false), truth(may_be_true), may_be_nan};
}

bool may_be_false(const Interval& a) { return a.holds(0); }
bool may_be_true(const Interval& a) { return !a.is_empty() && (a.low != 0 || a.high != 0); }

Interval comparison(Operation operation, const Interval& a, const Interval& b) {
  const bool may_be_nan = a.may_be_nan || b.may_be_nan;
  if (operation == Operation::less) return truth_range(a.high >= b.low, a.low < b.high, may_be_nan);
  if (operation == Operation::less_equal) return truth_range(a.high > b.low, a.low <= b.high, may_be_nan);
  const bool may_be_equal = a.low <= b.high && b.low <= a.high;
  const bool may_differ = !(a.is_point() && b.is_point() && a.low == b.low);
  return operation == Operation::equal ? truth_range(may_differ, may_be_equal, may_be_nan)
                                       : truth_range(may_be_equal, may_differ, may_be_nan);
}

/// Those that need not have both arguments: one that is no number may leave the other's truth.
Interval logic(Operation operation, const Interval& a, const Interval& b) {
  const bool may_be_nan = a.may_be_nan || b.may_be_nan;
  if (operation == Operation::logical_and)
    return truth_range(may_be_false(a) || may_be_false(b), may_be_true(a) && may_be_true(b), may_be_nan);
  return truth_range(may_be_false(a) && may_be_false(b), may_be_true(a) || may_be_true(b), may_be_nan);
}

}  // namespace

Interval unary_range(Operation operation, int n, const Interval& a) {
  if (a.is_empty()) return {kInfinity, -kInfinity, true};
  const auto if_any = [](const Interval& in, Interval result) {
    return in.is_empty() ? Interval{kInfinity, -kInfinity, true} : result;
  };
  switch (operation) {
    case Operation::negate:
      return {-a.high, -a.low, a.may_be_nan};
    case Operation::logical_not:
      return truth_range(may_be_true(a), may_be_false(a), a.may_be_nan);
    case Operation::abs:
      return absolute(a);
    case Operation::sqrt: {
      const Interval in = in_domain(a, 0, kInfinity);
      return if_any(in, {std::sqrt(in.low), std::sqrt(in.high), in.may_be_nan});
    }
    case Operation::log:
    case Operation::log10: {
      const Interval in = in_domain(a, 0, kInfinity);
      return if_any(in, increasing(operation, in));
    }
    case Operation::asin: {
      const Interval in = in_domain(a, -1, 1);
      return if_any(in, increasing(operation, in));
    }
    case Operation::acos: {
      const Interval in = in_domain(a, -1, 1);
      return if_any(in, widened(std::acos(in.high), std::acos(in.low), in.may_be_nan, 0));
    }
    case Operation::exp:
      return increasing(operation, a, 0);
    case Operation::tanh:
      return increasing(operation, a, -1, 1);
    case Operation::cbrt:
    case Operation::atan:
    case Operation::sinh:
      return increasing(operation, a);
    case Operation::cosh:
      return increasing(operation, absolute(a), 1);
    case Operation::sin:
      return wave(operation, a, kPi / 2);
    case Operation::cos:
      return wave(operation, a, 0);
    case Operation::tan:
      return tangent(a);
    case Operation::power_of_integer:
      return integer_power_range(a, n);
    default:
      return {call(operation, n, a.low), call(operation, n, a.high), a.may_be_nan};  // floor, ceil, sign
  }
}

Interval binary_range(Operation operation, const Interval& a, const Interval& b, bool is_same) {
  if (operation == Operation::logical_and || operation == Operation::logical_or) return logic(operation, a, b);
  if (a.is_empty() || b.is_empty()) return {kInfinity, -kInfinity, true};
  const bool may_be_nan = a.may_be_nan || b.may_be_nan;
  switch (operation) {
    case Operation::add:
      return sum(a, b);
    case Operation::subtract:
      return sum(a, {-b.high, -b.low, b.may_be_nan});
    case Operation::multiply:
      return is_same ? integer_power_range(a, 2) : product(a, b);
    case Operation::divide:
      return quotient(a, b);
    case Operation::power:
      return power_range(a, b);
    case Operation::minimum:
      return {std::min(a.low, b.low), std::min(a.high, b.high), may_be_nan};
    case Operation::maximum:
      return {std::max(a.low, b.low), std::max(a.high, b.high), may_be_nan};
    case Operation::hypot: {
      const Interval x = absolute(a), y = absolute(b);
      return widened(scaled_hypot(x.low, y.low), scaled_hypot(x.high, y.high), may_be_nan, 0);
    }
    case Operation::atan2:
      return angle_range(a, b);
    case Operation::modulo:
      return modulo_range(a, b);
    default:
      return comparison(operation, a, b);
  }
}

Interval choice_range(const Interval& condition, const Interval& a, const Interval& b) {
  Interval result{kInfinity, -kInfinity, condition.may_be_nan};
  const auto add = [&](const Interval& branch) {
    result.low = std::min(result.low, branch.low);
    result.high = std::max(result.high, branch.high);
    result.may_be_nan = result.may_be_nan || branch.may_be_nan;
  };
  if (may_be_true(condition)) add(a);
  if (may_be_false(condition)) add(b);
  return result;
}

}  // namespace delfront
