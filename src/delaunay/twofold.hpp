// SPDX-License-Identifier: Apache-2.0
#pragma once
// Numbers of twice the precision in the lanes of a vector: an unevaluated sum high + low with |low| <= u |high|, u =
// 2^-53. Sums and products of doubles are held without error; what follows is wrong by a few u^2:
//   sum:              the low parts' sum u (u |a| + u |b|), the correction u (u |a + b| + u |a| + u |b|): less than
//   4u^2
//                     (|a| + |b|)
//   double * twofold: the correction u (u + u) |a b|: less than 4u^2 |a b|
//   product:          low * high u^2, its sum with the other 2u^2, the correction 3u^2, low * low u^2: less than 8u^2
//                     |a b|
// Source: Dekker (1971), Knuth (TAOCP 2, 4.2.2), Joldes, Muller & Popescu (2017); without their last shortcuts, which
// need one part to be larger than the other.
#if defined(__AVX2__) && defined(__FMA__)
#define DELFRONT_HAS_TWOFOLD  // without a fused multiplication it costs what exact integers do
#include <immintrin.h>

namespace delfront::lanes {

typedef double Vector __attribute__((vector_size(32)));

/// @brief A double that is multiplied without error.
struct Exact {
  Vector value;
};

struct Twofold {
  Vector high, low;
};

/// @brief a + b without error. @par Source Knuth
inline Twofold exact_sum(Vector a, Vector b) {
  const Vector sum = a + b, b_part = sum - a, a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

inline Twofold operator*(Exact a, Exact b) {
  const Vector product = a.value * b.value;
  return {product, _mm256_fmsub_pd(a.value, b.value, product)};
}

inline Twofold operator+(Twofold a, Twofold b) {
  const Twofold sum = exact_sum(a.high, b.high);
  return exact_sum(sum.high, sum.low + (a.low + b.low));
}

inline Twofold operator-(Twofold a, Twofold b) { return a + Twofold{-b.high, -b.low}; }

inline Twofold operator*(Exact a, Twofold b) {
  const Twofold product = a * Exact{b.high};
  return exact_sum(product.high, _mm256_fmadd_pd(a.value, b.low, product.low));
}
inline Twofold operator*(Twofold a, Exact b) { return b * a; }

inline Twofold operator*(Twofold a, Twofold b) {
  const Twofold product = Exact{a.high} * Exact{b.high};
  return exact_sum(product.high, product.low + _mm256_fmadd_pd(a.low, b.high, a.high * b.low));
}

}  // namespace delfront::lanes
#endif
