// SPDX-License-Identifier: Apache-2.0
// The in-sphere determinant with other lifts: a semi-static filter, then integers of the least width that holds the
// coordinates' differences; weights stand at the square of the coordinates' scale.
//
// Error bound of the filter, in the notation of predicates_inline.hpp. Let L be the largest computed |p - e|^2 and W
// the largest computed |w_p - w_e|. |p - e|^2 is wrong by 5u L, the difference of weights by u W, their difference is
// rounded by u (L + W): at most 6u M in all with M = L + W, which also bounds the lift itself. 3x3 minors 46u XYZ, at
// most 6XYZ. Times a lift: 46u + 36u + 6u = 88u, at most 6XYZM. Sum of four in pairs: 352u + 2 * 12u + 24u = 400u XYZM.
// Two more pay for second order terms and the bound's own rounding.
// Underflow: with |x| <= 2^100 and |w| <= 2^200 the lifts are below 2^204, so a product that underflows (2^-1075) costs
// at most 4 * 3 * 2 * 2^(-1075 + 101 + 204) by the minors and 4 * 3 * 2^-1075 * 6 * 2^303 by the lifts, together less
// than 2^-764; kTinyInsphere is more.
#include "predicates/power.hpp"

#include "predicates/load_exact.hpp"

namespace delfront {
namespace detail {

PowerEvaluation evaluate_power(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c,
                               const WeightedPoint& d, const WeightedPoint& e) {
  const WeightedPoint* const p[4] = {&a, &b, &c, &d};
  double x[4], y[4], z[4], lift[4];
  PowerEvaluation v{};
  double largest_square = 0, largest_weight = 0;
  for (int i = 0; i < 4; ++i) {
    x[i] = p[i]->at.x - e.at.x, y[i] = p[i]->at.y - e.at.y, z[i] = p[i]->at.z - e.at.z;
    const double square = x[i] * x[i] + y[i] * y[i] + z[i] * z[i], weight = p[i]->weight - e.weight;
    lift[i] = square - weight;
    v.x = std::max(v.x, std::fabs(x[i]));
    v.y = std::max(v.y, std::fabs(y[i]));
    v.z = std::max(v.z, std::fabs(z[i]));
    largest_square = std::max(largest_square, square);
    largest_weight = std::max(largest_weight, std::fabs(weight));
  }
  v.lift = largest_square + largest_weight;
  const auto minor = [&](int i, int j) { return x[i] * y[j] - x[j] * y[i]; };
  const double ab = minor(0, 1), bc = minor(1, 2), cd = minor(2, 3), da = minor(3, 0), ac = minor(0, 2),
               bd = minor(1, 3);
  const double abc = z[0] * bc - z[1] * ac + z[2] * ab, bcd = z[1] * cd - z[2] * bd + z[3] * bc;
  const double cda = z[2] * da + z[3] * ac + z[0] * cd, dab = z[3] * ab + z[0] * bd + z[1] * da;
  v.det = (lift[0] * bcd - lift[1] * cda) + (lift[2] * dab - lift[3] * abc);
  return v;
}

namespace {

/// Coordinates in units of 2^low, weights in units of 4^low.
template <int L>
int power_sign_at(const WeightedPoint* const (&p)[5], int low) {
  FixedInt<L> rows[4][3];
  FixedInt<2 * L> lifts[4];
  const FixedInt<2 * L> weight_e = scaled<2 * L>(p[4]->weight, 2 * low);
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) rows[i][k] = scaled<L>(p[i]->at[k], low) - scaled<L>(p[4]->at[k], low);
    lifts[i] = lift(rows[i], 3) - (scaled<2 * L>(p[i]->weight, 2 * low) - weight_e);
  }
  return lifted_sign(rows, lifts[0], lifts[1], lifts[2], lifts[3]);
}

int half_down(int x) { return x >= 0 ? x / 2 : -((1 - x) / 2); }

}  // namespace

/// Differences of weights stay below 2^(2 bits), those of coordinates below 2^bits with bits <= 64 L - 3, so lifts are
/// at most 4 * 2^(128 L - 6) and the determinant 4 * 6 * 4 * 2^(320 L - 15) < 2^(320 L - 1): nothing wraps. From 2^1024
/// down to 2^-1074 is 2099 bits, so 50 limbs always do.
int power_exact(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                const WeightedPoint& e) {
  const WeightedPoint* const p[5] = {&a, &b, &c, &d, &e};
  BinaryRange place, weight;
  for (const WeightedPoint* q : p) {
    for (int k = 0; k < 3; ++k) place.add(q->at[k]);
    weight.add(q->weight);
  }
  if (place.high < place.low) return 0;  // all at the origin
  int low = place.low, bits = place.difference_bits();
  if (weight.high >= weight.low) {
    low = std::min(low, half_down(weight.low));
    bits = std::max(place.high - low + 1, half_down(weight.high - 2 * low + 2));
  }
  if (bits <= max_bits(1)) return power_sign_at<1>(p, low);
  if (bits <= max_bits(2)) return power_sign_at<2>(p, low);
  if (bits <= max_bits(5)) return power_sign_at<5>(p, low);
  return power_sign_at<50>(p, low);
}

}  // namespace detail

int power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
               const WeightedPoint& e) {
  const detail::PowerEvaluation v = detail::evaluate_power(a, b, c, d, e);
  const double bound = detail::kPowerBound * v.x * v.y * v.z * v.lift + detail::kTinyInsphere;
  if (std::fabs(v.det) > bound) return v.det > 0 ? 1 : -1;
  return detail::power_exact(a, b, c, d, e);
}

int power_test_perturbed(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                         const WeightedPoint& e) {
  const int sign = power_test(a, b, c, d, e);
  return sign != 0 ? sign : detail::insphere_tie(a.at, b.at, c.at, d.at, e.at);
}

}  // namespace delfront
