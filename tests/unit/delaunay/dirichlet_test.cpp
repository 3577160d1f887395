// SPDX-License-Identifier: Apache-2.0
// Dirichlet cells against their definition: what lies nearer to a point than to any other.
#include "delfront/dirichlet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "delaunay/circumcentre.hpp"
#include "delfront/delaunay.hpp"
#include "delfront/errors.hpp"
#include "unit/delaunay/point_sets.hpp"

namespace delfront {
namespace {

using point_sets::NamedSet;
using point_sets::random_points;
using point_sets::small_sets;

constexpr std::uint32_t kNone = DirichletCells::kNone;

Box box_of(const std::vector<Point>& points, double grow) {
  Box box;
  for (const Point& p : points) box.add(p);
  const Point margin = grow * (box.high - box.low);
  return {box.low - margin, box.high + margin};
}

double volume_of(const Box& box) {
  const Point size = box.high - box.low;
  return size.x * size.y * size.z;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

Point area_of(const DirichletCells& cells, std::size_t f) {
  const auto loop = cells.face(f);
  Point area;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    area = area + 0.5 * cross(cells.vertices[loop[k]] - cells.vertices[loop[0]],
                              cells.vertices[loop[k + 1]] - cells.vertices[loop[0]]);
  return area;
}

/// Surfaces of the cells close: each edge of a cell once in either direction.
void expect_closed(const DirichletCells& cells) {
  for (std::uint32_t cell = 0; cell < cells.num_cells(); ++cell) {
    if (cells.is_unbounded[cell]) continue;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const std::uint32_t f : cells.faces_of(cell)) {
      const auto loop = cells.face(f);
      ASSERT_GE(loop.size(), 3u);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const std::uint32_t v = loop[k], w = loop[(k + 1) % loop.size()];
        ++edges[cells.face_cells[f][0] == cell ? std::pair{v, w} : std::pair{w, v}];
      }
    }
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(count, 1) << "cell " << cell;
      ASSERT_EQ(edges.count({edge.second, edge.first}), 1u) << "cell " << cell;
    }
  }
}

/// Vertices of a face between two cells are as near to one point as to the other; normals run from the first.
void expect_faces_between(const std::vector<Point>& points, const DirichletCells& cells, double size) {
  for (std::size_t f = 0; f < cells.num_faces(); ++f) {
    const auto [a, b] = cells.face_cells[f];
    ASSERT_NE(a, kNone);
    if (b == kNone) continue;
    const Point normal = (points[b] - points[a]) / length(points[b] - points[a]);
    for (const std::uint32_t v : cells.face(f))
      ASSERT_NEAR(dot(cells.vertices[v] - 0.5 * (points[a] + points[b]), normal), 0, 1e-11 * size);
    ASSERT_GE(dot(area_of(cells, f), normal), -1e-11 * size * size);
  }
}

bool holds(const DirichletCells& cells, std::uint32_t cell, Point at, double tolerance) {
  for (const std::uint32_t f : cells.faces_of(cell)) {
    const Point area = area_of(cells, f);
    const double outside = dot(at - cells.vertices[cells.face(f)[0]], area) * (cells.face_cells[f][0] == cell ? 1 : -1);
    if (outside > tolerance * length(area)) return false;
  }
  return true;
}

std::uint32_t nearest(const std::vector<Point>& points, Point at) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < points.size(); ++i)
    if (squared_length(points[i] - at) < squared_length(points[best] - at)) best = i;
  return best;
}

TEST(Circumcentre, is_as_far_from_all_corners_however_flat_the_tet) {
  std::mt19937 random(51);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int n = 0; n < 20000; ++n) {
    const double flat = std::pow(10.0, -(n % 17));
    Point p[4];
    for (Point& q : p) q = {uniform(random), uniform(random), flat * uniform(random)};
    if (n % 3 == 0)
      for (Point& q : p) q = q + Point{3, 4, 5};
    if (!(dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0])) > 0)) std::swap(p[0], p[1]);
    if (!(dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0])) > 0)) continue;
    const Point centre = circumcentre(p[0], p[1], p[2], p[3]);
    const double radius = distance(centre, p[3]);
    for (int i = 0; i < 3; ++i) {  // the bisecting plane, in long double since the radius may be large
      const Point mid = 0.5 * (p[i] + p[3]), along = p[i] - p[3];
      long double off = 0;
      for (int k = 0; k < 3; ++k) off += (static_cast<long double>(centre[k]) - mid[k]) * along[k];
      ASSERT_LT(std::fabs(static_cast<double>(off)), 2e-12 * length(along) * std::max(1.0, 1e-3 * radius))
          << "seed 51 case " << n;
    }
  }
}

TEST(Circumcentre, is_the_same_at_any_scale) {
  const Point p[4] = {{1, 0.25, 0}, {0, 1, 0.5}, {0.125, 0, 1}, {0, 0, 0}};
  const Point wanted = circumcentre(p[0], p[1], p[2], p[3]);
  const auto wanted2 = circumcentre2({1, 0.25}, {0, 1}, {0, 0});
  for (const int bits : {-1000, -400, -150, -90, 90}) {
    const double s = std::ldexp(1.0, bits);
    const Point centre = circumcentre(s * p[0], s * p[1], s * p[2], s * p[3]);
    EXPECT_LE(distance(std::ldexp(1.0, -bits) * centre, wanted), 1e-15);
    const auto centre2 = circumcentre2({s, s / 4}, {0, s}, {0, 0});
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(std::ldexp(centre2[k], -bits), wanted2[k], 1e-15);
  }
  EXPECT_NEAR(distance(wanted, p[3]), distance(wanted, p[0]), 1e-15);
}

TEST(Dirichlet, T6_cells_of_a_lattice_are_cubes) {
  const std::vector<Point> points = point_sets::lattice(6, 0.5, {0.25, 0.25, 0.25});
  for (const bool clip : {false, true}) {
    Context context;
    const DirichletCells cells =
        clip ? dirichlet(points, context, Box{{0, 0, 0}, {3, 3, 3}}) : dirichlet(points, context);
    int cubes = 0;
    for (std::uint32_t cell = 0; cell < points.size(); ++cell) {
      if (cells.is_unbounded[cell]) continue;
      ++cubes;
      ASSERT_NEAR(cells.volumes[cell], 0.125, clip ? 1e-13 : 0);
      ASSERT_EQ(cells.faces_of(cell).size(), 6u);
      std::set<std::uint32_t> corners;
      for (const std::uint32_t f : cells.faces_of(cell)) {
        ASSERT_EQ(cells.face(f).size(), 4u);
        corners.insert(cells.face(f).begin(), cells.face(f).end());
      }
      ASSERT_EQ(corners.size(), 8u);
    }
    EXPECT_EQ(cubes, clip ? 216 : 64);
    EXPECT_EQ(cells.vertices.size(), clip ? 343u : 125u);
    expect_closed(cells);
  }
}

TEST(Dirichlet, clipped_to_its_own_box_a_lattice_has_half_cubes_at_the_border) {
  const std::vector<Point> points = point_sets::lattice(4, 1, {});
  Context context;
  const DirichletCells cells = dirichlet(points, context, Box{{0, 0, 0}, {3, 3, 3}});
  for (std::size_t i = 0; i < points.size(); ++i) {
    double wanted = 1;
    for (int k = 0; k < 3; ++k) wanted *= points[i][k] == 0 || points[i][k] == 3 ? 0.5 : 1;
    EXPECT_NEAR(cells.volumes[i], wanted, 1e-13);
    EXPECT_EQ(cells.faces_of(i).size(), 6u);
  }
  expect_closed(cells);
}

TEST(Dirichlet, clipped_volumes_sum_to_the_box_and_everything_closes) {
  for (const NamedSet& set : small_sets())
    for (const double grow : {0.0, 0.5, 20.0, -0.2}) {
      SCOPED_TRACE(set.name + ", box grown by " + std::to_string(grow));
      const Box box = box_of(set.points, grow);
      Context context;
      const DirichletCells cells = dirichlet(set.points, context, box);
      EXPECT_NEAR(sum(cells.volumes), volume_of(box), 1e-11 * volume_of(box));
      EXPECT_EQ(std::count(cells.is_unbounded.begin(), cells.is_unbounded.end(), 1), 0);
      for (const double v : cells.volumes) EXPECT_GE(v, -1e-12 * volume_of(box));
      ASSERT_NO_FATAL_FAILURE(expect_closed(cells));
      ASSERT_NO_FATAL_FAILURE(expect_faces_between(set.points, cells, box.diagonal()));
      for (const Point& v : cells.vertices)
        for (int k = 0; k < 3; ++k) {
          ASSERT_GE(v[k], box.low[k]);
          ASSERT_LE(v[k], box.high[k]);
        }
      for (const auto& [v, used] : cells.duplicates) {
        EXPECT_EQ(cells.volumes[v], 0);
        EXPECT_TRUE(cells.faces_of(v).empty());
        EXPECT_EQ(set.points[v], set.points[used]);
      }
    }
}

TEST(Dirichlet, tiny_sets_full_of_ties_close_and_fill_the_box) {
  std::mt19937 random(58);
  const auto upto = [&](int n) { return static_cast<double>(random() % static_cast<unsigned>(n + 1)); };
  for (int n = 0; n < 2000; ++n) {
    std::vector<Point> points;
    const double step = n % 2 == 0 ? 1 : 0.1;  // 0.1: ties broken by rounding
    for (int i = 0; i < 1 + n % 17; ++i) points.push_back({step * upto(3), step * upto(3), step * upto(3)});
    const Box box{{step * (upto(2) - 1), -step, step * 0.5}, {step * (upto(2) + 1.5), step * 2.5, step * 3}};
    SCOPED_TRACE("seed 58 case " + std::to_string(n));
    Context context;
    const DirichletCells cells = dirichlet(points, context, box);
    ASSERT_NEAR(sum(cells.volumes), volume_of(box), 1e-11 * volume_of(box));
    ASSERT_NO_FATAL_FAILURE(expect_closed(cells));
    ASSERT_NO_FATAL_FAILURE(expect_faces_between(points, cells, box.diagonal()));
  }
}

TEST(Dirichlet, random_places_lie_in_the_cell_of_the_nearest_point) {
  std::mt19937 random(52);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const NamedSet& set : small_sets()) {
    if (set.name == "neighbours in floating point") continue;  // no room for places between them
    SCOPED_TRACE(set.name + ", seed 52");
    const Box box = box_of(set.points, 0.1);
    Context context;
    const DirichletCells clipped = dirichlet(set.points, context, box), open = dirichlet(set.points, context);
    for (int n = 0; n < 300; ++n) {
      const Point size = box.high - box.low;
      Point at = box.low + Point{size.x * uniform(random), size.y * uniform(random), size.z * uniform(random)};
      if (n % 2 == 0) {  // near a point: small cells too
        const Point& p = set.points[random() % set.points.size()];
        at = p + std::pow(10.0, -9 * uniform(random)) * (at - p);
      }
      const std::uint32_t cell = nearest(set.points, at);
      bool is_held = false;  // by its cell, or that of a point that is as near to within rounding
      for (std::uint32_t i = 0; i < set.points.size(); ++i) {
        if (clipped.faces_of(i).empty()) continue;
        if (distance(set.points[i], at) > distance(set.points[cell], at) + 1e-15 * box.diagonal()) continue;
        is_held |= holds(clipped, i, at, 1e-12 * box.diagonal()) && holds(open, i, at, 1e-12 * box.diagonal());
      }
      EXPECT_TRUE(is_held);
      // and in no other that is clearly farther
      for (int k = 0; k < 10; ++k) {
        const auto other = static_cast<std::uint32_t>(random() % set.points.size());
        if (distance(set.points[other], at) < distance(set.points[cell], at) + 1e-9 * box.diagonal()) continue;
        if (clipped.faces_of(other).empty()) continue;
        EXPECT_FALSE(holds(clipped, other, at, -1e-12 * box.diagonal()));
      }
    }
  }
}

TEST(Dirichlet, cells_of_the_hull_are_unbounded_and_the_others_the_same_with_a_large_box) {
  const std::vector<Point> points = random_points(400, 53);
  Context context;
  const DirichletCells open = dirichlet(points, context), clipped = dirichlet(points, context, box_of(points, 1e4));
  std::set<std::uint32_t> corners;
  for (const auto& t : delaunay(points, context).hull) corners.insert(t.begin(), t.end());
  int compared = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(open.is_unbounded[i] != 0, corners.count(i) != 0);
    if (open.is_unbounded[i]) {
      EXPECT_EQ(open.volumes[i], std::numeric_limits<double>::infinity());
      continue;
    }
    EXPECT_GT(open.volumes[i], 0);
    if (open.volumes[i] > 1) continue;  // some reach far out, and may reach the box
    EXPECT_NEAR(open.volumes[i], clipped.volumes[i], 1e-6 * open.volumes[i]);
    ++compared;
  }
  EXPECT_GT(compared, 250);
  expect_closed(open);
}

TEST(Dirichlet, with_a_box_one_point_is_enough_and_so_is_a_plane_of_them) {
  Context context;
  const Box box{{0, 0, 0}, {1, 2, 3}};
  const std::vector<Point> one = {{0.3, 0.4, 0.5}};
  const DirichletCells whole = dirichlet(one, context, box);
  EXPECT_EQ(whole.faces_of(0).size(), 6u);
  EXPECT_NEAR(whole.volumes[0], 6, 1e-13);
  const std::vector<Point> line = {{0.5, 1, 0.5}, {0.5, 1, 1.5}, {0.5, 1, 2.5}, {0.5, 1, 9}};
  const DirichletCells slabs = dirichlet(line, context, box);
  EXPECT_NEAR(slabs.volumes[0], 2, 1e-12);
  EXPECT_NEAR(slabs.volumes[1], 2, 1e-12);
  EXPECT_NEAR(slabs.volumes[2], 2, 1e-12);
  EXPECT_EQ(slabs.volumes[3], 0);  // outside, and farther than the others everywhere
  EXPECT_TRUE(slabs.faces_of(3).empty());
  std::vector<Point> plane;
  for (const Point& p : random_points(60, 54)) plane.push_back({p.x, 2 * p.y, 1});
  EXPECT_NEAR(sum(dirichlet(plane, context, box).volumes), 6, 1e-11);
}

TEST(Dirichlet, what_it_cannot_do_is_refused) {
  Context context;
  const std::vector<Point> points = random_points(10, 55);
  EXPECT_THROW(dirichlet(points, context, Box{}), InputError);
  EXPECT_THROW(dirichlet(points, context, Box{{0, 0, 0}, {1, 1, 0}}), InputError);
  EXPECT_THROW(dirichlet({}, context, Box{{0, 0, 0}, {1, 1, 1}}), InputError);
  EXPECT_THROW(dirichlet({}, context), InputError);
  std::vector<Point> bad = points;
  bad[3].z = std::numeric_limits<double>::infinity();
  EXPECT_THROW(dirichlet(bad, context), InputError);
  EXPECT_THROW(dirichlet(bad, context, Box{{0, 0, 0}, {1, 1, 1}}), InputError);
}

TEST(Dirichlet, threads_and_the_order_of_points_do_not_matter) {
  std::vector<Point> points = random_points(40000, 56);
  Context one, three;
  three.threads = 3;
  const Box box{{0, 0, 0}, {1, 1, 1}};
  const DirichletCells first = dirichlet(points, one, box), second = dirichlet(points, three, box);
  EXPECT_TRUE(first.vertices == second.vertices);
  EXPECT_TRUE(first.face_vertices == second.face_vertices);
  EXPECT_TRUE(first.volumes == second.volumes);
  EXPECT_NEAR(sum(first.volumes), 1, 1e-11);
  std::reverse(points.begin(), points.end());
  DirichletCells reversed = dirichlet(points, one, box);
  std::reverse(reversed.volumes.begin(), reversed.volumes.end());
  EXPECT_EQ(reversed.num_faces(), first.num_faces());
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_NEAR(reversed.volumes[i], first.volumes[i], 1e-15);
}

TEST(Dirichlet, the_mesh_holds_the_bounded_cells_as_polyhedra) {
  const std::vector<Point> points = random_points(100, 57);
  Context context;
  const DirichletCells cells = dirichlet(points, context);
  const Mesh mesh = mesh_of(cells);
  const auto bounded = static_cast<std::size_t>(std::count(cells.is_unbounded.begin(), cells.is_unbounded.end(), 0));
  ASSERT_EQ(mesh.num_cells(CellType::polyhedron), bounded);
  ASSERT_GT(bounded, 10u);
  const CellBlock& block = *mesh.find_block(CellType::polyhedron);
  for (std::size_t cell = 0; cell < bounded; ++cell) {
    const auto stream = block[cell];
    double six_volumes = 0;
    std::size_t at = 1;
    for (std::size_t f = 0; f < stream[0].index(); ++f) {
      const std::size_t n = stream[at].index();
      for (std::size_t k = 2; k < n; ++k)
        six_volumes +=
            dot(mesh.points[stream[at + 1]], cross(mesh.points[stream[at + k]], mesh.points[stream[at + k + 1]]));
      at += n + 1;
    }
    EXPECT_EQ(at, stream.size());
    const auto point = static_cast<std::size_t>(mesh.fields[0].values[cell]);
    EXPECT_EQ(mesh.fields[1].values[cell], cells.volumes[point]);
    EXPECT_NEAR(six_volumes / 6, cells.volumes[point], 1e-9 * std::max(1.0, cells.volumes[point]));
  }
}

}  // namespace
}  // namespace delfront
