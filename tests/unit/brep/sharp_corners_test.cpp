// SPDX-License-Identifier: Apache-2.0
// Prisms over sharp triangles: what is as sharp as the geometry is one triangle a corner, and nothing else is.
#include "brep/sharp_corners.hpp"

#include "brep_fixtures.hpp"
#include "delfront/uniform_size.hpp"

namespace delfront {
namespace {

using namespace fixtures;

constexpr double kSize = 0.04;

/// Corners of the Brep that are sharp in a face, by point of the grid.
std::set<VertexId> sharp_points(const Brep& brep, const Gridded& made) {
  std::set<std::uint32_t> sharp;
  for (const SharpCorner& corner : find_sharp_corners(brep, 30 * kPi / 180)) sharp.insert(corner.corner.value);
  std::set<VertexId> points;
  for (std::size_t p = 0; p < made.report.entity.size(); ++p)
    if (made.report.entity[p].dimension == 0 && sharp.contains(made.report.entity[p].id)) points.insert(VertexId(p));
  return points;
}

/// Triangles of the bottom and the top of a prism with a corner at p.
std::vector<TriangleId> flat_triangles_at(const Model& m, VertexId p) {
  std::vector<TriangleId> found;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto& corners = m.triangles[TriangleId(t)];
    if (m.input_face[TriangleId(t)] < 2 && std::find(corners.begin(), corners.end(), p) != corners.end())
      found.push_back(TriangleId(t));
  }
  return found;
}

void expect_sharp_only_in_corners(const std::vector<Point2>& polygon, std::size_t num_sharp) {
  const Brep brep = make_prism(polygon, 0.3);
  const Gridded made = grid(brep, UniformSize(kSize));
  const std::set<VertexId> sharp = sharp_points(brep, made);
  ASSERT_EQ(sharp.size(), num_sharp);
  EXPECT_GT(smallest_angle(made.model, sharp), 20);
  for (const VertexId p : sharp) EXPECT_EQ(flat_triangles_at(made.model, p).size(), 1u);
  Context context;
  EXPECT_TRUE(check_surface(made.model, context).can_bound_volume);
}

TEST(SharpCorners, WedgesHaveOneSharpTriangleEach) {
  for (const double degrees : {7.0, 8.0, 9.5, 11.0, 15.0, 19.0, 24.0}) {
    SCOPED_TRACE(degrees);
    const double a = degrees * kPi / 180;
    expect_sharp_only_in_corners({{0, 0}, {1, 0}, {std::cos(a), std::sin(a)}}, 2);
  }
}

TEST(SharpCorners, EdgesWithTwoOfThem) {
  for (const double degrees : {7.0, 12.0, 18.0}) {
    SCOPED_TRACE(degrees);
    expect_sharp_only_in_corners({{-1, 0}, {1, 0}, {0, std::tan(degrees * kPi / 180)}}, 4);
  }
}

TEST(SharpCorners, AreFoundInsideFacesOnly) {
  const double a = 10 * kPi / 180;
  const Point2 tip{std::cos(a), std::sin(a)};
  const std::vector<SharpCorner> inside = find_sharp_corners(make_prism({{0, 0}, {1, 0}, tip}, 1), 0.5);
  ASSERT_EQ(inside.size(), 2u);
  for (const SharpCorner& corner : inside) EXPECT_NEAR(corner.angle, a, 1e-12);
  EXPECT_TRUE(find_sharp_corners(make_sphere({}, 1), 0.5).empty());  // its seam turns round at both poles
  // the same wedge, cut out of a square: no face is sharp there
  EXPECT_TRUE(find_sharp_corners(make_prism({{0, 0}, {2, -2}, {2, 2}, {-2, 2}, {-2, -2}, {1.9, -2}}, 1), 0.5).empty());
}

}  // namespace
}  // namespace delfront
