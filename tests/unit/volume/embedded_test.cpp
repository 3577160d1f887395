// SPDX-License-Identifier: Apache-2.0
// Curves and points in the volume: recovered vertex for vertex, or divided and said so.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "support/plc_fixtures.hpp"
#include "support/support.hpp"
#include "volume/to_mesh.hpp"

namespace delfront {
namespace {

using namespace fixtures;

/// A curve through n points at random in the ball of that radius, and as many points alone.
void add_random_curve(Facets& body, int n, Point centre, double radius, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto place = [&] {
    for (;;) {
      const Point p{unit(random), unit(random), unit(random)};
      if (squared_length(p) < 1) return centre + radius * p;
    }
  };
  std::vector<std::size_t> curve;
  for (int i = 0; i < n; ++i) curve.push_back(body.add_point(place()));
  body.curves.push_back(curve);
  for (int i = 0; i < n; ++i) body.corners.push_back(body.add_point(place()));
}

/// One case a seed; few of the curves' edges may stay divided.
template <class Try>
void try_random_curves(unsigned usual_cases, const Try& try_one) {
  const unsigned first = setting("DELFRONT_RANDOM_SEED", 1), cases = setting("DELFRONT_RANDOM_CASES", usual_cases);
  std::size_t edges = 0, split = 0;
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    std::mt19937 random(seed);
    const RecoveryReport report = try_one(random, seed);
    edges += report.curve_edges;
    split += report.curve_edges_split;
  }
  testing::Test::RecordProperty("edges", std::to_string(edges));
  testing::Test::RecordProperty("split", std::to_string(split));
  EXPECT_LE(split, edges / 10) << "of " << edges << " edges";
}

TEST(Embedded, random_curves_in_a_box) {
  try_random_curves(50, [](std::mt19937& random, unsigned seed) {
    const int n = 2 + static_cast<int>(seed % 10);
    Facets body = gridded_cube(1 + static_cast<int>(seed % 5));
    add_random_curve(body, n, {0.5, 0.5, 0.5}, 0.48, random);
    const RecoveryReport report = expect_recovered(body, 1).report;
    EXPECT_EQ(report.curve_edges, static_cast<std::size_t>(n - 1));
    EXPECT_EQ(report.curve_edges_inside, static_cast<std::size_t>(n - 1));
    EXPECT_EQ(report.embedded_points, static_cast<std::size_t>(n));
    EXPECT_EQ(report.steiner_left, 0u);
    return report;
  });
}

TEST(Embedded, random_curves_in_a_sphere) {
  try_random_curves(20, [](std::mt19937& random, unsigned) {
    Facets body = sphere_facets(2);
    const double volume = body.volume();
    add_random_curve(body, 8, {}, 0.8, random);
    return expect_recovered(body, volume).report;
  });
}

TEST(Embedded, curves_that_meet_at_one_degree) {
  for (const double degrees : {10.0, 1.0, 0.01}) {
    SCOPED_TRACE(degrees);
    Facets body = gridded_cube(4);
    const double angle = degrees * std::numbers::pi / 180;
    const std::size_t apex = body.add_point({0.2, 0.31, 0.42});
    for (int i = 0; i < 4; ++i) {
      const Point along{std::cos(i * angle), std::sin(i * angle), i % 2 * 0.3 * angle};
      body.curves.push_back({apex, body.add_point(body.points[apex] + (0.5 + 0.02 * i) * along)});
    }
    EXPECT_EQ(expect_recovered(body, 1).report.curve_edges, 4u);
  }
}

TEST(Embedded, a_fan_of_curves_at_one_point) {
  for (const int n : {6, 40, 200}) {
    SCOPED_TRACE(n);
    Facets body = gridded_cube(6);
    const std::size_t apex = body.add_point({0.5, 0.5, 0.5});
    for (int i = 0; i < n; ++i) {
      const double z = 1 - (2 * i + 1) / double(n), r = std::sqrt(1 - z * z),
                   turn = i * std::numbers::pi * 1.2360679775;
      const double reach = 0.1 + 0.38 * (i % 7) / 7;
      body.curves.push_back(
          {apex, body.add_point(body.points[apex] + reach * Point{r * std::cos(turn), r * std::sin(turn), z})});
    }
    const Recovered r = expect_recovered(body, 1);
    EXPECT_EQ(r.report.curve_edges, static_cast<std::size_t>(n));
    EXPECT_EQ(r.report.curve_edges_split, 0u);
  }
}

TEST(Embedded, a_curve_that_nearly_touches_a_wall) {
  for (const double gap : {1e-2, 1e-5, 1e-9}) {
    SCOPED_TRACE(gap);
    Facets body = gridded_cube(3);
    std::vector<std::size_t> curve;
    for (int i = 0; i <= 8; ++i) curve.push_back(body.add_point({0.1 + 0.1 * i, 0.2 + 0.07 * i, i % 2 ? gap : 0.1}));
    body.curves.push_back(curve);
    const Recovered r = expect_recovered(body, 1);
    EXPECT_EQ(r.report.curve_edges, 8u);
    EXPECT_EQ(r.report.curve_edges_split, 0u);
    EXPECT_EQ(r.report.steiner_left, 0u);
  }
}

/// Points of a lattice: cospherical all over; curves along edges, and along diagonals of squares and cubes.
TEST(Embedded, curves_along_lattice_points) {
  Facets body = gridded_cube(4);
  const auto at = [&](int i, int j, int k) { return body.add_point({i / 4.0, j / 4.0, k / 4.0}); };
  body.curves.push_back({at(1, 1, 1), at(2, 1, 1), at(2, 2, 1), at(2, 2, 2), at(3, 3, 3)});
  body.curves.push_back({at(1, 2, 2), at(2, 3, 2), at(3, 3, 2)});
  body.curves.push_back({at(0, 2, 2), at(1, 2, 2)});  // from the surface
  body.curves.push_back({at(1, 1, 3), at(2, 2, 2)});  // a diagonal of a square
  body.curves.push_back({at(3, 1, 1), at(2, 2, 2)});  // the diagonal of a cube
  for (int i = 1; i < 4; ++i) body.corners.push_back(at(i, 1, 2));
  const Recovered r = expect_recovered(body, 1);
  EXPECT_EQ(r.report.curve_edges, 9u);
  EXPECT_EQ(r.report.curve_edges_split, 0u);
  EXPECT_EQ(r.report.embedded_points, 3u);
}

TEST(Embedded, curves_from_wall_to_wall_and_along_them) {
  Facets body = box_facets({0, 0, 0}, {1, 1, 1});
  body.curves.push_back({0, body.add_point({0.5, 0.4, 0.6}), 6});
  body.curves.push_back({0, 1, 2});  // features: edges of the box
  body.corners.push_back(0);
  const Recovered r = expect_recovered(body, 1);
  EXPECT_EQ(r.report.curve_edges, 4u);
  EXPECT_EQ(r.report.curve_edges_inside, 2u);
  EXPECT_EQ(r.report.embedded_points, 0u);
  EXPECT_EQ(r.mesh.num_cells(CellType::line), 4u);
  EXPECT_EQ(r.mesh.num_cells(CellType::vertex), 1u);
  EXPECT_TRUE(r.mesh.find_group(1, "wire").is_valid());
}

TEST(Embedded, what_lies_outside_is_left_out_with_a_warning) {
  Facets body = box_facets({0, 0, 0}, {1, 1, 1});
  body.curves.push_back({6, body.add_point({2, 2, 2})});
  body.curves.push_back({body.add_point({0.3, 0.4, 0.5}), body.add_point({0.6, 0.5, 0.4})});
  body.corners.push_back(body.add_point({3, 0, 0}));
  const Model model = fixtures::to_model(body);
  std::vector<std::string> warnings;
  Context context;
  context.on_log = [&](LogLevel level, const std::string& message) {
    if (level == LogLevel::warning) warnings.push_back(message);
  };
  RecoveryReport report;
  const BoundaryGrid grid = tetrahedralize_boundary(model, {}, {false}, report, context);
  EXPECT_EQ(report.curve_edges, 1u);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("curve 'wire'"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("embedded point"), std::string::npos) << warnings[1];
  const Mesh mesh = to_mesh(grid, model);
  EXPECT_EQ(mesh.num_cells(CellType::line), 1u);
  EXPECT_EQ(mesh.num_cells(CellType::vertex), 0u);
}

/// A tangle among chords much longer than the surface's triangles: points stay on some, and are said.
TEST(Embedded, a_tangle_of_long_chords_is_kept_or_reported) {
  std::mt19937 random(5);
  Facets body = gridded_cube(8);
  add_random_curve(body, 20, {0.5, 0.5, 0.5}, 0.4, random);
  EXPECT_EQ(expect_recovered(body, 1).report.curve_edges, 19u);
}

/// Short chords at random among the notches of Chazelle's polyhedron, whose facets have to be filled again: those that
/// the exact check lets pass are there, or outside.
TEST(Embedded, curves_among_facets_that_need_points) {
  const unsigned first = setting("DELFRONT_RANDOM_SEED", 1), cases = (setting("DELFRONT_RANDOM_CASES", 50) + 9) / 10;
  std::size_t inside = 0;
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    std::mt19937 random(seed);
    Facets body = fixtures::chazelle(4, 0.05);
    const double volume = body.volume();
    Box box;
    for (const Point& p : body.points) box.add(p);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto place = [&] {
      Point p;
      for (int k = 0; k < 3; ++k) p[k] = box.low[k] + unit(random) * (box.high[k] - box.low[k]);
      return p;
    };
    Context context;
    for (int i = 0; i < 20; ++i) {
      Facets with = body;
      const Point from = place();
      with.curves.push_back({with.add_point(from), with.add_point(from + 0.2 * (place() - from))});
      if (!has_errors(check_surface(fixtures::to_model(with), context).findings)) body = with;
    }
    inside += expect_recovered(body, volume).report.curve_edges_inside;
  }
  EXPECT_GE(inside, cases);
}

}  // namespace
}  // namespace delfront
