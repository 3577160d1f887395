// SPDX-License-Identifier: Apache-2.0
#include "improve/improve.hpp"

#include <gtest/gtest.h>

#include "delfront/uniform_size.hpp"
#include "support/tet_fixtures.hpp"
#include "tetra/quality.hpp"

namespace delfront {
namespace {

struct Worst {
  double least = 180, greatest = 0;  // degrees
};

Worst measure_worst(const TetComplex& c, std::uint32_t region = 0) {
  Worst worst;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t) || c.region[t] != region) continue;
    const std::uint32_t* n = &c.node[4 * t];
    const auto range = measure_dihedrals(c.point(n[0]), c.point(n[1]), c.point(n[2]), c.point(n[3]));
    worst.least = std::min(worst.least, range.least * 180 / std::numbers::pi);
    worst.greatest = std::max(worst.greatest, range.greatest * 180 / std::numbers::pi);
  }
  return worst;
}

/// Improve; the boundary, its vertices and the volume must stay, and the report must agree with the complex.
ImproveReport improve_and_check(TetComplex& c, const ImproveOptions& options = {}) {
  const auto faces = fixtures::constrained_faces(c);
  const double volume = fixtures::total_volume(c);
  const auto vertices = c.vertex;
  Context context;
  const ImproveReport report = improve_complex(c, UniformSize(1), options, context);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_NEAR(fixtures::total_volume(c), volume, 1e-12 * volume);
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
  for (VertexIndex v = 0; v < vertices.size(); ++v) {
    if (!c.on_boundary[v]) continue;
    EXPECT_EQ(c.point(v), vertices[v].point());
    EXPECT_NE(c.vertex_tet[v], kNoIndex);
  }
  return report;
}

TEST(Improve, T5_lifts_a_sliver_ridden_ball_above_the_goal) {
  TetComplex c = fixtures::sliver_ball(0.15, 0, 1);
  EXPECT_LT(measure_worst(c).least, 3);
  const ImproveReport report = improve_and_check(c);
  const Worst after = measure_worst(c);
  EXPECT_GT(after.least, 15);
  EXPECT_LT(after.greatest, 155);
  EXPECT_NEAR(report.min_dihedral_after_deg, after.least, 1e-6);
  EXPECT_EQ(report.below_goal, 0u);
}

TEST(Improve, T5_frees_points_pressed_against_the_surface) {
  TetComplex c = fixtures::sliver_ball(0.15, 60, 2);
  const double before = measure_worst(c).least;
  EXPECT_LT(before, 1);
  const ImproveReport report = improve_and_check(c);
  EXPECT_NEAR(report.min_dihedral_before_deg, before, 1e-6);
  EXPECT_GT(measure_worst(c).least, 15);
  EXPECT_LT(measure_worst(c).greatest, 158);
  EXPECT_GT(report.points_moved, 0u);
}

TEST(Improve, T5_keeps_a_wall_between_regions) {
  TetComplex c = fixtures::jittered_cube_with_wall(8, 0.5, 3);
  improve_and_check(c);
  for (const std::uint32_t region : {0u, 1u}) {
    EXPECT_GT(measure_worst(c, region).least, 15);
    EXPECT_LT(measure_worst(c, region).greatest, 158);
  }
  for (TetIndex t = 0; t < c.num_slots(); ++t) {  // every tet still lies on the side its region says
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    double z = 0;
    for (unsigned i = 0; i < 4; ++i) z += 0.25 * c.point(c.node[4 * t + i]).z;
    EXPECT_EQ(c.region[t], z > 0.5 ? 1u : 0u);
  }
}

TEST(Improve, T5_leaves_the_outside_alone) {
  TetComplex c = fixtures::jittered_cube_with_wall(6, 0.5, 4);
  for (TetIndex t = 0; t < c.num_slots(); ++t)
    if (c.region[t] == 1) c.region[t] = TetComplex::kOutside;
  const double outside = measure_worst(c, TetComplex::kOutside).least;
  improve_and_check(c);
  EXPECT_EQ(measure_worst(c, TetComplex::kOutside).least, outside);
  EXPECT_GT(measure_worst(c, 0).least, 15);
}

TEST(Improve, fills_an_empty_ball_of_boundary_tets) {
  TetComplex c;
  {
    const TetComplex full = fixtures::sliver_ball(0.3, 0, 5);
    std::vector<Point> surface;
    for (VertexIndex v = 0; v < full.num_vertices(); ++v)
      if (full.on_boundary[v]) surface.push_back(full.point(v));
    for (const Point& p : surface) c.add_vertex(p, 0.3);
  }
  fixtures::connect_hull(c);
  const ImproveReport report = improve_and_check(c);
  EXPECT_LT(report.min_dihedral_before_deg, 1);
  EXPECT_GT(report.points_added, 0u);
  EXPECT_GT(measure_worst(c).least, 8);
}

TEST(Improve, is_the_same_twice) {
  TetComplex a = fixtures::sliver_ball(0.2, 30, 6), b = a;
  improve_and_check(a);
  improve_and_check(b);
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(a.neigh, b.neigh);
  ASSERT_EQ(a.num_vertices(), b.num_vertices());
  for (VertexIndex v = 0; v < a.num_vertices(); ++v) EXPECT_EQ(a.point(v), b.point(v));
}

TEST(Improve, changes_nothing_where_it_is_off_and_counts_what_is_below) {
  TetComplex c = fixtures::jittered_cube(5, 0.5, 7);
  const auto node = c.node;
  ImproveOptions options;
  options.enabled = false;
  const ImproveReport report = improve_and_check(c, options);
  EXPECT_EQ(c.node, node);
  EXPECT_GT(report.below_goal, 0u);
  EXPECT_EQ(report.min_dihedral_before_deg, report.min_dihedral_after_deg);
  EXPECT_EQ(report.passes, 0u);
}

TEST(Improve, a_goal_of_nothing_changes_nothing) {
  TetComplex c = fixtures::jittered_cube(4, 0.5, 9);
  const auto node = c.node;
  ImproveOptions options;
  options.min_dihedral = 0;
  const ImproveReport report = improve_and_check(c, options);
  EXPECT_EQ(c.node, node);
  EXPECT_EQ(report.below_goal, 0u);
  EXPECT_NEAR(report.min_dihedral_after_deg, measure_worst(c).least, 1e-9);
}

TEST(Improve, counts_cells_that_have_only_boundary_vertices_as_forced) {
  TetComplex c = fixtures::complex_from_tets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.05}}, {{0, 1, 2, 3}}, 1);
  const ImproveReport report = improve_and_check(c);
  EXPECT_EQ(report.below_goal, 1u);
  EXPECT_EQ(report.below_goal_forced, 1u);
}

TEST(Improve, stops_when_cancelled_and_leaves_a_valid_complex) {
  TetComplex c = fixtures::sliver_ball(0.2, 30, 8);
  std::atomic<bool> cancel = false;
  int calls = 0;
  Context context;
  context.cancel = &cancel;
  context.on_progress = [&](const Progress& progress) {
    EXPECT_EQ(progress.stage, "improve");
    if (++calls == 5) cancel = true;
  };
  EXPECT_THROW(improve_complex(c, UniformSize(1), {}, context), Cancelled);
  EXPECT_EQ(c.find_defect(), "");
}

}  // namespace
}  // namespace delfront
