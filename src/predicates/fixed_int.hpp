// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace delfront::detail {

__extension__ typedef unsigned __int128 Wide;
__extension__ typedef __int128 SignedWide;

/// @brief Signed integer of N 64-bit limbs, two's complement, least significant first. Wraps; never allocates.
template <int N>
struct FixedInt {
  std::uint64_t limb[N];

  bool is_negative() const { return limb[N - 1] >> 63; }
};

template <int N>
inline FixedInt<N> operator+(const FixedInt<N>& a, const FixedInt<N>& b) {
  FixedInt<N> sum;
  Wide carry = 0;
  for (int i = 0; i < N; ++i) {
    carry += static_cast<Wide>(a.limb[i]) + b.limb[i];
    sum.limb[i] = static_cast<std::uint64_t>(carry);
    carry >>= 64;
  }
  return sum;
}

template <int N>
inline FixedInt<N> operator-(const FixedInt<N>& a, const FixedInt<N>& b) {
  FixedInt<N> difference;
  std::uint64_t borrow = 0;
  for (int i = 0; i < N; ++i) {
    const Wide d = static_cast<Wide>(a.limb[i]) - b.limb[i] - borrow;
    difference.limb[i] = static_cast<std::uint64_t>(d);
    borrow = static_cast<std::uint64_t>(d >> 64) & 1;
  }
  return difference;
}

/// @brief Full product; school method, then the correction for negative factors read as unsigned.
template <int A, int B>
inline FixedInt<A + B> operator*(const FixedInt<A>& a, const FixedInt<B>& b) {
  FixedInt<A + B> product{};
  for (int i = 0; i < A; ++i) {
    std::uint64_t carry = 0;
    for (int j = 0; j < B; ++j) {
      const Wide t = static_cast<Wide>(a.limb[i]) * b.limb[j] + product.limb[i + j] + carry;
      product.limb[i + j] = static_cast<std::uint64_t>(t);
      carry = static_cast<std::uint64_t>(t >> 64);
    }
    product.limb[i + B] = carry;
  }
  const auto subtract_high = [&product](const std::uint64_t* value, int count, int from, std::uint64_t mask) {
    std::uint64_t borrow = 0;
    for (int i = 0; i < count; ++i) {
      const Wide d = static_cast<Wide>(product.limb[from + i]) - (value[i] & mask) - borrow;
      product.limb[from + i] = static_cast<std::uint64_t>(d);
      borrow = static_cast<std::uint64_t>(d >> 64) & 1;
    }
  };
  subtract_high(b.limb, B, A, a.is_negative() ? ~std::uint64_t{0} : 0);
  subtract_high(a.limb, A, B, b.is_negative() ? ~std::uint64_t{0} : 0);
  return product;
}

inline FixedInt<2> operator*(const FixedInt<1>& a, const FixedInt<1>& b) {
  const SignedWide p =
      static_cast<SignedWide>(static_cast<std::int64_t>(a.limb[0])) * static_cast<std::int64_t>(b.limb[0]);
  return {{static_cast<std::uint64_t>(p), static_cast<std::uint64_t>(static_cast<Wide>(p) >> 64)}};
}

template <int N>
inline int sign(const FixedInt<N>& a) {
  if (a.is_negative()) return -1;
  std::uint64_t any = 0;
  for (int i = 0; i < N; ++i) any |= a.limb[i];
  return any != 0;
}

}  // namespace delfront::detail
