// SPDX-License-Identifier: Apache-2.0
// Predicates on points a + t (b - a), against fractions of arbitrary precision.
#include <gtest/gtest.h>

#include "unit/predicates/reference.hpp"

namespace delfront {
namespace {

using reference::integer;
using reference::Random;
using reference::rational;
using reference::some_points;
using reference::uniform;

constexpr unsigned kSeed = 91;

double some_parameter(Random& random) {
  switch (integer(random, 0, 4)) {
    case 0:
      return 0.5;
    case 1:
      return std::ldexp(double(integer(random, 0, 31) * 2 + 1), -6);
    case 2:
      return 0x1p-40;
    case 3:
      return 1 - 0x1p-53;
    default:
      return uniform(random, 1e-9, 1 - 1e-9);
  }
}

ExactPoint some_exact_point(Random& random, const std::vector<Point>& pool) {
  const auto pick = [&] { return pool[static_cast<std::size_t>(integer(random, 0, int(pool.size()) - 1))]; };
  const Point a = pick(), b = pick();
  if (integer(random, 0, 2) == 0 || a == b) return ExactPoint::explicit_point(a);
  return ExactPoint::on_segment(a, b, some_parameter(random));
}

TEST(SegmentPoints, approximation_is_as_near_as_promised) {
  Random random(kSeed);
  for (int n = 0; n < 12000; ++n) {
    const auto pool = some_points(random, n % reference::kNumKinds);
    const ExactPoint p = ExactPoint::on_segment(pool[0], pool[1], some_parameter(random));
    const auto exact = rational(p);
    for (int k = 0; k < 3; ++k) {
      const reference::Rational error = abs(exact[static_cast<std::size_t>(k)] - rational(p.approx[k]));
      const double size = std::max(std::fabs(p.a[k]), std::fabs(p.b[k]));
      ASSERT_LE(error, rational(kSegmentPointError) * rational(size) + rational(0x1p-1072))
          << "seed " << kSeed << " case " << n;
    }
  }
}

TEST(SegmentPoints, predicates_agree_with_arbitrary_precision) {
  Random random(kSeed + 1);
  int zeros = 0;
  for (int n = 0; n < 6000; ++n) {
    const auto pool = some_points(random, n % reference::kNumKinds);
    ExactPoint p[5];
    std::vector<reference::Vector<reference::Rational>> exact;
    for (ExactPoint& q : p) exact.push_back(rational(q = some_exact_point(random, pool)));
    SCOPED_TRACE(testing::Message() << "seed " << kSeed + 1 << " case " << n);
    ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3]), reference::orient3d(exact));
    const int sphere = reference::insphere(exact);
    ASSERT_EQ(insphere(p[0], p[1], p[2], p[3], p[4]), sphere);
    zeros += sphere == 0;
    ASSERT_EQ(compare_xyz(p[0], p[1]), exact[0] < exact[1] ? -1 : exact[0] > exact[1] ? 1 : 0);
  }
  EXPECT_GT(zeros, 500);
}

TEST(SegmentPoints, equal_places_given_differently_are_equal) {
  Random random(kSeed + 2);
  for (int n = 0; n < 2000; ++n) {
    const Point a = reference::lattice_point(random, 8), v = reference::lattice_point(random, 8) + Point{0, 0, 1};
    const Point b = reference::lattice_point(random, 8), c = reference::lattice_point(random, 8);
    const ExactPoint one = ExactPoint::on_segment(a - v, a + v, 0.5),
                     two = ExactPoint::on_segment(a + v, a - 7.0 * v, 0.125);
    const ExactPoint itself = ExactPoint::explicit_point(a);
    ASSERT_EQ(compare_xyz(one, two), 0) << n;
    ASSERT_EQ(compare_xyz(one, itself), 0) << n;
    const auto b_exact = ExactPoint::explicit_point(b), c_exact = ExactPoint::explicit_point(c);
    ASSERT_EQ(orient3d(one, two, b_exact, c_exact), 0) << n;
    const auto d_exact = ExactPoint::explicit_point(b + Point{1, 2, 4});
    ASSERT_EQ(insphere(one, b_exact, c_exact, d_exact, itself), 0) << n;
  }
}

TEST(SegmentPoints, ends_are_explicit) {
  const Point a{0.1, 0.2, 0.3}, b{0.4, -0.5, 0.6};
  EXPECT_TRUE(ExactPoint::on_segment(a, b, 0).is_explicit());
  EXPECT_EQ(ExactPoint::on_segment(a, b, 0).approx, a);
  EXPECT_EQ(ExactPoint::on_segment(a, b, 1).approx, b);
  EXPECT_FALSE(ExactPoint::on_segment(a, b, 0x1p-1074).is_explicit());
  EXPECT_EQ(compare_xyz(ExactPoint::on_segment(a, b, 0x1p-1074), ExactPoint::explicit_point(a)), 1);
}

TEST(SegmentPoints, points_of_one_segment_are_in_line_and_in_order) {
  Random random(kSeed + 3);
  for (int n = 0; n < 4000; ++n) {
    const Point a = reference::random_point(random), b = reference::random_point(random);
    const auto c = ExactPoint::explicit_point(reference::random_point(random));
    const double s = uniform(random, 0.01, 0.99), t = std::nextafter(s, 1.0);
    const ExactPoint p = ExactPoint::on_segment(a, b, s), q = ExactPoint::on_segment(a, b, t);
    ASSERT_EQ(orient3d(p, q, ExactPoint::explicit_point(a), c), 0) << "seed " << kSeed + 3 << " case " << n;
    ASSERT_EQ(compare_xyz(p, q), compare_xyz(a, b)) << "seed " << kSeed + 3 << " case " << n;
    ASSERT_EQ(compare_xyz(ExactPoint::explicit_point(a), p), compare_xyz(a, b));
  }
}

}  // namespace
}  // namespace delfront
