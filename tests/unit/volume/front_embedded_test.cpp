// SPDX-License-Identifier: Apache-2.0
// The pure front round curves and points in the volume: its exact test against fractions, and grids that have them all.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "delfront/grid_check.hpp"
#include "delfront/size_field.hpp"
#include "delfront/surface_check.hpp"
#include "delfront/uniform_size.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"
#include "support/tet_fixtures.hpp"
#include "volume/front.hpp"
#include "volume/front_obstacles.hpp"
#include "volume/to_mesh.hpp"

namespace delfront {
namespace {

using namespace fixtures;

/// The definition, by fractions of whole numbers: where a segment enters a tet, where it leaves it.
bool meets_by_fractions(const std::array<NumberedPoint, 2>& s, const std::array<NumberedPoint, 4>& tet) {
  const auto is_corner = [&](const NumberedPoint& p) {
    return std::any_of(tet.begin(), tet.end(), [&](const NumberedPoint& q) { return q.id == p.id; });
  };
  if (is_corner(s[0]) && is_corner(s[1])) return false;
  struct Fraction {
    std::int64_t up, down;  // down > 0
    bool operator<(const Fraction& o) const { return up * o.down < o.up * down; }
  };
  Fraction from{0, 1}, to{1, 1};
  for (const auto& k : kFaceNodes) {
    const auto height = [&](Point p) {
      const Point a = tet[k[0]].at;
      return std::llround(dot(cross(tet[k[1]].at - a, tet[k[2]].at - a), p - a));
    };
    const std::int64_t start = height(s[0].at), end = height(s[1].at), slope = end - start;
    if (slope == 0 && start < 0) return false;
    if (slope > 0) from = std::max(from, Fraction{-start, slope});
    if (slope < 0) to = std::min(to, Fraction{start, -slope});
  }
  if (is_corner(s[0])) return Fraction{0, 1} < to;
  if (is_corner(s[1])) return from < Fraction{1, 1};
  return !(to < from);
}

TEST(FrontObstacles, segments_and_tets_on_a_lattice_as_by_fractions) {
  std::mt19937 random(1);
  int met = 0, apart = 0;
  for (int i = 0; i < 300000; ++i) {
    std::uniform_int_distribution<int> place(0, 1 + i % 5);
    const auto point = [&] { return Point{double(place(random)), double(place(random)), double(place(random))}; };
    std::array<NumberedPoint, 4> tet{{{0, point()}, {1, point()}, {2, point()}, {3, point()}}};
    if (orient3d(tet[0].at, tet[1].at, tet[2].at, tet[3].at) <= 0) continue;
    std::array<NumberedPoint, 2> segment{{{4, point()}, {5, point()}}};
    if (i % 7 == 0) segment[1] = segment[0];
    for (NumberedPoint& p : segment)
      for (const NumberedPoint& q : tet)
        if (p.at == q.at) p.id = q.id;
    if (segment[0].at == segment[1].at) segment[1] = segment[0];
    const bool expected = meets_by_fractions(segment, tet);
    ASSERT_EQ(is_met_by_tet(segment, tet), expected) << "case " << i;
    ++(expected ? met : apart);
  }
  EXPECT_GT(met, 10000);
  EXPECT_GT(apart, 10000);
}

struct Filled {
  BoundaryGrid grid;
  RecoveryReport recovery;
  FrontReport report;
};

BoundaryGrid recovered(const Model& model, RecoveryReport& report) {
  Context context;
  EXPECT_FALSE(has_errors(check_surface(model, context).findings));
  return tetrahedralize_boundary(model, DomainOptions(), std::vector<bool>(model.patches.size(), false), report,
                                 context);
}

/// By the front itself, with every edge of a curve and every point in the grid, and all else that must hold.
Filled expect_embedded(const Facets& body, const SizeField& size) {
  const Model model = to_model(body);
  Filled r;
  r.grid = recovered(model, r.recovery);
  TetComplex& c = r.grid.complex;
  const double volume = total_volume(c);
  const auto edges = c.kept_edges.sorted();
  std::vector<VertexIndex> used;
  for (VertexIndex v = 0; v < c.num_vertices(); ++v)
    if (c.on_boundary[v] && c.vertex_tet[v] != kNoIndex) used.push_back(v);
  const auto faces = constrained_faces(c);
  Context context;
  r.report = fill_by_front(r.grid, size, context);
  EXPECT_EQ(r.report.gave_up, "");
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_NEAR(total_volume(c), volume, 1e-11 * volume);
  EXPECT_EQ(constrained_faces(c), faces);
  std::vector<TetIndex> scratch;
  for (const auto& [a, b] : edges) EXPECT_NE(c.find_edge(a, b, scratch), kNoIndex) << a << " " << b;
  for (const VertexIndex v : used) EXPECT_NE(c.vertex_tet[v], kNoIndex) << v;
  for (const Finding& f : check(to_mesh(r.grid, model))) EXPECT_NE(f.severity, Severity::error) << f.message;
  return r;
}

TEST(FrontEmbedded, one_edge_in_a_cube) {
  for (const double length : {0.01, 0.2, 0.6}) {
    Facets body = gridded_cube(4);
    body.curves.push_back({body.add_point({0.2, 0.43, 0.51}), body.add_point({0.2 + length, 0.57, 0.49})});
    EXPECT_EQ(expect_embedded(body, UniformSize(0.25)).recovery.curve_edges, 1u) << length;
  }
}

TEST(FrontEmbedded, a_ring) {
  Facets body = sphere_facets(3);
  std::vector<std::size_t> ring;
  for (int i = 0; i < 24; ++i) {
    const double angle = i * std::numbers::pi / 12;
    ring.push_back(body.add_point({0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.1}));
  }
  ring.push_back(ring.front());
  body.curves.push_back(ring);
  EXPECT_EQ(expect_embedded(body, UniformSize(0.14)).recovery.curve_edges, 24u);
}

/// From a vertex of the sphere to the opposite one.
TEST(FrontEmbedded, a_chain_from_wall_to_wall) {
  for (const int pieces : {1, 5, 20, 100}) {
    SCOPED_TRACE(pieces);
    Facets body = sphere_facets(3);
    const auto opposite = [&](std::size_t v) {
      for (std::size_t w = 0; w < body.points.size(); ++w)
        if (squared_length(body.points[v] + body.points[w]) < 1e-24) return w;
      return v;
    };
    const std::size_t end = opposite(0);
    ASSERT_NE(end, 0u);
    const Point from = body.points[0], to = body.points[end];
    std::vector<std::size_t> chain{0};
    for (int i = 1; i < pieces; ++i) {
      const double t = double(i) / pieces;
      const Point off{0.1 * std::sin(9 * t), 0.08 * std::sin(7 * t), 0.05 * t * (1 - t)};
      chain.push_back(body.add_point(from + t * (to - from) + (1 - t) * t * 4 * off));
    }
    chain.push_back(end);
    body.curves.push_back(chain);
    EXPECT_EQ(expect_embedded(body, UniformSize(0.14)).recovery.curve_edges, static_cast<std::size_t>(pieces));
  }
}

TEST(FrontEmbedded, three_curves_that_cross_in_one_corner) {
  Facets body = gridded_cube(5);
  const std::size_t middle = body.add_point({0.5, 0.5, 0.5});
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::size_t> curve;
    for (int i = 1; i <= 9; ++i) {
      Point p{0.5, 0.5, 0.5};
      p[axis] = i / 10.0;
      curve.push_back(i == 5 ? middle : body.add_point(p));
    }
    body.curves.push_back(curve);
  }
  EXPECT_EQ(expect_embedded(body, UniformSize(0.2)).recovery.curve_edges, 24u);
}

TEST(FrontEmbedded, a_thousand_points) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.01, 0.99);
  for (const double h : {0.2, 0.05}) {
    Facets body = gridded_cube(5);
    for (int i = 0; i < 1000; ++i) body.corners.push_back(body.add_point({unit(random), unit(random), unit(random)}));
    EXPECT_EQ(expect_embedded(body, UniformSize(h)).recovery.embedded_points, 1000u);
  }
}

TEST(FrontEmbedded, points_and_edges_close_to_a_wall) {
  Facets body = gridded_cube(4);
  for (int i = 0; i < 5; ++i) {
    body.corners.push_back(body.add_point({0.11 + 0.17 * i, 0.37, 1e-6}));
    body.curves.push_back(
        {body.add_point({0.15 + 0.17 * i, 0.5, 1 - 1e-6}), body.add_point({0.2 + 0.17 * i, 0.6, 1 - 2e-6})});
  }
  EXPECT_EQ(expect_embedded(body, UniformSize(0.25)).recovery.embedded_points, 5u);
}

TEST(FrontEmbedded, several_regions) {
  Facets body = box_facets({0, 0, 0}, {1, 1, 1});
  Facets next = box_facets({1, 0, 0}, {2, 1, 1});
  next.faces.erase(next.faces.begin());  // the wall is there already
  body.add(next);
  for (int i = 0; i < 4; ++i) {
    const double x = 0.3 + 0.4 * i;
    body.curves.push_back({body.add_point({x, 0.4, 0.4}), body.add_point({x + 0.1, 0.6, 0.5})});
    body.corners.push_back(body.add_point({x, 0.7, 0.7}));
  }
  const Filled r = expect_embedded(body, UniformSize(0.3));
  EXPECT_EQ(r.grid.regions.size(), 2u);
  EXPECT_EQ(r.recovery.curve_edges, 4u);
}

TEST(FrontEmbedded, the_same_grid_for_any_number_of_threads) {
  Facets body = sphere_facets(4);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  for (int i = 0; i < 300; ++i) body.corners.push_back(body.add_point({unit(random), unit(random), unit(random)}));
  for (int i = 0; i < 20; ++i) {
    std::vector<std::size_t> curve;
    for (int k = 0; k < 10; ++k) curve.push_back(body.add_point({-0.5 + 0.1 * k, 0.04 * i - 0.4, 0.1 * unit(random)}));
    body.curves.push_back(curve);
  }
  const Model model = to_model(body);
  RecoveryReport recovery;
  const BoundaryGrid empty = recovered(model, recovery);
  BoundaryGrid first = empty;
  Context context;
  const FrontReport report = fill_by_front(first, UniformSize(0.06), context);
  EXPECT_EQ(report.gave_up, "");
  for (const int threads : {2, 3}) {
    BoundaryGrid other = empty;
    context.threads = threads;
    fill_by_front(other, UniformSize(0.06), context);
    EXPECT_EQ(first.complex.node, other.complex.node);
    EXPECT_EQ(first.complex.neigh, other.complex.neigh);
  }
}

/// Chains, some from walls, and points at random in a box with a hole.
Facets random_room(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const int n = 1 + static_cast<int>(random() % 5);
  Facets body = gridded_cube(n);
  const bool has_hole = random() % 2 == 0;
  if (has_hole) {
    Facets hole = box_facets({0.4, 0.42, 0.44}, {0.6, 0.62, 0.64});
    hole.turn();
    body.add(hole);
  }
  const auto is_free = [&](Point p) {
    return !has_hole || p.x < 0.38 || p.x > 0.62 || p.y < 0.4 || p.y > 0.64 || p.z < 0.4 || p.z > 0.66;
  };
  const auto place = [&] {
    for (;;)
      if (const Point p{unit(random), unit(random), unit(random)}; is_free(p)) return p;
  };
  const double step = std::pow(10.0, -0.5 - 1.5 * unit(random));
  for (int chain = 0; chain < 1 + static_cast<int>(random() % 4); ++chain) {
    std::vector<std::size_t> curve{random() % 2 == 0 ? random() % 8 : body.add_point(place())};
    for (std::size_t i = 0; i < 1 + random() % 12; ++i) {
      const Point p =
          body.points[curve.back()] + step * (2 * Point{unit(random), unit(random), unit(random)} - Point{1, 1, 1});
      const bool inside = std::min({p.x, p.y, p.z}) > 0.01 && std::max({p.x, p.y, p.z}) < 0.99;
      if (inside && is_free(p)) curve.push_back(body.add_point(p));
    }
    if (curve.size() > 1) body.curves.push_back(curve);
  }
  for (std::size_t i = random() % 30; i-- > 0;) body.corners.push_back(body.add_point(place()));
  return body;
}

TEST(FrontEmbedded, random_rooms) {
  const unsigned first = setting("DELFRONT_RANDOM_SEED", 1), cases = setting("DELFRONT_RANDOM_CASES", 200);
  unsigned tried = 0;
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    std::mt19937 random(seed);
    const Facets body = random_room(random);
    Context context;
    if (has_errors(check_surface(to_model(body), context).findings)) continue;  // chains that meet
    ++tried;
    const double size = std::pow(10.0, -0.5 - std::uniform_real_distribution<double>(0, 0.6)(random));
    expect_embedded(body, UniformSize(size));
    if (HasFailure()) return;
  }
  EXPECT_GE(2 * tried, cases);
}

}  // namespace
}  // namespace delfront
