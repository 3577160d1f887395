// SPDX-License-Identifier: Apache-2.0
#include "brep/face_bends.hpp"

#include "brep_fixtures.hpp"
#include "delfront/nurbs.hpp"

namespace delfront {
namespace {

using namespace fixtures;

constexpr double kTurn = 0.5;  // radians a side

BoundarySizes bends_of(const NurbsSurfaceData& data, double size) {
  const LinearSize asked(size, 1, {}, -2, 2);
  const SurfacePointer surface = make_nurbs_surface(data);
  BoundarySizes found;
  find_bends(*surface, surface->box(), WantedSize(asked, kTurn), found);
  return found;
}

/// A cylinder of half axes 1 and 0.05, whose noses bend by 1 / 0.0025, and 2 high.
NurbsSurfaceData flat_cylinder() {
  NurbsSurfaceData data = nurbs_cylinder({}, 1, 2);
  for (Point& p : data.points) p.y *= 0.05;
  return data;
}

TEST(FaceBends, NosesHaveTheSizeOfTheirRadiusAllAlong) {
  const BoundarySizes found = bends_of(flat_cylinder(), 0.2);
  const double least = *std::min_element(found.size.begin(), found.size.end());
  EXPECT_GE(least, kTurn * 0.0025 * (1 - 1e-12));
  EXPECT_LT(least, 1.2 * kTurn * 0.0025);
  for (const double nose : {-1.0, 1.0}) {
    std::vector<double> height = {0, 2};
    for (std::size_t i = 0; i < found.points.size(); ++i)
      if (found.size[i] < 2 * least && std::abs(found.points[i].x - nose) < 0.01) height.push_back(found.points[i].z);
    std::sort(height.begin(), height.end());
    for (std::size_t i = 0; i + 1 < height.size(); ++i) ASSERT_LE(height[i + 1] - height[i], 3 * least) << height[i];
  }
}

TEST(FaceBends, SidesThatAreNearlyFlatHaveNone) {
  const BoundarySizes found = bends_of(flat_cylinder(), 0.2);
  // There the ellipse bends by at most 0.05 / (1 - 0.9975 * 0.6^2)^1.5.
  for (const Point& p : found.points) EXPECT_GT(std::abs(p.x), 0.6);
  EXPECT_TRUE(bends_of(nurbs_cylinder({}, 1, 2), 0.3).points.empty());
}

TEST(FaceBends, BothDirectionsAreLookedAt) {
  const NurbsSurfaceData turned = flat_cylinder();
  const BoundarySizes along_u = bends_of(turned, 0.2);
  // The same surface with its parameters the other way round.
  NurbsSurfaceData swapped = turned;
  std::swap(swapped.degree[0], swapped.degree[1]);
  std::swap(swapped.knots[0], swapped.knots[1]);
  std::swap(swapped.count[0], swapped.count[1]);
  for (std::size_t i = 0; i < turned.count[0]; ++i)
    for (std::size_t j = 0; j < turned.count[1]; ++j) {
      swapped.points[j * turned.count[0] + i] = turned.points[i * turned.count[1] + j];
      swapped.weights[j * turned.count[0] + i] = turned.weights[i * turned.count[1] + j];
    }
  const BoundarySizes along_v = bends_of(swapped, 0.2);
  EXPECT_NEAR(double(along_v.points.size()) / double(along_u.points.size()), 1, 0.1);
}

}  // namespace
}  // namespace delfront
