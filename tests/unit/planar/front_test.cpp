// SPDX-License-Identifier: Apache-2.0
#include "planar/front.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "front_fixtures.hpp"
#include "planar/front_neighbours.hpp"
#include "planar/prepare.hpp"
#include "planar_fixtures.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using namespace fixtures;

TEST(FillByFront, F5_F11_square_at_one_size) {
  PlanarDomain domain;
  add_loop(domain, square(40), "wall");
  const Filled filled = fill_domain(domain, nullptr);
  EXPECT_GT(filled.mean_quality, 0.985);
  EXPECT_GT(filled.min_angle, 25);
  EXPECT_EQ(filled.report.cavities, 0u);
  EXPECT_EQ(filled.report.sweeps, 1u);
  // An ideal grid of this size has 2 / (sqrt(3) / 2) * 1600 = 3695 triangles.
  EXPECT_NEAR(double(filled.num_triangles), 3695, 0.05 * 3695);
  // Each triangle is made over one side, and points are half as many.
  EXPECT_LT(double(filled.report.sides_processed), 1.05 * double(filled.num_triangles));
}

TEST(FillByFront, F5_embedded_lines_points_regions_and_holes_stay) {
  PlanarDomain domain;
  add_loop(domain, square(24), "outer");
  add_loop(domain, circle({0.3, 0.3}, -0.1, 16), "hole");
  add_loop(domain, circle({0.7, 0.6}, 0.15, 24), "region");
  add_line(domain, {{0.1, 0.8}, {0.2, 0.82}, {0.3, 0.85}, {0.4, 0.83}}, "line");
  add_line(domain, {{0, 0.5}, {0.05, 0.52}, {0.1, 0.5}}, "from the wall");
  for (int i = 0; i < 5; ++i) domain.points.push_back({0.5 + 0.03 * i, 0.2 + 0.01 * i * i});
  const Filled filled = fill_domain(domain, nullptr);
  EXPECT_EQ(filled.num_regions, 2u);
  EXPECT_GT(filled.mean_quality, 0.9);
}

/// Whether the side u -> v touches the triangle but at shared corners, in other words than the front's: an end of the
/// side in the triangle, a corner on the side, or sides that cross.
bool meets(const std::vector<Point2>& point, const std::array<VertexIndex, 3>& t, VertexIndex u, VertexIndex v) {
  const Point2 p = point[u], q = point[v], corner[3] = {point[t[0]], point[t[1]], point[t[2]]};
  for (const VertexIndex end : {u, v}) {
    if (end == t[0] || end == t[1] || end == t[2]) continue;
    bool is_in = true;
    for (int e = 0; e < 3; ++e) is_in &= orient2d(corner[e], corner[(e + 1) % 3], point[end]) >= 0;
    if (is_in) return true;
  }
  if (u == v) return false;
  for (int k = 0; k < 3; ++k) {
    if (t[k] != u && t[k] != v && orient2d(p, q, corner[k]) == 0 && dot(corner[k] - p, corner[k] - q) < 0) return true;
    const Point2 a = corner[k], b = corner[(k + 1) % 3];
    if (orient2d(a, b, p) * orient2d(a, b, q) < 0 && orient2d(p, q, a) * orient2d(p, q, b) < 0) return true;
  }
  return false;
}

/// Points on a small lattice, so that nearly every case is degenerate somewhere; sides that share all ends they can.
TEST(FrontNeighbours, F12_decides_as_all_pairs_do_on_a_lattice) {
  std::size_t num_free = 0, num_touched = 0;
  for (std::uint64_t seed = 1; seed <= 40000; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<Point2> point;
    while (point.size() < 6) {
      const Point2 p = {double(random() % 5), double(random() % 5)};
      if (std::find(point.begin(), point.end(), p) == point.end()) point.push_back(p);
    }
    if (orient2d(point[0], point[1], point[2]) <= 0) continue;
    SideGrid grid;
    grid.clear({0, 0}, {4, 4});
    const auto side = [&](VertexIndex from, VertexIndex to, std::uint32_t id) {
      return FrontSide{point[from], point[to], from, to, id};
    };
    grid.insert(side(0, 1, 0));
    const auto u = static_cast<VertexIndex>(random() % 6), v = static_cast<VertexIndex>(random() % 6);
    if (u != v || u > 2) grid.insert(side(u, v, 1));
    FrontNeighbours near;
    near.gather(grid, side(0, 1, 0), FrontFrame(point[0], point[1], FrontMetric::isotropic(1)), 10);
    const bool is_new = u != 2 && v != 2 && seed % 2;
    const bool is_free = near.is_free(point[2], is_new ? kInfinity : 2);
    const bool wanted = (u == v && u <= 2) || !meets(point, {0, 1, 2}, u, v);
    ASSERT_EQ(is_free, wanted) << "seed " << seed << ", side " << u << " -> " << v;
    ++(is_free ? num_free : num_touched);
  }
  EXPECT_GT(num_free, 1000u);
  EXPECT_GT(num_touched, 1000u);
}

TEST(FillByFront, F12_random_fronts_never_cross_themselves) {
  class Oracle : public FrontWatcher {
   public:
    void before_triangle(const TriComplex& c, std::span<const std::array<VertexIndex, 2>> sides,
                         const std::array<VertexIndex, 3>& t) override {
      ASSERT_GT(orient2d(c.point[t[0]], c.point[t[1]], c.point[t[2]]), 0);
      std::map<VertexIndex, int> degree;
      bool is_over_a_side = false;
      for (const auto& [u, v] : sides) {
        degree[u] += u != v;
        degree[v] -= u != v;
        is_over_a_side |= u == t[0] && v == t[1];
        ASSERT_FALSE(u == t[0] && v == t[2] && !has(sides, v, u)) << "a side that is there is opened again";
        ASSERT_FALSE(meets(c.point, t, u, v)) << "triangle " << num_triangles;
      }
      ASSERT_TRUE(is_over_a_side);
      for (const auto& [v, surplus] : degree) ASSERT_EQ(surplus, 0) << "the front is not closed at " << v;
      ++num_triangles;
    }
    std::size_t num_triangles = 0;

   private:
    static bool has(std::span<const std::array<VertexIndex, 2>> sides, VertexIndex u, VertexIndex v) {
      return std::find(sides.begin(), sides.end(), std::array{u, v}) != sides.end();
    }
  };
  const unsigned first = setting("DELFRONT_RANDOM_SEED", 1), cases = (setting("DELFRONT_RANDOM_CASES", 200) + 9) / 10;
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Oracle oracle;
    std::mt19937_64 random(seed);
    fill_domain(random_domain(random, 24), random_sizes(random, 0.02), &oracle);
    EXPECT_GT(oracle.num_triangles, 20u);
    if (HasFatalFailure()) return;
  }
}

TEST(FillByFront, F17_random_domains_are_filled_completely) {
  const unsigned first = setting("DELFRONT_RANDOM_SEED", 1), cases = setting("DELFRONT_RANDOM_CASES", 200);
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    Options options;
    if (seed % 3 == 0) options.planar.boundary = "split";
    const PlanarDomain domain = random_domain(random, 8 + int(seed % 60));
    const Filled filled = fill_domain(domain, options, seed % 4 == 0 ? nullptr : random_sizes(random, 1e-4));
    EXPECT_LT(filled.report.sides_processed, 20 * filled.num_triangles + 1000);
    if (HasFailure()) return;
  }
}

TEST(FillByFront, F17_thin_slots_and_sharp_wedges) {
  for (const double gap : {1e-1, 1e-2, 1e-4, 1e-8}) {
    SCOPED_TRACE(gap);
    PlanarDomain slot;
    add_loop(slot, circle({0.5, 0}, 2, 40), "outer");
    add_loop(slot, {{0, 0}, {0, -0.5}, {1, -0.5}, {1, 0}}, "below");
    add_loop(slot, {{0, gap}, {1, gap}, {1, 0.5}, {0, 0.5}}, "above");
    fill_domain(slot, nullptr);
    PlanarDomain wedge;
    add_loop(wedge, {{0, 0}, {1, 0}, {1, gap}}, "wedge");
    fill_domain(wedge, nullptr);
  }
}

/// Its middle corner lies 1e-21 from the opposite side, which the frame of another side rounds away.
TEST(FillByFront, F17_a_needle_as_thin_as_rounding_does_not_leak) {
  PlanarDomain domain;
  add_loop(domain,
           {{0.98432620614767075, 0.32745908200740814},
            {0.98429315238441173, 0.32755008811913183},
            {0.98431692138271032, 0.32748464552193729}},
           "needle");
  const Filled filled = fill_domain(domain, nullptr);
  EXPECT_EQ(filled.num_triangles, 1u);
  EXPECT_EQ(filled.report.points, 0u);
}

TEST(FillByFront, F17_nothing_but_given_points_in_a_sliver) {
  PlanarDomain domain;
  add_loop(domain, {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1e-9}, {2, 1e-9}, {1, 1e-9}, {0, 1e-9}}, "sliver");
  const Filled filled = fill_domain(domain, nullptr);
  EXPECT_EQ(filled.num_triangles, 6u);
  EXPECT_EQ(filled.report.points, 0u);
  EXPECT_EQ(filled.report.cavities, 1u);
  EXPECT_EQ(filled.report.closed_by_delaunay, 6u);
}

TEST(FillByFront, F5_lengths_are_those_of_a_graded_field) {
  PlanarDomain domain;
  add_loop(domain, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "outer");
  Options options;
  options.planar.boundary = "split";
  const auto field = std::make_shared<Formula>([](Point2 p) { return 0.004 + 0.1 * std::abs(p.x - 0.5); });
  const Filled filled = fill_domain(domain, options, field);
  EXPECT_GT(filled.share_within(0.6, 1.5), 0.97);
  EXPECT_GT(filled.mean_quality, 0.95);
}

TEST(FillByFront, F5_lengths_are_those_of_a_stretched_metric) {
  for (const double s1 : {10.0, 30.0, 100.0}) {
    SCOPED_TRACE(s1);
    PlanarDomain domain;
    const int n = int(10 * s1);
    add_loop(domain, square(n), "outer");
    const Filled filled = fill_domain(domain, std::make_shared<Stretched>(1.0 / n, s1));
    EXPECT_GT(filled.share_within(0.5, 2), 0.95);
  }
}

TEST(FillByFront, F5_a_boundary_is_divided_in_the_metric) {
  PlanarDomain domain;
  add_loop(domain, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "outer");
  Options options;
  options.planar.method = "front";
  options.planar.boundary = "split";
  Context context;
  const auto sizes = std::make_shared<Stretched>(0.01, 12);
  auto [grid, size, is_too_long] = prepare_planar(domain, options, sizes, context);
  std::size_t good = 0;
  for (const PlanarPiece& piece : grid.pieces) {
    const Point2 e = grid.complex.point[piece.b] - grid.complex.point[piece.a];
    Metric metric;
    sizes->metrics({}, {&metric, 1});
    const double length = length_in(metric, {e.x, e.y, 0});
    good += length > 0.7 && length < 1.4;
  }
  EXPECT_EQ(good, grid.pieces.size());
  fill_by_front(grid, *size, context);
  EXPECT_STREQ(grid.complex.find_defect(), "");
  Filled filled;
  measure(grid, *sizes, filled);
  EXPECT_GT(filled.share_within(0.5, 2), 0.97);
}

TEST(FillByFront, F5_a_scaled_domain_has_the_same_triangles) {
  std::mt19937_64 random(5);
  const PlanarDomain domain = random_domain(random, 30);
  const Filled filled = fill_domain(domain, nullptr);
  PlanarDomain scaled = domain;
  for (Point2& p : scaled.points) p = {1048576 * p.x, 1048576 * p.y};
  const Filled other = fill_domain(scaled, nullptr);
  ASSERT_EQ(filled.corners, other.corners);
}

}  // namespace
}  // namespace delfront
