// SPDX-License-Identifier: Apache-2.0
#pragma once
// The determinants over exact integers. With |difference| <= 2^(64 L - 3) nothing below wraps:
//   2x2 minors  2 * 2^(128 L - 6)            < 2^(128 L - 1)
//   3x3 minors  6 * 2^(192 L - 9)            < 2^(192 L - 1)
//   lifts       3 * 2^(128 L - 6)            < 2^(128 L - 1)
//   in-sphere   4 * 6 * 3 * 2^(320 L - 15)   < 2^(320 L - 1)
#include "predicates/fixed_int.hpp"

namespace delfront::detail {

/// @brief Largest number of bits that a coordinate difference may have in FixedInt<L>.
constexpr int max_bits(int limbs) { return 64 * limbs - 3; }

/// @brief x y' - x' y of two rows.
template <int L>
inline FixedInt<2 * L> minor_xy(const FixedInt<L>* a, const FixedInt<L>* b) {
  return a[0] * b[1] - b[0] * a[1];
}

template <int L>
inline FixedInt<2 * L> lift(const FixedInt<L>* a, int dimension) {
  FixedInt<2 * L> sum = a[0] * a[0];
  for (int k = 1; k < dimension; ++k) sum = sum + a[k] * a[k];
  return sum;
}

template <int L>
inline int det2_sign(const FixedInt<L> (&r)[2][2]) {
  return sign(minor_xy(r[0], r[1]));
}

template <int L>
inline int det3_sign(const FixedInt<L> (&r)[3][3]) {
  return sign(r[0][2] * minor_xy(r[1], r[2]) + r[1][2] * minor_xy(r[2], r[0]) + r[2][2] * minor_xy(r[0], r[1]));
}

/// @brief Rows a - d, b - d, c - d; +1 where d lies in the circle of the anticlockwise a, b, c.
template <int L>
inline int incircle_sign(const FixedInt<L> (&r)[3][2]) {
  return sign(lift(r[0], 2) * minor_xy(r[1], r[2]) + lift(r[1], 2) * minor_xy(r[2], r[0]) +
              lift(r[2], 2) * minor_xy(r[0], r[1]));
}

/// @brief Rows a - e … d - e and what e's neighbours are lifted by over e: +1 where e lies below the hyperplane through
/// the others, lifted, for a positive tet a, b, c, d.
template <int L>
inline int lifted_sign(const FixedInt<L> (&r)[4][3], const FixedInt<2 * L>& lift_a, const FixedInt<2 * L>& lift_b,
                       const FixedInt<2 * L>& lift_c, const FixedInt<2 * L>& lift_d) {
  const FixedInt<L>*a = r[0], *b = r[1], *c = r[2], *d = r[3];
  const auto ab = minor_xy(a, b), bc = minor_xy(b, c), cd = minor_xy(c, d), da = minor_xy(d, a);
  const auto ac = minor_xy(a, c), bd = minor_xy(b, d);
  const auto abc = a[2] * bc - b[2] * ac + c[2] * ab;
  const auto bcd = b[2] * cd - c[2] * bd + d[2] * bc;
  const auto cda = c[2] * da + d[2] * ac + a[2] * cd;
  const auto dab = d[2] * ab + a[2] * bd + b[2] * da;
  return sign((bcd * lift_a - cda * lift_b) + (dab * lift_c - abc * lift_d));
}

/// @brief Rows a - e … d - e; +1 where e lies in the sphere of the positive tet a, b, c, d.
template <int L>
inline int insphere_sign(const FixedInt<L> (&r)[4][3]) {
  return lifted_sign(r, lift(r[0], 3), lift(r[1], 3), lift(r[2], 3), lift(r[3], 3));
}

}  // namespace delfront::detail
