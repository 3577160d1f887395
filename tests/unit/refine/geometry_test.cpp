// SPDX-License-Identifier: Apache-2.0
// New points on the true geometry: on it, with its features, and back again where a cell would suffer.
#include <gtest/gtest.h>

#include "delfront/generate.hpp"
#include "delfront/grid_check.hpp"
#include "unit/refine/refine_fixtures.hpp"

namespace delfront {
namespace {

using namespace refine_fixtures;

Mesh grid_inside(const Mesh& surface, const std::string& name) {
  Context context;
  return generate(build_model({{surface, name}}, context), Options(), context).mesh;
}

bool is_valid(const Mesh& mesh) { return !has_errors(check(mesh)); }

/// Largest distance of the middles of the boundary faces from the unit sphere.
double deviation(const Mesh& mesh) {
  double largest = 0;
  const CellBlock& faces = *mesh.find_block(CellType::triangle);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Point sum = mesh.points[faces[i][0]] + mesh.points[faces[i][1]] + mesh.points[faces[i][2]];
    largest = std::max(largest, std::abs(length(sum) / 3 - 1));
  }
  return largest;
}

TEST(RefineGeometry, a_ball_nears_the_sphere_by_four_a_level) {
  const Model sphere = sphere_model(6);
  const double error_of_model = 1 - std::cos(0.02);  // its edges are at most 0.02 long or so, its facets below that
  Mesh mesh = grid_inside(fixtures::sphere_surface(1), "sphere");
  double before = deviation(mesh);
  for (int level = 0; level < 3; ++level) {
    RefineGridReport report;
    const std::size_t num_old = mesh.points.size();
    mesh = refined(mesh, 1, &sphere, &report);
    EXPECT_TRUE(is_valid(mesh));
    EXPECT_EQ(report.reversed + report.halved, 0u);
    EXPECT_EQ(report.points_on_features, 0u);
    EXPECT_GT(report.points_on_surface, 0u);
    const CellBlock& faces = *mesh.find_block(CellType::triangle);
    for (const VertexId v : faces.vertices)
      if (v.index() >= num_old) {
        ASSERT_NEAR(length(mesh.points[v]), 1, error_of_model);
      }
    const double after = deviation(mesh);
    EXPECT_NEAR(before / after, 4, 0.5) << "level " << level;
    before = after;
  }
}

/// Even of a ball whose edges turn by more than the feature angle: the model has no feature there.
TEST(RefineGeometry, an_icosahedron_becomes_round) {
  const Model sphere = sphere_model(5);
  const Mesh fine = refined(fixtures::sphere_surface(0), 2, &sphere);
  EXPECT_TRUE(is_valid(fine));
  for (const Point& p : fine.points) EXPECT_NEAR(length(p), 1, 2e-3);
}

/// A curve a tenth beside an edge of the icosahedron, along it: not what the edge stands for, whose ends are elsewhere.
TEST(RefineGeometry, a_feature_beside_a_sharp_edge_is_left_alone) {
  Model sphere = sphere_model(5);
  sphere.points.push_back({-1, 0.85, 0.1});
  sphere.points.push_back({1, 0.85, 0.1});
  sphere.curves.push_back({"beside", {VertexId(sphere.points.size() - 2), VertexId(sphere.points.size() - 1)}});
  RefineGridReport report;
  const Mesh fine = refined(fixtures::sphere_surface(0), 1, &sphere, &report);
  EXPECT_EQ(report.points_on_features, 0u);
  for (const Point& p : fine.points) EXPECT_NEAR(length(p), 1, 2e-3);
}

TEST(RefineGeometry, nothing_moves_where_the_model_is_the_grids_own_surface) {
  Context context;
  const Mesh cube = fixtures::cube_surface();
  const Model model = build_model({{cube, "cube"}}, context);
  const Mesh coarse = grid_inside(cube, "cube");
  RefineGridReport report;
  const Mesh with = refined(coarse, 2, &model, &report), without = refined(coarse, 2);
  EXPECT_EQ(report.points_on_surface + report.points_on_features, 0u);
  EXPECT_EQ(with.points, without.points);
  for (std::size_t i = 0; i < with.blocks.size(); ++i) EXPECT_EQ(with.blocks[i].vertices, without.blocks[i].vertices);
}

TEST(RefineGeometry, rims_go_to_rims_and_faces_to_the_patch_of_their_name) {
  Context context;
  const double height = 0.7;
  const Model model = build_model({{cylinder_surface(240, height), "fine"}}, context);
  const Mesh coarse = grid_inside(cylinder_surface(20, height), "coarse");
  RefineGridReport report;
  const Mesh fine = refined(coarse, 2, &model, &report);
  EXPECT_TRUE(is_valid(fine));
  EXPECT_TRUE(report.groups_not_in_model.empty());
  EXPECT_EQ(report.reversed + report.halved, 0u);
  EXPECT_EQ(report.points_on_features, 2u * 20 * (1 + 2));  // both rims, both levels
  const CellBlock& faces = *fine.find_block(CellType::triangle);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool is_side = fine.groups[faces.group[i]].name == "side";
    for (const VertexId v : faces[i]) {
      const Point p = fine.points[v];
      if (is_side)
        EXPECT_NEAR(std::hypot(p.x, p.y), 1, 1 - std::cos(std::numbers::pi / 240) + 1e-12);
      else
        EXPECT_TRUE(p.z == 0 || p.z == height) << p.z;
    }
  }
}

TEST(RefineGeometry, groups_that_the_model_does_not_have_stay_straight) {
  Context context;
  Mesh named = fixtures::sphere_surface(1);
  CellBlock& faces = named.block(CellType::triangle);
  const GroupId upper = named.add_group(2, "upper"), lower = named.add_group(2, "lower");
  faces.group.clear();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    double z = 0;
    for (const VertexId v : faces[i]) z += named.points[v].z;
    faces.group.push_back(z > 0 ? upper : lower);
  }
  const Mesh coarse = grid_inside(named, "ball");
  const Model model = sphere_model(5, "upper");
  RefineGridReport report;
  const Mesh fine = refined(coarse, 1, &model, &report);
  EXPECT_TRUE(is_valid(fine));
  EXPECT_EQ(report.groups_not_in_model, std::vector<std::string>{"lower"});
  const CellBlock& halves = *fine.find_block(CellType::triangle);
  std::vector<int> sides(fine.points.size(), 0);  // bits: of the upper, of the lower group
  for (std::size_t i = 0; i < halves.size(); ++i)
    for (const VertexId v : halves[i]) sides[v.index()] |= fine.groups[halves.group[i]].name == "upper" ? 1 : 2;
  std::size_t num_round = 0, num_straight = 0;
  for (std::size_t v = coarse.points.size(); v < fine.points.size(); ++v) {
    const double r = length(fine.points[VertexId(v)]);
    if (sides[v] == 1) {
      ++num_round;
      EXPECT_NEAR(r, 1, 1e-3);
    } else if (sides[v] >= 2) {
      ++num_straight;
      EXPECT_LT(r, 0.98);
    }
  }
  EXPECT_GT(num_round, 20u);
  EXPECT_GT(num_straight, 20u);
}

TEST(RefineGeometry, far_fields_stay_where_they_are_when_nothing_is_named_alike) {
  Mesh ball = grid_inside(fixtures::sphere_surface(1), "outer");
  for (Group& group : ball.groups) group.kind = group.dimension == 2 ? "farfield" : "";
  const Model model = sphere_model(4, "body");
  EXPECT_EQ(refined(ball, 1, &model).points, refined(ball).points);
}

/// A flat cell over whose base the model bulges, up to beyond its apex.
Mesh flat_tet() {
  return grids::single_cell(CellType::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.1}});
}

Model plane_at(double z) {
  Mesh plane;
  plane.points = {{-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}};
  grids::add_cell(plane, CellType::triangle, {0, 1, 2});
  grids::add_cell(plane, CellType::triangle, {0, 2, 3});
  Context context;
  return build_model({{plane, "plane"}}, context);
}

TEST(RefineGeometry, points_that_would_invert_a_cell_go_back) {
  const Mesh coarse = flat_tet(), straight = refined(coarse);
  for (const double z : {0.02, 0.06, 0.15, 0.3}) {
    SCOPED_TRACE(z);
    const Model model = plane_at(z);
    RefineGridReport report;
    const Mesh fine = refined(coarse, 1, &model, &report);
    EXPECT_TRUE(is_valid(fine));
    EXPECT_EQ(report.reversed_places.size(), report.reversed + report.halved);
    if (z == 0.3) {
      EXPECT_GT(report.reversed, 0u);
    }
    for (const Place& place : report.reversed_places) {
      ASSERT_EQ(place.ids.size(), 1u);
      EXPECT_EQ(place.at, fine.points[VertexId(place.ids[0])]);
    }
    std::size_t num_middle = 0, num_half = 0, num_there = 0;  // what the report says is so
    for (std::size_t v = 4; v < 10; ++v) {
      const double from = straight.points[VertexId(v)].z, at = fine.points[VertexId(v)].z;
      num_middle += at == from;
      num_half += at != from && std::abs(at - (from + z) / 2) < 1e-15;
      num_there += at != from && at == z;
    }
    EXPECT_EQ(num_middle + num_half + num_there, 6u);
    EXPECT_EQ(num_half, report.halved);
    EXPECT_EQ(num_there, report.points_on_surface + report.points_on_features - report.halved - report.reversed);
  }
}

TEST(RefineGeometry, a_child_is_not_squashed) {
  // The middles of the apex's edges would come to a fiftieth of their height: positive, but of no use.
  const Mesh coarse = flat_tet();
  const Model model = plane_at(0.001);
  Context context;
  RefineGridReport report;
  const auto least = [](const Mesh& mesh) {
    double smallest = 1;
    const CellBlock& tets = *mesh.find_block(CellType::tetrahedron);
    for (std::size_t i = 0; i < tets.size(); ++i) {
      const Point a = mesh.points[tets[i][0]];
      smallest = std::min(
          smallest, dot(cross(mesh.points[tets[i][1]] - a, mesh.points[tets[i][2]] - a), mesh.points[tets[i][3]] - a));
    }
    return smallest;
  };
  const double straight = least(refined(coarse));
  const Mesh careful = refine_grid(coarse, {.model = &model, .least_volume_share = 0.3}, report, context);
  EXPECT_TRUE(is_valid(careful));
  EXPECT_GE(least(careful), 0.3 * straight * (1 - 1e-12));
  EXPECT_GT(report.reversed + report.halved, 0u);
}

TEST(RefineGeometry, coarse_grids_far_from_their_surface_stay_valid) {
  // Coarse grids of an ellipsoid far from its true surface: moves of half an edge and more.
  for (int levels = 0; levels < 2; ++levels)
    for (const double thickness : {0.05, 0.2}) {
      Mesh surface = fixtures::sphere_surface(levels);
      for (Point& p : surface.points) p.z *= thickness;
      Mesh fine_surface = fixtures::sphere_surface(5);
      for (Point& p : fine_surface.points) p.z *= thickness;
      Context context;
      const Model model = build_model({{fine_surface, "ball"}}, context);
      const Mesh fine = refined(grid_inside(surface, "ball"), 2, &model);
      EXPECT_TRUE(is_valid(fine)) << levels << ' ' << thickness;
    }
}

TEST(RefineGeometry, any_number_of_threads_gives_the_same_bytes) {
  const Model sphere = sphere_model(4);
  const Mesh coarse = grid_inside(fixtures::sphere_surface(3), "sphere");
  RefineGridReport report, other;
  const Mesh one = refined(coarse, 1, &sphere, &report);
  for (const int threads : {2, 5}) {
    const Mesh many = refined(coarse, 1, &sphere, &other, threads);
    EXPECT_EQ(one.points, many.points);
    for (std::size_t i = 0; i < one.blocks.size(); ++i) EXPECT_EQ(one.blocks[i].vertices, many.blocks[i].vertices);
    EXPECT_EQ(report.points_on_surface, other.points_on_surface);
  }
}

TEST(RefineGeometry, in_the_plane_lines_go_to_the_curves_of_their_name) {
  const auto circle = [](int n, bool is_grid) {
    Mesh mesh;
    mesh.dimension = 2;
    const GroupId rim = mesh.add_group(1, "rim");
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(n); ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.points.push_back({std::cos(angle), std::sin(angle), 0});
      grids::add_cell(mesh, CellType::line, {i, (i + 1) % static_cast<std::uint32_t>(n)});
      if (is_grid)
        grids::add_cell(mesh, CellType::triangle,
                        {i, (i + 1) % static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(n)});
    }
    mesh.block(CellType::line).group.assign(static_cast<std::size_t>(n), rim);
    if (is_grid) mesh.points.push_back({0, 0, 0});
    return mesh;
  };
  const Model model = model_of_lines(circle(1000, false), "circle");
  const Mesh coarse = circle(8, true);
  RefineGridReport report;
  const Mesh fine = refined(coarse, 3, &model, &report);
  EXPECT_TRUE(is_valid(fine));
  EXPECT_EQ(report.points_on_features, 8u * (1 + 2 + 4));
  for (const VertexId v : fine.find_block(CellType::line)->vertices) EXPECT_NEAR(length(fine.points[v]), 1, 1e-5);
  for (const Point& p : fine.points) EXPECT_EQ(p.z, 0);
}

}  // namespace
}  // namespace delfront
