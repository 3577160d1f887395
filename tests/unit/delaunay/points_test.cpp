// SPDX-License-Identifier: Apache-2.0
// The public calls on point sets against the definitions, by brute force over all points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>

#include "delfront/delaunay.hpp"
#include "delfront/errors.hpp"
#include "predicates/power.hpp"
#include "predicates/predicates.hpp"
#include "unit/delaunay/point_sets.hpp"

namespace delfront {
namespace {

using point_sets::NamedSet;
using point_sets::random_points;
using point_sets::small_sets;
using Triangle = std::array<std::uint32_t, 3>;
using Tet = std::array<std::uint32_t, 4>;

constexpr std::uint32_t kNone = Tetrahedrization::kNone;

WeightedPoint weighted(const std::vector<Point>& points, const std::vector<double>& weights, std::uint32_t v) {
  return {points[v], weights.empty() ? 0 : weights[v]};
}

/// Nodes of the face opposite node i, seen from outside.
Triangle face(const Tet& t, std::size_t i) {
  static constexpr std::size_t kFace[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  return {t[kFace[i][0]], t[kFace[i][1]], t[kFace[i][2]]};
}

Triangle from_lowest(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

std::set<Tet> as_set(const Tetrahedrization& result) {
  std::set<Tet> tets;
  for (Tet t : result.tets) {
    std::sort(t.begin(), t.end());
    tets.insert(t);
  }
  return tets;
}

/// Positive tets, mutual neighbours with the same face, hull triangles where there is none.
void expect_valid_bonds(const std::vector<Point>& points, const Tetrahedrization& result) {
  ASSERT_EQ(result.tets.size(), result.neighbours.size());
  std::vector<Triangle> open;
  for (std::uint32_t t = 0; t < result.tets.size(); ++t) {
    const Tet& n = result.tets[t];
    ASSERT_GT(orient3d(points[n[0]], points[n[1]], points[n[2]], points[n[3]]), 0) << "tet " << t;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t other = result.neighbours[t][i];
      if (other == kNone) {
        open.push_back(from_lowest(face(n, i)));
        continue;
      }
      const auto& back = result.neighbours[other];
      const auto at = std::find(back.begin(), back.end(), t) - back.begin();
      ASSERT_LT(at, 4);
      Triangle mine = face(n, i), its = face(result.tets[other], static_cast<std::size_t>(at));
      std::swap(its[1], its[2]);
      ASSERT_EQ(from_lowest(mine), from_lowest(its));
    }
  }
  std::vector<Triangle> hull;
  for (const Triangle& t : result.hull) hull.push_back(from_lowest(t));
  std::sort(hull.begin(), hull.end());
  std::sort(open.begin(), open.end());
  ASSERT_EQ(hull, open);
}

/// Hull triangles: no point strictly beyond any; closed; so it is the convex hull of the points.
void expect_convex_hull(const std::vector<Point>& points, const Tetrahedrization& result) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : result.hull) {
    for (const Point& p : points) ASSERT_LE(orient3d(points[t[0]], points[t[1]], points[t[2]], p), 0);
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.count({edge.second, edge.first}));
  }
}

/// Each point that stands for its place is in a tet or listed as hidden; the others are duplicates of one that is used.
void expect_every_point_accounted(const std::vector<Point>& points, const std::vector<double>& weights,
                                  const Tetrahedrization& result) {
  std::vector<int> role(points.size(), 0);
  for (const Tet& t : result.tets)
    for (const std::uint32_t v : t) role[v] = 1;
  for (const std::uint32_t v : result.hidden) {
    ASSERT_EQ(role[v], 0);
    role[v] = 2;
  }
  for (const auto& [v, used] : result.duplicates) {
    ASSERT_EQ(role[v], 0);
    ASSERT_NE(role[used], 0);
    ASSERT_EQ(points[v], points[used]);
    if (weights.empty()) {
      ASSERT_LT(used, v);
    } else {
      ASSERT_GE(weights[used], weights[v]);
    }
    role[v] = 3;
  }
  ASSERT_EQ(std::count(role.begin(), role.end(), 0), 0);
}

/// No point in the (perturbed) sphere of any tet: with the hull and the bonds right, that is the definition.
void expect_empty_spheres(const std::vector<Point>& points, const std::vector<double>& weights,
                          const Tetrahedrization& result) {
  for (const Tet& t : result.tets)
    for (std::uint32_t v = 0; v < points.size(); ++v) {
      if (std::any_of(t.begin(), t.end(), [&](std::uint32_t w) { return points[w] == points[v]; })) continue;
      ASSERT_LT(power_test_perturbed(weighted(points, weights, t[0]), weighted(points, weights, t[1]),
                                     weighted(points, weights, t[2]), weighted(points, weights, t[3]),
                                     weighted(points, weights, v)),
                0)
          << "point " << v;
    }
}

void expect_right(const std::vector<Point>& points, const std::vector<double>& weights,
                  const Tetrahedrization& result) {
  ASSERT_NO_FATAL_FAILURE(expect_valid_bonds(points, result));
  ASSERT_NO_FATAL_FAILURE(expect_convex_hull(points, result));
  ASSERT_NO_FATAL_FAILURE(expect_every_point_accounted(points, weights, result));
  ASSERT_NO_FATAL_FAILURE(expect_empty_spheres(points, weights, result));
}

/// The result with every point number replaced.
template <class Renumber>
std::set<Tet> renumbered(const Tetrahedrization& result, const Renumber& number) {
  std::set<Tet> tets;
  for (Tet t : result.tets) {
    for (std::uint32_t& v : t) v = number(v);
    std::sort(t.begin(), t.end());
    tets.insert(t);
  }
  return tets;
}

TEST(DelaunayOfPoints, T4_empty_spheres_and_the_convex_hull) {
  for (const NamedSet& set : small_sets()) {
    SCOPED_TRACE(set.name);
    Context context;
    const Tetrahedrization result = delaunay(set.points, context);
    ASSERT_NO_FATAL_FAILURE(expect_right(set.points, {}, result));
    EXPECT_TRUE(result.hidden.empty());
    EXPECT_EQ(result.duplicates.size() + point_sets::num_places(set.points), set.points.size());
  }
}

TEST(DelaunayOfPoints, the_set_of_tets_does_not_depend_on_the_order_of_the_points) {
  for (const NamedSet& set : small_sets()) {
    SCOPED_TRACE(set.name);
    std::vector<std::uint32_t> order(set.points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    std::vector<Point> shuffled;
    for (const std::uint32_t v : order) shuffled.push_back(set.points[v]);
    Context context;
    const Tetrahedrization first = delaunay(set.points, context), second = delaunay(shuffled, context);
    std::map<std::array<double, 3>, std::uint32_t> place;  // of equal points any stands for all
    for (std::uint32_t v = 0; v < set.points.size(); ++v)
      place.insert({{set.points[v].x + 0.0, set.points[v].y + 0.0, set.points[v].z + 0.0}, v});
    const auto number = [&](const std::vector<Point>& p) {
      return [&](std::uint32_t v) { return place.at({p[v].x + 0.0, p[v].y + 0.0, p[v].z + 0.0}); };
    };
    EXPECT_EQ(renumbered(first, number(set.points)), renumbered(second, number(shuffled)));
  }
}

TEST(DelaunayOfPoints, any_number_of_threads_gives_the_same_result) {
  std::vector<Point> points = random_points(200000, 21);
  for (std::size_t i = 0; i < 1000; ++i) points.push_back(points[7 * i]);
  Context one;
  const Tetrahedrization first = delaunay(points, one);
  EXPECT_EQ(first.duplicates.size(), 1000u);
  EXPECT_EQ(first.counts.points + 4, 200000u);
  for (const int threads : {2, 3}) {
    Context context;
    context.threads = threads;
    const Tetrahedrization other = delaunay(points, context);
    EXPECT_TRUE(other.tets == first.tets) << threads << " threads";
    EXPECT_TRUE(other.neighbours == first.neighbours) << threads << " threads";
    EXPECT_TRUE(other.hull == first.hull) << threads << " threads";
    EXPECT_EQ(other.duplicates, first.duplicates) << threads << " threads";
    EXPECT_EQ(other.counts.walk_steps, first.counts.walk_steps);
  }
}

TEST(DelaunayOfPoints, coordinates_of_any_size_give_the_same_tets) {
  std::vector<Point> points = random_points(500, 22);
  Context context;
  const Tetrahedrization first = delaunay(points, context);
  for (const int bits : {-1000, -500, -60, 60, 99}) {
    std::vector<Point> scaled = points;
    for (Point& p : scaled) p = {std::ldexp(p.x, bits), std::ldexp(p.y, bits), std::ldexp(p.z, bits)};
    EXPECT_EQ(delaunay(scaled, context).tets, first.tets) << "2^" << bits;
    EXPECT_EQ(as_set(regular(scaled, std::vector<double>(500, 0), context)), as_set(first)) << "2^" << bits;
  }
}

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

TEST(DelaunayOfPoints, what_cannot_be_tetrahedrized_is_refused_with_the_reason) {
  Context context;
  const auto message = [&](const std::vector<Point>& points) {
    const std::string one = message_of([&] { delaunay(points, context); });
    EXPECT_EQ(message_of([&] { regular(points, std::vector<double>(points.size(), 1), context); }), one);
    return one;
  };
  EXPECT_NE(message({}).find("at least four"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).find("at least four"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}}).find("plane"), std::string::npos);
  EXPECT_NE(message(std::vector<Point>(9, Point{1, 2, 3})).find("one place"), std::string::npos);
  std::vector<Point> points = random_points(20, 23);
  points[13].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(points).find("point 13"), std::string::npos);
  points[13].y = 0x1p101;
  EXPECT_NE(message(points).find("point 13"), std::string::npos);
  points[13].y = 0;
  EXPECT_NE(message_of([&] { regular(points, std::vector<double>(19, 1), context); }).find("19 weights"),
            std::string::npos);
  std::vector<double> weights(20, 0);
  weights[4] = std::numeric_limits<double>::infinity();
  EXPECT_NE(message_of([&] { regular(points, weights, context); }).find("point 4"), std::string::npos);
}

TEST(DelaunayOfPoints, more_points_than_32_bits_hold_are_refused_before_the_run) {
  Context context;
  const Point one;  // never read: the number alone is too large
  EXPECT_THROW(delaunay(std::span<const Point>(&one, 200'000'000), context), LimitError);
}

TEST(DelaunayOfPoints, limits_of_the_context_hold) {
  const std::vector<Point> points = random_points(20000, 24);
  std::atomic<bool> cancel = true;
  Context context;
  context.cancel = &cancel;
  EXPECT_THROW(delaunay(points, context), Cancelled);
  EXPECT_THROW(regular(points, std::vector<double>(points.size(), 0), context), Cancelled);
  context.cancel = nullptr;
  context.max_cells = 1000;
  EXPECT_THROW(delaunay(points, context), LimitError);
}

TEST(RegularOfPoints, equal_weights_give_the_delaunay_tets) {
  for (const NamedSet& set : small_sets()) {
    SCOPED_TRACE(set.name);
    Context context;
    const Tetrahedrization wanted = delaunay(set.points, context);
    for (const double w : {0.0, -3.5, 100.0}) {
      const Tetrahedrization result = regular(set.points, std::vector<double>(set.points.size(), w), context);
      EXPECT_EQ(as_set(result), as_set(wanted));
      EXPECT_EQ(result.duplicates, wanted.duplicates);
      EXPECT_TRUE(result.hidden.empty());
    }
  }
}

/// Weights of these sizes beside the points' distances: some points are hidden, by far or by a hair.
std::vector<double> random_weights(const std::vector<Point>& points, int kind, std::mt19937& random) {
  Box box;
  for (const Point& p : points) box.add(p);
  const double unit = box.diagonal() * box.diagonal() / static_cast<double>(points.size());
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> weights;
  for (const Point& p : points) switch (kind) {
      case 0:
        weights.push_back(unit * uniform(random));
        break;
      case 1:
        weights.push_back(unit * std::floor(4 * uniform(random)));
        break;
      case 2:  // the lifted points lie in one hyperplane: ties everywhere
        weights.push_back(squared_length(p) - 2 * p.x + p.z);
        break;
      default:  // the same with one in five above or below it
        weights.push_back(squared_length(p) - 2 * p.x + p.z +
                          (uniform(random) < 0.2 ? unit * (uniform(random) - 0.5) : 0));
    }
  return weights;
}

TEST(RegularOfPoints, the_definition_holds_for_all_weights) {
  std::size_t hidden = 0;
  for (int kind = 0; kind < 4; ++kind) {
    std::mt19937 random(25);
    for (const NamedSet& set : small_sets()) {
      SCOPED_TRACE(set.name + ", weights of kind " + std::to_string(kind) + ", seed 25");
      const std::vector<double> weights = random_weights(set.points, kind, random);
      Context context;
      const Tetrahedrization result = regular(set.points, weights, context);
      ASSERT_NO_FATAL_FAILURE(expect_right(set.points, weights, result));
      hidden += result.hidden.size();
    }
  }
  EXPECT_GT(hidden, 500u);
}

TEST(RegularOfPoints, the_set_of_tets_does_not_depend_on_the_order_of_the_points) {
  for (int kind = 0; kind < 4; ++kind) {
    std::mt19937 random(26);
    for (const NamedSet& set : small_sets()) {
      if (point_sets::num_places(set.points) != set.points.size()) continue;
      SCOPED_TRACE(set.name + ", weights of kind " + std::to_string(kind) + ", seed 26");
      const std::vector<double> weights = random_weights(set.points, kind, random);
      std::vector<std::uint32_t> order(set.points.size());
      std::iota(order.begin(), order.end(), 0u);
      std::shuffle(order.begin(), order.end(), random);
      std::vector<Point> points;
      std::vector<double> shuffled;
      for (const std::uint32_t v : order) points.push_back(set.points[v]), shuffled.push_back(weights[v]);
      Context context;
      const Tetrahedrization first = regular(set.points, weights, context), second = regular(points, shuffled, context);
      EXPECT_EQ(as_set(first), renumbered(second, [&](std::uint32_t v) { return order[v]; }));
      std::vector<std::uint32_t> hidden;
      for (const std::uint32_t v : second.hidden) hidden.push_back(order[v]);
      std::sort(hidden.begin(), hidden.end());
      EXPECT_EQ(first.hidden, hidden);
    }
  }
}

TEST(RegularOfPoints, the_definition_holds_for_tiny_sets_full_of_ties) {
  std::mt19937 random(34);
  const auto upto = [&](int n) { return static_cast<double>(random() % static_cast<unsigned>(n + 1)); };
  std::size_t hidden = 0, flat = 0;
  for (int n = 0; n < 5000; ++n) {
    std::vector<Point> points;
    std::vector<double> weights;
    const int side = 1 + n % 3;
    for (int i = 0; i < 4 + n % 13; ++i) {
      points.push_back({upto(side), upto(side), upto(side)});
      weights.push_back(upto(n % 5));
    }
    SCOPED_TRACE("seed 34 case " + std::to_string(n));
    Context context;
    try {
      const Tetrahedrization result = regular(points, weights, context);
      ASSERT_NO_FATAL_FAILURE(expect_right(points, weights, result));
      ASSERT_NO_FATAL_FAILURE(expect_right(points, {}, delaunay(points, context)));
      hidden += result.hidden.size();
    } catch (const InputError&) {
      ++flat;
    }
  }
  EXPECT_GT(hidden, 200u);
  EXPECT_LT(flat, 1500u);
}

TEST(RegularOfPoints, a_heavy_point_hides_those_near_it_and_never_a_corner_of_the_hull) {
  std::vector<Point> points = random_points(2000, 27);
  points.push_back({0.5, 0.5, 0.5});
  std::vector<double> weights(points.size(), 0);
  weights.back() = 0.3 * 0.3;  // hides the whole ball of radius 0.3 around it, but for what its border still needs
  Context context;
  const Tetrahedrization result = regular(points, weights, context);
  std::vector<std::uint8_t> is_hidden(points.size(), 0);
  for (const std::uint32_t v : result.hidden) is_hidden[v] = 1;
  for (std::size_t v = 0; v + 1 < points.size(); ++v) {
    const double r = distance(points[v], points.back());
    if (r < 0.29 / 2) {
      EXPECT_TRUE(is_hidden[v]) << r;
    }
    if (r > 0.3) {
      EXPECT_FALSE(is_hidden[v]) << r;
    }
  }
  weights.back() = 1e12;  // hides what lies 1e-12 below the hull
  const Tetrahedrization all = regular(points, weights, context);
  std::set<std::uint32_t> corners;
  for (const Triangle& t : delaunay(points, context).hull) corners.insert(t.begin(), t.end());
  for (const std::uint32_t v : all.hidden) EXPECT_FALSE(corners.count(v));
  EXPECT_EQ(all.hidden.size() + corners.size() + 1, points.size());
}

TEST(RegularOfPoints, of_points_at_one_place_the_heaviest_is_used) {
  std::vector<Point> points = random_points(50, 28);
  for (std::size_t i = 0; i < 10; ++i) points.push_back(points[i]);
  std::vector<double> weights(points.size(), 0);
  for (std::size_t i = 50; i < 55; ++i) weights[i] = 1e-3;
  Context context;
  const Tetrahedrization result = regular(points, weights, context);
  ASSERT_EQ(result.duplicates.size(), 10u);
  for (const auto& [v, used] : result.duplicates) EXPECT_EQ(used, v < 5 ? v + 50 : v - 50);
}

TEST(RegularOfPoints, counts_are_kept_and_scale_does_not_matter) {
  std::vector<Point> points = random_points(3000, 29);
  std::mt19937 random(30);
  std::vector<double> weights = random_weights(points, 0, random);
  Context context;
  const Tetrahedrization first = regular(points, weights, context);
  EXPECT_GT(first.counts.insphere_tests, 10 * first.counts.points);
  EXPECT_GE(first.counts.points + first.hidden.size(), points.size());
  EXPECT_EQ(first.counts.tets_created - first.counts.tets_deleted + 5, first.tets.size() + first.hull.size());
  for (Point& p : points) p = 0x1p-80 * p;
  for (double& w : weights) w *= 0x1p-160;
  EXPECT_EQ(regular(points, weights, context).tets, first.tets);
}

}  // namespace
}  // namespace delfront
