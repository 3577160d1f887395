// SPDX-License-Identifier: Apache-2.0
#pragma once
// From doubles to exact integers on one common scale (a power of two), the way into exact_kernels.hpp.
#include <bit>
#include <climits>

#include "predicates/exact_kernels.hpp"
#include "predicates/predicates.hpp"

namespace delfront::detail {

/// @brief Common scale of a set of numbers: every one is a multiple of 2^low and smaller than 2^high in magnitude.
struct BinaryRange {
  int low = INT_MAX, high = INT_MIN;

  /// @param shift  widen as if the value had been divided by 2^shift
  void add(double value, int shift = 0) {
    const auto bits = std::bit_cast<std::uint64_t>(value) & ~(std::uint64_t{1} << 63);
    if (bits == 0) return;
    const int biased = static_cast<int>(bits >> 52);
    const std::uint64_t fraction = (bits & 0xfffffffffffffu) | (biased ? std::uint64_t{1} << 52 : 0);
    const int exponent = (biased ? biased : 1) - 1075;
    low = std::min(low, exponent + std::countr_zero(fraction) - shift);
    high = std::max(high, exponent + static_cast<int>(std::bit_width(fraction)));
  }
  /// @return bits of a difference of two of the numbers
  int difference_bits() const { return high < low ? 0 : high - low + 1; }
};

/// @brief value / 2^low; the caller knows that this is an integer which fits.
template <int L>
FixedInt<L> scaled(double value, int low) {
  FixedInt<L> out{};
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const int biased = static_cast<int>(bits >> 52) & 0x7ff;
  std::uint64_t fraction = (bits & 0xfffffffffffffu) | (biased ? std::uint64_t{1} << 52 : 0);
  if (fraction == 0) return out;
  int shift = (biased ? biased : 1) - 1075 - low;
  if (shift < 0) {  // only trailing zeros go
    fraction >>= -shift;
    shift = 0;
  }
  const int word = shift / 64, bit = shift % 64;
  out.limb[word] = fraction << bit;
  if (bit > 11 && word + 1 < L) out.limb[word + 1] = fraction >> (64 - bit);
  return bits >> 63 ? FixedInt<L>{} - out : out;
}

/// @brief t = numerator / 2^shift with odd numerator; t in (0, 1).
struct Parameter {
  std::uint64_t numerator;
  int shift;

  explicit Parameter(double t) {
    const auto bits = std::bit_cast<std::uint64_t>(t);
    const int biased = static_cast<int>(bits >> 52);
    numerator = (bits & 0xfffffffffffffu) | (biased ? std::uint64_t{1} << 52 : 0);
    const int zeros = std::countr_zero(numerator);
    numerator >>= zeros;
    shift = 1075 - (biased ? biased : 1) - zeros;
  }
};

/// @brief Add what the exact coordinate needs: a segment point's is a multiple of 2^-shift times that of its ends.
inline void add_coordinate(BinaryRange& range, const ExactPoint& p, int axis) {
  if (p.is_explicit()) return range.add(p.approx[axis]);
  const int shift = Parameter(p.t).shift;
  range.add(p.a[axis], shift);
  range.add(p.b[axis], shift);
}

/// @brief The exact coordinate in units of 2^low.
template <int L>
FixedInt<L> exact_coordinate(const ExactPoint& p, int axis, int low) {
  if (p.is_explicit()) return scaled<L>(p.approx[axis], low);
  const Parameter t(p.t);
  const FixedInt<L> a = scaled<L>(p.a[axis], low + t.shift), b = scaled<L>(p.b[axis], low + t.shift);
  const FixedInt<L + 1> product = (b - a) * FixedInt<1>{{t.numerator}};
  FixedInt<L> sum = scaled<L>(p.a[axis], low);
  FixedInt<L> low_part;
  for (int i = 0; i < L; ++i) low_part.limb[i] = product.limb[i];
  return sum + low_part;
}

/// @brief Differences of the first Rows points to the last, exact, and the sign that `kernel` finds in them.
template <int L, int Rows, int Axes, class Kernel>
int sign_at(const ExactPoint* const* points, int low, const Kernel& kernel) {
  FixedInt<L> rows[Rows][Axes];
  for (int k = 0; k < Axes; ++k) {
    const FixedInt<L> origin = exact_coordinate<L>(*points[Rows], k, low);
    for (int i = 0; i < Rows; ++i) rows[i][k] = exact_coordinate<L>(*points[i], k, low) - origin;
  }
  return kernel(rows);
}

/// @brief Exact sign for any finite coordinates, at the narrowest width that holds their differences.
/// Widest: from 2^1024 down to 2^-1074 times 2^-1074 (parameter) is 3173 bits, so 50 limbs always do.
template <int Rows, int Axes, class Kernel>
int exact_sign(const ExactPoint* const* points, const Kernel& kernel) {
  BinaryRange range;
  for (int i = 0; i <= Rows; ++i)
    for (int k = 0; k < Axes; ++k) add_coordinate(range, *points[i], k);
  const int bits = range.difference_bits();
  if (bits == 0) return 0;
  if (bits <= max_bits(1)) return sign_at<1, Rows, Axes>(points, range.low, kernel);
  if (bits <= max_bits(2)) return sign_at<2, Rows, Axes>(points, range.low, kernel);
  if (bits <= max_bits(3)) return sign_at<3, Rows, Axes>(points, range.low, kernel);
  if (bits <= max_bits(5)) return sign_at<5, Rows, Axes>(points, range.low, kernel);
  if (bits <= max_bits(12)) return sign_at<12, Rows, Axes>(points, range.low, kernel);
  return sign_at<50, Rows, Axes>(points, range.low, kernel);
}

/// @brief Differences as one-limb integers, if they have at most 61 bits on a common scale; no decoding of doubles.
///
/// Works from the differences, so it holds for points close together anywhere, where the coordinates would not fit.
template <int Rows, int Axes>
bool load_small(const double (&p)[Rows + 1][Axes], FixedInt<1> (&rows)[Rows][Axes]) {
  double high[Rows][Axes], tail[Rows][Axes], largest = 0;
  bool has_tail = false;
  for (int i = 0; i < Rows; ++i)
    for (int k = 0; k < Axes; ++k) {
      // Two-difference (Knuth): high + tail is the exact difference.
      const double a = p[i][k], b = p[Rows][k], d = a - b, bv = a - d, av = d + bv;
      high[i][k] = d;
      tail[i][k] = (a - av) + (bv - b);
      has_tail |= tail[i][k] != 0;
      largest = std::max(largest, std::fabs(d));
    }
  const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(largest) >> 52) - 1023;
  if (exponent < -900 || exponent > 60) return false;  // scale in 2^0 … 2^960: scaling up is exact
  const double scale = std::bit_cast<double>(static_cast<std::uint64_t>(60 - exponent + 1023) << 52);
  bool exact = true;
  for (int i = 0; i < Rows; ++i)
    for (int k = 0; k < Axes; ++k) {
      const double v = high[i][k] * scale;
      const auto n = static_cast<std::int64_t>(v);
      exact &= static_cast<double>(n) == v;
      rows[i][k].limb[0] = static_cast<std::uint64_t>(n);
    }
  if (!exact || !has_tail) return exact;
  for (int i = 0; i < Rows; ++i)
    for (int k = 0; k < Axes; ++k) {
      if (tail[i][k] == 0) continue;
      const double v = tail[i][k] * scale;
      const auto n = static_cast<std::int64_t>(v);
      if (static_cast<double>(n) != v) return false;
      rows[i][k].limb[0] += static_cast<std::uint64_t>(n);
    }
  return true;
}

}  // namespace delfront::detail
