// SPDX-License-Identifier: Apache-2.0
// Regular triangulations and Dirichlet cells in the plane against their definitions, by brute force.
#include "delfront/planar_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>

#include "delfront/errors.hpp"
#include "predicates/predicates.hpp"

namespace delfront {
namespace {

constexpr std::uint32_t kNone = DirichletCells2::kNone;

struct NamedSet {
  std::string name;
  std::vector<Point2> points;
};

std::vector<Point2> random_points(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point2> points;
  for (std::size_t i = 0; i < n; ++i) points.push_back({uniform(random), uniform(random)});
  return points;
}

std::vector<NamedSet> small_sets() {
  std::vector<NamedSet> sets;
  sets.push_back({"random, seed 71", random_points(120, 71)});
  std::vector<Point2> lattice, circle, lines, clusters;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) lattice.push_back({double(i), double(j)});
  for (int x = -65; x <= 65; ++x)
    for (int y = -65; y <= 65; ++y)
      if (x * x + y * y == 65 * 65) circle.push_back({double(x), double(y)});
  for (int i = 0; i < 30; ++i) {
    lines.push_back({double(i), 0});
    lines.push_back({3, double(i) - 7});
  }
  for (int c = 0; c < 4; ++c)
    for (const Point2& p : random_points(30, 72 + static_cast<unsigned>(c)))
      clusters.push_back({c + std::pow(10.0, -2 * c) * p.x, c * c + std::pow(10.0, -2 * c) * p.y});
  sets.push_back({"lattice", lattice});
  sets.push_back({"circle", circle});
  sets.push_back({"lines", lines});
  sets.push_back({"clusters, seeds 72 to 75", clusters});
  return sets;
}

Box2 box_of(const std::vector<Point2>& points, double grow) {
  Box box;
  for (const Point2& p : points) box.add(Point{p.x, p.y, 0});
  const Point margin = grow * (box.high - box.low);
  return {{box.low.x - margin.x, box.low.y - margin.y}, {box.high.x + margin.x, box.high.y + margin.y}};
}
double diagonal(const Box2& box) { return std::hypot(box.high.x - box.low.x, box.high.y - box.low.y); }
double area(const Box2& box) { return (box.high.x - box.low.x) * (box.high.y - box.low.y); }
double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
double between(Point2 a, Point2 b) { return std::hypot(a.x - b.x, a.y - b.y); }

bool holds(const DirichletCells2& cells, std::size_t i, Point2 at, double tolerance) {
  const auto loop = cells.cell(i);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Point2 a = cells.vertices[loop[k]], b = cells.vertices[loop[(k + 1) % loop.size()]];
    const double outside = (at.x - a.x) * (b.y - a.y) - (at.y - a.y) * (b.x - a.x);
    if (outside > tolerance * between(a, b)) return false;
  }
  return !loop.empty();
}

/// Each side of a cell stands turned round in the neighbour it names; it lies on the bisector.
void expect_conforming(const std::vector<Point2>& points, const DirichletCells2& cells, double size) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::uint32_t, std::uint32_t>> sides;
  for (std::uint32_t i = 0; i < cells.num_cells(); ++i) {
    const auto loop = cells.cell(i);
    ASSERT_TRUE(loop.empty() || loop.size() >= 3u);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::uint32_t other = cells.cell_neighbours[cells.cell_offsets[i] + k];
      const auto [at, is_new] = sides.insert({{loop[k], loop[(k + 1) % loop.size()]}, {i, other}});
      ASSERT_TRUE(is_new);
      if (other == kNone) continue;
      for (const std::uint32_t v : {at->first.first, at->first.second})
        ASSERT_NEAR(between(cells.vertices[v], points[i]) - between(cells.vertices[v], points[other]), 0, 1e-11 * size);
    }
  }
  for (const auto& [side, cell] : sides) {
    if (cell.second == kNone || cells.is_unbounded[cell.second]) continue;
    const auto twin = sides.find({side.second, side.first});
    ASSERT_NE(twin, sides.end()) << "cell " << cell.first;
    ASSERT_EQ(twin->second, (std::pair{cell.second, cell.first}));
  }
}

TEST(Dirichlet2, T6_clipped_areas_sum_to_the_box_and_cells_conform) {
  for (const NamedSet& set : small_sets())
    for (const double grow : {0.0, 0.5, 20.0, -0.2}) {
      SCOPED_TRACE(set.name + ", box grown by " + std::to_string(grow));
      const Box2 box = box_of(set.points, grow);
      Context context;
      const DirichletCells2 cells = dirichlet2(set.points, context, box);
      EXPECT_NEAR(sum(cells.areas), area(box), 1e-11 * area(box));
      ASSERT_NO_FATAL_FAILURE(expect_conforming(set.points, cells, diagonal(box)));
      for (const Point2& v : cells.vertices)
        EXPECT_TRUE(v.x >= box.low.x && v.x <= box.high.x && v.y >= box.low.y && v.y <= box.high.y);
    }
}

TEST(Dirichlet2, cells_of_a_lattice_are_squares) {
  std::vector<Point2> points;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) points.push_back({i + 0.5, j + 0.5});
  Context context;
  for (const bool clip : {false, true}) {
    const DirichletCells2 cells =
        clip ? dirichlet2(points, context, Box2{{0, 0}, {8, 8}}) : dirichlet2(points, context);
    int squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (cells.is_unbounded[i]) {
        EXPECT_EQ(cells.areas[i], std::numeric_limits<double>::infinity());
        continue;
      }
      ++squares;
      EXPECT_EQ(cells.cell(i).size(), 4u);
      EXPECT_NEAR(cells.areas[i], 1, 1e-13);
    }
    EXPECT_EQ(squares, clip ? 64 : 36);
    EXPECT_EQ(cells.vertices.size(), clip ? 81u : 49u);
    expect_conforming(points, cells, 8);
  }
}

TEST(Dirichlet2, random_places_lie_in_the_cell_of_the_nearest_point) {
  std::mt19937 random(76);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const NamedSet& set : small_sets()) {
    SCOPED_TRACE(set.name + ", seed 76");
    const Box2 box = box_of(set.points, 0.1);
    Context context;
    const DirichletCells2 clipped = dirichlet2(set.points, context, box), open = dirichlet2(set.points, context);
    for (int n = 0; n < 500; ++n) {
      Point2 at{box.low.x + uniform(random) * (box.high.x - box.low.x),
                box.low.y + uniform(random) * (box.high.y - box.low.y)};
      const auto nearest = static_cast<std::size_t>(
          std::min_element(set.points.begin(), set.points.end(),
                           [&](Point2 a, Point2 b) { return between(a, at) < between(b, at); }) -
          set.points.begin());
      EXPECT_TRUE(holds(clipped, nearest, at, 1e-12 * diagonal(box)));
      EXPECT_TRUE(open.is_unbounded[nearest] || holds(open, nearest, at, 1e-12 * diagonal(box)));
      for (std::size_t i = 0; i < set.points.size(); ++i)
        if (between(set.points[i], at) > between(set.points[nearest], at) + 1e-9 * diagonal(box)) {
          EXPECT_FALSE(holds(clipped, i, at, -1e-12 * diagonal(box)));
        }
    }
  }
}

TEST(Dirichlet2, one_point_fills_the_box_and_what_cannot_be_done_is_refused) {
  Context context;
  const std::vector<Point2> one = {{0.25, 5}};
  const DirichletCells2 whole = dirichlet2(one, context, Box2{{0, 0}, {1, 2}});
  EXPECT_EQ(whole.cell(0).size(), 4u);
  EXPECT_NEAR(whole.areas[0], 2, 1e-13);
  EXPECT_THROW(dirichlet2(one, context), InputError);
  EXPECT_THROW(dirichlet2(one, context, Box2{{0, 0}, {1, 0}}), InputError);
  EXPECT_THROW(dirichlet2({}, context, Box2{{0, 0}, {1, 1}}), InputError);
  const std::vector<Point2> bad = {{0, std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_THROW(dirichlet2(bad, context, Box2{{0, 0}, {1, 1}}), InputError);
}

TEST(Dirichlet2, repeated_points_have_empty_cells_and_the_mesh_the_others) {
  std::vector<Point2> points = random_points(50, 77);
  for (std::size_t i = 0; i < 10; ++i) points.push_back(points[3 * i]);
  Context context;
  const DirichletCells2 cells = dirichlet2(points, context, Box2{{0, 0}, {1, 1}});
  EXPECT_EQ(cells.duplicates.size(), 10u);
  for (std::size_t i = 50; i < 60; ++i) EXPECT_EQ(cells.areas[i], 0);
  EXPECT_NEAR(sum(cells.areas), 1, 1e-12);
  const Mesh mesh = mesh_of(cells);
  EXPECT_EQ(mesh.dimension, 2);
  EXPECT_EQ(mesh.num_cells(CellType::polygon), 50u);
  EXPECT_NEAR(sum(mesh.fields[1].values), 1, 1e-12);
}

/// Whether p, lifted, lies strictly below the plane through the lifted corners of the anticlockwise triangle, in long
/// double with a margin: 0 where it is too near to tell.
int power_sign(const std::vector<Point2>& points, const std::vector<double>& weights,
               const std::array<std::uint32_t, 3>& t, std::uint32_t p) {
  long double x[3], y[3], lift[3];
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = static_cast<long double>(points[t[i]].x) - points[p].x;
    y[i] = static_cast<long double>(points[t[i]].y) - points[p].y;
    lift[i] = x[i] * x[i] + y[i] * y[i] - (static_cast<long double>(weights[t[i]]) - weights[p]);
  }
  long double det = 0, size = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    det += lift[i] * (x[j] * y[k] - x[k] * y[j]);
    size += std::fabs(lift[i]) * (std::fabs(x[j] * y[k]) + std::fabs(x[k] * y[j]));
  }
  return std::fabs(det) <= 1e-17L * size ? 0 : det > 0 ? 1 : -1;
}

TEST(Regular2, T4_the_definition_holds) {
  std::size_t hidden = 0;
  for (int kind = 0; kind < 3; ++kind) {
    std::mt19937 random(78);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const NamedSet& set : small_sets()) {
      SCOPED_TRACE(set.name + ", weights of kind " + std::to_string(kind) + ", seed 78");
      const Box2 box = box_of(set.points, 0);
      std::vector<double> weights;
      for (const Point2& p : set.points)
        weights.push_back(kind == 0   ? 7
                          : kind == 1 ? uniform(random) * area(box) / static_cast<double>(set.points.size())
                                      : p.x * p.x + p.y * p.y - p.x);  // ties everywhere
      Context context;
      const RegularTriangulation2 result = regular2(set.points, weights, context);
      const Triangulation2& mesh = result.triangulation;
      double total = 0;
      std::vector<std::uint8_t> is_used(set.points.size(), 0);
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& n = mesh.triangles[t];
        const Point2 &a = set.points[n[0]], &b = set.points[n[1]], &c = set.points[n[2]];
        ASSERT_GT(orient2d(&a.x, &b.x, &c.x), 0);
        total += 0.5 * ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
        for (std::size_t i = 0; i < 3; ++i) {
          is_used[n[i]] = 1;
          const std::uint32_t other = mesh.neighbours[t][i];
          if (other == Triangulation2::kNone) continue;
          const auto& back = mesh.neighbours[other];
          ASSERT_NE(std::find(back.begin(), back.end(), t), back.end());
          for (const std::uint32_t v : {n[(i + 1) % 3], n[(i + 2) % 3]})
            ASSERT_NE(std::find(mesh.triangles[other].begin(), mesh.triangles[other].end(), v),
                      mesh.triangles[other].end());
        }
        for (std::uint32_t v = 0; v < set.points.size(); ++v) ASSERT_LE(power_sign(set.points, weights, n, v), 0);
      }
      double hull = 0;  // area inside of the hull; convex
      for (std::size_t i = 0; i < mesh.hull.size(); ++i) {
        const Point2 &a = set.points[mesh.hull[i]], &b = set.points[mesh.hull[(i + 1) % mesh.hull.size()]];
        hull += 0.5 * (a.x * b.y - b.x * a.y);
        for (const Point2& p : set.points) ASSERT_GE(orient2d(&a.x, &b.x, &p.x), 0);
      }
      EXPECT_NEAR(total, hull, 1e-12 * hull);
      for (const std::uint32_t v : result.hidden) EXPECT_EQ(is_used[v]++, 0);
      for (const auto& duplicate : mesh.duplicates) EXPECT_EQ(is_used[duplicate.first]++, 0);
      EXPECT_EQ(std::count(is_used.begin(), is_used.end(), 0), 0);
      hidden += result.hidden.size();
      if (kind == 0) {
        EXPECT_TRUE(result.hidden.empty());
      }
    }
  }
  EXPECT_GT(hidden, 50u);
}

TEST(Regular2, what_it_cannot_do_is_refused_with_the_reason) {
  Context context;
  const auto message = [&](const std::vector<Point2>& points, std::size_t num_weights) -> std::string {
    try {
      regular2(points, std::vector<double>(num_weights, 0), context);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_NE(message({{0, 0}, {1, 0}}, 2).find("at least three"), std::string::npos);
  EXPECT_NE(message({{0, 0}, {1, 1}, {2, 2}, {3, 3}}, 4).find("one line"), std::string::npos);
  EXPECT_NE(message({{1, 1}, {1, 1}, {1, 1}}, 3).find("one place"), std::string::npos);
  EXPECT_NE(message({{0, 0}, {1, 0}, {0, 1}}, 2).find("2 weights"), std::string::npos);
  EXPECT_NE(message({{0, 0}, {1, 0}, {0, std::numeric_limits<double>::infinity()}}, 3).find("point 2"),
            std::string::npos);
}

}  // namespace
}  // namespace delfront
