// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "delfront/grid_check.hpp"
#include "delfront/planar.hpp"
#include "planar/prepare.hpp"
#include "planar_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

Outcome generate(const PlanarDomain& domain, const Options& options, std::shared_ptr<const SizeField> size = nullptr) {
  Context context;
  return generate_planar(domain, options, context, size);
}
Outcome generate(const PlanarDomain& domain) {
  const Options defaults;
  return generate(domain, defaults);
}

std::string findings_of(const Mesh& mesh) {
  std::string text;
  for (const Finding& finding : check(mesh)) text += finding.kind + ": " + finding.message + "\n";
  return text;
}

double min_angle(const Outcome& outcome) { return outcome.report.quality.find("min_angle")->min; }

/// Every given segment between points of the grid is there as a line of its curve, and nothing else is.
void expect_boundary_kept(const PlanarDomain& domain, const Mesh& mesh) {
  std::vector<std::array<double, 4>> given, got;
  const auto sorted_ends = [](Point2 a, Point2 b) {
    if (b.x < a.x || (b.x == a.x && b.y < a.y)) std::swap(a, b);
    return std::array<double, 4>{a.x, a.y, b.x, b.y};
  };
  for (const auto& [a, b] : domain.segments) given.push_back(sorted_ends(domain.points[a], domain.points[b]));
  const CellBlock* lines = mesh.find_block(CellType::line);
  for (std::size_t i = 0; i < lines->size(); ++i) {
    const Point a = mesh.points[(*lines)[i][0]], b = mesh.points[(*lines)[i][1]];
    got.push_back(sorted_ends({a.x, a.y}, {b.x, b.y}));
  }
  std::sort(given.begin(), given.end());
  std::sort(got.begin(), got.end());
  EXPECT_EQ(given, got);
}

TEST(GeneratePlanar, T2_T3_square_at_its_own_size) {
  PlanarDomain domain;
  add_loop(domain, square(40), "wall", "wall");
  const Outcome outcome = generate(domain);
  EXPECT_EQ(findings_of(outcome.mesh), "");
  EXPECT_NEAR(outcome.report.quality.volume, 1, 1e-12);
  EXPECT_GT(min_angle(outcome), 30);
  expect_boundary_kept(domain, outcome.mesh);
  // An ideal grid of this size has 2 / (sqrt(3) / 2) * 1600 = 3695 triangles.
  EXPECT_NEAR(double(outcome.report.quality.num_cells), 3695, 0.12 * 3695);
  ASSERT_TRUE(outcome.mesh.find_group(1, "wall").is_valid());
  EXPECT_EQ(outcome.mesh.groups[outcome.mesh.find_group(1, "wall")].kind, "wall");
  ASSERT_TRUE(outcome.mesh.find_group(2, "fluid").is_valid());
}

TEST(GeneratePlanar, T2_inner_loops_by_direction) {
  const auto with_inner = [](const std::vector<Point2>& inner) {
    PlanarDomain domain;
    add_loop(domain, square(20), "outer");
    add_loop(domain, inner, "inner");
    return generate(domain);
  };
  const std::vector<Point2> loop = circle({0.5, 0.5}, 0.25, 40);
  const Outcome hole = with_inner(reversed(loop)), region = with_inner(loop);
  EXPECT_NEAR(hole.report.quality.volume, 1 - area_of(loop), 1e-12);
  EXPECT_NEAR(region.report.quality.volume, 1, 1e-12);
  EXPECT_EQ(findings_of(hole.mesh), "");
  EXPECT_EQ(findings_of(region.mesh), "");
  EXPECT_TRUE(region.mesh.find_group(2, "region_2").is_valid());
  EXPECT_TRUE(region.mesh.groups[region.mesh.find_group(1, "inner")].two_sided);
  EXPECT_FALSE(hole.mesh.groups[hole.mesh.find_group(1, "inner")].two_sided);
}

TEST(GeneratePlanar, T2_an_island_in_a_hole_is_a_region) {
  PlanarDomain domain;
  add_loop(domain, square(40), "outer");
  add_loop(domain, circle({0.5, 0.5}, -0.4, 80), "hole");
  add_loop(domain, circle({0.5, 0.5}, 0.2, 40), "island");
  const Outcome outcome = generate(domain);
  EXPECT_NEAR(outcome.report.quality.volume,
              1 - area_of(circle({0.5, 0.5}, 0.4, 80)) + area_of(circle({0.5, 0.5}, 0.2, 40)), 1e-12);
  EXPECT_EQ(findings_of(outcome.mesh), "");
}

TEST(GeneratePlanar, T2_seeds_name_regions_and_make_holes) {
  PlanarDomain domain;
  add_loop(domain, square(20), "outer");
  add_loop(domain, circle({0.3, 0.5}, 0.15, 24), "left");
  add_loop(domain, circle({0.7, 0.5}, 0.15, 24), "right");
  domain.inner_loops = InnerLoops::are_regions;
  domain.holes = {{0.3, 0.5}};
  domain.regions = {{{0.7, 0.5}, "solid", 0.01}, {{0.01, 0.01}, "air", {}}};
  const Outcome outcome = generate(domain);
  EXPECT_EQ(findings_of(outcome.mesh), "");
  EXPECT_NEAR(outcome.report.quality.volume, 1 - area_of(circle({0.3, 0.5}, 0.15, 24)), 1e-12);
  const GroupId solid = outcome.mesh.find_group(2, "solid"), air = outcome.mesh.find_group(2, "air");
  ASSERT_TRUE(solid.is_valid() && air.is_valid());
  const CellBlock* triangles = outcome.mesh.find_block(CellType::triangle);
  const auto in_solid = std::count(triangles->group.begin(), triangles->group.end(), solid);
  // Wanted: 0.01. Area pi 0.15^2 over sqrt(3)/4 0.01^2 is 1632; the boundary's edges are longer.
  EXPECT_GT(in_solid, 900);
  domain.holes = {{0.5, 0}};
  EXPECT_THROW(generate(domain), InputError);
}

TEST(GeneratePlanar, T2_embedded_lines_and_points_stay) {
  PlanarDomain domain;
  add_loop(domain, square(20), "outer");
  const std::size_t first = domain.points.size();
  for (int i = 0; i <= 8; ++i) domain.points.push_back({0.3 + 0.05 * i, 0.4 + 0.01 * i});
  domain.curves.push_back({"wake", ""});
  for (std::size_t i = 0; i < 8; ++i) {
    domain.segments.push_back({VertexId(first + i), VertexId(first + i + 1)});
    domain.curve_of_segment.push_back(CurveId(1));
  }
  domain.points.push_back({0.123, 0.777});
  const Outcome outcome = generate(domain);
  EXPECT_EQ(findings_of(outcome.mesh), "");
  expect_boundary_kept(domain, outcome.mesh);
  EXPECT_TRUE(outcome.mesh.groups[outcome.mesh.find_group(1, "wake")].two_sided);
  EXPECT_NE(std::find(outcome.mesh.points.begin(), outcome.mesh.points.end(), Point{0.123, 0.777, 0}),
            outcome.mesh.points.end());
  EXPECT_GT(min_angle(outcome), 20);
}

TEST(GeneratePlanar, T2_a_segment_through_a_vertex_is_split_there) {
  PlanarDomain domain;
  add_loop(domain, {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, "outer");
  for (const Point2 p : {Point2{0.5, 0.5}, {1.5, 1.5}, {1, 1}, {0.75, 0.75}}) domain.points.push_back(p);
  domain.curves.push_back({"inner", ""});
  domain.segments.push_back({VertexId(4), VertexId(5)});
  domain.curve_of_segment.push_back(CurveId(1));
  const Outcome outcome = generate(domain);
  EXPECT_EQ(findings_of(outcome.mesh), "");
  const CellBlock* lines = outcome.mesh.find_block(CellType::line);
  const GroupId inner = outcome.mesh.find_group(1, "inner");
  EXPECT_EQ(std::count(lines->group.begin(), lines->group.end(), inner), 3);
}

TEST(GeneratePlanar, T2_crossing_segments_are_refused_with_the_place) {
  PlanarDomain domain;
  add_loop(domain, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "outer");
  for (const Point2 p : {Point2{0.2, 0.2}, {0.8, 0.8}, {0.2, 0.8}, {0.8, 0.2}}) domain.points.push_back(p);
  for (const int i : {4, 6}) {
    domain.segments.push_back({VertexId(std::size_t(i)), VertexId(std::size_t(i) + 1)});
    domain.curve_of_segment.push_back(CurveId(0));
  }
  try {
    generate(domain);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    ASSERT_EQ(e.places.size(), 1u);
    EXPECT_NEAR(e.places[0].at.x, 0.5, 1e-12);
    EXPECT_NEAR(e.places[0].at.y, 0.5, 1e-12);
  }
}

TEST(GeneratePlanar, T2_nothing_bounded_is_refused) {
  PlanarDomain domain;
  domain.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  domain.curves.push_back({"open", ""});
  for (std::size_t i = 0; i < 3; ++i) {
    domain.segments.push_back({VertexId(i), VertexId(i + 1)});
    domain.curve_of_segment.push_back(CurveId(0));
  }
  EXPECT_THROW(generate(domain), InputError);
}

TEST(GeneratePlanar, T3_sizes_of_a_field_are_met) {
  class Graded : public SizeField {
   public:
    void sizes(std::span<const Point> at, std::span<double> size) const override {
      for (std::size_t i = 0; i < at.size(); ++i) size[i] = 0.004 + 0.1 * std::abs(at[i].x - 0.5);
    }
    double lower_bound(const Box&) const override { return 0.004; }
  };
  PlanarDomain domain;
  add_loop(domain, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "outer");
  Options options;
  options.planar.boundary = "split";
  const auto field = std::make_shared<Graded>();
  const Outcome outcome = generate(domain, options, field);
  EXPECT_EQ(findings_of(outcome.mesh), "");
  EXPECT_NEAR(outcome.report.quality.volume, 1, 1e-12);
  EXPECT_GT(min_angle(outcome), 28);
  const CellBlock* triangles = outcome.mesh.find_block(CellType::triangle);
  std::size_t good = 0, all = 0;
  for (std::size_t t = 0; t < triangles->size(); ++t)
    for (unsigned k = 0; k < 3; ++k, ++all) {
      const Point a = outcome.mesh.points[(*triangles)[t][k]], b = outcome.mesh.points[(*triangles)[t][(k + 1) % 3]];
      const double ratio = distance(a, b) / field->size(0.5 * (a + b));
      good += ratio > 0.6 && ratio < 1.5;
    }
  EXPECT_GT(double(good), 0.99 * double(all));
}

TEST(GeneratePlanar, T3_split_boundary_lies_on_the_given_one) {
  PlanarDomain domain;
  add_loop(domain, {{0, 0}, {3, 1}, {2, 4}, {-1, 2}}, "outer");
  add_loop(domain, reversed({{0.9, 1.4}, {1.4, 1.5}, {1.2, 2.1}}), "hole");
  Options options;
  options.planar.boundary = "split";
  options.size.hmax = Length{0.1, ""};
  const Outcome outcome = generate(domain, options);
  EXPECT_EQ(findings_of(outcome.mesh), "");
  EXPECT_GT(min_angle(outcome), 25);
  double given = 0;
  for (const auto& [a, b] : domain.segments)
    given += std::hypot(domain.points[a].x - domain.points[b].x, domain.points[a].y - domain.points[b].y);
  const CellBlock* lines = outcome.mesh.find_block(CellType::line);
  double total = 0;
  for (std::size_t i = 0; i < lines->size(); ++i) {
    const double length = distance(outcome.mesh.points[(*lines)[i][0]], outcome.mesh.points[(*lines)[i][1]]);
    EXPECT_LT(length, 0.15);
    total += length;
  }
  EXPECT_NEAR(total, given, 1e-12 * given);
}

/// Length of a piece over the sizes along it, by the middle of each of many parts.
double sizes_in(const Point2& a, const Point2& b, const SizeField& size) {
  constexpr int kParts = 200;
  double sum = 0;
  for (int i = 0; i < kParts; ++i) {
    const double t = (i + 0.5) / kParts;
    sum += std::hypot(b.x - a.x, b.y - a.y) / kParts / size.size({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), 0});
  }
  return sum;
}

/// The last sizes, not those before pieces were halved for points in their circles.
TEST(GeneratePlanar, T3_no_side_of_a_split_boundary_is_longer_than_the_square_root_of_two_sizes) {
  std::mt19937_64 random(3);
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    PlanarDomain domain;
    add_loop(domain, star(random, {0, 0}, 0.3, 1, 5 + seed % 13), "outer");
    add_loop(domain, reversed(circle({0.01, 0.02}, 0.02 + 0.004 * (seed % 9), 5 + seed % 40)), "hole");
    Options options;
    options.planar.boundary = "split";
    if (seed % 3 == 0) options.size.hmax = Length{0.05 + 0.001 * seed, ""};
    if (seed % 3 == 1) options.size.growth = 1.1 + 0.02 * seed;
    Context context;
    const PlanarPrepared prepared = prepare_planar(domain, options, nullptr, context);
    double worst = 0;
    for (const PlanarPiece& piece : prepared.grid.pieces)
      worst = std::max(
          worst, sizes_in(prepared.grid.complex.point[piece.a], prepared.grid.complex.point[piece.b], *prepared.size));
    EXPECT_LT(worst, 1.43);  // sizes are sampled
  }
}

TEST(GeneratePlanar, T3_sharp_corners_end) {
  for (const double degrees : {30.0, 10.0, 1.0, 0.1, 0.01, 0.001})
    for (const char* boundary : {"keep", "split"}) {
      SCOPED_TRACE(std::to_string(degrees) + " " + boundary);
      const double angle = degrees * std::numbers::pi / 180;
      PlanarDomain domain;
      add_loop(domain, {{0, 0}, {1, 0}, {std::cos(angle), std::sin(angle)}}, "wedge");
      add_loop(domain, circle({0.2, 0}, 3, 60), "farfield", "farfield");
      Options options;
      options.planar.boundary = boundary;
      options.domain.keep = "all";
      const Outcome outcome = generate(domain, options);
      EXPECT_EQ(findings_of(outcome.mesh), "");
      EXPECT_NEAR(outcome.report.quality.volume, area_of(circle({0, 0}, 3, 60)), 1e-11);
      EXPECT_LT(outcome.report.quality.num_cells, 100000u);
    }
}

TEST(GeneratePlanar, T3_far_from_the_origin) {
  PlanarDomain domain;
  std::vector<Point2> loop = square(64);  // coordinates that the offset does not round
  for (Point2& p : loop) p = {p.x + 1048576, p.y - 1048576};
  add_loop(domain, loop, "outer");
  const Outcome outcome = generate(domain);
  EXPECT_EQ(findings_of(outcome.mesh), "");
  EXPECT_NEAR(outcome.report.quality.volume, 1, 1e-9);
  EXPECT_GT(min_angle(outcome), 29);
}

TEST(GeneratePlanar, T3_scaling_by_a_power_of_two_changes_nothing) {
  PlanarDomain domain, scaled;
  std::mt19937_64 random(17);
  const std::vector<Point2> loop = star(random, {0.3, 0.2}, 0.5, 1, 60);
  std::vector<Point2> larger = loop;
  for (Point2& p : larger) p = {0x1p20 * p.x, 0x1p20 * p.y};
  add_loop(domain, loop, "a");
  add_loop(scaled, larger, "a");
  const Outcome one = generate(domain), two = generate(scaled);
  EXPECT_EQ(one.mesh.find_block(CellType::triangle)->vertices, two.mesh.find_block(CellType::triangle)->vertices);
}

TEST(GeneratePlanar, T3_the_same_bytes_twice) {
  PlanarDomain domain;
  std::mt19937_64 random(17);
  add_loop(domain, star(random, {0, 0}, 0.5, 1, 100), "a");
  const Outcome one = generate(domain), two = generate(domain);
  EXPECT_EQ(one.mesh.points, two.mesh.points);
  EXPECT_EQ(one.mesh.find_block(CellType::triangle)->vertices, two.mesh.find_block(CellType::triangle)->vertices);
}

/// Stars in stars, alternately holes and islands, and a row of small holes: 300 of them.
TEST(GeneratePlanar, T2_T3_random_polygons_with_holes) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_int_distribution<int> corners(3, 60);
    PlanarDomain domain;
    double area = 0, radius = 1;
    const int depth = 1 + int(seed % 4);
    for (int k = 0; k < depth; ++k) {
      // A star of n corners keeps clear of the circle of low * cos(pi / n) at worst; gaps of its angles are up
      // to 1.8/n.
      const int n = std::max(6, corners(random));
      const double low = 0.6 * radius;
      const std::vector<Point2> loop = star(random, {0, 0}, low, radius, n);
      add_loop(domain, k % 2 ? reversed(loop) : loop, "loop" + std::to_string(k));
      area += (k % 2 ? -1 : 1) * area_of(loop);
      radius = 0.9 * low * std::cos(1.8 * std::numbers::pi / n);
    }
    Options options;
    if (seed % 3 == 0) options.planar.boundary = "split";
    const Outcome outcome = generate(domain, options);
    ASSERT_EQ(findings_of(outcome.mesh), "");
    ASSERT_NEAR(outcome.report.quality.volume, area, 1e-12);
    if (seed % 3) expect_boundary_kept(domain, outcome.mesh);
  }
}

TEST(GeneratePlanar, T2_random_segments_without_crossings_are_all_there) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_int_distribution<int> place(0, 30);
    // On a lattice, so that points on segments and overlaps are common; a crossing segment is dropped again.
    PlanarDomain domain;
    add_loop(domain, {{-1, -1}, {31, -1}, {31, 31}, {-1, 31}}, "outer");
    for (int i = 0; i < 40; ++i) {
      PlanarDomain more = domain;
      for (int k = 0; k < 2; ++k) more.points.push_back({double(place(random)), double(place(random))});
      more.segments.push_back({VertexId(more.points.size() - 2), VertexId(more.points.size() - 1)});
      more.curve_of_segment.push_back(CurveId(0));
      Options options;
      options.improve.enabled = false;
      options.size.hmax = Length{100, ""};
      options.domain.keep = "all";
      try {
        const Outcome outcome = generate(more, options);
        ASSERT_EQ(findings_of(outcome.mesh), "");
        ASSERT_NEAR(outcome.report.quality.volume, 32 * 32, 1e-9);
        domain = more;
      } catch (const InputError& e) {
        ASSERT_FALSE(e.places.empty());
      }
    }
    EXPECT_GT(domain.segments.size(), 8u);
  }
}

}  // namespace
}  // namespace delfront
