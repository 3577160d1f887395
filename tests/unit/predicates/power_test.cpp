// SPDX-License-Identifier: Apache-2.0
#include "predicates/power.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "unit/predicates/reference.hpp"

namespace delfront {
namespace {

using reference::integer;
using reference::Random;
using reference::Rational;
using reference::uniform;

constexpr unsigned kSeed = 20240611;

/// By fractions, with differences to the first point, expanded along the lift.
int reference_power(const std::vector<WeightedPoint>& p) {
  std::vector<reference::Vector<Rational>> at;
  std::vector<Rational> lift;
  for (const WeightedPoint& q : p) at.push_back(reference::rational(q.at));
  for (std::size_t i = 0; i < 5; ++i)
    lift.push_back(reference::squared(reference::minus(at[i], at[0])) - reference::rational(p[i].weight) +
                   reference::rational(p[0].weight));
  const auto b = reference::minus(at[1], at[0]), c = reference::minus(at[2], at[0]), d = reference::minus(at[3], at[0]),
             e = reference::minus(at[4], at[0]);
  using reference::det3;
  const Rational det =
      lift[4] * det3(b, c, d) - lift[3] * det3(b, c, e) + lift[2] * det3(b, d, e) - lift[1] * det3(c, d, e);
  return -reference::sign_of(det);
}

/// Kinds: no weights, equal, random, that put all lifted points on (or next to) one hyperplane, of any size.
std::vector<WeightedPoint> some_weighted(Random& random, int n) {
  const auto points = reference::some_points(random, n % reference::kNumKinds);
  std::vector<WeightedPoint> p;
  const double equal = uniform(random);
  const Point slope{double(integer(random, -3, 3)), double(integer(random, -3, 3)), 0.5};
  for (const Point& q : points) {
    double weight = 0;
    switch (integer(random, 0, 9) == 0 ? 2 : n / reference::kNumKinds % 5) {
      case 0:
        break;
      case 1:
        weight = equal;
        break;
      case 2:
        weight = uniform(random);
        break;
      case 3:
        weight = squared_length(q) - dot(slope, q);
        break;
      default:
        weight = std::ldexp(uniform(random), integer(random, -300, 190));
    }
    p.push_back({q, weight});
  }
  return p;
}

TEST(PowerTest, signs_follow_the_conventions) {
  const WeightedPoint a{{0, 0, 0}}, b{{1, 0, 0}}, c{{0, 1, 0}}, d{{0, 0, 1}};
  const Point centre{0.5, 0.5, 0.5};  // of the circumsphere, whose squared radius is 3/4
  EXPECT_EQ(power_test(a, b, c, d, {centre, 0}), 1);
  EXPECT_EQ(power_test(a, b, c, d, {centre, -0.75}), 0);
  EXPECT_EQ(power_test(a, b, c, d, {centre, -0.75 - 0x1p-52}), -1);
  EXPECT_EQ(power_test(a, b, c, d, {{1, 1, 1}, 0}), 0);
  EXPECT_EQ(power_test(a, b, c, d, {{1, 1, 1}, 0x1p-1074}), 1);
  EXPECT_EQ(power_test(a, b, c, d, {{2, 2, 2}, 5}), -1);
  EXPECT_EQ(power_test(a, b, c, d, {{2, 2, 2}, 6}), 0);
  EXPECT_EQ(power_test(a, b, c, d, {{2, 2, 2}, 6.5}), 1);
  EXPECT_EQ(power_test(b, a, c, d, {centre, 0}), -1);
}

TEST(PowerTest, agrees_with_fractions) {
  Random random(kSeed);
  int zeros = 0, big = 0;
  for (int n = 0; n < 40000; ++n) {
    const auto p = some_weighted(random, n);
    const int sign = power_test(p[0], p[1], p[2], p[3], p[4]);
    ASSERT_EQ(sign, reference_power(p)) << "seed " << kSeed << " case " << n;
    ASSERT_EQ(sign, detail::power_exact(p[0], p[1], p[2], p[3], p[4])) << "seed " << kSeed << " case " << n;
    zeros += sign == 0 && orient3d(p[0].at, p[1].at, p[2].at, p[3].at) != 0;
    big += std::fabs(p[4].weight) > 1e30;
  }
  EXPECT_GT(zeros, 500);
  EXPECT_GT(big, 500);
}

TEST(PowerTest, filter_agrees_with_the_exact_layer_where_it_begins_to_decide) {
  Random random(kSeed + 1);
  int decided = 0;
  for (int n = 0; n < 300000; ++n) {
    auto p = some_weighted(random, n);
    p[4].weight += std::ldexp(uniform(random), -integer(random, 35, 56));
    const auto v = detail::evaluate_power(p[0], p[1], p[2], p[3], p[4]);
    if (!(std::fabs(v.det) > detail::kPowerBound * v.x * v.y * v.z * v.lift + detail::kTinyInsphere)) continue;
    ++decided;
    ASSERT_EQ(v.det > 0 ? 1 : -1, detail::power_exact(p[0], p[1], p[2], p[3], p[4]))
        << "seed " << kSeed + 1 << " case " << n;
  }
  EXPECT_GT(decided, 50000);
  EXPECT_LT(decided, 280000);
}

TEST(PowerTest, is_the_in_sphere_test_where_weights_are_equal) {
  Random random(kSeed + 2);
  for (int n = 0; n < 20000; ++n) {
    const auto p = reference::some_points(random, n % reference::kNumKinds);
    const double w = n % 3 == 0 ? 0 : uniform(random, -10, 10);
    ASSERT_EQ(power_test_perturbed({p[0], w}, {p[1], w}, {p[2], w}, {p[3], w}, {p[4], w}),
              insphere_perturbed(p[0], p[1], p[2], p[3], p[4]))
        << "seed " << kSeed + 2 << " case " << n;
  }
}

TEST(PowerTest, ties_are_decided_and_antisymmetric) {
  Random random(kSeed + 3);
  int ties = 0;
  for (int n = 0; n < 3000; ++n) {
    std::vector<WeightedPoint> p;
    for (int i = 0; i < 5; ++i) {
      const Point q = reference::lattice_point(random, 3);
      p.push_back({q, squared_length(q) - q.x + 2 * q.y});  // all on one hyperplane
    }
    if (orient3d(p[0].at, p[1].at, p[2].at, p[3].at) == 0) continue;
    if (std::any_of(p.begin(), p.end() - 1, [&](auto& q) { return q.at == p[4].at; })) continue;
    ++ties;
    const int sign = power_test_perturbed(p[0], p[1], p[2], p[3], p[4]);
    ASSERT_EQ(power_test(p[0], p[1], p[2], p[3], p[4]), 0);
    ASSERT_NE(sign, 0);
    ASSERT_EQ(power_test_perturbed(p[1], p[0], p[2], p[3], p[4]), -sign);
    ASSERT_EQ(power_test_perturbed(p[4], p[1], p[2], p[3], p[0]), -sign);
    ASSERT_EQ(power_test_perturbed(p[1], p[2], p[0], p[3], p[4]), sign);
  }
  EXPECT_GT(ties, 500);
}

}  // namespace
}  // namespace delfront
