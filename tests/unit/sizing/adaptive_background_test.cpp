// SPDX-License-Identifier: Apache-2.0
#include "delfront/adaptive_background.hpp"

#include <gtest/gtest.h>

#include "background_grids.hpp"
#include "delfront/errors.hpp"
#include "delfront/grid_check.hpp"

namespace delfront {
namespace {

using namespace fixtures;

struct Sized {
  std::vector<Point> points;
  std::vector<double> size;
};

/// Points on a circle (in space a sphere) of small sizes, and some wild ones.
Sized some_points(bool is_plane) {
  Sized result;
  for (const Point& p : random_points(400, -1, 1, 31, is_plane)) {
    result.points.push_back(Point{0.5, 0.5, is_plane ? 0 : 0.5} + (0.3 / length(p)) * p);
    result.size.push_back(0.01 + 0.01 * std::abs(p.x));
  }
  for (const Point& p : random_points(20, 0, 1, 32, is_plane)) {
    result.points.push_back(p);
    result.size.push_back(0.05);
  }
  return result;
}

Box unit_box(bool is_plane) { return {{0, 0, 0}, {1, 1, is_plane ? 0.0 : 1.0}}; }

double allowed(PointRule rule, double s, double delta) {
  return rule == PointRule::slope ? delta + s * 0.2 / 1.2 : std::max(delta, (s * 0.2 + delta) / 1.2);
}

double volume_of(const Mesh& mesh) {
  double sum = 0;
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; cell < block.size(); ++cell) {
      const auto v = block[cell];
      if (block.type == CellType::tetrahedron)
        sum += dot(mesh.points[v[1]] - mesh.points[v[0]],
                   cross(mesh.points[v[2]] - mesh.points[v[0]], mesh.points[v[3]] - mesh.points[v[0]])) /
               6;
      else if (block.type == CellType::triangle && mesh.dimension == 2)
        sum += cross(mesh.points[v[1]] - mesh.points[v[0]], mesh.points[v[2]] - mesh.points[v[0]]).z / 2;
    }
  return sum;
}

TEST(AdaptiveBackground, S8_follows_the_points_with_a_sound_grid) {
  for (const auto& [is_plane, rule] : {std::pair{true, PointRule::slope},
                                       {false, PointRule::slope},
                                       {true, PointRule::sequence},
                                       {false, PointRule::sequence}}) {
    Context context;
    const Sized asked = some_points(is_plane);
    AdaptiveBackground background(unit_box(is_plane), 3, 1.0, context);
    EXPECT_TRUE(check(background.grid(context).mesh).empty());
    const AdaptReport report = background.adapt(asked.points, asked.size, {.rule = rule}, context);
    EXPECT_TRUE(report.is_converged);
    EXPECT_GT(report.cells_refined, 20u);
    EXPECT_EQ(report.points_outside, 0u);
    const BackgroundGrid grid = background.grid(context);
    const auto findings = check(grid.mesh);
    EXPECT_TRUE(findings.empty()) << findings[0].message;
    EXPECT_NEAR(volume_of(grid.mesh), 1, 1e-12);
    // (3.18) at every node, from every point, and no size below the least there is.
    const Field& size = grid.mesh.fields[0];
    for (std::size_t node = 0; node < grid.mesh.points.size(); ++node) {
      ASSERT_GE(size.values[node], 0.01);
      for (std::size_t i = 0; i < asked.points.size(); ++i)
        ASSERT_LE(
            size.values[node],
            allowed(rule, distance(grid.mesh.points[VertexId(node)], asked.points[i]), asked.size[i]) * (1 + 1e-12));
    }
    // (3.19) holds no more: a point's cell has a node with at most 1.5 of its size, or a smaller one.
    const auto field = build_background_size_field(grid, {}, context);
    for (std::size_t i = 0; i < asked.points.size(); ++i) {
      const Point p = asked.points[i];
      ASSERT_LE(field->lower_bound({p, p}), 1.5 * asked.size[i]);
    }
  }
}

TEST(AdaptiveBackground, S8_twenty_passes_do_not_ratchet_sizes_down) {
  for (const bool is_plane : {true, false}) {
    Context context;
    const Sized asked = some_points(is_plane);
    AdaptiveBackground background(unit_box(is_plane), 3, 1.0, context);
    background.adapt(asked.points, asked.size, {}, context);
    const BackgroundGrid first = background.grid(context);
    for (int pass = 1; pass < 20; ++pass) {
      const AdaptReport report = background.adapt(asked.points, asked.size, {}, context);
      ASSERT_EQ(report.nodes_lowered, 0u) << "pass " << pass;
      ASSERT_EQ(report.cells_refined, 0u) << "pass " << pass;
    }
    EXPECT_EQ(background.grid(context).mesh.fields[0].values, first.mesh.fields[0].values);
  }
}

TEST(AdaptiveBackground, S8_passes_with_points_made_from_the_field_settle) {
  // As in gridding: each pass has other points, whose sizes are those of the field at hand.
  for (const bool is_plane : {true, false}) {
    Context context;
    AdaptiveBackground background(unit_box(is_plane), 3, 0.3, context);
    const std::vector<Point> seed = {{0.4, 0.6, is_plane ? 0 : 0.5}};
    background.adapt(seed, std::vector<double>{0.01}, {}, context);
    double least_before = 0;
    for (unsigned pass = 0; pass < 20; ++pass) {
      const auto field = build_background_size_field(background.grid(context), {}, context);
      Sized made{random_points(300, 0.01, 0.99, 40 + pass, is_plane), std::vector<double>(300)};
      field->sizes(made.points, made.size);
      background.adapt(made.points, made.size, {}, context);
      const BackgroundGrid grid = background.grid(context);
      ASSERT_TRUE(check(grid.mesh).empty()) << "pass " << pass;
      const std::vector<double>& size = grid.mesh.fields[0].values;
      const double least = *std::min_element(size.begin(), size.end());
      if (pass > 0) {
        ASSERT_EQ(least, least_before) << "pass " << pass;
      }
      least_before = least;
      // No size is below what the first point alone asks for, but for what linear values miss of the cone's tip.
      for (std::size_t node = 0; node < size.size(); ++node)
        ASSERT_GE(size[node], 0.01 + 0.2 / 1.2 * distance(grid.mesh.points[VertexId(node)], seed[0]) - 1e-12)
            << "pass " << pass;
    }
  }
}

TEST(AdaptiveBackground, S8_the_field_with_growth_keeps_its_slope) {
  Context context;
  const Sized asked = some_points(false);
  AdaptiveBackground background(unit_box(false), 3, 1.0, context);
  background.adapt(asked.points, asked.size, {}, context);
  const auto field = build_background_size_field(background.grid(context), {.growth = 1.2}, context);
  const std::vector<Point> a = random_points(500, 0, 1, 33), b = random_points(500, 0, 1, 34);
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_LE(std::abs(field->size(a[i]) - field->size(b[i])), 0.2 / 1.2 * distance(a[i], b[i]) * (1 + 1e-9));
}

double worst_shape(const Mesh& mesh) {
  double worst = 1;
  const CellBlock& block = *mesh.find_block(CellType::tetrahedron);
  for (std::size_t cell = 0; cell < block.size(); ++cell) {
    const auto v = block[cell];
    const Point a = mesh.points[v[0]], u = mesh.points[v[1]] - a, w = mesh.points[v[2]] - a, t = mesh.points[v[3]] - a;
    double longest = 0;
    for (const Point e : {u, w, t, u - w, u - t, w - t}) longest = std::max(longest, length(e));
    worst = std::min(worst, dot(u, cross(w, t)) / (longest * longest * longest));
  }
  return worst;
}

TEST(AdaptiveBackground, S8_cells_do_not_degenerate_however_deep) {
  // Six and twelve levels about one place: the worst shape is that of halves and quarters of the first cells.
  double worst[2];
  int at = 0;
  for (const double size : {1e-2, 1e-4}) {
    Context context;
    AdaptiveBackground background(unit_box(false), 2, 1.0, context);
    const std::vector<Point> point = {{0.37, 0.41, 0.53}};
    background.adapt(point, std::vector<double>{size}, {}, context);
    const Mesh mesh = background.grid(context).mesh;
    ASSERT_TRUE(check(mesh).empty());
    worst[at++] = worst_shape(mesh);
  }
  EXPECT_NEAR(worst[1], worst[0], 1e-6 + 0.3 * worst[0]);
  EXPECT_GT(worst[1], 0.02);
}

TEST(AdaptiveBackground, S8_starts_from_a_given_grid_and_stops_at_its_limit) {
  Context context;
  BackgroundGrid given;
  given.mesh = kuhn_box(3, 0.2);
  add_node_field(given.mesh, "h", [](Point p) { return 0.5 + 0.1 * p.x; });
  AdaptiveBackground background(given, context);
  const std::vector<Point> points = {{0.5, 0.5, 0.5}, {3, 3, 3}};
  const AdaptReport report = background.adapt(points, std::vector<double>{0.001, 0.5}, {.max_cells = 400}, context);
  EXPECT_FALSE(report.is_converged);
  EXPECT_EQ(report.points_outside, 1u);
  EXPECT_TRUE(check(background.grid(context).mesh).empty());
}

TEST(AdaptiveBackground, S8_bad_input_is_refused) {
  Context context;
  EXPECT_THROW(AdaptiveBackground(Box{}, 3, 1.0, context), UsageError);
  EXPECT_THROW(AdaptiveBackground(unit_box(false), 0, 1.0, context), UsageError);
  EXPECT_THROW(AdaptiveBackground(unit_box(false), 3, -1.0, context), UsageError);
  AdaptiveBackground background(unit_box(false), 2, 1.0, context);
  const std::vector<Point> points = {{0.5, 0.5, 0.5}};
  EXPECT_THROW(background.adapt(points, std::vector<double>{0.0}, {}, context), InputError);
  EXPECT_THROW(background.adapt(points, std::vector<double>{}, {}, context), InputError);
  EXPECT_THROW(background.adapt(points, std::vector<double>{1}, {.growth = 1}, context), UsageError);
  EXPECT_THROW(background.adapt(points, std::vector<double>{1}, {.refine_above = 1}, context), UsageError);
}

}  // namespace
}  // namespace delfront
