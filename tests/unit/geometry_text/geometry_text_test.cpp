// SPDX-License-Identifier: Apache-2.0
#include "delfront/geometry_text.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "delfront/errors.hpp"
#include "delfront/surface_check.hpp"
#include "delfront/uniform_size.hpp"
#include "support/errors.hpp"

namespace delfront {
namespace {

using namespace fixtures;

constexpr double kPi = std::numbers::pi;

Brep brep_of(const std::string& text) { return build_brep(parse_geometry(text, "part.geom.toml"), "part.geom.toml"); }

struct Looked {
  Model model;
  SurfaceReport surface;
  BrepGridReport grid;
};

Looked look_at(const std::string& text, double h) {
  Looked looked;
  Context context;
  looked.model = grid_brep(brep_of(text), UniformSize(h), {}, looked.grid, context);
  looked.surface = check_surface(looked.model, context);
  return looked;
}

/// Closed, sound, outwards, with about that volume.
Looked expect_solid(const std::string& text, double h, double volume) {
  Looked looked = look_at(text, h);
  EXPECT_TRUE(looked.surface.is_closed);
  EXPECT_TRUE(looked.surface.can_bound_volume);
  for (const Finding& f : looked.surface.findings) EXPECT_NE(f.severity, Severity::error) << f.message;
  EXPECT_NEAR(looked.surface.volume / volume, 1, 0.02);
  EXPECT_GT(looked.grid.min_angle_deg, 20);
  return looked;
}

std::string refused(const std::string& text) {
  return message_of<InputError>([&] { brep_of(text); });
}

const char* const kCan = R"(
[[surface]]
name = "round"
type = "cylinder"
radius = 0.5

[[surface]]
name = "low"
type = "plane"

[[surface]]
name = "high"
type = "plane"
origin = [0, 0, 2]

[[corner]]
name = "a"
at = [0.5, 0, 0]

[[corner]]
name = "b"
at = [0.5, 0, 2]

[[edge]]
name = "bottom ring"
type = "circle"
from = "a"
to = "a"
radius = 0.5

[[edge]]
name = "top ring"
type = "circle"
from = "b"
to = "b"
origin = [0, 0, 2]
radius = 0.5

[[edge]]
name = "seam"
type = "line"
from = "a"
to = "b"

[[face]]
name = "wall"
kind = "wall"
surface = "round"
loops = [["bottom ring", "seam", "-top ring", "-seam"]]

[[face]]
name = "inlet"
kind = "inlet"
surface = "low"
reversed = true
loops = [["bottom ring"]]

[[face]]
name = "outlet"
surface = "high"
loops = [["top ring"]]
)";

TEST(GeometryText, ShapesAreSolidsOfTheirVolume) {
  expect_solid("[[shape]]\ntype = \"sphere\"\nradius = 1\n", 0.15, 4 * kPi / 3);
  expect_solid("[[shape]]\ntype = \"torus\"\nradius = 2\ntube = 0.6\naxis = [1, 2, 0]\n", 0.2, 2 * kPi * kPi * 0.72);
  expect_solid("[[shape]]\ntype = \"cylinder\"\nradius = 1\nheight = 2\naxis = [0, -1, 3]\n", 0.15, 2 * kPi);
  const Looked box =
      expect_solid("[[shape]]\ntype = \"box\"\nname = \"room\"\nmin = [0, 0, 0]\nmax = [1, 2, 3]\n", 0.2, 6);
  EXPECT_EQ(box.model.patches.size(), 6u);
  EXPECT_EQ(box.model.patches[PatchId(std::size_t(0))].name, "room_x_low");
  EXPECT_EQ(box.model.corners.size(), 8u);
  EXPECT_EQ(box.model.curves.size(), 12u);
  Looked cone = look_at("[[shape]]\ntype = \"cone\"\nradius = 1\nheight = 2\n", 0.1);
  EXPECT_TRUE(cone.surface.can_bound_volume);
  EXPECT_NEAR(cone.surface.volume, 2 * kPi / 3, 0.03);
}

TEST(GeometryText, AReversedShapeIsAHoleInAnother) {
  const Looked both = look_at(
      "[[shape]]\ntype = \"box\"\nmin = [-2, -2, -2]\nmax = [2, 2, 2]\n[[shape]]\ntype = \"sphere\"\nradius = 1\n"
      "reversed = true\n",
      0.25);
  ASSERT_EQ(both.surface.components.size(), 2u);
  double sum = 0;
  for (const SurfaceComponent& c : both.surface.components) sum += c.signed_volume;
  EXPECT_NEAR(sum, 64 - 4 * kPi / 3, 0.2);
}

TEST(GeometryText, FacesOfCornersEdgesAndSurfaces) {
  const Looked can = expect_solid(kCan, 0.1, kPi / 2);
  ASSERT_EQ(can.model.patches.size(), 3u);
  EXPECT_EQ(can.model.patches[PatchId(std::size_t(1))].name, "inlet");
  EXPECT_EQ(can.model.patches[PatchId(std::size_t(1))].kind, "inlet");
  ASSERT_EQ(can.model.curves.size(), 2u);  // the seam is none
  EXPECT_EQ(can.model.curves[CurveId(std::size_t(0))].name, "bottom ring");
  ASSERT_EQ(can.model.corners.size(), 2u);
  EXPECT_EQ(can.model.corner_names[0], "a");
}

TEST(GeometryText, LoopsMayRunEitherWayAndBeginAnywhere) {
  const std::string text = kCan, given = R"(["bottom ring", "seam", "-top ring", "-seam"])";
  for (const char* other :
       {R"(["seam", "top ring", "-seam", "-bottom ring"])", R"(["-seam", "bottom ring", "seam", "-top ring"])",
        R"(["-top ring", "-seam", "bottom ring", "seam"])"}) {
    SCOPED_TRACE(other);
    std::string turned = text;
    turned.replace(turned.find(given), given.size(), other);
    expect_solid(turned, 0.1, kPi / 2);
  }
}

/// A can with a round hole in its side, at an angle, and a lid of another, equal cylinder in it.
std::string can_with_a_lid(double angle) {
  std::string uv;
  for (int i = 0; i <= 32; ++i) {
    const double a = 2 * kPi * (i % 32) / 32;
    uv += fmt::format("{}[{}, {}]", i > 0 ? ", " : "", angle + 0.4 * std::cos(a), 1 + 0.3 * std::sin(a));
  }
  std::string text = kCan;
  const std::string loop = R"(["bottom ring", "seam", "-top ring", "-seam"])";
  text.replace(text.find(loop), loop.size(), loop + ", [\"hole\"]");
  return text + fmt::format(R"(
[[surface]]
name = "same"
type = "cylinder"
radius = 0.5

[[edge]]
name = "hole"
type = "on"
surface = "same"
uv = [{}]

[[face]]
name = "lid"
surface = "same"
loops = [["hole"]]
)",
                            uv);
}

TEST(GeometryText, HolesLieWithinTheOuterLoopWhateverTheirPeriod) {
  for (const double angle : {-9.0, -2.0, 0.5, 1.5, 3.0, 4.7, 5.8, 8.0}) {
    SCOPED_TRACE(angle);
    expect_solid("tolerance = 1e-4\n" + can_with_a_lid(angle), 0.1, kPi / 2);
  }
}

TEST(GeometryText, PolesAreFilledIn) {
  const std::string text = R"(
[[surface]]
name = "ball"
type = "sphere"
radius = 1

[[surface]]
name = "floor"
type = "plane"

[[edge]]
name = "equator"
type = "circle"
from = "a"
to = "a"
radius = 1

[[corner]]
name = "a"
at = [1, 0, 0]

[[corner]]
name = "pole"
at = [0, 0, 1]

[[edge]]
name = "seam"
type = "circle"
from = "a"
to = "pole"
axis = [0, -1, 0]
x = [1, 0, 0]
radius = 1

[[face]]
name = "dome"
surface = "ball"
loops = [["equator", "seam", "-seam"]]

[[face]]
name = "base"
surface = "floor"
reversed = true
loops = [["equator"]]
)";
  expect_solid(text, 0.12, 2 * kPi / 3);
}

/// Half of a sphere made of two wedges that meet in the pole: each loop passes it without an edge there.
TEST(GeometryText, WedgesThatMeetInAPole) {
  std::string text = R"(
[[surface]]
name = "ball"
type = "sphere"
radius = 1
[[corner]]
name = "e"
at = [1, 0, 0]
[[corner]]
name = "w"
at = [-1, 0, 0]
[[corner]]
name = "n"
at = [0, 0, 1]
[[edge]]
name = "front"
type = "circle"
from = "e"
to = "w"
radius = 1
[[edge]]
name = "back"
type = "circle"
from = "w"
to = "e"
radius = 1
[[edge]]
name = "up e"
type = "circle"
from = "e"
to = "n"
axis = [0, -1, 0]
x = [1, 0, 0]
radius = 1
[[edge]]
name = "up w"
type = "circle"
from = "w"
to = "n"
axis = [0, 1, 0]
x = [-1, 0, 0]
radius = 1
[[face]]
name = "one"
surface = "ball"
loops = [["front", "up w", "-up e"]]
[[face]]
name = "other"
surface = "ball"
loops = [["back", "up e", "-up w"]]
[[surface]]
name = "floor"
type = "plane"
[[face]]
name = "base"
surface = "floor"
reversed = true
loops = [["front", "back"]]
)";
  expect_solid(text, 0.12, 2 * kPi / 3);
}

TEST(GeometryText, SplinesWithHolesAndParameterCurves) {
  const std::string text = R"(
[[surface]]
name = "hill"
type = "interpolated"
sections = [
  [[0, 0, 0], [1, 0, 0.1], [2, 0, 0.3], [3, 0, 0]],
  [[0, 1, 0], [1, 1, 0.4], [2, 1, 0.6], [3, 1, 0]],
  [[0, 2, 0], [1, 2, 0.3], [2, 2, 0.2], [3, 2, 0]],
  [[0, 3, 0], [1, 3, 0], [2, 3, 0.1], [3, 3, 0]],
]
[[edge]]
name = "south"
type = "on"
surface = "hill"
uv = [[0, 0], [1, 0]]
[[edge]]
name = "east"
type = "on"
surface = "hill"
uv = [[1, 0], [1, 1]]
[[edge]]
name = "north"
type = "on"
surface = "hill"
uv = [[0, 1], [1, 1]]
[[edge]]
name = "west"
type = "on"
surface = "hill"
uv = [[0, 0], [0, 1]]
[[edge]]
name = "hole"
type = "on"
surface = "hill"
uv = [[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6], [0.4, 0.4]]
[[face]]
name = "top"
surface = "hill"
loops = [["south", "east", {edge = "-north", uv = [[0, 1], [1, 1]]}, "-west"], ["hole"]]
)";
  const Looked hill = look_at(text, 0.15);
  EXPECT_TRUE(hill.surface.is_manifold);
  EXPECT_FALSE(hill.surface.is_closed);
  EXPECT_EQ(hill.model.curves.size(), 5u);
  EXPECT_GT(hill.surface.area, 7);
  EXPECT_LT(hill.surface.area, 9.5);
  EXPECT_GT(hill.grid.min_angle_deg, 20);
}

TEST(GeometryText, WritesWhatItReads) {
  GeometryText all = parse_geometry(kCan, "can");
  all.tolerance = 1e-7;
  TextSurface spline;
  spline.name = "a \"quoted\" name\t";
  spline.type = "nurbs";
  spline.degree = {2, 1};
  spline.knots_u = {0, 0, 0, 1.0 / 3, 1, 1, 1};
  spline.points = {
      {{0, 0, 0.1}, {0, 1, 0}}, {{1, 0, 1e-300}, {1, 1, -0.5}}, {{2, 0, 1e22}, {2, 1, 0}}, {{3, 0, 0}, {3, 1, 0}}};
  spline.weights = {{1, 1}, {0.7, 0.7}, {1, 2}, {1, 1}};
  all.surfaces.push_back(spline);
  TextEdge on;
  on.name = "on";
  on.type = "on";
  on.surface = spline.name;
  on.uv = {{0, 0.1}, {1, 2.0 / 3}};
  all.edges.push_back(on);
  TextUse use;
  use.edge = "on";
  use.is_reversed = true;
  use.degree = 1;
  for (int i = 0; i < 12; ++i) use.points.push_back({i / 7.0, std::sqrt(i)});
  all.faces[0].loops.push_back({use, {}});
  all.faces[0].loops[1][1].edge = "seam";
  for (const char* type : {"sphere", "box", "cylinder", "cone", "torus"}) {
    TextShape shape;
    shape.type = type;
    shape.name = type;
    shape.frame.x = Point{0, 1, 0};
    shape.frame.axis = {1, 0, 1.0 / 7};
    shape.radius = 1;
    if (shape.type == "torus") shape.tube = 0.25;
    if (shape.type == "cylinder" || shape.type == "cone") shape.height = 1e-3;
    shape.reversed = true;
    if (shape.type == "box") {  // has no frame
      shape.frame = {};
      shape.radius = 0;
      shape.max = {1, 1, 1};
    }
    all.shapes.push_back(shape);
  }
  const std::string text = to_text(all);
  const GeometryText again = parse_geometry(text, "again");
  EXPECT_EQ(to_text(again), text);
  EXPECT_EQ(again.surfaces, all.surfaces);
  EXPECT_EQ(again.edges, all.edges);
  EXPECT_EQ(again.faces, all.faces);
  EXPECT_EQ(again.corners, all.corners);
  EXPECT_EQ(again.shapes, all.shapes);
  EXPECT_EQ(again.tolerance, all.tolerance);
  const std::string path = testing::TempDir() + "written.geom.toml";
  write_geometry(all, path);
  EXPECT_EQ(to_text(read_geometry(path)), text);
  std::filesystem::remove(path);
  EXPECT_TRUE(is_geometry_file(path));
  EXPECT_FALSE(is_geometry_file("case.toml"));
}

TEST(GeometryText, ErrorsSayLineAndRemedy) {
  expect_mentions(refused("[[shape]\n"), {"part.geom.toml:1", "not valid TOML"});
  expect_mentions(refused("[[shape]]\ntype = \"ball\"\n"), {"part.geom.toml:2", "no type 'ball'", "sphere, box"});
  expect_mentions(refused("[[shape]]\ntype = \"sphere\"\nradius = 1\nkind = \"wal\"\n"),
                  {"part.geom.toml:4", "no kind 'wal'", "did you mean wall?"});
  expect_mentions(refused("[[shape]]\ntype = \"sphere\"\n"), {"part.geom.toml:1", "radius is missing"});
  expect_mentions(refused("[[shape]]\ntype = \"sphere\"\nradius = -1\n"), {":1", "above 0"});
  expect_mentions(refused("[[shape]]\ntype = \"sphere\"\nradius = inf\n"), {":3", "finite"});
  expect_mentions(refused("[[shape]]\ntype = \"sphere\"\nraduis = 1\nradius = 1\n"), {":3", "'raduis'", "mean radius"});
  expect_mentions(refused("[[shape]]\ntype = \"torus\"\nradius = 1\ntube = 2\n"), {"tube"});
  expect_mentions(refused("[[shape]]\ntype = \"sphere\"\nradius = 1\naxis = [0, 0, 0]\n"), {"axis has no length"});
  expect_mentions(refused("[[shape]]\ntype = \"sphere\"\nradius = 1\norigin = [0, 0]\n"), {":4", "[x, y, z]"});
  expect_mentions(refused("[shape]\ntype = \"sphere\"\n"), {"[[shape]]"});
  expect_mentions(refused("tolerance = -1\n"), {"tolerance"});
  expect_mentions(refused(""), {"no faces", "[[shape]]"});
}

/// The can with a part of its text replaced.
std::string spoiled(const std::string& from, const std::string& to) {
  std::string text = kCan;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

TEST(GeometryText, ErrorsOfGeometrySayWhatDoesNotFit) {
  expect_mentions(refused(spoiled("\"-top ring\"", "\"-top rnig\"")),
                  {"face 'wall'", "no edge 'top rnig'", "top ring"});
  expect_mentions(refused(spoiled("surface = \"round\"", "surface = \"rond\"")), {"no surface 'rond'", "round"});
  expect_mentions(refused(spoiled("from = \"a\"", "from = \"c\"")), {"edge 'bottom ring'", "no corner 'c'"});
  expect_mentions(refused(spoiled("name = \"b\"", "name = \"a\"")), {"corner 'a'", "unique"});
  expect_mentions(refused(spoiled("at = [0.5, 0, 2]", "at = [0.5, 0, 2.1]")),
                  {"edge 'top ring'", "away from its corner"});
  expect_mentions(refused(spoiled("radius = 0.5", "radius = 0.6")), {"face 'wall'", "away from the surface"});
  expect_mentions(refused(spoiled("[\"bottom ring\", \"seam\", \"-top ring\", \"-seam\"]", "[\"bottom ring\"]")),
                  {"face 'wall'", "seam"});
  expect_mentions(
      refused(spoiled("[\"bottom ring\", \"seam\", \"-top ring\", \"-seam\"]", "[\"bottom ring\", \"seam\"]")),
      {"face 'wall'", "open"});
  expect_mentions(refused(spoiled("loops = [[\"top ring\"]]", "")), {"face 'outlet'", "for ever"});
  expect_mentions(refused(spoiled("loops = [[\"top ring\"]]", "loops = [[]]")), {"no edges"});
  expect_mentions(refused(spoiled("to = \"b\"\n\n[[face]]", "to = \"a\"\n\n[[face]]")), {"edge 'seam'", "two ends"});
}

TEST(GeometryText, ErrorsOfSplinesSayWhatIsWrong) {
  const auto with = [](const std::string& fields) {
    return refused("[[surface]]\nname = \"s\"\ntype = \"nurbs\"\ndegree = [1, 1]\n" + fields +
                   "[[face]]\nsurface = \"s\"\n");
  };
  expect_mentions(with("points = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\nweights = [[1,1],[1,0]]\n"),
                  {":1", "surface 's'", "weight 4"});
  expect_mentions(with("points = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\nknots_u = [0,1,0,1]\n"), {"ascend"});
  expect_mentions(with("points = [[[0,0,0],[0,1,0]],[[1,0,0]]]\n"), {"equally long"});
  expect_mentions(with("points = [[[0,0,0],[0,1,0]]]\n"), {"along u", "2 control points"});
  expect_mentions(with("points = []\n"), {"control points"});
  expect_mentions(with("points = [[[0,0,0],[0,1e-13,0]],[[1,0,0],[1,1,0]]]\n"), {"no length"});
}

}  // namespace
}  // namespace delfront
