// SPDX-License-Identifier: Apache-2.0
// Gridding with larger sizes, then halving every edge: final sizes are those asked for.
#include "pipeline/levels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "delfront/errors.hpp"
#include "pipeline/size_survey.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

Model sphere_model(int levels) {
  Context context;
  return build_model({{fixtures::sphere_surface(levels), "sphere"}}, context);
}

Options in_levels(int levels, const std::string& method = "front-delaunay") {
  Options options;
  options.volume.method = method;
  options.refine.levels = levels;
  return options;
}

void expect_valid(const Mesh& mesh) {
  for (const Finding& f : check(mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
}

/// Of tetrahedra.
std::vector<std::array<VertexId, 2>> edges_of(const Mesh& mesh) {
  std::set<std::pair<std::size_t, std::size_t>> edges;
  const CellBlock& tets = *mesh.find_block(CellType::tetrahedron);
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const std::size_t a = tets[t][i].index(), b = tets[t][j].index();
        edges.insert({std::min(a, b), std::max(a, b)});
      }
  std::vector<std::array<VertexId, 2>> list;
  for (const auto& [a, b] : edges) list.push_back({VertexId(a), VertexId(b)});
  return list;
}

double share_of_good_edges(const Mesh& mesh, double h) {
  std::size_t good = 0;
  const auto edges = edges_of(mesh);
  for (const auto& [a, b] : edges) {
    const double ratio = distance(mesh.points[a], mesh.points[b]) / h;
    good += ratio >= 0.5 && ratio <= 2;
  }
  return static_cast<double>(good) / static_cast<double>(edges.size());
}

TEST(Levels, cells_and_triangles_are_the_coarse_grids_children) {
  const Model model = sphere_model(2);
  Context context;
  const Outcome coarse = generate(model, in_levels(0), context);
  EXPECT_EQ(coarse.report.levels.refined.levels, 0);
  for (int levels = 1; levels <= 2; ++levels) {
    const Outcome fine = generate(model, in_levels(levels), context);
    expect_valid(fine.mesh);
    const std::size_t children = std::size_t{1} << (3 * levels), of_triangle = std::size_t{1} << (2 * levels);
    EXPECT_EQ(fine.report.quality.num_cells, children * coarse.report.quality.num_cells);
    EXPECT_EQ(fine.mesh.num_cells(CellType::triangle), of_triangle * model.triangles.size());
    EXPECT_NEAR(fine.report.quality.volume, coarse.report.quality.volume, 1e-12);
    EXPECT_EQ(fine.report.levels.refined.levels, levels);
    EXPECT_EQ(fine.report.levels.coarse_cells, coarse.report.quality.num_cells);
    EXPECT_EQ(fine.report.levels.coarse_points, coarse.report.quality.num_points);
    for (std::size_t v = 0; v < model.points.size(); ++v)
      EXPECT_EQ(fine.mesh.points[VertexId(v)], model.points[VertexId(v)]);
  }
}

TEST(Levels, final_sizes_are_those_asked_for_with_every_method) {
  for (const std::string method : {"front", "front-delaunay", "delaunay"}) {
    Context context;
    Options options = in_levels(1, method);
    options.size.hmax = Length{0.1, ""};
    const Outcome outcome = generate(sphere_model(3), options, context);  // sides of about 0.14: 0.07 in the end
    expect_valid(outcome.mesh);
    EXPECT_GT(share_of_good_edges(outcome.mesh, 0.08), 0.99) << method;
    Options direct = options;
    direct.refine.levels = 0;
    const Outcome at_once = generate(sphere_model(4), direct, context);
    const double ratio =
        static_cast<double>(outcome.report.quality.num_cells) / static_cast<double>(at_once.report.quality.num_cells);
    EXPECT_NEAR(ratio, 1, 0.35) << method;  // a coarse grid of 2 000 cells, most of them at the boundary
  }
}

TEST(Levels, new_boundary_points_are_on_the_geometry) {
  const Model coarse = sphere_model(2), true_sphere = sphere_model(5);
  Context context;
  const Outcome outcome = generate(coarse, in_levels(2), context, nullptr, &true_sphere);
  expect_valid(outcome.mesh);
  const CellBlock& triangles = *outcome.mesh.find_block(CellType::triangle);
  double off = 0;
  for (const VertexId v : triangles.vertices) off = std::max(off, std::abs(length(outcome.mesh.points[v]) - 1));
  EXPECT_LT(off, 1e-3);  // the chords of the finer sphere; those of the coarse one are 0.02 off
  EXPECT_EQ(outcome.report.levels.refined.reversed, 0u);
  EXPECT_GT(outcome.report.levels.refined.points_on_surface, 1000u);
}

TEST(Levels, a_surface_gridded_anew_is_coarse_and_its_new_points_are_on_the_given_one) {
  const Model fine_sphere = sphere_model(5);
  Options options = in_levels(1);
  options.surface.method = "front";
  options.size.hmax = Length{0.15, ""};
  Context context;
  const Outcome outcome = generate(fine_sphere, options, context);
  expect_valid(outcome.mesh);
  const CellBlock& triangles = *outcome.mesh.find_block(CellType::triangle);
  double off = 0;
  for (const VertexId v : triangles.vertices) off = std::max(off, std::abs(length(outcome.mesh.points[v]) - 1));
  EXPECT_LT(off, 1e-3);
  EXPECT_GT(outcome.report.levels.refined.points_on_surface, 300u);
  EXPECT_EQ(triangles.size(), 4 * outcome.report.surface_grid.triangles);
  EXPECT_GT(share_of_good_edges(outcome.mesh, 0.14), 0.99);
}

TEST(Levels, the_field_of_sizes_is_the_final_one_and_keeps_the_growth) {
  Context context;
  Options options = in_levels(1);
  options.size.growth = 1.3;
  options.output.sizes = true;
  const Outcome outcome = generate(sphere_model(3), options, context);
  const Field& h = outcome.mesh.fields.back();
  ASSERT_EQ(h.name, "h");
  const double slope = 0.3 / 1.3;
  for (const auto& [a, b] : edges_of(outcome.mesh)) {
    const double rise = std::abs(h.values[a.index()] - h.values[b.index()]);
    EXPECT_LE(rise, slope * distance(outcome.mesh.points[a], outcome.mesh.points[b]) * (1 + 1e-9));
  }
  const auto [least, greatest] = std::minmax_element(h.values.begin(), h.values.end());
  EXPECT_LT(*least, 0.08);  // half of a triangle's side
  EXPECT_GT(*greatest, 2.5 * *least);
}

TEST(Levels, the_limit_of_cells_is_that_of_the_final_grid) {
  Context counting;
  const std::size_t cells = generate(sphere_model(2), in_levels(1), counting).report.quality.num_cells;
  Context enough;
  enough.max_cells = 2 * cells;
  EXPECT_EQ(generate(sphere_model(2), in_levels(1), enough).report.quality.num_cells, cells);
  EXPECT_EQ(enough.max_cells, 2 * cells);
  Context few;
  few.max_cells = cells - 1;
  EXPECT_THROW(generate(sphere_model(2), in_levels(1), few), LimitError);
  EXPECT_EQ(few.max_cells, cells - 1);
}

TEST(Levels, an_estimate_counts_the_final_cells) {
  Estimate estimate{.cells = 1000, .least_size = 0.2, .greatest_size = 0.4, .seconds = 1};
  refine_estimate(estimate, false, 2);
  EXPECT_EQ(estimate.cells, 64000);
  EXPECT_EQ(estimate.least_size, 0.05);
  EXPECT_EQ(estimate.greatest_size, 0.1);
  EXPECT_GT(estimate.seconds, 1);
  Estimate planar{.cells = 1000};
  refine_estimate(planar, true, 2);
  EXPECT_EQ(planar.cells, 16000);
}

TEST(Levels, the_same_grid_for_any_number_of_threads) {
  std::vector<Mesh> meshes;
  for (const int threads : {1, 2, 4}) {
    Context context;
    context.threads = threads;
    const Model true_sphere = sphere_model(4);
    meshes.push_back(generate(sphere_model(2), in_levels(1), context, nullptr, &true_sphere).mesh);
  }
  for (const Mesh& mesh : meshes) {
    EXPECT_EQ(mesh.points, meshes[0].points);
    EXPECT_EQ(mesh.find_block(CellType::tetrahedron)->vertices, meshes[0].find_block(CellType::tetrahedron)->vertices);
  }
}

TEST(CoarseOptions, lengths_asked_for_are_scaled_and_nothing_else) {
  Options options = in_levels(2);
  options.size.hmin = Length{0.1, ""};
  options.size.hmax = Length{1, ""};
  options.domain.enclose.h = Length{3, ""};
  const Options coarse = coarse_options(options);
  EXPECT_EQ(coarse.size.hmin->value, 0.4);
  EXPECT_EQ(coarse.size.hmax->value, 4);
  EXPECT_EQ(coarse.domain.enclose.h->value, 12);
  EXPECT_EQ(coarse.refine.levels, 0);
  EXPECT_EQ(coarse.size.steeper, 4);
  EXPECT_EQ(coarse_options(in_levels(0)).size.steeper, 1);
}

}  // namespace
}  // namespace delfront
