// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "delfront/surface_check.hpp"
#include "geometry/shells.hpp"
#include "support/support.hpp"
#include "surface_fixtures.hpp"

namespace delfront {
namespace {

using fixtures::cube_surface;
using fixtures::facets;
using fixtures::find;
using fixtures::joined;
using fixtures::LatticeCell;
using fixtures::model_of;
using fixtures::sphere_surface;
using fixtures::summary;

SurfaceReport check_of(const Mesh& mesh) {
  Context context;
  return check_surface(model_of(mesh), context);
}

void expect_error(const SurfaceReport& report, const std::string& kind, std::size_t count) {
  const Finding* finding = find(report, kind);
  ASSERT_NE(finding, nullptr) << kind << " not found among " << summary(report);
  EXPECT_EQ(finding->severity, Severity::error) << kind;
  EXPECT_EQ(finding->count, count) << finding->message;
  EXPECT_FALSE(finding->places.empty()) << kind;
  EXPECT_FALSE(report.can_bound_volume);
}

Mesh without_triangle(Mesh mesh, std::size_t triangle) {
  CellBlock& block = mesh.block(CellType::triangle);
  const auto begin = block.vertices.begin() + std::ptrdiff_t(3 * triangle);
  block.vertices.erase(begin, begin + 3);
  if (!block.group.empty()) block.group.erase(block.group.begin() + std::ptrdiff_t(triangle));
  return mesh;
}

Mesh tetrahedron() {
  return facets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
}

TEST(CheckSurface, a_cube_is_valid_and_measured) {
  const SurfaceReport report = check_of(cube_surface());
  EXPECT_TRUE(report.can_bound_volume && report.is_closed && report.is_manifold && report.is_oriented);
  EXPECT_TRUE(report.findings.empty()) << summary(report);
  EXPECT_DOUBLE_EQ(report.volume, 1);
  EXPECT_DOUBLE_EQ(report.area, 6);
  EXPECT_DOUBLE_EQ(report.min_edge, 1);
  EXPECT_DOUBLE_EQ(report.max_edge, std::sqrt(2.0));
  EXPECT_NEAR(report.min_angle_deg, 45, 1e-12);
  EXPECT_NEAR(report.min_dihedral_deg, 90, 1e-12);
  EXPECT_EQ(report.num_edges, 18u);
  ASSERT_EQ(report.components.size(), 1u);
  EXPECT_TRUE(report.components[0].is_closed);
  EXPECT_EQ(report.components[0].inside_of, -1);
}

TEST(CheckSurface, an_open_surface_is_refused_with_its_loops) {
  const SurfaceReport report = check_of(without_triangle(without_triangle(cube_surface(), 2), 0));
  expect_error(report, "open_edges", 6);
  const Finding& open = *find(report, "open_edges");
  EXPECT_EQ(open.places.size(), 2u) << "one place a loop";
  EXPECT_NE(open.message.find("6 open edges in 2 loops"), std::string::npos) << open.message;
  const SurfaceReport lone = check_of(facets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  expect_error(lone, "open_edges", 3);
}

TEST(CheckSurface, a_seam_that_does_not_match_is_told_from_a_hole) {
  Mesh mesh = sphere_surface(2);
  Mesh split = mesh;
  split.points.clear();
  split.groups.clear();
  CellBlock& block = split.block(CellType::triangle);
  block = CellBlock{CellType::triangle, {}, {}, {}};
  const CellBlock& given = *mesh.find_block(CellType::triangle);
  for (std::size_t t = 0; t < given.size(); ++t) {
    double top = -1;
    for (VertexId v : given[t]) top = std::max(top, mesh.points[v].z);
    for (VertexId v : given[t]) {
      split.points.push_back(mesh.points[v] + (top > 0.5 ? Point{0, 0, 3e-6} : Point{}));
      block.vertices.push_back(VertexId(split.points.size() - 1));
    }
  }
  const SurfaceReport report = check_of(split);
  ASSERT_NE(find(report, "open_edges"), nullptr);
  EXPECT_NE(find(report, "open_edges")->remedy.find("merge the points"), std::string::npos);
  const SurfaceReport hole = check_of(without_triangle(cube_surface(), 0));
  EXPECT_EQ(find(hole, "open_edges")->remedy.find("merge the points"), std::string::npos);
}

TEST(CheckSurface, degenerate_and_duplicate_triangles_are_errors) {
  Mesh mesh = cube_surface();
  const std::size_t on_edge = mesh.points.size();
  mesh.points.push_back({0.5, 0, 0});
  CellBlock& block = mesh.block(CellType::triangle);
  // A facet with a corner twice; one with three corners on a line; one facet again, and again turned.
  for (std::size_t v : {std::size_t(0), std::size_t(0), std::size_t(1), std::size_t(0), on_edge, std::size_t(1),
                        std::size_t(0), std::size_t(4), std::size_t(6), std::size_t(4), std::size_t(0), std::size_t(6)})
    block.vertices.push_back(VertexId(v));
  block.group.clear();
  const SurfaceReport report = check_of(mesh);
  expect_error(report, "degenerate_triangles", 2);
  expect_error(report, "duplicate_triangles", 2);
  EXPECT_EQ(find(report, "duplicate_triangles")->places[0].ids, (std::vector<std::uint32_t>{0, 14}));
}

TEST(CheckSurface, a_doubled_sheet_encloses_nothing) {
  const SurfaceReport report = check_of(facets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}));
  expect_error(report, "open_edges", 3);
}

TEST(CheckSurface, crossings_overlaps_and_touches_are_told_apart) {
  const SurfaceReport crossing = check_of(joined(tetrahedron(), tetrahedron(), {0.1, 0.1, 0.1}));
  EXPECT_NE(find(crossing, "self_intersection"), nullptr) << summary(crossing);
  EXPECT_EQ(find(crossing, "overlapping_triangles"), nullptr);
  EXPECT_FALSE(crossing.can_bound_volume);

  const SurfaceReport overlap = check_of(joined(cube_surface(), cube_surface(), {1, 0.25, 0.25}));
  EXPECT_NE(find(overlap, "overlapping_triangles"), nullptr) << summary(overlap);
  EXPECT_EQ(find(overlap, "self_intersection"), nullptr) << "the cubes' insides stay apart";

  // The tip of a tetrahedron in the middle of a cube's facet.
  const SurfaceReport tip = check_of(joined(cube_surface(), tetrahedron(), {0.375, 0.5, 1}));
  EXPECT_NE(find(tip, "t_junctions"), nullptr) << summary(tip);
  EXPECT_FALSE(tip.can_bound_volume);
}

TEST(CheckSurface, two_tetrahedra_that_share_a_vertex_or_an_edge_are_valid) {
  const SurfaceReport vertex = check_of(joined(tetrahedron(), tetrahedron(), {}, -1));
  EXPECT_TRUE(vertex.can_bound_volume) << summary(vertex);
  ASSERT_NE(find(vertex, "pinched_vertices"), nullptr);
  EXPECT_EQ(find(vertex, "pinched_vertices")->count, 1u);
  EXPECT_EQ(vertex.components.size(), 2u);
  EXPECT_FALSE(vertex.is_manifold);
  EXPECT_TRUE(vertex.is_closed);

  Mesh other = tetrahedron();
  for (Point& p : other.points) p = {-p.x, -p.y, p.z};
  const SurfaceReport edge = check_of(joined(tetrahedron(), other));
  EXPECT_TRUE(edge.can_bound_volume) << summary(edge);
  ASSERT_NE(find(edge, "non_manifold_edges"), nullptr);
  EXPECT_EQ(find(edge, "non_manifold_edges")->count, 1u);
  EXPECT_EQ(find(edge, "regions")->count, 2u);
}

TEST(CheckSurface, a_klein_bottle_is_refused_where_it_crosses_itself) {
  // The figure-8 immersion, closed with a half turn.
  constexpr std::size_t kAround = 24, kAcross = 12;
  std::vector<Point> points;
  fixtures::Triangles triangles;
  for (std::size_t i = 0; i < kAround; ++i) {
    for (std::size_t j = 0; j < kAcross; ++j) {
      const double u = 2 * std::numbers::pi * double(i) / kAround;
      const double v = 2 * std::numbers::pi * (double(j) + 0.5) / kAcross;
      const double r = 3 + std::cos(u / 2) * std::sin(v) - std::sin(u / 2) * std::sin(2 * v);
      points.push_back(
          {r * std::cos(u), r * std::sin(u), std::sin(u / 2) * std::sin(v) + std::cos(u / 2) * std::sin(2 * v)});
    }
  }
  auto at = [&](std::size_t i, std::size_t j) {
    // After one round v comes back as -v: column j meets column -1 - j.
    const std::size_t column = i == kAround ? (2 * kAcross - 1 - j % kAcross) % kAcross : j % kAcross;
    return (i % kAround) * kAcross + column;
  };
  for (std::size_t i = 0; i < kAround; ++i) {
    for (std::size_t j = 0; j < kAcross; ++j) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const SurfaceReport report = check_of(facets(points, triangles));
  EXPECT_TRUE(report.is_closed);
  EXPECT_FALSE(report.can_bound_volume);
  EXPECT_TRUE(has_errors(report.findings));
  EXPECT_TRUE(find(report, "self_intersection") || find(report, "t_junctions")) << summary(report);
  ASSERT_NE(find(report, "non_orientable_shell"), nullptr) << summary(report);
  EXPECT_EQ(find(report, "non_orientable_shell")->count, 1u);
}

TEST(CheckSurface, a_house_with_two_rooms_has_no_open_edge_and_encloses_nothing) {
  // R. H. Bing's house: the upper room is entered from below through a shaft in the lower one, and the other way round.
  enum Label { outside, upper, lower, upper_shaft, lower_shaft };
  auto label = [](LatticeCell cell) {
    const auto [x, y, z] = cell;
    if (x < 0 || x > 3 || y < 0 || y > 2 || z < 0 || z > 1) return outside;
    if (z == 0) return x == 1 && y == 1 ? upper_shaft : lower;
    return x == 2 && y == 1 ? lower_shaft : upper;
  };
  auto is_wall = [&](LatticeCell a, LatticeCell b) {
    const Label low = std::min(label(a), label(b)), high = std::max(label(a), label(b));
    if (low == high) return false;
    const bool is_entrance = low == outside && high >= upper_shaft;
    const bool is_shaft_end = (low == upper && high == upper_shaft) || (low == lower && high == lower_shaft);
    return !is_entrance && !is_shaft_end;
  };
  const SurfaceReport report = check_of(fixtures::lattice_walls(5, is_wall));
  EXPECT_EQ(find(report, "open_edges"), nullptr) << summary(report);
  ASSERT_NE(find(report, "encloses_nothing"), nullptr) << summary(report);
  EXPECT_FALSE(report.can_bound_volume);
}

TEST(CheckSurface, a_baffle_in_a_box_is_valid_and_a_closed_box_beside_a_sheet_too) {
  Mesh sheet = facets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  for (const Point& shift : {Point{0.25, 0.25, 0.25}, Point{4, 0, 0}}) {
    const SurfaceReport report = check_of(joined(cube_surface(), sheet, shift, 0.25));
    EXPECT_TRUE(report.can_bound_volume) << summary(report);
    ASSERT_NE(find(report, "open_edges"), nullptr);
    EXPECT_EQ(find(report, "open_edges")->severity, Severity::warning);
    EXPECT_EQ(find(report, "dangling_sheets")->count, 1u);
    EXPECT_DOUBLE_EQ(report.volume, 1);
  }
}

TEST(CheckSurface, nesting_tells_what_lies_in_what) {
  // Boxes in boxes: 0 holds 1 and 2, 1 holds 3; 4 stands beside. Half of them inside out.
  Mesh mesh = cube_surface();
  mesh = joined(mesh, cube_surface(), {0.1, 0.1, 0.1}, 0.5);
  mesh = joined(mesh, cube_surface(), {0.9, 0.9, 0.9}, -0.125);
  mesh = joined(mesh, cube_surface(), {0.3, 0.3, 0.3}, -0.125);
  mesh = joined(mesh, cube_surface(), {2, 0, 0});
  const SurfaceReport report = check_of(mesh);
  ASSERT_EQ(report.components.size(), 5u);
  const int expected[5] = {-1, 0, 0, 1, -1};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(report.components[i].inside_of, expected[i]) << i;
  EXPECT_LT(report.components[2].signed_volume, 0);
  EXPECT_DOUBLE_EQ(report.components[1].signed_volume, 0.125);
  EXPECT_TRUE(report.is_oriented) << "a shell that points inwards is consistent";
  EXPECT_EQ(report.reoriented, 0u);
}

/// Sizes of the connected sets of lattice cells with one label, without those of label 0 that reach outside.
std::vector<double> flooded_volumes(int n, const std::function<int(LatticeCell)>& label) {
  std::map<LatticeCell, bool> seen;
  std::vector<double> volumes;
  for (int i = -1; i <= n; ++i)
    for (int j = -1; j <= n; ++j)
      for (int k = -1; k <= n; ++k) {
        std::vector<LatticeCell> stack = {{i, j, k}};
        double volume = 0;
        bool is_outside = false;
        while (!stack.empty()) {
          const LatticeCell cell = stack.back();
          stack.pop_back();
          if (seen[cell]) continue;
          seen[cell] = true;
          ++volume;
          for (std::size_t axis = 0; axis < 3; ++axis)
            for (int step : {-1, 1}) {
              LatticeCell next = cell;
              next[axis] += step;
              if (next[axis] < -1 || next[axis] > n)
                is_outside = true;
              else if (label(next) == label(cell))
                stack.push_back(next);
            }
        }
        if (volume > 0 && !is_outside) volumes.push_back(volume);
      }
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

TEST(CheckSurface, regions_of_random_lattices_are_those_of_a_flood_fill) {
  constexpr unsigned kSeed = 21;
  constexpr int kSide = 5;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " round " << round);
    std::map<LatticeCell, int> labels;
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j)
        for (int k = 0; k < kSide; ++k) labels[{i, j, k}] = int(random() % (2 + unsigned(round) % 3));
    auto label = [&](LatticeCell cell) {
      const auto it = labels.find(cell);
      return it == labels.end() ? 0 : it->second;
    };
    const Mesh mesh =
        fixtures::lattice_walls(kSide, [&](LatticeCell a, LatticeCell b) { return label(a) != label(b); });
    const Model model = model_of(mesh);
    Context context;
    const SurfaceReport report = check_surface(model, context);
    EXPECT_TRUE(report.can_bound_volume) << summary(report);
    std::vector<double> volumes;
    for (const auto& region : find_shells(Surface(model), context).regions()) volumes.push_back(region.volume);
    std::sort(volumes.begin(), volumes.end());
    const std::vector<double> expected = flooded_volumes(kSide, label);
    ASSERT_EQ(volumes.size(), expected.size());
    for (std::size_t i = 0; i < volumes.size(); ++i) EXPECT_NEAR(volumes[i], expected[i], 1e-9);
  }
}

TEST(CheckSurface, decisions_do_not_depend_on_scale_or_offset) {
  Mesh valid = joined(cube_surface(), sphere_surface(2), {0.5, 0.5, 0.5}, 0.25);
  Mesh invalid = joined(cube_surface(), cube_surface(), {0.5, 0.25, 0.125});
  for (const double scale : {1.0, std::ldexp(1.0, 20), std::ldexp(1.0, -20), 1e-6, 1e6, 1e-29, 1e29}) {
    for (Mesh mesh : {valid, invalid}) {
      const SurfaceReport before = check_of(mesh);
      for (Point& p : mesh.points) p = scale * p;
      const SurfaceReport after = check_of(mesh);
      EXPECT_EQ(after.can_bound_volume, before.can_bound_volume) << scale;
      EXPECT_EQ(find(after, "self_intersection") != nullptr, find(before, "self_intersection") != nullptr) << scale;
      EXPECT_NEAR(after.max_edge / scale, before.max_edge, 1e-12) << scale;
      EXPECT_NEAR(after.volume / scale / scale / scale, before.volume, 1e-9) << scale;
    }
  }
  for (Point& p : valid.points) p = p + Point{1e6, -1e6, 3e5};
  EXPECT_TRUE(check_of(valid).can_bound_volume);
}

TEST(CheckSurface, thin_spots_and_sharp_edges_are_located) {
  Mesh plate = cube_surface();
  for (Point& p : plate.points) p.z *= 0.01;
  const SurfaceReport thin = check_of(plate);
  EXPECT_TRUE(thin.can_bound_volume);
  ASSERT_NE(find(thin, "thin_spots"), nullptr) << summary(thin);
  EXPECT_EQ(find(thin, "thin_spots")->count, 4u) << "two facets on top and two below";
  EXPECT_EQ(find(check_of(cube_surface()), "thin_spots"), nullptr);

  const double height = std::tan(10 * std::numbers::pi / 180);
  const Mesh wedge = facets({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, height}, {1, 1, height}},
                            {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}});
  const SurfaceReport sharp = check_of(wedge);
  EXPECT_NEAR(sharp.min_dihedral_deg, 10, 1e-9);
  ASSERT_NE(find(sharp, "small_dihedral_angles"), nullptr) << summary(sharp);
  EXPECT_EQ(find(sharp, "small_dihedral_angles")->places[0].at.x, 0);
  Mesh inside_out = wedge;
  for (std::size_t t = 0; t < 8; ++t) fixtures::turn_triangle(inside_out, t);
  EXPECT_NEAR(check_of(inside_out).min_dihedral_deg, 10, 1e-9) << "orientation does not matter";
}

TEST(CheckSurface, slivers_are_counted) {
  const SurfaceReport report = check_of(
      facets({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-3, 0}, {0.5, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}));
  ASSERT_NE(find(report, "sliver_triangles"), nullptr);
  EXPECT_EQ(find(report, "sliver_triangles")->count, 1u);
  EXPECT_NEAR(report.min_angle_deg, std::atan(2e-3) * 180 / std::numbers::pi, 1e-9);
}

TEST(OrientShells, turns_what_is_mixed_outwards_and_leaves_the_rest) {
  constexpr unsigned kSeed = 9;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  Mesh mixed = sphere_surface(2);
  const double volume = check_of(mixed).volume;
  std::size_t turned = 0;
  for (std::size_t t = 0; t < 320; ++t) {
    if (random() % 3 == 0) continue;
    fixtures::turn_triangle(mixed, t);
    ++turned;
  }
  Context context;
  Model model = model_of(mixed);
  const SurfaceReport before = check_surface(model, context);
  EXPECT_FALSE(before.is_oriented);
  EXPECT_EQ(before.reoriented, turned);
  EXPECT_EQ(orient_shells(model, context), turned);
  const SurfaceReport after = check_surface(model, context);
  EXPECT_TRUE(after.is_oriented);
  EXPECT_NEAR(after.volume, volume, 1e-12);

  Mesh hole = joined(cube_surface(), cube_surface(), {0.75, 0.75, 0.75}, -0.5);
  Model with_hole = model_of(hole);
  EXPECT_EQ(orient_shells(with_hole, context), 0u);
  EXPECT_DOUBLE_EQ(check_surface(with_hole, context).volume, 1 - 0.125);
}

TEST(OrientShells, internal_faces_do_not_mislead_it) {
  // Two cells with a wall between them; the walls of a lattice face along the axes, so half of the outer ones face in.
  const auto label = [](LatticeCell c) { return c[1] == 0 && c[2] == 0 ? (c[0] == 0 ? 1 : c[0] == 1 ? 2 : 0) : 0; };
  Mesh mesh = fixtures::lattice_walls(3, [&](LatticeCell a, LatticeCell b) { return label(a) != label(b); });
  Model model = model_of(mesh);
  Context context;
  orient_shells(model, context);
  const SurfaceReport report = check_surface(model, context);
  EXPECT_TRUE(report.is_oriented);
  EXPECT_DOUBLE_EQ(report.volume, 2);
  EXPECT_EQ(orient_shells(model, context), 0u) << "a second time there is nothing to do";
  ASSERT_EQ(find(report, "regions")->count, 2u);
}

TEST(CheckSurface, can_be_cancelled) {
  std::atomic<bool> stop = true;
  Context context;
  context.cancel = &stop;
  const Model model = model_of(cube_surface());
  EXPECT_THROW(check_surface(model, context), Cancelled);
}

}  // namespace
}  // namespace delfront
