// SPDX-License-Identifier: Apache-2.0
#include "predicates/predicates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "unit/predicates/reference.hpp"

namespace delfront {
namespace {

using reference::integer;
using reference::kNumKinds;
using reference::Random;
using reference::some_points;
using reference::uniform;

constexpr unsigned kSeed = 20240607;

TEST(Predicates, signs_follow_the_conventions) {
  const Point a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};
  EXPECT_EQ(orient3d(a, b, c, d), 1);
  EXPECT_EQ(orient3d(a, c, b, d), -1);
  EXPECT_EQ(insphere(a, b, c, d, Point{0.5, 0.5, 0.5}), 1);
  EXPECT_EQ(insphere(a, b, c, d, Point{2, 2, 2}), -1);
  EXPECT_EQ(insphere(a, b, c, d, Point{1, 1, 1}), 0);
  EXPECT_EQ(orient2d(&a.x, &b.x, &c.x), 1);
  const Point inside{0.5, 0.5, 0}, on{1, 1, 0}, outside{1, 1.5, 0};
  EXPECT_EQ(incircle(&a.x, &b.x, &c.x, &inside.x), 1);
  EXPECT_EQ(incircle(&a.x, &b.x, &c.x, &on.x), 0);
  EXPECT_EQ(incircle(&a.x, &b.x, &c.x, &outside.x), -1);
  EXPECT_EQ(dot_sign(a, b, c), 0);
  EXPECT_EQ(dot_sign(a, b, Point{0.1, 5, 5}), 1);
  EXPECT_EQ(compare_xyz(a, b), -1);
  EXPECT_EQ(compare_xyz(d, a), 1);
  EXPECT_EQ(compare_xyz(c, c), 0);
}

TEST(Predicates, agree_with_arbitrary_precision) {
  Random random(kSeed);
  int num_cospherical = 0;
  for (int n = 0; n < 120000; ++n) {
    const auto p = some_points(random, n % kNumKinds);
    const auto exact = reference::integers(p);
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " case " << n);
    ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3]), reference::orient3d(exact));
    ASSERT_EQ(orient3d(p[0], p[1], p[2], p[4]),
              reference::orient3d<reference::Integer>({exact[0], exact[1], exact[2], exact[4]}));
    const int sphere = reference::insphere(exact);
    ASSERT_EQ(insphere(p[0], p[1], p[2], p[3], p[4]), sphere);
    num_cospherical += sphere == 0 && reference::orient3d(exact) != 0;
    ASSERT_EQ(orient2d(&p[0].x, &p[1].x, &p[4].x),
              reference::orient2d<reference::Integer>({exact[0], exact[1], exact[4]}));
    ASSERT_EQ(incircle(&p[0].x, &p[1].x, &p[2].x, &p[3].x), reference::incircle(exact));
    const auto b = reference::minus(exact[1], exact[0]), c = reference::minus(exact[4], exact[0]);
    ASSERT_EQ(dot_sign(p[0], p[1], p[4]),
              reference::sign_of(reference::Integer(b[0] * c[0] + b[1] * c[1] + b[2] * c[2])));
  }
  EXPECT_GT(num_cospherical, 5000);
}

// The exact layer on its own, where the filter would have answered: same sign.
TEST(Predicates, filter_agrees_with_the_exact_layer_near_degeneracy) {
  Random random(kSeed + 1);
  constexpr int kNearlyDegenerate[] = {2, 4, 5, 6, 7, 9};
  int decided = 0;
  for (int n = 0; n < 1000000; ++n) {
    auto p = some_points(random, kNearlyDegenerate[n % 6]);
    // Step off the degenerate place by 2^-55 … 2^-40, where the filter just begins to decide.
    const double step = std::ldexp(1.0, -integer(random, 40, 55));
    p[n % 5] = p[n % 5] + step * reference::random_point(random);
    const int o = orient3d(p[0], p[1], p[2], p[3]), s = insphere(p[0], p[1], p[2], p[3], p[4]);
    ASSERT_EQ(o, detail::orient3d_exact(p[0], p[1], p[2], p[3])) << "seed " << kSeed + 1 << " case " << n;
    ASSERT_EQ(s, detail::insphere_exact(p[0], p[1], p[2], p[3], p[4])) << "seed " << kSeed + 1 << " case " << n;
    const auto v = detail::evaluate_insphere(p[0], p[1], p[2], p[3], p[4]);
    decided += std::fabs(v.det) > detail::kInsphereBound * v.x * v.y * v.z * v.lift;
  }
  EXPECT_GT(decided, 100000);  // else the test would have compared the exact layer with itself
  EXPECT_LT(decided, 900000);
}

TEST(Predicates, rounding_error_stays_below_the_filter_bound) {
  using Float = boost::multiprecision::cpp_bin_float_100;
  const auto exact = [](const std::vector<Point>& p) {
    std::vector<reference::Vector<Float>> out;
    for (const Point& q : p) out.push_back({Float(q.x), Float(q.y), Float(q.z)});
    return out;
  };
  Random random(kSeed + 2);
  constexpr int kTried[] = {0, 2, 4, 9};
  double worst_orient = 0, worst_sphere = 0;
  for (int n = 0; n < 20000; ++n) {
    const auto p = some_points(random, kTried[n % 4]);
    const auto q = exact(p);
    using reference::det3, reference::minus, reference::squared;
    const auto o = detail::evaluate_orient3d(p[0], p[1], p[2], p[3]);
    const Float orient = det3(minus(q[1], q[0]), minus(q[2], q[0]), minus(q[3], q[0]));
    if (o.x * o.y * o.z > 0)
      worst_orient = std::max(worst_orient, std::fabs(static_cast<double>(orient - o.det)) / (o.x * o.y * o.z));
    const auto s = detail::evaluate_insphere(p[0], p[1], p[2], p[3], p[4]);
    const auto b = minus(q[1], q[0]), c = minus(q[2], q[0]), d = minus(q[3], q[0]), e = minus(q[4], q[0]);
    const Float sphere = squared(d) * det3(b, c, e) + squared(b) * det3(c, d, e) - squared(e) * det3(b, c, d) -
                         squared(c) * det3(b, d, e);
    const double extent = s.x * s.y * s.z * s.lift;
    if (extent > 0) worst_sphere = std::max(worst_sphere, std::fabs(static_cast<double>(sphere - s.det)) / extent);
  }
  EXPECT_LT(worst_orient, detail::kOrient3dBound);
  EXPECT_LT(worst_sphere, detail::kInsphereBound);
  EXPECT_GT(worst_orient, 0.01 * detail::kOrient3dBound);  // the comparison does see rounding errors
  EXPECT_GT(worst_sphere, 0.005 * detail::kInsphereBound);
}

TEST(Predicates, no_sign_is_lost_to_underflow_or_size) {
  for (const int bits : {-1000, -500, -200, -100, 0, 98}) {
    const double s = std::ldexp(1.0, bits);
    const Point a{0, 0, 0}, b{s, 0, 0}, c{0, s, 0}, d{0, 0, s};
    EXPECT_EQ(orient3d(a, b, c, d), 1) << bits;
    EXPECT_EQ(insphere(a, b, c, d, Point{s / 2, s / 2, s / 2}), 1) << bits;
    EXPECT_EQ(insphere(a, b, c, d, Point{s, s, s}), 0) << bits;
    EXPECT_EQ(insphere(a, b, c, d, Point{s, s, s * (1 + 0x1p-52)}), -1) << bits;
    EXPECT_EQ(incircle(&a.x, &b.x, &c.x, &d.x), 0) << bits;
    EXPECT_EQ(dot_sign(a, Point{s, s, s}, Point{s, -s, 0x1p-1074}), 1) << bits;
  }
  const double tiny = 0x1p-1074;
  EXPECT_EQ(orient3d(Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{0.25, 0.25, tiny}), 1);
  EXPECT_EQ(orient3d(Point{0, 0, 0}, Point{1, 0, tiny}, Point{0, 1, tiny}, Point{0.5, 0.5, tiny}), 0);
}

int parity(const std::array<int, 5>& order) {
  int sign = 1;
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = i + 1; j < 5; ++j)
      if (order[i] > order[j]) sign = -sign;
  return sign;
}

TEST(Predicates, perturbed_insphere_is_antisymmetric_and_never_zero) {
  Random random(kSeed + 3);
  for (int n = 0; n < 1200; ++n) {
    const auto p = some_points(random, n % kNumKinds);
    SCOPED_TRACE(testing::Message() << "seed " << kSeed + 3 << " case " << n);
    const int sign = insphere_perturbed(p[0], p[1], p[2], p[3], p[4]);
    const int exact = insphere(p[0], p[1], p[2], p[3], p[4]);
    ASSERT_EQ(exact == 0 ? sign : exact, sign);
    bool distinct = true, coplanar = true;
    for (int i = 0; i < 5; ++i) {
      const Point &a = p[(i + 1) % 5], &b = p[(i + 2) % 5], &c = p[(i + 3) % 5], &d = p[(i + 4) % 5];
      coplanar &= orient3d(a, b, c, d) == 0;
      distinct &= p[i] != a && p[i] != b;
    }
    if (!distinct) continue;
    ASSERT_EQ(sign == 0, coplanar);
    std::array<int, 5> order = {0, 1, 2, 3, 4};
    do {  // the determinant is antisymmetric in all five rows
      const int permuted = insphere_perturbed(p[order[0]], p[order[1]], p[order[2]], p[order[3]], p[order[4]]);
      ASSERT_EQ(permuted, parity(order) * sign);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST(Predicates, orient3d_is_antisymmetric) {
  Random random(kSeed + 4);
  for (int n = 0; n < 5000; ++n) {
    const auto p = some_points(random, n % kNumKinds);
    std::array<int, 5> order = {0, 1, 2, 3, 4};
    const int sign = orient3d(p[0], p[1], p[2], p[3]);
    do ASSERT_EQ(orient3d(p[order[0]], p[order[1]], p[order[2]], p[order[3]]), parity(order) * sign);
    while (std::next_permutation(order.begin(), order.begin() + 4));
  }
}

/// @brief Six times the volumes of all tets whose perturbed sphere holds no other point, by trying all of them.
template <class AnyPoint>
double volume_of_empty_tets(const std::vector<AnyPoint>& p, const std::vector<Point>& at) {
  double volume = 0;
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k)
        for (std::size_t l = k + 1; l < n; ++l) {
          const int sign = orient3d(p[i], p[j], p[k], p[l]);
          bool is_empty = sign != 0;
          for (std::size_t m = 0; m < n && is_empty; ++m)
            if (m != i && m != j && m != k && m != l)
              is_empty = sign * insphere_perturbed(p[i], p[j], p[k], p[l], p[m]) < 0;
          if (is_empty) volume += std::fabs(dot(at[j] - at[i], cross(at[k] - at[i], at[l] - at[i])));
        }
  return volume;
}

std::vector<Point> lattice(int n) {
  std::vector<Point> points;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k <= n; ++k) points.push_back({double(i), double(j), double(k)});
  return points;
}

TEST(Predicates, perturbed_delaunay_of_a_lattice_fills_it_once) {
  for (const int n : {1, 2}) {
    std::vector<Point> points = lattice(n);
    EXPECT_EQ(volume_of_empty_tets(points, points), 6.0 * n * n * n);
    std::shuffle(points.begin(), points.end(), Random(kSeed));  // no dependence on numbering
    EXPECT_EQ(volume_of_empty_tets(points, points), 6.0 * n * n * n);
  }
}

TEST(Predicates, perturbed_delaunay_of_a_lattice_of_segment_points_fills_it_once) {
  Random random(kSeed + 5);
  const std::vector<Point> points = lattice(2);
  std::vector<ExactPoint> exact;
  for (const Point& p : points) {
    const Point v = reference::lattice_point(random, 4) + Point{1, 0, 0};
    exact.push_back(integer(random, 0, 1) ? ExactPoint::explicit_point(p)
                                          : ExactPoint::on_segment(p - v, p + 3.0 * v, 0.25));
  }
  EXPECT_EQ(volume_of_empty_tets(exact, points), 48.0);
}

}  // namespace
}  // namespace delfront
