// SPDX-License-Identifier: Apache-2.0
#include "brep_fixtures.hpp"
#include "delfront/errors.hpp"
#include "support/errors.hpp"

namespace delfront {
namespace {

using namespace fixtures;

std::set<VertexId> tips_of(const Model& m) {
  std::set<VertexId> tips;
  for (std::size_t c = 0; c < m.corners.size(); ++c)
    if (m.corner_names[c] == "tip") tips.insert(m.corners[c]);
  return tips;
}

void expect_good(const Shape& shape, const Gridded& made, const SizeField& size, double least_angle) {
  Context context;
  const SurfaceReport look = check_surface(made.model, context);
  const Topology topology = topology_of(made.model);
  EXPECT_EQ(topology.euler, shape.euler);
  EXPECT_EQ(topology.crowded, 0u);
  EXPECT_EQ(topology.open == 0, shape.is_closed);
  EXPECT_EQ(look.is_closed, shape.is_closed);
  EXPECT_TRUE(look.is_manifold);
  EXPECT_TRUE(look.is_oriented);
  if (shape.is_closed) {
    EXPECT_TRUE(look.can_bound_volume);
    ASSERT_EQ(look.components.size(), 1u);
    EXPECT_GT(look.components[0].signed_volume, 0);
    for (const Finding& f : look.findings) EXPECT_NE(f.severity, Severity::error) << f.message;
  }
  EXPECT_LT(farthest_from_entity(made, shape.brep), 1e-12 * look.box.diagonal());
  // the triangles at a tip are narrow, and those beside them not quite right
  const std::set<VertexId> tips = tips_of(made.model);
  EXPECT_GT(smallest_angle(made.model, tips), tips.empty() ? least_angle : std::min(least_angle, 28.0));
  EXPECT_GE(share_of_right_lengths(made.model, size), 0.9);
  EXPECT_GT(worst_agreement(made, shape.brep), 0.3);
  EXPECT_EQ(made.report.rounds, 1u);
  EXPECT_EQ(made.report.entity.size(), made.model.points.size());
}

TEST(GridBrep, AllShapesThroughTheirMapping) {
  for (const Shape& shape : all_shapes())
    for (const double h : {1.0, 0.5}) {
      SCOPED_TRACE(shape.name + " " + std::to_string(h));
      const LinearSize size(h * shape.h, 1, {}, shape.low, shape.high);
      const Gridded made = grid(shape.brep, size, {.method = BrepOptions::Method::mapped});
      expect_good(shape, made, size, 30);
      for (const BrepFaceReport& face : made.report.faces) EXPECT_TRUE(face.is_mapped) << face.why;
      EXPECT_LT(made.report.largest_normal_angle_deg, 75);  // at the cone's tip; else under 40
    }
}

TEST(GridBrep, AllShapesWithSizesGradedByTwenty) {
  for (const Shape& shape : all_shapes()) {
    SCOPED_TRACE(shape.name);
    const LinearSize size(0.1 * shape.h, 20, {}, shape.low, shape.high);
    const Gridded made = grid(shape.brep, size, {.method = BrepOptions::Method::mapped});
    expect_good(shape, made, size, 30);
    EXPECT_GT(made.report.mean_min_angle_deg, 50);
  }
}

TEST(GridBrep, AllShapesDirectlyInSpace) {
  for (const Shape& shape : all_shapes())
    for (const double grading : {1.0, 20.0}) {
      SCOPED_TRACE(shape.name + " " + std::to_string(grading));
      const LinearSize size((grading > 1 ? 0.1 : 0.6) * shape.h, grading, {}, shape.low, shape.high);
      const Gridded made = grid(shape.brep, size, {.method = BrepOptions::Method::direct});
      expect_good(shape, made, size, 20);
      for (const BrepFaceReport& face : made.report.faces) EXPECT_FALSE(face.is_mapped);
    }
}

TEST(GridBrep, HalfOfAPatchUnderItsDiagonal) {
  const Shape shape{"half bicubic", half_bicubic(), 0.1, 0, 3.3, 1, false};
  for (const double grading : {1.0, 20.0}) {
    const LinearSize size((grading > 1 ? 0.15 : 1) * shape.h, grading, {}, 0, 3.3);
    const Gridded made = grid(shape.brep, size);
    expect_good(shape, made, size, 22);  // the patch has corners of 30 and 35 degrees there
  }
}

TEST(GridBrep, AMappingThatIsTooBadIsGriddedInAnotherWay) {
  // a triangle as a patch of four sides: at the corner amid the base u and v run against each other
  std::array<std::array<Point, 4>, 4> b;
  const double squares[] = {0, 0, 1.0 / 3, 1};  // Bezier points of t^2
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      const double u = double(i) / 3, v = double(j) / 3;
      b[i][j] = {u - v, 0.001 * (u + v) + u * v, 0.2 * (squares[i] - 2 * u * v + squares[j])};  // z = x^2 / 5
    }
  const Brep brep = make_bicubic(b);
  const LinearSize size(0.05, 1, {}, 0, 1);
  for (const auto method : {BrepOptions::Method::choose, BrepOptions::Method::direct}) {
    BrepOptions options;
    options.method = method;
    const Gridded made = grid(brep, size, options);
    const bool is_direct = method == BrepOptions::Method::direct;
    EXPECT_EQ(made.report.faces[0].is_mapped, !is_direct);
    expect_mentions(made.report.faces[0].why, {is_direct ? "asked for" : "stretches"});
    EXPECT_EQ(topology_of(made.model).euler, 1);
    EXPECT_LT(farthest_from_entity(made, brep), 1e-12);
    EXPECT_GT(worst_agreement(made, brep), 0.9);
    EXPECT_GT(smallest_angle(made.model), 20);
    EXPECT_GE(share_of_right_lengths(made.model, size), 0.9);
  }
}

/// Both in one; the second's ids follow the first's.
Brep joined(Brep a, const Brep& b) {
  const std::size_t corners = a.corners.size(), edges = a.edges.size();
  for (const BrepCorner& corner : b.corners) a.corners.push_back(corner);
  for (BrepEdge edge : b.edges) {
    for (CornerId& c : edge.corners)
      if (c.is_valid()) c = CornerId(corners + c.index());
    a.edges.push_back(edge);
  }
  for (BrepFace face : b.faces) {
    for (auto& loop : face.loops)
      for (BrepUse& use : loop) use.edge = EdgeId(edges + use.edge.index());
    a.faces.push_back(face);
  }
  return a;
}

TEST(GridBrep, AFaceFarFromOneThatFailsKeepsItsGridWhileThatIsDoneAgain) {
  // triangles of the ball differ by more from its normals than is allowed, until sizes are lowered there
  const Brep ball = make_rectangle_on(make_sphere_surface({}, 1), {{0, -0.5}, {1.5, 0.5}});
  SpaceFrame far;
  far.origin = {50, 0, 0};
  const Brep square = make_rectangle_on(make_plane_surface(far), {{0, 0}, {2, 2}});
  const LinearSize size(0.35, 1, {}, 0, 1);
  const BrepOptions options = {.method = BrepOptions::Method::mapped, .normal_angle_deg = 9};
  const Gridded alone = grid(square, size, options), both = grid(joined(ball, square), size, options);
  EXPECT_GT(both.report.rounds, 1u);
  EXPECT_LE(both.report.largest_normal_angle_deg, 9);
  // the same places, though points of edges have other numbers in each round
  const auto on_square = [](const Gridded& made, std::uint32_t face) {
    std::multiset<std::array<double, 9>> triangles;
    for (std::size_t t = 0; t < made.model.triangles.size(); ++t) {
      if (made.model.input_face[TriangleId(t)] != face) continue;
      std::array<std::array<double, 3>, 3> at;
      for (std::size_t k = 0; k < 3; ++k) {
        const Point p = made.model.points[made.model.triangles[TriangleId(t)][k]];
        at[k] = {p.x, p.y, p.z};
      }
      std::sort(at.begin(), at.end());
      triangles.insert({at[0][0], at[0][1], at[0][2], at[1][0], at[1][1], at[1][2], at[2][0], at[2][1], at[2][2]});
    }
    return triangles;
  };
  EXPECT_EQ(on_square(both, 1), on_square(alone, 0));
  EXPECT_LT(farthest_from_entity(both, joined(ball, square)), 1e-12);
}

TEST(GridBrep, SidesOfOneEdgeHaveALimit) {
  EXPECT_THROW(grid(make_cylinder({}, 1, 2), LinearSize(1e-10, 1, {}, 0, 1)), LimitError);
}

TEST(GridBrep, NoMoreRoundsThanAskedFor) {
  const Brep ball = make_rectangle_on(make_sphere_surface({}, 1), {{0, -0.5}, {1.5, 0.5}});
  const LinearSize size(0.35, 1, {}, 0, 1);
  EXPECT_THROW(grid(ball, size, {.method = BrepOptions::Method::mapped, .normal_angle_deg = 9, .most_rounds = 1}),
               MeshingError);
}

TEST(GridBrep, TurnedAndScaledCopiesHaveTheSameCounts) {
  SpaceFrame turned;  // about (1, 2, 3), by 40 degrees
  const Point axis = Point{1, 2, 3} / std::sqrt(14.0);
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (Point* p : {&turned.x, &turned.y, &turned.z}) *p = c * *p + s * cross(axis, *p) + (1 - c) * dot(axis, *p) * axis;
  turned.origin = {300, -20, 7};
  const std::vector<Shape> given = all_shapes(), copies = all_shapes(turned, 1000);
  for (std::size_t i = 0; i < given.size(); ++i) {
    SCOPED_TRACE(given[i].name);
    const LinearSize size(0.2 * given[i].h, 10, {}, given[i].low, given[i].high);
    const LinearSize copied(0.2 * copies[i].h, 10, turned, copies[i].low, copies[i].high);
    const Gridded a = grid(given[i].brep, size), b = grid(copies[i].brep, copied);
    EXPECT_NEAR(double(b.model.triangles.size()), double(a.model.triangles.size()),
                0.01 * double(a.model.triangles.size()));
    expect_good(copies[i], b, copied, 30);
  }
}

TEST(GridBrep, TheSameForAnyNumberOfThreads) {
  for (const Shape& shape : all_shapes()) {
    SCOPED_TRACE(shape.name);
    const LinearSize size(shape.h, 3, {}, shape.low, shape.high);
    const Gridded a = grid(shape.brep, size), b = grid(shape.brep, size), c = grid(shape.brep, size, {}, 3);
    EXPECT_EQ(a.model.points, b.model.points);
    EXPECT_EQ(a.model.triangles, b.model.triangles);
    EXPECT_EQ(a.model.points, c.model.points);
    EXPECT_EQ(a.model.triangles, c.model.triangles);
  }
}

TEST(GridBrep, SizesFarTooLargeGiveWhatTheBendsNeed) {
  for (const Shape& shape : all_shapes()) {
    SCOPED_TRACE(shape.name);
    const LinearSize size(100, 1, {}, shape.low, shape.high);
    const Gridded made = grid(shape.brep, size);
    EXPECT_EQ(topology_of(made.model).euler, shape.euler);
    EXPECT_LT(farthest_from_entity(made, shape.brep), 1e-11);
    EXPECT_GT(worst_agreement(made, shape.brep), 0);
    EXPECT_LT(made.model.triangles.size(), 3000u);
  }
}

TEST(GridBrep, CornersCurvesAndPatchesAreNamed) {
  const LinearSize size(0.3, 1, {}, 0, 1);
  Brep brep = make_cylinder({}, 1, 2);
  brep.faces[face_0()].kind = "wall";
  const Gridded made = grid(brep, size);
  ASSERT_EQ(made.model.patches.size(), 3u);
  EXPECT_EQ(made.model.patches[PatchId(std::size_t(0))].name, "side");
  EXPECT_EQ(made.model.patches[PatchId(std::size_t(0))].kind, "wall");
  EXPECT_EQ(made.model.patches[PatchId(std::size_t(2))].name, "top");
  ASSERT_EQ(made.model.curves.size(), 2u);  // both circles; the seam is no border
  for (const Curve& curve : made.model.curves) {
    EXPECT_EQ(curve.vertices.front(), curve.vertices.back());
    EXPECT_EQ(curve.vertices.size(), std::size_t(std::floor(2 * kPi / 0.3 + 0.5)) + 1);
    for (const VertexId v : curve.vertices) {
      const Point p = made.model.points[v];
      EXPECT_NEAR(std::hypot(p.x, p.y), 1, 1e-15);
    }
  }
  EXPECT_TRUE(made.model.corners.empty());
  for (std::size_t t = 0; t < made.model.triangles.size(); ++t)
    EXPECT_EQ(made.model.patch_of_triangle[TriangleId(t)].value, made.model.input_face[TriangleId(t)]);
  const Gridded cone = grid(make_cone({}, kPi / 6, 1), size);
  ASSERT_EQ(cone.model.corners.size(), 1u);
  EXPECT_EQ(cone.model.corner_names[0], "tip");
  EXPECT_EQ(cone.model.points[cone.model.corners[0]], (Point{0, 0, 0}));
}

TEST(GridBrep, FacesBesideEachOtherShareTheirEdges) {
  // two halves of a sphere between its poles, the second's surface turned inside out
  const SurfacePointer sphere = make_sphere_surface({}, 1);
  SpaceFrame mirrored;
  mirrored.z = {0, 0, -1};
  const SurfacePointer inside_out = make_sphere_surface(mirrored, 1);
  Brep brep = make_rectangle_on(sphere, {{0, -kPi / 2}, {kPi, kPi / 2}});
  const auto& loop = brep.faces[face_0()].loops[0];  // south pole, up at pi, north pole, down at 0
  BrepFace second;
  second.surface = inside_out;
  second.is_reversed = true;
  // in its parameters: longitude from pi to 2 pi, latitude against the first's
  const auto line = [](double u0, double v0, double u1, double v1) { return make_parameter_line({u0, v0}, {u1, v1}); };
  const double q = kPi / 2;
  second.loops = {{BrepUse{loop[2].edge, line(kPi, -q, 2 * kPi, -q), false},
                   BrepUse{loop[3].edge, line(2 * kPi, q, 2 * kPi, -q), true},
                   BrepUse{loop[0].edge, line(2 * kPi, q, kPi, q), false},
                   BrepUse{loop[1].edge, line(kPi, q, kPi, -q), false}}};
  brep.faces[face_0()].name = "first";
  second.name = "second";
  brep.faces.push_back(second);
  const LinearSize size(0.1, 4, {}, -1, 1);
  const Gridded made = grid(brep, size, {}, 2);
  expect_good({"halves", brep, 0.1, -1, 1, 2, true}, made, size, 30);
  EXPECT_EQ(made.model.patches.size(), 2u);
  EXPECT_EQ(made.model.curves.size(), 2u);
  EXPECT_EQ(made.model.corners.size(), 2u);
}

TEST(GridBrep, AReversedShellPointsInwards) {
  Brep brep = make_torus({}, 2, 0.6);
  brep.faces[face_0()].is_reversed = true;
  const LinearSize size(0.2, 1, {}, 0, 1);
  const Gridded made = grid(brep, size);
  Context context;
  const SurfaceReport look = check_surface(made.model, context);
  ASSERT_EQ(look.components.size(), 1u);
  EXPECT_NEAR(look.components[0].signed_volume, -2 * kPi * kPi * 2 * 0.36, 0.3);
  EXPECT_GT(worst_agreement(made, brep), 0.3);
}

TEST(GridBrep, AreaAndVolumeConvergeWithTheSquareOfTheSize) {
  double last = 0;
  for (const double h : {0.2, 0.1, 0.05}) {
    const Gridded made = grid(make_sphere({1, 2, 3}, 1), LinearSize(h, 1, {}, 0, 1));
    Context context;
    const double missing = 4 * kPi / 3 - check_surface(made.model, context).volume;
    EXPECT_GT(missing, 0);
    if (last > 0) {
      EXPECT_NEAR(last / missing, 4, 0.5);
    }
    last = missing;
  }
}

TEST(GridBrep, WhatIsNotValidIsRefusedByName) {
  const LinearSize size(0.3, 1, {}, 0, 1);
  EXPECT_THROW(grid(Brep{}, size), InputError);
  Brep brep = make_cylinder({}, 1, 2);
  brep.faces[face_0()].loops[0].pop_back();
  expect_mentions(message_of<InputError>([&] { grid(brep, size); }), {"face 0 ('side')", "does not close"});
  brep = make_cylinder({}, 1, 2);
  brep.edges[EdgeId(std::size_t(1))].name = "seam";
  brep.corners[CornerId(std::size_t(0))].at.z = 0.1;
  expect_mentions(message_of<InputError>([&] { grid(brep, size); }), {"away from its corner"});
  brep = make_cylinder({}, 1, 2);
  brep.faces[FaceId(std::size_t(2))].surface = make_plane_surface({});  // the top at the bottom's height
  expect_mentions(message_of<InputError>([&] { grid(brep, size); }), {"face 2 ('top')", "parameter curve", "2 away"});
  brep = make_bicubic(wavy_patch());
  brep.edges[EdgeId(std::size_t(2))].range = {1, 1};
  expect_mentions(message_of<InputError>([&] { grid(brep, size); }), {"edge 2", "range"});
  brep = make_bicubic(wavy_patch());
  brep.edges[EdgeId(std::size_t(2))].corners[1] = CornerId(std::size_t(9));
  expect_mentions(message_of<InputError>([&] { grid(brep, size); }), {"edge 2", "corner"});
  EXPECT_THROW(make_rectangle_on(make_torus_surface({}, 2, 1), {{0, 0}, {7, 1}}), InputError);
}

TEST(GridBrep, ALoopThatCrossesAnotherIsAnError) {
  Brep brep = make_bicubic(wavy_patch());
  cut_hole(brep, face_0(), {0.9, 0.5}, 0.3, 0.1);  // over the border
  Context context;
  BrepGridReport report;
  EXPECT_THROW(grid_brep(brep, LinearSize(0.2, 1, {}, 0, 1), {}, report, context), InputError);
}

}  // namespace
}  // namespace delfront
