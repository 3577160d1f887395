// SPDX-License-Identifier: Apache-2.0
// The filters of the kernel may leave a question open, but never answer it wrongly.
#include "delaunay/face_tests.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "unit/predicates/reference.hpp"

namespace delfront {
namespace {

using reference::integer;
using reference::Random;
using reference::uniform;

constexpr unsigned kSeed = 20240613;

/// A tet, the apexes over its faces, and a point.
struct Case {
  TetVertex tet[4], apex[4], at;
  double min_distance2;
};

/// Nine points of one of the reference's kinds (three draws that share no parameters would not be near-degenerate
/// together, so points of later draws are often replaced by one near an earlier one).
Case some_case(Random& random, int n) {
  std::vector<Point> p = reference::some_points(random, n % reference::kNumKinds);
  const double scale = std::ldexp(1.0, n % 7 == 0 ? integer(random, -250, 90) : 0);
  while (p.size() < 9) {
    const Point& near = p[static_cast<std::size_t>(integer(random, 0, 4))];
    switch (integer(random, 0, 3)) {
      case 0:
        p.push_back(near);
        break;
      case 1:  // mirrored at the middle of two others: near-coplanar and near-cospherical with them
        p.push_back(p[static_cast<std::size_t>(integer(random, 0, 4))] + p[4] - near);
        break;
      case 2:
        p.push_back(reference::nudged(random, near, 8));
        break;
      default:
        p.push_back({near.x, p[1].y, p[2].z});  // a corner of a box
    }
  }
  for (Point& q : p)
    if (integer(random, 0, 5) == 0) q = q + std::ldexp(1.0, -integer(random, 40, 55)) * reference::random_point(random);
  Case c;
  const auto vertex = [&](const Point& q) { return TetVertex{scale * q.x, scale * q.y, scale * q.z, uniform(random)}; };
  for (std::size_t i = 0; i < 4; ++i) c.tet[i] = vertex(p[i]), c.apex[i] = vertex(p[5 + i]);
  c.at = vertex(p[4]);
  c.min_distance2 = scale * scale * uniform(random, 0, 1);
  return c;
}

FaceTests run_twofold(const Case& c) {
  const TetVertex* const v[4] = {&c.tet[0], &c.tet[1], &c.tet[2], &c.tet[3]};
  const TetVertex* const w[4] = {&c.apex[0], &c.apex[1], &c.apex[2], &c.apex[3]};
  return test_faces_twofold(v, w, c.at);
}

FaceTests run(const Case& c) {
  const TetVertex* const v[4] = {&c.tet[0], &c.tet[1], &c.tet[2], &c.tet[3]};
  const TetVertex* const w[4] = {&c.apex[0], &c.apex[1], &c.apex[2], &c.apex[3]};
  const FaceTests tests = test_faces<true>(v, w, c.at, c.min_distance2);
  const FaceTests sides = test_sides(v, c.at);
  EXPECT_EQ(sides.seen, tests.seen);
  EXPECT_EQ(sides.unseen, tests.unseen);
  return tests;
}

TEST(FaceTests, never_wrong_where_they_claim_to_be_sure) {
  Random random(kSeed);
  long sure = 0, open = 0, open_sides = 0;
  for (int n = 0; n < 1'000'000; ++n) {
    const Case c = some_case(random, n);
    const FaceTests tests = run(c);
    ASSERT_EQ(tests.inside & tests.outside, 0u);
    ASSERT_EQ(tests.seen & tests.unseen, 0u);
    const Point p = c.at.point();
    for (unsigned f = 0; f < 4; ++f) {
      const Point x = c.tet[kFaceNodes[f][0]].point(), y = c.tet[kFaceNodes[f][1]].point(),
                  z = c.tet[kFaceNodes[f][2]].point(), w = c.apex[f].point();
      const bool is_sure = (tests.inside | tests.outside) >> f & 1, is_side_sure = (tests.seen | tests.unseen) >> f & 1;
      (is_sure ? sure : open) += 1;
      open_sides += !is_side_sure;
      if (is_sure) {
        const int exact = detail::insphere_exact(x, z, y, w, p);
        ASSERT_EQ(exact, tests.inside >> f & 1 ? 1 : -1) << "seed " << kSeed << " case " << n << " face " << f;
      }
      if (is_side_sure) {
        const int exact = detail::orient3d_exact(x, y, z, p);
        ASSERT_EQ(exact, tests.seen >> f & 1 ? 1 : -1) << "seed " << kSeed << " case " << n << " face " << f;
      }
    }
  }
  EXPECT_GT(sure, 1'000'000);
  EXPECT_GT(open, 200'000);
  EXPECT_GT(open_sides, 200'000);
}

TEST(FaceTests, in_twofold_precision_are_never_wrong_and_know_ties) {
  Random random(kSeed + 3);
  long sure = 0, open = 0, ties = 0, unseen = 0;
  for (int n = 0; n < 1'000'000; ++n) {
    const Case c = some_case(random, n);
    const FaceTests tests = run_twofold(c);
    ASSERT_EQ((tests.inside & tests.outside) | (tests.tie & (tests.inside | tests.outside)), 0u);
    ASSERT_EQ(tests.seen & tests.unseen, 0u);
    ASSERT_LT(tests.inside | tests.outside | tests.tie | tests.seen | tests.unseen, 16u);
    const Point p = c.at.point();
    for (unsigned f = 0; f < 4; ++f) {
      const Point x = c.tet[kFaceNodes[f][0]].point(), y = c.tet[kFaceNodes[f][1]].point(),
                  z = c.tet[kFaceNodes[f][2]].point(), w = c.apex[f].point();
      const int power = detail::insphere_exact(x, z, y, w, p), side = detail::orient3d_exact(x, y, z, p);
      const unsigned bit = 1u << f;
      if (tests.inside & bit) {
        ASSERT_EQ(power, 1) << "seed " << kSeed + 3 << " case " << n << " face " << f;
      }
      if (tests.outside & bit) {
        ASSERT_EQ(power, -1) << "seed " << kSeed + 3 << " case " << n << " face " << f;
      }
      if (tests.tie & bit) {
        ASSERT_EQ(power, 0) << "seed " << kSeed + 3 << " case " << n << " face " << f;
      }
      if (tests.seen & bit) {
        ASSERT_EQ(side, 1) << "seed " << kSeed + 3 << " case " << n << " face " << f;
      }
      if (tests.unseen & bit) {
        ASSERT_LE(side, 0) << "seed " << kSeed + 3 << " case " << n << " face " << f;
      }
      ((tests.inside | tests.outside | tests.tie) & bit ? sure : open) += 1;
      ties += (tests.tie & bit) != 0;
      unseen += (tests.unseen & bit) && side == 0;
    }
  }
  if (!kHasTwofoldTests) {  // without a fused multiplication everything is left to the exact predicates
    EXPECT_EQ(sure, 0);
    return;
  }
  EXPECT_GT(sure, 2'500'000);  // the others: ties and near-ties off any lattice, of which these cases are full
  EXPECT_GT(open, 100'000);
  EXPECT_GT(ties, 100'000);
  EXPECT_GT(unseen, 50'000);
}

TEST(FaceTests, decide_nearly_everything_of_random_tets) {
  Random random(kSeed + 1);
  int open = 0;
  for (int n = 0; n < 100'000; ++n) {
    Case c{};
    for (TetVertex* v :
         {&c.tet[0], &c.tet[1], &c.tet[2], &c.tet[3], &c.apex[0], &c.apex[1], &c.apex[2], &c.apex[3], &c.at})
      *v = {uniform(random), uniform(random), uniform(random), 0};
    const FaceTests tests = run(c);
    open += ((tests.inside | tests.outside) & (tests.seen | tests.unseen)) != 15;
    const double min_distance2 = c.min_distance2;
    for (unsigned f = 0; f < 4; ++f)
      EXPECT_EQ(tests.close >> f & 1, squared_length(c.apex[f].point() - c.at.point()) < min_distance2 ? 1u : 0u);
  }
  EXPECT_LT(open, 20);
}

/// The rounding error itself, of the same operations in the same order, against a hundred digits.
TEST(FaceTests, rounding_error_stays_below_the_bound) {
  using Float = boost::multiprecision::cpp_bin_float_100;
  using lanes::Vector;
  Random random(kSeed + 2);
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    Case c = some_case(random, n % 2 == 0 ? 4 : 2);
    reference::Vector<Float> q[4], w[4];
    double extent[3] = {}, lift = 0;
    const auto relative = [&](const TetVertex& v) {
      const double d[3] = {v.x - c.at.x, v.y - c.at.y, v.z - c.at.z};
      for (int k = 0; k < 3; ++k) extent[k] = std::max(extent[k], std::fabs(d[k]));
      lift = std::max(lift, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      return reference::Vector<Float>{Float(v.x) - c.at.x, Float(v.y) - c.at.y, Float(v.z) - c.at.z};
    };
    for (int i = 0; i < 4; ++i) q[i] = relative(c.tet[i]), w[i] = relative(c.apex[i]);
    // face 0 by the formula of face_tests.hpp, scalar
    const auto d = [&](const TetVertex& v) { return v.point() - c.at.point(); };
    const Point a = d(c.tet[1]), b = d(c.tet[2]), e = d(c.tet[3]), apex = d(c.apex[0]);
    const double la = a.x * a.x + a.y * a.y + a.z * a.z, lb = b.x * b.x + b.y * b.y + b.z * b.z,
                 le = e.x * e.x + e.y * e.y + e.z * e.z, lw = apex.x * apex.x + apex.y * apex.y + apex.z * apex.z;
    const Point be = cross(b, e), ae = cross(a, e), ab = cross(a, b);
    const double m = a.x * be.x + a.y * be.y + a.z * be.z;
    const double qx = la * be.x - lb * ae.x + le * ab.x, qy = la * be.y - lb * ae.y + le * ab.y,
                 qz = la * be.z - lb * ae.z + le * ab.z;
    const double power = m * lw - (qx * apex.x + qy * apex.y + qz * apex.z);
    using reference::det3, reference::squared;
    const Float exact = squared(w[0]) * det3(q[1], q[2], q[3]) - squared(q[1]) * det3(w[0], q[2], q[3]) +
                        squared(q[2]) * det3(w[0], q[1], q[3]) - squared(q[3]) * det3(w[0], q[1], q[2]);
    const double size = extent[0] * extent[1] * extent[2] * lift;
    if (size > 0) worst = std::max(worst, std::fabs(static_cast<double>(exact - power)) / size);
  }
  EXPECT_LT(worst, lanes::kInsphereFaceBound);
  EXPECT_GT(worst, 0.002 * lanes::kInsphereFaceBound);  // the comparison does see rounding errors
}

#ifdef DELFRONT_HAS_TWOFOLD
/// The same in twofold precision, with exact differences in one double and in two.
TEST(FaceTests, twofold_rounding_error_stays_below_the_bound) {
  using Float = boost::multiprecision::cpp_bin_float_100;
  using namespace lanes;
  Random random(kSeed + 4);
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    const Case c = some_case(random, n % 2 == 0 ? 4 : 2);
    const TetVertex* const v[4] = {&c.tet[0], &c.tet[1], &c.tet[2], &c.tet[3]};
    const TetVertex* const w[4] = {&c.apex[0], &c.apex[1], &c.apex[2], &c.apex[3]};
    Four<Twofold> corner, apex;
    const bool is_corner_short = exact_relative(v, load(c.at), corner),
               is_short = exact_relative(w, load(c.at), apex) && is_corner_short;
    const Extent e = extent_of(extent_of(rounded(corner)), rounded(apex));
    Twofold power;
    if (is_short) {
      power = powers_of(corners_of(narrowed(corner)), narrowed(apex));
    } else {
      corner.lift = corner.x * corner.x + corner.y * corner.y + corner.z * corner.z;
      apex.lift = apex.x * apex.x + apex.y * apex.y + apex.z * apex.z;
      power = powers_of(corners_of(corner), apex);
    }
    const auto relative_to_p = [&](const TetVertex& at) {
      return reference::Vector<Float>{Float(at.x) - c.at.x, Float(at.y) - c.at.y, Float(at.z) - c.at.z};
    };
    const auto q1 = relative_to_p(c.tet[1]), q2 = relative_to_p(c.tet[2]), q3 = relative_to_p(c.tet[3]),
               w0 = relative_to_p(c.apex[0]);
    using reference::det3, reference::squared;
    const Float exact = squared(w0) * det3(q1, q2, q3) - squared(q1) * det3(w0, q2, q3) +
                        squared(q2) * det3(w0, q1, q3) - squared(q3) * det3(w0, q1, q2);
    const double size = e.x[0] * e.y[0] * e.z[0] * e.lift[0];
    const Float error = exact - Float(power.high[0]) - Float(power.low[0]);
    if (size > 0) worst = std::max(worst, std::fabs(static_cast<double>(error)) / size);
  }
  EXPECT_LT(worst, kTwofoldInsphereBound);
  EXPECT_GT(worst, 1e-4 * kTwofoldInsphereBound);  // the comparison does see rounding errors
}
#endif

}  // namespace
}  // namespace delfront
