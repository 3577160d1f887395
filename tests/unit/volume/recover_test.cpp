// SPDX-License-Identifier: Apache-2.0
// Boundary recovery on surfaces whose grids are known: number of regions, volumes, which faces have two sides.
#include "volume/recover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "delfront/errors.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"
#include "support/tet_fixtures.hpp"

namespace delfront {
namespace {

using fixtures::box_facets;
using fixtures::expect_recovered;
using fixtures::Facets;
using fixtures::Recovered;

std::size_t num_two_sided_faces(const Mesh& mesh) {
  const CellBlock* faces = mesh.find_block(CellType::triangle);
  return static_cast<std::size_t>(
      std::count_if(faces->group.begin(), faces->group.end(), [&](GroupId g) { return mesh.groups[g].two_sided; }));
}

TEST(RecoverBoundary, a_cube_and_one_tetrahedron) {
  const Recovered cube = expect_recovered(box_facets({0, 0, 0}, {1, 1, 1}), 1);
  EXPECT_EQ(cube.grid.regions.size(), 1u);
  EXPECT_EQ(cube.report.steiner_points, 0u);
  EXPECT_EQ(cube.mesh.points.size(), 8u);
  const Recovered tet =
      expect_recovered(fixtures::tetrahedron_facets({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1.0 / 6);
  EXPECT_EQ(tet.mesh.num_cells(CellType::tetrahedron), 1u);
  EXPECT_EQ(tet.mesh.num_cells(CellType::triangle), 4u);
}

TEST(RecoverBoundary, model_vertices_keep_their_numbers_and_places) {
  const Model model = fixtures::to_model(fixtures::chazelle(2, 0.1));
  const Recovered r = expect_recovered(model, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t v = 0; v < model.points.size(); ++v) {
    EXPECT_EQ(r.grid.complex.point(static_cast<VertexIndex>(v)), model.points[VertexId(v)]);
    EXPECT_EQ(r.grid.complex.on_boundary[v], 1);
    EXPECT_EQ(r.mesh.points[VertexId(v)], model.points[VertexId(v)]);
  }
  for (std::size_t v = model.points.size(); v < r.grid.complex.num_vertices(); ++v)
    EXPECT_EQ(r.grid.complex.on_boundary[v], 0) << "an inner point that may not move";
}

TEST(RecoverBoundary, a_failure_brings_the_grid_as_far_as_it_came) {
  Facets touching = box_facets({0, 0, 0}, {1, 1, 1});  // a corner on an edge: no grid has both
  touching.add(fixtures::tetrahedron_facets({0.5, 0, 0}, {0.2, -1, -1}, {0.8, -1, -1}, {0.5, -1, -2}));
  const Model model = fixtures::to_model(touching);
  RecoveryReport report;
  Context context;
  try {
    tetrahedralize_boundary(model, {}, std::vector<bool>(model.patches.size(), false), report, context);
    FAIL() << "recovered what cannot be";
  } catch (const MeshingError& e) {
    EXPECT_FALSE(e.places.empty());
    ASSERT_TRUE(e.partial);
    const Mesh& mesh = *e.partial;
    EXPECT_GT(mesh.num_cells(CellType::tetrahedron), 6u);
    ASSERT_EQ(mesh.num_cells(CellType::triangle), model.triangles.size());
    const std::vector<GroupId>& groups = mesh.find_block(CellType::triangle)->group;
    const auto lacking = std::count(groups.begin(), groups.end(), mesh.find_group(2, "missing_or_divided"));
    EXPECT_GE(lacking, 2) << "the triangles at the edge";
    EXPECT_LT(lacking, std::ptrdiff_t(groups.size()));
    for (const CellBlock& block : mesh.blocks)
      for (const VertexId v : block.vertices) ASSERT_LT(v.index(), mesh.points.size());
  }
}

TEST(RecoverBoundary, an_inside_out_surface_is_gridded_all_the_same) {
  Facets box = box_facets({0, 0, 0}, {2, 1, 1});
  box.turn();
  const Recovered r = expect_recovered(box, 2);
  EXPECT_EQ(r.grid.regions.size(), 1u);
}

TEST(RecoverBoundary, two_cubes_with_a_common_face) {
  Facets cubes = box_facets({0, 0, 0}, {1, 1, 1});
  Facets other = box_facets({1, 0, 0}, {2, 1, 1});
  other.faces.erase(other.faces.begin());
  cubes.add(other);
  const Recovered r = expect_recovered(cubes, 2);
  EXPECT_EQ(r.grid.regions.size(), 2u);
  EXPECT_EQ(num_two_sided_faces(r.mesh), 2u);
}

TEST(RecoverBoundary, two_cubes_that_touch_in_an_edge_or_a_vertex) {
  for (const Point shift : {Point{1, 1, 0}, Point{1, 1, 1}}) {
    Facets cubes = box_facets({0, 0, 0}, {1, 1, 1});
    cubes.add(box_facets({0, 0, 0}, {1, 1, 1}), shift);
    const Recovered r = expect_recovered(cubes, 2);
    EXPECT_EQ(r.grid.regions.size(), 2u);
    EXPECT_EQ(num_two_sided_faces(r.mesh), 0u);
    EXPECT_EQ(r.mesh.num_cells(CellType::triangle), 24u);
  }
}

/// A box with a sheet across its lower half, attached to the bottom and to two sides.
Facets box_with_baffle() {
  Facets box;
  box.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0},   {0, 0, 1},
                {1, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}, {0, 1, 1}, {1, 0, 0.6}, {1, 1, 0.6}};
  box.faces = {{0, 5, 4, 1},     {1, 4, 3, 2},     {6, 7, 10, 11},     {7, 8, 9, 10},     {0, 6, 11, 5}, {2, 3, 9, 8},
               {0, 1, 12, 7, 6}, {1, 2, 8, 7, 12}, {5, 11, 10, 13, 4}, {4, 13, 10, 9, 3}, {1, 4, 13, 12}};
  return box;
}

TEST(RecoverBoundary, a_baffle_stays_two_sided_in_one_region) {
  const Recovered r = expect_recovered(box_with_baffle(), 2);
  EXPECT_EQ(r.grid.regions.size(), 1u);
  EXPECT_GE(num_two_sided_faces(r.mesh), 2u);
}

TEST(RecoverBoundary, sheets_that_float_or_hang_on_one_edge) {
  Facets floating = box_facets({0, 0, 0}, {1, 1, 1});
  floating.add({{{0.3, 0.3, 0.4}, {0.7, 0.3, 0.5}, {0.5, 0.7, 0.6}}, {{0, 1, 2}}});
  const Recovered r = expect_recovered(floating, 1);
  EXPECT_EQ(r.grid.regions.size(), 1u);
  EXPECT_EQ(num_two_sided_faces(r.mesh), r.grid.split.empty() ? 1u : num_two_sided_faces(r.mesh));
  Facets many = box_facets({0, 0, 0}, {1, 1, 1});
  for (int i = 1; i < 10; ++i)  // a stack of parallel sheets
    many.add({{{0.2, 0.2, 0.1 * i}, {0.8, 0.2, 0.1 * i}, {0.8, 0.8, 0.1 * i}, {0.2, 0.8, 0.1 * i}}, {{0, 1, 2, 3}}});
  expect_recovered(many, 1);
  Facets hanging = box_facets({0, 0, 0}, {1, 1, 1});
  hanging.add({{{0, 0, 0}, {1, 0, 0}, {0.5, 0.6, 0.5}}, {{0, 1, 2}}});  // along an edge of the box
  expect_recovered(hanging, 1);
}

TEST(RecoverBoundary, nested_shells_of_one_sense_are_regions) {
  Facets shells;
  for (int i = 20; i > 0; --i) shells.add(box_facets({-1, -1, -1}, {1, 1, 1}), {}, i);
  const Recovered r = expect_recovered(shells, 8.0 * 20 * 20 * 20);
  EXPECT_EQ(r.grid.regions.size(), 20u);
  EXPECT_EQ(num_two_sided_faces(r.mesh), 12u * 19);
}

TEST(RecoverBoundary, nested_shells_of_alternating_sense_are_holes_in_turn) {
  Facets shells;
  double volume = 0;
  for (int i = 20; i > 0; --i) {
    Facets box = box_facets({-1, -1, -1}, {1, 1, 1});
    if (i % 2) box.turn();
    shells.add(box, {}, i);
    volume += (i % 2 ? -8.0 : 8.0) * i * i * i;
  }
  const Recovered r = expect_recovered(shells, volume);
  EXPECT_EQ(r.grid.regions.size(), 10u);
  EXPECT_EQ(num_two_sided_faces(r.mesh), 0u);
  DomainOptions all;
  all.keep = "all";
  EXPECT_EQ(expect_recovered(shells, 8.0 * 20 * 20 * 20, all).grid.regions.size(), 20u);
}

TEST(RecoverBoundary, domain_keep_chooses_regions) {
  Facets bodies = box_facets({0, 0, 0}, {1, 1, 1});
  bodies.add(box_facets({2, 0, 0}, {4, 2, 2}));
  DomainOptions domain;
  domain.keep = "largest";
  EXPECT_EQ(expect_recovered(bodies, 8, domain).grid.regions.size(), 1u);
  domain.keep = "";
  domain.keep_points = {{0.5, 0.25, 0.125}};
  EXPECT_EQ(expect_recovered(bodies, 1, domain).grid.regions.size(), 1u);
  domain.keep_points = {{10, 0, 0}};
  RecoveryReport report;
  Context context;
  const Model model = fixtures::to_model(bodies);
  EXPECT_THROW(tetrahedralize_boundary(model, domain, {false}, report, context), InputError);
}

Facets small_tets(int n, double box, unsigned seed, bool are_holes, double& volume) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Facets all = box_facets({0, 0, 0}, {box, box, box});
  volume = 0;
  const int side = static_cast<int>(std::ceil(std::cbrt(n)));
  for (int i = 0; i < n; ++i) {
    const Point cell{double(i % side), double(i / side % side), double(i / side / side)};
    Point p[4];
    double v = 0;
    do {
      for (Point& q : p) q = Point{uniform(random), uniform(random), uniform(random)};
      v = dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6;
    } while (v < 0.01);
    Facets tet = fixtures::tetrahedron_facets(p[0], p[1], p[2], p[3]);
    if (are_holes) tet.turn();
    const double scale = 0.2 * box / side;
    all.add(tet, (box / side) * (cell + Point{0.3, 0.3, 0.3}), scale);
    volume += v * scale * scale * scale;
  }
  return all;
}

TEST(RecoverBoundary, five_hundred_tets_scattered_in_a_box) {
  double volume = 0;
  Recovered r = expect_recovered(small_tets(500, 10, 1, false, volume), 1000);
  EXPECT_EQ(r.grid.regions.size(), 501u);
  const Facets holes = small_tets(500, 10, 2, true, volume);
  r = expect_recovered(holes, 1000 - volume);
  EXPECT_EQ(r.grid.regions.size(), 1u);
}

TEST(RecoverBoundary, the_same_in_two_runs_and_after_scaling_by_powers_of_two) {
  Facets body = fixtures::chazelle(2, 0.05);
  const Recovered first = expect_recovered(body, body.volume());
  EXPECT_EQ(expect_recovered(body, body.volume()).grid.complex.node, first.grid.complex.node);
  for (const double scale : {0x1p-20, 0x1p20}) {
    SCOPED_TRACE(scale);
    Facets scaled;
    scaled.add(body, {}, scale);
    const Recovered r = expect_recovered(scaled, scaled.volume());
    EXPECT_EQ(r.grid.complex.node, first.grid.complex.node);
    EXPECT_EQ(r.report.steiner_points, first.report.steiner_points);
  }
}

TEST(RecoverBoundary, stops_when_told_to) {
  double volume = 0;
  const Model model = fixtures::to_model(small_tets(500, 10, 3, false, volume));
  std::atomic<bool> cancel = false;
  Context context;
  context.cancel = &cancel;
  context.on_progress = [&](const Progress& p) { cancel = p.stage == "recover"; };
  RecoveryReport report;
  EXPECT_THROW(tetrahedralize_boundary(model, {}, {false}, report, context), Cancelled);
}

TEST(ToMesh, boundary_faces_point_out_of_the_region_with_the_lower_id) {
  Facets shells = box_facets({-2, -2, -2}, {2, 2, 2});
  shells.add(box_facets({-1, -1, -1}, {1, 1, 1}));
  const Recovered r = expect_recovered(shells, 64);
  const CellBlock& tets = *r.mesh.find_block(CellType::tetrahedron);
  const CellBlock& faces = *r.mesh.find_block(CellType::triangle);
  auto region_volume = [&](GroupId g) {
    double sum = 0;
    for (std::size_t i = 0; i < tets.size(); ++i) {
      if (tets.group[i] != g) continue;
      const Point a = r.mesh.points[tets[i][0]];
      sum +=
          dot(cross(r.mesh.points[tets[i][1]] - a, r.mesh.points[tets[i][2]] - a), r.mesh.points[tets[i][3]] - a) / 6;
    }
    return sum;
  };
  const GroupId first = r.mesh.find_group(3, "fluid"), second = r.mesh.find_group(3, "region_2");
  ASSERT_TRUE(first.is_valid() && second.is_valid());
  EXPECT_NEAR(region_volume(first) + region_volume(second), 64, 1e-10);
  const bool outer_is_first = region_volume(first) > 30;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Point a = r.mesh.points[faces[i][0]], b = r.mesh.points[faces[i][1]], c = r.mesh.points[faces[i][2]];
    const bool is_outer = std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}) > 1.5;
    const double outwards = dot(cross(b - a, c - a), a + b + c);
    EXPECT_EQ(r.mesh.groups[faces.group[i]].two_sided, !is_outer);
    EXPECT_EQ(outwards > 0, is_outer || !outer_is_first);
  }
}

}  // namespace
}  // namespace delfront
