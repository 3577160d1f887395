// SPDX-License-Identifier: Apache-2.0
// classify_triangles against clipping in fractions of arbitrary precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "unit/predicates/reference.hpp"

namespace delfront {
namespace {

using reference::integer;
using reference::Random;
using reference::Rational;
using RationalPoint = reference::Vector<Rational>;
using Polygon = std::vector<RationalPoint>;

constexpr unsigned kSeed = 4711;

/// @brief A pair of triangles with ids.
struct Pair {
  Point p[3], q[3];
  unsigned p_id[3] = {0, 1, 2}, q_id[3] = {3, 4, 5};

  Crossing classify(Point* where = nullptr) const { return classify_triangles(p, p_id, q, q_id, where); }
  void share(int i, int j) {
    q[j] = p[i];
    q_id[j] = p_id[i];
  }
};

Rational dot_product(const RationalPoint& a, const RationalPoint& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

RationalPoint cross_product(const RationalPoint& a, const RationalPoint& b) {
  return {Rational(a[1] * b[2] - a[2] * b[1]), Rational(a[2] * b[0] - a[0] * b[2]),
          Rational(a[0] * b[1] - a[1] * b[0])};
}

Polygon clipped(const Polygon& in, const RationalPoint& normal, const RationalPoint& origin) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const RationalPoint &a = in[i], &b = in[(i + 1) % in.size()];
    const Rational da = dot_product(normal, reference::minus(a, origin));
    const Rational db = dot_product(normal, reference::minus(b, origin));
    if (da >= 0) out.push_back(a);
    if (da * db < 0) {
      const Rational t = da / (da - db);
      out.push_back(
          {Rational(a[0] + t * (b[0] - a[0])), Rational(a[1] + t * (b[1] - a[1])), Rational(a[2] + t * (b[2] - a[2]))});
    }
  }
  return out;
}

RationalPoint opposite(const RationalPoint& v) { return {Rational(-v[0]), Rational(-v[1]), Rational(-v[2])}; }

RationalPoint normal_of(const Polygon& t) {
  return cross_product(reference::minus(t[1], t[0]), reference::minus(t[2], t[0]));
}
bool is_zero(const RationalPoint& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

/// @brief Half-spaces whose intersection is the triangle, segment or point: clip with each.
Polygon clipped_by_triangle(Polygon polygon, const Polygon& t) {
  const RationalPoint n = normal_of(t);
  if (!is_zero(n)) {
    polygon = clipped(clipped(polygon, n, t[0]), opposite(n), t[0]);
    for (std::size_t e = 0; e < 3; ++e)
      polygon = clipped(polygon, cross_product(n, reference::minus(t[(e + 1) % 3], t[e])), t[e]);
    return polygon;
  }
  const auto [low, high] = std::minmax_element(t.begin(), t.end());
  const RationalPoint d = reference::minus(*high, *low);
  if (is_zero(d)) {
    for (std::size_t k = 0; k < 3; ++k) {
      RationalPoint axis{0, 0, 0};
      axis[k] = 1;
      polygon = clipped(clipped(polygon, axis, *low), opposite(axis), *low);
    }
    return polygon;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    RationalPoint axis{0, 0, 0};
    axis[k] = 1;
    const RationalPoint across = cross_product(d, axis);
    if (!is_zero(across)) polygon = clipped(clipped(polygon, across, *low), opposite(across), *low);
  }
  return clipped(clipped(polygon, d, *low), opposite(d), *high);
}

bool is_in_relative_interior(const RationalPoint& x, const Polygon& t) {
  const RationalPoint n = normal_of(t);
  if (!is_zero(n)) {
    for (std::size_t e = 0; e < 3; ++e) {
      const RationalPoint inward = cross_product(n, reference::minus(t[(e + 1) % 3], t[e]));
      if (dot_product(inward, reference::minus(x, t[e])) <= 0) return false;
    }
    return true;
  }
  const auto [low, high] = std::minmax_element(t.begin(), t.end());
  return *low < x && x < *high;  // x is on the line
}

/// @brief The definition, word by word: clip, compare with the shared corners' hull, look at the interiors.
Crossing classify_reference(const Pair& pair) {
  Polygon p, q, shared;
  for (int i = 0; i < 3; ++i) {
    p.push_back(reference::rational(pair.p[i]));
    q.push_back(reference::rational(pair.q[i]));
    for (int j = 0; j < 3; ++j)
      if (pair.p_id[i] == pair.q_id[j]) shared.push_back(p.back());
  }
  if (shared.size() == 3) return Crossing::overlaps;
  Polygon common = clipped_by_triangle(p, q);
  if (common.empty()) return Crossing::none;
  std::sort(common.begin(), common.end());
  common.erase(std::unique(common.begin(), common.end()), common.end());
  std::sort(shared.begin(), shared.end());
  shared.erase(std::unique(shared.begin(), shared.end()), shared.end());
  RationalPoint centre{0, 0, 0};
  Rational area = 0;
  for (const RationalPoint& x : common)
    for (std::size_t k = 0; k < 3; ++k) centre[k] += x[k] / common.size();
  for (std::size_t i = 2; i < common.size(); ++i)
    area += reference::squared(normal_of({common[0], common[1], common[i]}));
  if (area > 0) return Crossing::overlaps;
  // Without area the hull of the vertices left is that of the least and the greatest.
  common = common.size() > 1 ? Polygon{common.front(), common.back()} : common;
  if (common == shared) return Crossing::none;
  const RationalPoint np = normal_of(p), nq = normal_of(q);
  bool in_one_plane = true;
  for (const RationalPoint& x : q) in_one_plane &= dot_product(np, reference::minus(x, p[0])) == 0;
  if (is_zero(np))
    for (const RationalPoint& x : p) in_one_plane &= dot_product(nq, reference::minus(x, q[0])) == 0;
  if (is_zero(np) && is_zero(nq)) in_one_plane = true;
  if (!in_one_plane && is_in_relative_interior(centre, p) && is_in_relative_interior(centre, q))
    return Crossing::crosses;
  return Crossing::touches;
}

Pair lattice_pair(Random& random, int n) {
  Pair pair;
  for (int i = 0; i < 3; ++i) {
    pair.p[i] = reference::lattice_point(random, n);
    pair.q[i] = reference::lattice_point(random, n);
  }
  const int num_shared = integer(random, 0, 2);
  const int i = integer(random, 0, 2), j = integer(random, 0, 2);
  if (num_shared > 0) pair.share(i, j);
  if (num_shared > 1) pair.share((i + 1) % 3, (j + integer(random, 1, 2)) % 3);
  return pair;
}

std::string text(const Pair& pair) {
  std::ostringstream out;
  for (const auto* t : {&pair.p, &pair.q})
    for (const Point& x : *t) out << "(" << x.x << " " << x.y << " " << x.z << ") ";
  for (const unsigned id : pair.q_id) out << id << " ";
  return out.str();
}

void expect_place_in_both(const Pair& pair, const Point& where) {
  for (const auto* t : {&pair.p, &pair.q}) {
    Box box;
    for (const Point& x : *t) box.add(x);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(where[k], box.low[k] - 1e-9) << text(pair);
      EXPECT_LE(where[k], box.high[k] + 1e-9) << text(pair);
    }
    const Point normal = cross((*t)[1] - (*t)[0], (*t)[2] - (*t)[0]);
    EXPECT_NEAR(dot(normal, where - (*t)[0]), 0, 1e-9) << text(pair);
  }
}

TEST(ClassifyTriangles, agrees_with_clipping_on_small_lattices) {
  Random random(kSeed);
  int counts[4] = {};
  for (int n = 0; n < 16000; ++n) {
    const Pair pair = lattice_pair(random, n % 4 == 3 ? 4 : 2);
    Point where{1e9, 1e9, 1e9};
    const Crossing got = pair.classify(&where);
    ASSERT_EQ(int(got), int(classify_reference(pair))) << "seed " << kSeed << " case " << n << ": " << text(pair);
    if (got != Crossing::none) expect_place_in_both(pair, where);
    ++counts[int(got)];
  }
  for (const int count : counts) EXPECT_GT(count, 400);
}

TEST(ClassifyTriangles, agrees_with_clipping_in_one_plane) {
  Random random(kSeed + 1);
  for (int n = 0; n < 5000; ++n) {
    Pair pair = lattice_pair(random, 3);
    for (auto* t : {&pair.p, &pair.q})  // a plane that leans on every axis, or lies along one
      for (Point& x : *t) x.z = n % 2 ? x.x - 2 * x.y : 1;
    Point where;
    const Crossing got = pair.classify(&where);
    ASSERT_EQ(int(got), int(classify_reference(pair))) << "seed " << kSeed + 1 << " case " << n << ": " << text(pair);
    if (got != Crossing::none) expect_place_in_both(pair, where);
  }
}

TEST(ClassifyTriangles, agrees_with_clipping_off_the_lattice) {
  Random random(kSeed + 2);
  for (int n = 0; n < 3000; ++n) {
    Pair pair = lattice_pair(random, 2);
    for (int i = 0; i < 3; ++i) {
      pair.p[i] = 0.1 * pair.p[i];  // no longer exactly in one plane, nor apart from one another
      pair.q[i] = 0.1 * pair.q[i];
    }
    ASSERT_EQ(int(pair.classify()), int(classify_reference(pair))) << "seed " << kSeed + 2 << " case " << n;
  }
}

TEST(ClassifyTriangles, does_not_depend_on_the_order) {
  Random random(kSeed + 3);
  for (int n = 0; n < 20000; ++n) {
    const Pair pair = lattice_pair(random, 3);
    const Crossing expected = pair.classify();
    Pair turned;
    const int i = integer(random, 0, 2), j = integer(random, 0, 2), flip = integer(random, 1, 2);
    for (int k = 0; k < 3; ++k) {
      turned.p[k] = pair.q[(i + flip * k) % 3];
      turned.p_id[k] = pair.q_id[(i + flip * k) % 3];
      turned.q[k] = pair.p[(j + k) % 3];
      turned.q_id[k] = pair.p_id[(j + k) % 3];
    }
    ASSERT_EQ(int(turned.classify()), int(expected)) << "seed " << kSeed + 3 << " case " << n << ": " << text(pair);
  }
}

TEST(ClassifyTriangles, knows_the_named_cases) {
  const Point a{0, 0, 0}, b{2, 0, 0}, c{0, 2, 0};
  const auto with = [&](Point x, Point y, Point z) { return Pair{{a, b, c}, {x, y, z}}; };
  EXPECT_EQ(with({0.5, 0.5, -1}, {0.5, 0.6, 1}, {0.6, 0.5, 1}).classify(), Crossing::crosses);
  EXPECT_EQ(with({0.5, 0.5, 0}, {0.5, 0.6, 1}, {0.6, 0.5, 1}).classify(), Crossing::touches);  // vertex on face
  EXPECT_EQ(with({1, 0, 0}, {1, -1, 1}, {1, -1, 2}).classify(), Crossing::touches);            // vertex on edge
  EXPECT_EQ(with(a, {0, -1, 1}, {0, -1, 2}).classify(), Crossing::touches);                    // same place, other id
  EXPECT_EQ(with({0.5, 0, 0}, {1.5, 0, 0}, {1, -1, 0}).classify(), Crossing::touches);         // T-junction
  EXPECT_EQ(with({0.2, 0.2, 0}, {0.4, 0.2, 0}, {0.2, 0.4, 0}).classify(), Crossing::overlaps);
  EXPECT_EQ(with({0, 0, 1}, {2, 0, 1}, {0, 2, 1}).classify(), Crossing::none);

  Pair fold = with(a, b, {0.5, 0.5, 0});
  fold.share(0, 0);
  fold.share(1, 1);
  EXPECT_EQ(fold.classify(), Crossing::overlaps);
  fold.q[2] = {1, -1, 0};
  EXPECT_EQ(fold.classify(), Crossing::none);
  fold.q[2] = {0.5, 0.5, 1e-300};
  EXPECT_EQ(fold.classify(), Crossing::none);

  Pair fan = with(a, {0.5, 0.5, 1}, {0.5, 0.5, -1});
  fan.share(0, 0);
  EXPECT_EQ(fan.classify(), Crossing::crosses);
  fan.q[2] = {0.5, 0.5, 0};
  EXPECT_EQ(fan.classify(), Crossing::touches);
  fan.q[2] = {-0.5, -0.5, 0};
  EXPECT_EQ(fan.classify(), Crossing::none);

  Pair twice = with(a, b, c);
  for (int i = 0; i < 3; ++i) twice.share(i, i);
  EXPECT_EQ(twice.classify(), Crossing::overlaps);
}

TEST(ClassifyTriangles, takes_corners_named_twice) {
  Pair pair{{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 0, 1}, {0, 1, 2}};
  EXPECT_EQ(pair.classify(), Crossing::none);  // a flat triangle that is an edge of the other
  pair.q_id[1] = 5;
  EXPECT_EQ(pair.classify(), Crossing::touches);
}

}  // namespace
}  // namespace delfront
