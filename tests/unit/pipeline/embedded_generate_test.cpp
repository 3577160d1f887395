// SPDX-License-Identifier: Apache-2.0
// Curves and points in the volume through the whole run: refinement and improvement leave them where they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>

#include "delfront/errors.hpp"
#include "delfront/generate.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using fixtures::Facets;

/// The unit ball with a walk of steps like the surface's edges, in two arms from one point, and points alone.
Facets ball_with_walks(unsigned seed, int levels, int steps) {
  Facets body = fixtures::sphere_facets(levels);
  const double h = distance(body.points[body.faces[0][0]], body.points[body.faces[0][1]]);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    const Point d{normal(random), normal(random), normal(random)};
    return d / length(d);
  };
  const auto is_near = [&](Point p) {  // else no grid could be good
    return std::any_of(body.points.begin(), body.points.end(),
                       [&](const Point& q) { return distance(p, q) < 0.7 * h; });
  };
  const std::size_t start = body.add_point({0.1, 0.05, -0.02});
  for (int arm = 0; arm < 2; ++arm) {
    std::vector<std::size_t> curve{start};
    Point d = direction();
    while (static_cast<int>(curve.size()) < steps) {
      d = d + 0.4 * direction();
      d = d / length(d);
      const Point next = body.points[curve.back()] + h * d;
      if (length(next) > 0.9 || is_near(next)) {
        d = direction();
        continue;
      }
      curve.push_back(body.add_point(next));
    }
    body.curves.push_back(curve);
  }
  for (int i = 0; i < 5;) {
    const Point alone = (0.3 + 0.1 * i) * direction();
    if (is_near(alone)) continue;
    body.corners.push_back(body.add_point(alone));
    ++i;
  }
  return body;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> edges_of_tets(const Mesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  const CellBlock& tets = *mesh.find_block(CellType::tetrahedron);
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) edges.insert(std::minmax(tets[t][i].value, tets[t][j].value));
  return edges;
}

TEST(GenerateEmbedded, refinement_and_improvement_keep_curves_and_points) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Facets body = ball_with_walks(seed, 3, 20);
    const Model model = fixtures::to_model(body);
    Context context;
    const Outcome outcome = generate(model, Options(), context);
    for (const Finding& f : check(outcome.mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
    EXPECT_EQ(outcome.report.recovery.curve_edges_split, 0u);
    EXPECT_GT(outcome.report.improve.points_moved + outcome.report.improve.edge_swaps, 0u);
    // The model's points come first, in order: all are used here.
    for (std::size_t v = 0; v < model.points.size(); ++v)
      EXPECT_EQ(outcome.mesh.points[VertexId(v)], model.points[VertexId(v)]);
    const auto edges = edges_of_tets(outcome.mesh);
    std::size_t steps = 0;
    for (const Curve& curve : model.curves)
      for (std::size_t i = 0; i + 1 < curve.vertices.size(); ++i, ++steps)
        EXPECT_TRUE(edges.contains(std::minmax(curve.vertices[i].value, curve.vertices[i + 1].value)));
    EXPECT_EQ(outcome.mesh.num_cells(CellType::line), steps);
    EXPECT_EQ(outcome.mesh.num_cells(CellType::vertex), model.corners.size());
    EXPECT_GT(outcome.report.quality.find("min_dihedral")->min, 3);
  }
}

TEST(GenerateEmbedded, the_pure_front_has_curves_and_points_too) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Model model = fixtures::to_model(ball_with_walks(seed, 3, 20));
    Options options;
    options.volume.method = "front";
    Context context;
    const Outcome outcome = generate(model, options, context);
    EXPECT_EQ(outcome.report.front.gave_up, "");
    for (const Finding& f : check(outcome.mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
    const auto edges = edges_of_tets(outcome.mesh);
    for (const Curve& curve : model.curves)
      for (std::size_t i = 0; i + 1 < curve.vertices.size(); ++i)
        EXPECT_TRUE(edges.contains(std::minmax(curve.vertices[i].value, curve.vertices[i + 1].value)));
    EXPECT_EQ(outcome.mesh.num_cells(CellType::vertex), model.corners.size());
    EXPECT_GT(outcome.report.quality.find("min_dihedral")->min, 3);
  }
}

TEST(GenerateEmbedded, any_number_of_threads_gives_the_same_grid) {
  const Model model = fixtures::to_model(ball_with_walks(7, 4, 40));
  Options options;
  options.size.hmax = Length{0.04, ""};
  Mesh first;
  for (const int threads : {1, 2}) {
    Context context;
    context.threads = threads;
    const Mesh mesh = generate(model, options, context).mesh;
    if (threads == 1) {
      first = mesh;
      EXPECT_GT(mesh.num_cells(CellType::tetrahedron), 100000u);  // enough for several territories
      for (const Finding& f : check(mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
      continue;
    }
    ASSERT_EQ(mesh.blocks.size(), first.blocks.size());
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b) EXPECT_EQ(mesh.blocks[b].vertices, first.blocks[b].vertices);
    EXPECT_TRUE(std::equal(mesh.points.begin(), mesh.points.end(), first.points.begin(), first.points.end()));
  }
}

/// Short edges on a curve ask for small cells there, as those of triangles do.
TEST(GenerateEmbedded, sizes_follow_the_edges_of_curves) {
  Facets body = fixtures::box_facets({0, 0, 0}, {1, 1, 1});
  std::vector<std::size_t> curve;
  for (int i = 0; i <= 20; ++i) curve.push_back(body.add_point({0.4 + 0.01 * i, 0.5, 0.5}));
  body.curves.push_back(curve);
  Context context;
  const Model model = fixtures::to_model(body);
  const Outcome outcome = generate(model, Options(), context);
  const Mesh& mesh = outcome.mesh;
  std::set<std::uint32_t> near;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (distance(mesh.points[VertexId(i)], {0.5, 0.5, 0.5}) < 0.05) near.insert(static_cast<std::uint32_t>(i));
  double longest = 0;
  for (const auto& [a, b] : edges_of_tets(mesh))
    if (near.contains(a) && near.contains(b))
      longest = std::max(longest, distance(mesh.points[VertexId(a)], mesh.points[VertexId(b)]));
  EXPECT_GT(near.size(), 100u);
  EXPECT_LT(longest, 0.05);
}

std::vector<std::string> errors_of(const Facets& body) {
  Context context;
  std::vector<std::string> kinds;
  for (const Finding& f : check_surface(fixtures::to_model(body), context).findings)
    if (f.severity == Severity::error) kinds.push_back(f.kind + " " + std::to_string(f.count));
  return kinds;
}

TEST(GenerateEmbedded, what_meets_outside_of_common_vertices_is_refused) {
  const Facets box = fixtures::box_facets({0, 0, 0}, {1, 1, 1});
  const auto with = [&](const std::vector<std::vector<Point>>& curves, const std::vector<Point>& points = {}) {
    Facets body = box;
    for (const auto& curve : curves) {
      body.curves.emplace_back();
      for (const Point& p : curve) body.curves.back().push_back(body.add_point(p));
    }
    for (const Point& p : points) body.corners.push_back(body.add_point(p));
    return errors_of(body);
  };
  using Kinds = std::vector<std::string>;
  const Point a{0.25, 0.3125, 0.375}, b{0.75, 0.625, 0.5}, middle = 0.5 * (a + b), other{0.375, 0.5, 0.125};
  EXPECT_EQ(with({{a, b}}, {{0.1, 0.2, 0.3}}), Kinds{});
  EXPECT_EQ(with({{a, {0.3, 0.2, 1.5}}}), Kinds{"curves_through_facets 1"});
  EXPECT_EQ(with({{a, {0.3, 0.2, 1}}}), Kinds{"curves_through_facets 1"});              // ends in a facet
  EXPECT_EQ(with({{{0.6, 0.1, 1}, {0.5, 0.9, 1}}}), Kinds{"curves_through_facets 2"});  // in both triangles of a side
  EXPECT_EQ(with({{{0, 0, 0}, {0, 1, 1}}, {{0, 0, 1}, {0, 1, 0}}}).size(), 2u);         // one of them is no diagonal
  EXPECT_EQ(with({{{0, 0, 0}, {0.5, 0, 0}}}), Kinds{"curves_through_facets 2"});        // along a part of an edge
  EXPECT_EQ(with({{{-1, -1, -1}, {2, 2, 2}}}).size(), 1u);                              // through two corners
  EXPECT_EQ(with({{a, b}, {other, 2 * middle - other}}), Kinds{"crossing_curves 1"});
  EXPECT_EQ(with({{a, b}, {middle, {0.5, 0.1, 0.1}}}), Kinds{"crossing_curves 1"});  // a T
  EXPECT_EQ(with({{{0.25, 0.5, 0.5}, {0.5, 0.5, 0.5}}, {{0.375, 0.5, 0.5}, {0.75, 0.5, 0.5}}}),
            Kinds{"crossing_curves 1"});                                                                  // overlap
  EXPECT_EQ(with({{{0.25, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.375, 0.5, 0.5}}}), Kinds{"crossing_curves 1"});  // back
  EXPECT_EQ(with({{{0.25, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.75, 0.5, 0.5}}}), Kinds{});                      // straight on
  EXPECT_EQ(with({{a, a}}), Kinds{"degenerate_curves 1"});
  EXPECT_EQ(with({}, {{0.3, 0.2, 1}}), Kinds{"points_on_facets 1"});
  EXPECT_EQ(with({}, {{0.5, 0, 1}}), Kinds{"points_on_facets 1"});
  EXPECT_EQ(with({}, {{0, 0, 1}}), Kinds{});
  EXPECT_EQ(with({{a, b}}, {a}), Kinds{});
  EXPECT_EQ(with({{{0.25, 0.5, 0.5}, {0.75, 0.5, 0.5}}}, {{0.5, 0.5, 0.5}}), Kinds{"points_on_curves 1"});
  // A little off is not on.
  EXPECT_EQ(with({{a, {0.3, 0.2, 1 - 1e-15}}}, {{0.3, 0.6, 1 - 1e-15}}), Kinds{});
}

}  // namespace
}  // namespace delfront
