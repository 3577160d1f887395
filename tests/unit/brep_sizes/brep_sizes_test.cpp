// SPDX-License-Identifier: Apache-2.0
// Smooth geometry with nothing asked for: what is thin gets sizes of its own, deviation is kept to, and a model that is
// turned or scaled gets the same grid.
#include "delfront/brep_sizes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "delfront/brep_shapes.hpp"
#include "delfront/surface_check.hpp"
#include "pipeline/boundaries.hpp"
#include "pipeline/geometry_job.hpp"
#include "unit/brep_sizes/geometry_texts.hpp"

namespace delfront {
namespace {

using namespace fixtures;

struct Made {
  Brep brep;
  BrepLook look;
  Mesh mesh;
  BrepRounds rounds;
  const BrepAccuracy& accuracy() const { return rounds.last(); }
};

Made grid(const std::string& text, const Options& options = {}, int threads = 1) {
  Context context;
  context.threads = threads;
  Made made;
  made.brep = brep_of(text);
  made.look = look_at_brep(made.brep, context);
  GeometryInput input{0, {}, made.brep, made.look};
  const auto sizes = geometry_sizes(made.brep, made.look, options, nullptr, context);
  made.mesh = surface_mesh(grid_geometry_to_goals(input, sizes, options, context, made.rounds));
  return made;
}

void expect_sound(const Made& made, double least_angle) {
  Context context;
  const Model model = build_model({{made.mesh, "test"}}, context);
  const SurfaceReport look = check_surface(model, context);
  EXPECT_TRUE(look.can_bound_volume);
  for (const Finding& f : look.findings) EXPECT_NE(f.severity, Severity::error) << f.message;
  EXPECT_GT(made.accuracy().angle_deg.value, least_angle);
  EXPECT_TRUE(made.accuracy().is_reached()) << made.rounds.stopped;
}

TEST(BrepSizes, ExtentIsThatOfTheSmallestBallHoweverTurned) {
  for (const Placing& to : {Placing{}, odd_placing(), odd_placing(1e-3)}) {
    EXPECT_NEAR(measure_extent(brep_of(box_text(1, 2, 3, to))).whole / to.scale, std::sqrt(14.0), 1e-9);
    EXPECT_NEAR(measure_extent(brep_of(torus_text(2, 0.5, to))).whole / to.scale, 5, 1e-2);
    EXPECT_NEAR(measure_extent(brep_of(can_text(1, 2, to))).whole / to.scale, std::sqrt(8.0), 1e-2);
  }
}

/// A can in a sphere that is far larger, both about the origin.
Brep can_in_a_far_field(double radius) {
  Brep all = make_cylinder({}, 1, 2);
  const Brep ball = make_sphere({}, radius);
  const std::size_t corners = all.corners.size(), edges = all.edges.size();
  for (const BrepCorner& corner : ball.corners) all.corners.push_back(corner);
  for (BrepEdge edge : ball.edges) {
    for (CornerId& c : edge.corners)
      if (c.is_valid()) c = CornerId(corners + c.index());
    all.edges.push_back(edge);
  }
  for (BrepFace face : ball.faces) {
    for (auto& loop : face.loops)
      for (BrepUse& use : loop) use.edge = EdgeId(edges + use.edge.index());
    all.faces.push_back(face);
  }
  return all;
}

TEST(BrepSizes, AFarFieldIsNoPartOfTheBody) {
  const double can = std::sqrt(8.0);
  const BrepExtent far = measure_extent(can_in_a_far_field(50));
  EXPECT_NEAR(far.whole, 100, 0.5);
  EXPECT_NEAR(far.body, can, 1e-2);
  EXPECT_LT(distance(far.body_centre, Point{0, 0, 1}), 1e-2);
  const BrepExtent near = measure_extent(can_in_a_far_field(5));
  EXPECT_EQ(near.body, near.whole);
  const BrepExtent alone = measure_extent(make_cylinder({}, 1, 2));
  EXPECT_EQ(alone.body, alone.whole);
  EXPECT_NEAR(alone.whole, can, 1e-2);
}

TEST(BrepSizes, TheFirstLookIsAsFineOnABodyInAFarFieldAsAlone) {
  Context context;
  const auto triangles_of_can = [&](const Brep& brep) {
    const BrepLook look = look_at_brep(brep, context);
    std::size_t count = 0;
    for (const std::uint32_t face : look.grid.input_face) count += face < 3 ? 1 : 0;
    return count;
  };
  EXPECT_EQ(triangles_of_can(can_in_a_far_field(50)), triangles_of_can(make_cylinder({}, 1, 2)));
}

TEST(BrepSizes, ThinTrailingEdgeHasNoSlivers) { expect_sound(grid(wing_text(0.002, 1.2)), 20); }

TEST(BrepSizes, PlateHasNoSliversOnItsRim) { expect_sound(grid(box_text(1, 1, 0.01)), 20); }

TEST(BrepSizes, SlotHasNoSlivers) { expect_sound(grid(slot_text(0.01)), 20); }

TEST(BrepSizes, SharpCornersAreNoGaps) {
  // a wedge of 30 degrees: nothing in it asks for small sizes
  const Made made = grid(prism_text({{0, 0}, {1, 0}, {1, std::tan(kTau / 12)}}, 1));
  expect_sound(made, 20);
  EXPECT_LT(made.accuracy().triangles, 3000u);
}

TEST(BrepSizes, DeviationAsAskedFor) {
  for (const double asked : {0.02, 0.004}) {
    Options options;
    options.size.deviation = Length{asked, ""};
    options.size.hmax = Length{10, ""};
    for (const std::string& text : {torus_text(2, 0.5), can_text(1, 2), wing_text(0.01, 1)}) {
      const Made made = grid(text, options);
      EXPECT_TRUE(made.accuracy().is_reached()) << made.rounds.stopped;
      EXPECT_LE(made.accuracy().deviation.value, asked);
    }
  }
}

TEST(BrepSizes, FinerIsFiner) {
  std::size_t before = 0;
  double off = 1e300;
  for (const char* word : {"coarse", "medium", "fine"}) {
    Options options;
    options.size.accuracy = word;
    const Made made = grid(torus_text(2, 0.3), options);
    EXPECT_TRUE(made.accuracy().is_reached()) << word << ": " << made.rounds.stopped;
    EXPECT_GT(made.accuracy().triangles, 2 * before);
    EXPECT_LT(made.accuracy().deviation.value, 0.5 * off);
    before = made.accuracy().triangles;
    off = made.accuracy().deviation.value;
  }
}

TEST(BrepSizes, TurnedAndScaledModelsHaveTheSameGrids) {
  const auto texts = [](const Placing& to) {
    return std::vector<std::string>{wing_text(0.004, 0.4, to), can_text(1, 3, to), torus_text(2, 0.4, to),
                                    slot_text(0.02, to)};
  };
  const std::vector<std::string> plain = texts({});
  std::vector<double> count;
  for (const std::string& text : plain) count.push_back(double(grid(text).accuracy().triangles));
  for (const Placing& to : {Placing{1000, {}}, odd_placing(), odd_placing(1e-3)}) {
    const std::vector<std::string> moved = texts(to);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const double share = double(grid(moved[i]).accuracy().triangles) / count[i];
      EXPECT_NEAR(share, 1, 0.01) << i << " of scale " << to.scale;
    }
  }
}

TEST(BrepSizes, SameGridForAnyNumberOfThreads) {
  const std::string text = wing_text(0.01, 0.5);
  const Made one = grid(text), four = grid(text, {}, 4);
  ASSERT_EQ(one.mesh.points.size(), four.mesh.points.size());
  for (std::size_t v = 0; v < one.mesh.points.size(); ++v)
    EXPECT_EQ(one.mesh.points[VertexId(v)], four.mesh.points[VertexId(v)]);
}

}  // namespace
}  // namespace delfront
