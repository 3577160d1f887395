// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>

#include "delfront/errors.hpp"
#include "surface_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

TEST(RegridSurface, KeepReturnsTheModel) {
  const Model cube = model_of(cube_surface());
  const Regridded made = regrid(cube, UniformSize(0.1), "keep");
  EXPECT_EQ(made.model.triangles, cube.triangles);
  EXPECT_EQ(made.model.points, cube.points);
}

TEST(RegridSurface, CubeKeepsEdgesCornersPatchesAreaAndVolume) {
  const Model cube = model_of(cube_surface());
  for (const std::string method : {"front", "delaunay"})
    for (const double h : {2.0, 0.5, 0.2, 0.07}) {
      SCOPED_TRACE(h);
      const Regridded made = regrid(cube, UniformSize(h), method);
      expect_sound(made, cube);
      EXPECT_EQ(made.report.regions, 6u);
      EXPECT_EQ(made.report.lines, 12u);
      EXPECT_EQ(made.report.corners, 8u);
      EXPECT_NEAR(made.look.area, 6, 1e-12);
      EXPECT_NEAR(made.look.volume, 1, 1e-12);
      EXPECT_LT(made.report.largest_distance, 1e-14);
      std::map<std::string, double> area;
      for (std::size_t t = 0; t < made.model.triangles.size(); ++t) {
        const auto& [a, b, c] = made.model.triangles[TriangleId(t)];
        const Point p = made.model.points[a], q = made.model.points[b], r = made.model.points[c];
        area[made.model.patches[made.model.patch_of_triangle[TriangleId(t)]].name] += 0.5 * length(cross(q - p, r - p));
      }
      for (const char* name : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}) EXPECT_NEAR(area[name], 1, 1e-12);
      for (const Point corner : cube.points)
        EXPECT_NE(std::find(made.model.points.begin(), made.model.points.end(), corner), made.model.points.end());
      if (h < 1) {
        EXPECT_GE(made.report.shortest_edge, 0.5 * h);
        EXPECT_LE(made.report.longest_edge, 1.6 * h);
        EXPECT_GT(made.report.min_angle_deg, 30);
      }
    }
}

TEST(RegridSurface, SphereAsOnePatchStartsFromASeed) {
  const Model sphere = model_of(sphere_surface(4));
  for (const double h : {0.4, 0.15, 0.05}) {
    SCOPED_TRACE(h);
    const Regridded made = regrid(sphere, UniformSize(h));
    expect_sound(made, sphere);
    EXPECT_EQ(made.report.lines, 0u);
    // equal triangles of side h would be 4 pi / (sqrt(3) / 4 h^2)
    EXPECT_NEAR(double(made.report.triangles) * std::sqrt(3.0) / 4 * h * h / (4 * kPi), 1, 0.12);
    EXPECT_NEAR(made.look.area / (4 * kPi), 1, 0.25 * h * h + 0.003);
    EXPECT_NEAR(made.look.volume / (4 * kPi / 3), 1, 0.5 * h * h + 0.006);
    EXPECT_LT(made.report.largest_distance, 0.35 * h * h + 0.003);
    EXPECT_GT(made.report.min_angle_deg, 25);
    EXPECT_LT(largest_distance_of_points(made.model, sphere), 1e-12);
  }
}

TEST(RegridSurface, CylinderHasTwoLinesAndItsPatches) {
  const Model cylinder = cylinder_model();
  for (const double h : {0.5, 0.2, 0.06}) {
    SCOPED_TRACE(h);
    const Regridded made = regrid(cylinder, UniformSize(h));
    expect_sound(made, cylinder);
    EXPECT_EQ(made.report.lines, 2u);
    EXPECT_EQ(made.report.regions, 3u);
    EXPECT_EQ(made.report.corners, 0u);
    EXPECT_NEAR(made.look.volume / (3 * kPi), 1, 0.2 * h * h + 0.004);
    EXPECT_GT(made.report.min_angle_deg, 25);
    ASSERT_EQ(made.report.patches.size(), 2u);
    EXPECT_EQ(made.report.patches[0].name, "body");
    EXPECT_EQ(made.report.patches[1].name, "ends");
    EXPECT_EQ(made.report.patches[1].triangles_given, 96u);
  }
}

TEST(RegridSurface, TorusKeepsItsTopology) {
  const Model torus = torus_model();
  for (const double h : {0.3, 0.1}) {
    SCOPED_TRACE(h);
    const Regridded made = regrid(torus, UniformSize(h));
    expect_sound(made, torus);
    const long euler = long(made.look.num_vertices) - long(made.look.num_edges) + long(made.look.num_triangles);
    EXPECT_EQ(euler, 0);
    EXPECT_NEAR(made.look.area / (4 * kPi * kPi * 2 * 0.6), 1, 0.03);
    EXPECT_GT(made.report.min_angle_deg, 25);
  }
}

TEST(RegridSurface, SidesOfAThinPlateDoNotSeeEachOther) {
  const Model plate = box_model({0, 0, 0}, {10, 10, 0.05});
  for (const double h : {3.0, 1.0, 0.4}) {
    SCOPED_TRACE(h);
    const Regridded made = regrid(plate, UniformSize(h));
    expect_sound(made, plate);
    EXPECT_NEAR(made.look.volume, 5, 1e-11);
    EXPECT_NEAR(made.look.area, 202, 1e-10);
  }
}

/// Two boxes with a common face inside: an edge of three triangles all round it.
Model two_boxes() {
  Model m = model_of(cube_surface());
  const Model second = box_model({1, 0, 0}, {2, 1, 1});
  std::vector<VertexId> number;
  for (const Point p : second.points) {
    const auto known = std::find(m.points.begin(), m.points.end(), p);
    number.push_back(VertexId(std::size_t(known - m.points.begin())));
    if (known == m.points.end()) m.points.push_back(p);
  }
  const PatchId patch = m.patches.next_id();
  m.patches.push_back({"second", "wall"});
  for (std::size_t t = 0; t < second.triangles.size(); ++t) {
    std::array<VertexId, 3> corners = second.triangles[TriangleId(t)];
    if (std::all_of(corners.begin(), corners.end(), [&](VertexId v) { return second.points[v].x == 1; })) continue;
    for (VertexId& v : corners) v = number[v.index()];
    m.triangles.push_back(corners);
    m.patch_of_triangle.push_back(patch);
    m.input_face.push_back(std::uint32_t(m.input_face.size()));
  }
  return m;
}

TEST(RegridSurface, BoxesThatShareAFaceStayConformal) {
  const Model boxes = two_boxes();
  const Regridded made = regrid(boxes, UniformSize(0.15));
  expect_sound(made, boxes);
  EXPECT_EQ(made.report.regions, 11u);
  EXPECT_EQ(made.report.corners, 12u);
  EXPECT_NEAR(made.look.area, 11, 1e-12);
  EXPECT_EQ(made.model.patches.back().name, "second");
  EXPECT_EQ(made.model.patches.back().kind, "wall");
  std::map<std::set<std::uint32_t>, int> uses;
  for (const auto& t : made.model.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[{t[k].value, t[(k + 1) % 3].value}];
  std::size_t of_three = 0;
  for (const auto& [edge, count] : uses) {
    EXPECT_TRUE(count == 2 || count == 3);
    if (count != 3) continue;
    ++of_three;
    for (const std::uint32_t v : edge) EXPECT_EQ(made.model.points[VertexId(std::size_t(v))].x, 1);
  }
  EXPECT_EQ(of_three, 4u * 7u);
}

TEST(RegridSurface, OrientationIsThatOfTheInput) {
  Model cube = model_of(cube_surface());
  for (auto& t : cube.triangles) std::swap(t[1], t[2]);
  const Regridded made = regrid(cube, UniformSize(0.3));
  expect_sound(made, cube);
  double volume = 0;
  for (const auto& [a, b, c] : made.model.triangles)
    volume += dot(made.model.points[a], cross(made.model.points[b], made.model.points[c])) / 6;
  EXPECT_NEAR(volume, -1, 1e-12);
}

TEST(RegridSurface, OpenSurfaceKeepsItsBorder) {
  Model sheet = model_of(cube_surface());
  std::erase_if(sheet.triangles, [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](VertexId v) { return sheet.points[v].z == 1; });
  });
  std::vector<PatchId> patches;
  for (const auto& t : sheet.triangles) {
    const Point middle = (sheet.points[t[0]] + sheet.points[t[1]] + sheet.points[t[2]]) / 3.0;
    patches.push_back(PatchId(std::size_t(middle.z == 0)));
  }
  sheet.patch_of_triangle.assign(patches.begin(), patches.end());
  sheet.input_face.resize(sheet.triangles.size());
  const Regridded made = regrid(sheet, UniformSize(0.2));
  expect_sound(made, sheet);
  EXPECT_NEAR(made.look.area, 5, 1e-12);
  EXPECT_FALSE(made.look.is_closed);
}

TEST(RegridSurface, SizesThatVary) {
  const Model plate = box_model({0, 0, 0}, {10, 4, 2});
  const Regridded made = regrid(plate, RisingSize(0.05, 0.1));
  expect_sound(made, plate);
  EXPECT_NEAR(made.look.volume, 80, 1e-10);
  std::size_t narrow = 0, all = 0;
  for (const auto& t : made.model.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point a = made.model.points[t[k]], b = made.model.points[t[(k + 1) % 3]];
      const double ratio = distance(a, b) / (0.05 + 0.05 * (a.x + b.x));
      narrow += ratio > 0.6 && ratio < 1.5;
      ++all;
    }
  EXPECT_GT(double(narrow) / double(all), 0.9);
  EXPECT_GT(made.report.min_angle_deg, 25);
}

TEST(RegridSurface, AnyNumberOfThreadsGivesTheSameGrid) {
  const Model boxes = two_boxes();
  const Regridded one = regrid(boxes, UniformSize(0.11)), four = regrid(boxes, UniformSize(0.11), "front", 4);
  EXPECT_EQ(one.model.points, four.model.points);
  EXPECT_EQ(one.model.triangles, four.model.triangles);
}

TEST(RegridSurface, TurningChangesCountsByOnePercentAtMost) {
  for (const Model& given : {cylinder_model(), torus_model()}) {
    const Regridded made = regrid(given, UniformSize(0.1)), other = regrid(turned(given, 1), UniformSize(0.1));
    expect_sound(other, given);
    EXPECT_NEAR(double(other.report.triangles) / double(made.report.triangles), 1, 0.01);
  }
}

TEST(RegridSurface, CurvesAndCornersOfTheModelStay) {
  Model cube = model_of(cube_surface());
  // a curve along two edges of the cube, and one through the volume from a corner
  const auto at = [&](Point p) {
    return VertexId(std::size_t(std::find(cube.points.begin(), cube.points.end(), p) - cube.points.begin()));
  };
  cube.curves.push_back({"rim", {at({0, 0, 0}), at({1, 0, 0}), at({1, 1, 0})}});
  const VertexId inside = cube.points.next_id();
  cube.points.push_back({0.5, 0.5, 0.5});
  cube.curves.push_back({"through", {at({0, 0, 0}), inside}});
  cube.corners = {inside};
  cube.corner_names = {"middle"};
  const Regridded made = regrid(cube, UniformSize(0.25));
  expect_sound(made, cube);
  ASSERT_EQ(made.model.curves.size(), 2u);
  const Curve& rim = made.model.curves[CurveId(std::size_t(0))];
  EXPECT_EQ(rim.name, "rim");
  ASSERT_EQ(rim.vertices.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) {
    const Point wanted = i < 5 ? Point{0.25 * double(i), 0, 0} : Point{1, 0.25 * double(i - 4), 0};
    EXPECT_LT(distance(made.model.points[rim.vertices[i]], wanted), 1e-14);
  }
  const Curve& through = made.model.curves[CurveId(std::size_t(1))];
  ASSERT_EQ(through.vertices.size(), 2u);
  EXPECT_EQ(made.model.points[through.vertices[0]], (Point{0, 0, 0}));
  EXPECT_EQ(made.model.points[through.vertices[1]], (Point{0.5, 0.5, 0.5}));
  ASSERT_EQ(made.model.corners.size(), 1u);
  EXPECT_EQ(made.model.corner_names[0], "middle");
  EXPECT_EQ(made.model.points[made.model.corners[0]], (Point{0.5, 0.5, 0.5}));
}

TEST(RegridSurface, PatchesThatAreKeptKeepTheirTriangles) {
  const Model cube = model_of(cube_surface());
  Context context;
  SurfaceOptions options;
  options.method = "front";
  options.kept = {PatchId(std::size_t(0))};
  SurfaceGridReport report;
  const Model made = regrid_surface(cube, UniformSize(0.2), options, report, context);
  EXPECT_EQ(report.patches[0].triangles, 2u);
  EXPECT_TRUE(report.fallbacks.empty());
  const SurfaceReport look = check_surface(made, context);
  EXPECT_TRUE(look.can_bound_volume);
  EXPECT_NEAR(look.volume, 1, 1e-12);
}

TEST(RegridSurface, TrianglesWithoutAreaAreRefusedWithTheirPlace) {
  Model cube = model_of(cube_surface());
  cube.triangles.push_back({VertexId(std::size_t(0)), VertexId(std::size_t(1)), VertexId(std::size_t(1))});
  cube.patch_of_triangle.push_back(PatchId(std::size_t(0)));
  cube.input_face.push_back(12);
  try {
    regrid(cube, UniformSize(0.2));
    FAIL() << "taken";
  } catch (const InputError& e) {
    ASSERT_FALSE(e.places.empty());
    EXPECT_NE(std::string(e.what()).find("area"), std::string::npos);
  }
}

}  // namespace
}  // namespace delfront
