// SPDX-License-Identifier: Apache-2.0
// Faces whose mapping is no good: singular along a side or at a point of it, folded, crowded by a factor of 10^4, a
// side that is nearly a point and not told to be one. Each has a valid grid with its points on it.
#include "brep_fixtures.hpp"
#include "delfront/nurbs.hpp"
#include "delfront/uniform_size.hpp"

namespace delfront {
namespace {

using namespace fixtures;

/// A face over the whole of a surface with the knots of one Bezier patch along v.
Brep patch_of(std::size_t along_u, std::size_t along_v, std::vector<Point> points) {
  NurbsSurfaceData data;
  data.degree = {int(std::min<std::size_t>(along_u - 1, 3)), int(along_v) - 1};
  data.count = {along_u, along_v};
  data.knots = {even_knots(along_u, data.degree[0]), even_knots(along_v, data.degree[1])};
  data.points = std::move(points);
  const SurfacePointer surface = make_nurbs_surface(data);
  return make_rectangle_on(surface, surface->box());
}

/// The lip of an inlet: at v = 0 the surface sets out at right angles to how it goes on, by an amount that changes
/// along the lip. Where that is 0 the lip is sharp, and du x dv = 0 there; under 0 it folds a little over itself.
Brep make_lip(double rise, double least) {
  constexpr std::size_t kRows = 9;
  std::vector<Point> points;
  for (std::size_t i = 0; i < kRows; ++i) {
    const double y = 2 * double(i) / (kRows - 1) - 1, x = -0.3 * std::cos(y);
    points.push_back({x, y, 0});
    points.push_back({x, y + 0.02, rise * y * y + least});
    points.push_back({x + 0.4, y, 0.3});
    points.push_back({x + 1.2, y, 0.45});
  }
  return patch_of(kRows, 4, std::move(points));
}

struct Wanted {
  double least_angle;
  double most_turned_deg = 180;  ///< between neighbours
};

/// The largest angle between triangles at an edge, degrees.
double largest_turn(const Model& m) {
  std::vector<std::pair<std::pair<VertexId, VertexId>, std::size_t>> sides;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& v = m.triangles[TriangleId(t)];
      sides.push_back({std::minmax(v[k], v[(k + 1) % 3]), t});
    }
  std::sort(sides.begin(), sides.end());
  const auto normal = [&](std::size_t t) {
    const auto& [a, b, c] = m.triangles[TriangleId(t)];
    const Point n = cross(m.points[b] - m.points[a], m.points[c] - m.points[a]);
    return n / length(n);
  };
  double least = 1;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i)
    if (sides[i].first == sides[i + 1].first)
      least = std::min(least, dot(normal(sides[i].second), normal(sides[i + 1].second)));
  return std::acos(std::clamp(least, -1.0, 1.0)) * 180 / kPi;
}

double area_of(const Model& m) {
  double sum = 0;
  for (const auto& [a, b, c] : m.triangles)
    sum += 0.5 * length(cross(m.points[b] - m.points[a], m.points[c] - m.points[a]));
  return sum;
}

Gridded expect_good_grid(const Brep& brep, double h, const Wanted& wanted) {
  Gridded made = grid(brep, UniformSize(h));
  Context context;
  const SurfaceReport look = check_surface(made.model, context);
  for (const Finding& f : look.findings)
    EXPECT_TRUE(f.severity != Severity::error || f.kind == "open_edges") << f.message;
  const Topology topology = topology_of(made.model);
  EXPECT_EQ(topology.euler, 1);
  EXPECT_EQ(topology.crowded, 0u);
  EXPECT_GT(smallest_angle(made.model), wanted.least_angle) << "h " << h;
  EXPECT_LT(largest_turn(made.model), wanted.most_turned_deg) << "h " << h;
  EXPECT_LT(farthest_from_entity(made, brep), 1e-9 * look.box.diagonal());
  EXPECT_EQ(made.report.rounds, 1u);
  return made;
}

TEST(HardFaces, LipThatIsSingularAtAPoint) {
  for (const double h : {0.2, 0.05, 0.02}) expect_good_grid(make_lip(0.3, 0), h, {20, 100});
}

TEST(HardFaces, LipThatFoldsALittle) {
  for (const double h : {0.2, 0.05, 0.02}) expect_good_grid(make_lip(0.3, -0.004), h, {20, 100});
}

TEST(HardFaces, SingularAlongAWholeSide) {
  for (const double rise : {0.0, 1e-6, 1e-3})
    for (const double h : {0.2, 0.05}) expect_good_grid(make_lip(0, rise), h, {20, 100});
}

/// A plane quadrangle with a corner of over 180 degrees: its bilinear mapping turns round there, and some of it lies
/// outside.
TEST(HardFaces, PlaneQuadrangleThatFoldsAtACorner) {
  for (const double at : {0.98, 0.9, 0.7}) {
    const Brep brep = patch_of(2, 2, {{0, 0, 0}, {0, 2, 0}, {2, 0, 0}, {at, at, 0}});
    for (const double h : {0.5, 0.1, 0.03}) {
      const Gridded made = expect_good_grid(brep, h, {15, 1});
      EXPECT_NEAR(area_of(made.model), 2 * at, 1e-9);
    }
  }
}

/// Half of a body twenty times as long as wide, flat like a fish, with a pole at each end: a chart round a pole would
/// span ten orders of magnitude.
TEST(HardFaces, SlenderBodyWithTwoPoles) {
  constexpr std::size_t kRound = 9, kAlong = 7;
  const double wide[kAlong] = {0, 1, 1, 1, 1, 0.6, 0}, along[kAlong] = {0, 0, 0.5, 1, 1.5, 2, 2};  // blunt ends
  std::vector<Point> points;
  for (std::size_t i = 0; i < kRound; ++i)
    for (std::size_t j = 0; j < kAlong; ++j) {
      const double angle = kPi * double(i) / (kRound - 1), r = 0.05 * wide[j];
      points.push_back({along[j], r * std::cos(angle), 0.2 * r * std::sin(angle)});
    }
  const Brep brep = patch_of(kRound, kAlong, std::move(points));
  for (const double h : {0.02, 0.01, 0.004, 0.002}) expect_good_grid(brep, h, {20, 100});
}

/// Lengths along u change by 10^4 from one end to the other, and so does how far they differ from those along v.
TEST(HardFaces, CrowdedParameters) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      const double x = i == 0 ? 0 : i == 1 ? 1e-4 / 3 : i == 2 ? 3e-4 / 3 : 1;
      points.push_back({x, double(j) / 3, 0.2 * x * double(j % 2)});
    }
  const Brep brep = patch_of(4, 4, points);
  for (const double h : {0.2, 0.04}) expect_good_grid(brep, h, {20, 60});
}

/// A side 10^-6 long: too long to be one point, far too short for sizes. The angle there is the geometry's.
TEST(HardFaces, SideThatIsNearlyAPoint) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      const double angle = kPi / 2 * double(j) / 3, r = i == 0 ? 1e-6 : double(i) / 3;
      points.push_back({r * std::cos(angle), r * std::sin(angle), 0.2 * r * r});
    }
  const Brep brep = patch_of(4, 4, points);
  for (const double h : {0.2, 0.04}) expect_good_grid(brep, h, {0, 60});
}

}  // namespace
}  // namespace delfront
