// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace delfront {

/// @brief What an instruction of a compiled expression does. Those of one to three arguments have a functor below.
enum class Operation : std::uint8_t {
  constant,
  x,
  y,
  z,
  distance,
  negate,
  logical_not,
  abs,
  sqrt,
  cbrt,
  exp,
  log,
  log10,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  sinh,
  cosh,
  tanh,
  floor,
  ceil,
  sign,
  power_of_integer,
  add,
  subtract,
  multiply,
  divide,
  power,
  less,
  less_equal,
  equal,
  not_equal,
  logical_and,
  logical_or,
  minimum,
  maximum,
  hypot,
  atan2,
  modulo,
  choose,
};

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

inline bool is_nan(double a) { return a != a; }
/// -0 becomes 0.
inline double plus_zero(double a) { return a + 0.0; }

/// @brief a^n by squaring; of |a| monotone, since each product is.
inline double integer_power(double a, int n) {
  double result = 1, square = a;
  for (unsigned k = static_cast<unsigned>(n < 0 ? -n : n); k > 0; k >>= 1) {
    if (k & 1) result *= square;
    if (k > 1) square *= square;
  }
  return n < 0 ? 1 / plus_zero(result) : result;
}

inline double scaled_hypot(double a, double b) {
  a = std::abs(a);
  b = std::abs(b);
  const double large = a > b ? a : b, small = a > b ? b : a;
  const double ratio = small / large;
  const double result = large * std::sqrt(1 + ratio * ratio);
  const double safe = large > 0 && large < std::numeric_limits<double>::infinity() ? result : large;
  return is_nan(a) || is_nan(b) ? kNaN : safe;
}

/// @brief The remainder with the sign of b: a - b floor(a / b).
inline double floor_modulo(double a, double b) {
  const double r = std::fmod(a, b);
  return r != 0 && (r < 0) != (b < 0) ? r + b : r;
}

inline double truth(bool value) { return value ? 1.0 : 0.0; }

/// @brief Call use(f) with the function of an operation of one argument. @return false where it is none such
template <class Use>
bool with_unary(Operation operation, int n, Use&& use) {
  switch (operation) {
    case Operation::negate:
      return use([](double a) { return -a; }), true;
    case Operation::logical_not:
      return use([](double a) { return is_nan(a) ? a : truth(a == 0); }), true;
    case Operation::abs:
      return use([](double a) { return std::abs(a); }), true;
    case Operation::sqrt:
      return use([](double a) { return std::sqrt(a); }), true;
    case Operation::cbrt:
      return use([](double a) { return std::cbrt(a); }), true;
    case Operation::exp:
      return use([](double a) { return std::exp(a); }), true;
    case Operation::log:
      return use([](double a) { return std::log(a); }), true;
    case Operation::log10:
      return use([](double a) { return std::log10(a); }), true;
    case Operation::sin:
      return use([](double a) { return std::sin(a); }), true;
    case Operation::cos:
      return use([](double a) { return std::cos(a); }), true;
    case Operation::tan:
      return use([](double a) { return std::tan(a); }), true;
    case Operation::asin:
      return use([](double a) { return std::asin(a); }), true;
    case Operation::acos:
      return use([](double a) { return std::acos(a); }), true;
    case Operation::atan:
      return use([](double a) { return std::atan(a); }), true;
    case Operation::sinh:
      return use([](double a) { return std::sinh(a); }), true;
    case Operation::cosh:
      return use([](double a) { return std::cosh(a); }), true;
    case Operation::tanh:
      return use([](double a) { return std::tanh(a); }), true;
    case Operation::floor:
      return use([](double a) { return std::floor(a); }), true;
    case Operation::ceil:
      return use([](double a) { return std::ceil(a); }), true;
    case Operation::sign:
      return use([](double a) { return is_nan(a) ? a : truth(a > 0) - truth(a < 0); }), true;
    case Operation::power_of_integer:
      if (n == 2) return use([](double a) { return a * a; }), true;
      if (n == 3) return use([](double a) { return a * (a * a); }), true;
      return use([n](double a) { return integer_power(a, n); }), true;
    default:
      return false;
  }
}

/// @brief The same for two arguments.
template <class Use>
bool with_binary(Operation operation, Use&& use) {
  const auto compared = [](double a, double b, bool value) { return is_nan(a) || is_nan(b) ? kNaN : truth(value); };
  switch (operation) {
    case Operation::add:
      return use([](double a, double b) { return a + b; }), true;
    case Operation::subtract:
      return use([](double a, double b) { return a - b; }), true;
    case Operation::multiply:
      return use([](double a, double b) { return a * b; }), true;
    case Operation::divide:
      return use([](double a, double b) { return a / plus_zero(b); }), true;
    case Operation::power:
      return use([](double a, double b) { return is_nan(a) || is_nan(b) ? kNaN : std::pow(plus_zero(a), b); }), true;
    case Operation::less:
      return use([=](double a, double b) { return compared(a, b, a < b); }), true;
    case Operation::less_equal:
      return use([=](double a, double b) { return compared(a, b, a <= b); }), true;
    case Operation::equal:
      return use([=](double a, double b) { return compared(a, b, a == b); }), true;
    case Operation::not_equal:
      return use([=](double a, double b) { return compared(a, b, a != b); }), true;
    case Operation::logical_and:
      return use([=](double a, double b) { return a == 0 || b == 0 ? 0.0 : compared(a, b, true); }), true;
    case Operation::logical_or:
      return use([=](double a, double b) {
               const bool is_true = (a != 0 && !is_nan(a)) || (b != 0 && !is_nan(b));
               return is_true ? 1.0 : compared(a, b, false);
             }),
             true;
    case Operation::minimum:
      return use([](double a, double b) { return is_nan(a) ? a : is_nan(b) ? b : a < b ? a : b; }), true;
    case Operation::maximum:
      return use([](double a, double b) { return is_nan(a) ? a : is_nan(b) ? b : a > b ? a : b; }), true;
    case Operation::hypot:
      return use([](double a, double b) { return scaled_hypot(a, b); }), true;
    case Operation::atan2:
      return use([](double a, double b) { return std::atan2(plus_zero(a), plus_zero(b)); }), true;
    case Operation::modulo:
      return use([](double a, double b) { return floor_modulo(a, b); }), true;
    default:
      return false;
  }
}

inline double chosen(double condition, double a, double b) {
  return is_nan(condition) ? condition : condition != 0 ? a : b;
}

}  // namespace delfront
