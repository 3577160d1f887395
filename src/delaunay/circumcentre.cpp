// SPDX-License-Identifier: Apache-2.0
// With rows a, b, c relative to d: the centre is (|a|^2 b x c + |b|^2 c x a + |c|^2 a x b) / (2 det[a, b, c]).
#include "delaunay/circumcentre.hpp"

#include <cmath>

#include "predicates/load_exact.hpp"

namespace delfront {

namespace {

using detail::FixedInt;

// With X, Y, Z, m the largest |entry| on each axis and of all, L the largest lift: a component of the sum is wrong by
// 70u L XY at most (see predicates_inline.hpp), by 16u L XY as a rule, and is divided by 2 det. Where L XY <= 32 m
// |det| that is at most 1120u m = 1.3e-13 m; the determinant's own error is then less than 47u XYZ / det <= 47 * 32u of
// the offset.
constexpr double kFlat = 32;
constexpr double kTiny = 0x1p-100;  ///< m below which underflow could count

/// A long integer as mantissa * 2^exponent.
struct Leading {
  double mantissa;
  int exponent;
};

template <int N>
Leading leading(FixedInt<N> value) {
  const bool is_negative = value.is_negative();
  if (is_negative) value = FixedInt<N>{} - value;
  int top = N - 1;
  while (top > 0 && value.limb[top] == 0) --top;
  double mantissa = static_cast<double>(value.limb[top]);
  if (top > 0) mantissa = mantissa * 0x1p64 + static_cast<double>(value.limb[top - 1]);
  return {is_negative ? -mantissa : mantissa, top > 0 ? 64 * (top - 1) : 0};
}

template <int L>
FixedInt<2 * L> minor(const FixedInt<L>* a, const FixedInt<L>* b, int i) {
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  return a[j] * b[k] - b[j] * a[k];
}

template <int L>
Point offset_at(const Point (&p)[4], int low) {
  FixedInt<L> r[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) r[i][k] = detail::scaled<L>(p[i][k], low) - detail::scaled<L>(p[3][k], low);
  const Leading det =
      leading(r[0][0] * minor(r[1], r[2], 0) + r[0][1] * minor(r[1], r[2], 1) + r[0][2] * minor(r[1], r[2], 2));
  const FixedInt<2 * L> lift[3] = {detail::lift(r[0], 3), detail::lift(r[1], 3), detail::lift(r[2], 3)};
  Point offset;
  for (int k = 0; k < 3; ++k) {
    const Leading sum =
        leading(lift[0] * minor(r[1], r[2], k) + lift[1] * minor(r[2], r[0], k) + lift[2] * minor(r[0], r[1], k));
    offset[k] = std::ldexp(sum.mantissa / det.mantissa, sum.exponent - det.exponent + low - 1);
  }
  return offset;
}

template <int L>
Point offset2_at(const Point (&p)[3], int low) {
  FixedInt<L> r[2][2];
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 2; ++k) r[i][k] = detail::scaled<L>(p[i][k], low) - detail::scaled<L>(p[2][k], low);
  const Leading det = leading(detail::minor_xy(r[0], r[1]));
  const FixedInt<2 * L> lift[2] = {detail::lift(r[0], 2), detail::lift(r[1], 2)};
  const Leading x = leading(lift[0] * r[1][1] - lift[1] * r[0][1]);
  const Leading y = leading(lift[1] * r[0][0] - lift[0] * r[1][0]);
  return {std::ldexp(x.mantissa / det.mantissa, x.exponent - det.exponent + low - 1),
          std::ldexp(y.mantissa / det.mantissa, y.exponent - det.exponent + low - 1), 0};
}

/// Calls offset(integral_constant<L>, low) with the least number of limbs that holds the differences.
template <std::size_t N, class Offset>
Point at_least_width(const Point (&p)[N], const Offset& offset) {
  detail::BinaryRange range;
  for (const Point& q : p)
    for (int k = 0; k < 3; ++k) range.add(q[k]);
  const int bits = range.difference_bits();
  if (bits <= detail::max_bits(1)) return offset(std::integral_constant<int, 1>(), range.low);
  if (bits <= detail::max_bits(2)) return offset(std::integral_constant<int, 2>(), range.low);
  if (bits <= detail::max_bits(5)) return offset(std::integral_constant<int, 5>(), range.low);
  return offset(std::integral_constant<int, 50>(), range.low);
}

}  // namespace

Point circumcentre(Point a, Point b, Point c, Point d) {
  const Point u = a - d, v = b - d, w = c - d;
  const Point vw = cross(v, w);
  const double det = dot(u, vw);
  const double x = detail::max3(u.x, v.x, w.x), y = detail::max3(u.y, v.y, w.y), z = detail::max3(u.z, v.z, w.z);
  const double lift = std::max({squared_length(u), squared_length(v), squared_length(w)});
  const double largest = std::max({x, y, z});
  if (!(largest > kTiny && lift * std::max({x * y, y * z, z * x}) <= kFlat * largest * det)) {
    const Point p[4] = {a, b, c, d};
    return d + at_least_width(p, [&](auto width, int low) { return offset_at<width()>(p, low); });
  }
  return d + (squared_length(u) * vw + squared_length(v) * cross(w, u) + squared_length(w) * cross(u, v)) / (2 * det);
}

std::array<double, 2> circumcentre2(const std::array<double, 2>& a, const std::array<double, 2>& b,
                                    const std::array<double, 2>& c) {
  const double ux = a[0] - c[0], uy = a[1] - c[1], vx = b[0] - c[0], vy = b[1] - c[1];
  const double det = ux * vy - vx * uy, u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
  // u2 vy is wrong by 6u L X, the difference by 14u L X: at most 32 * 7u X of the quotient where L <= 32 |det|.
  if (std::max(u2, v2) > kTiny * kTiny && std::max(u2, v2) <= kFlat * std::fabs(det))
    return {c[0] + (u2 * vy - v2 * uy) / (2 * det), c[1] + (v2 * ux - u2 * vx) / (2 * det)};
  const Point p[3] = {{a[0], a[1], 0}, {b[0], b[1], 0}, {c[0], c[1], 0}};
  const Point offset = at_least_width(p, [&](auto width, int low) { return offset2_at<width()>(p, low); });
  return {c[0] + offset.x, c[1] + offset.y};
}

}  // namespace delfront
