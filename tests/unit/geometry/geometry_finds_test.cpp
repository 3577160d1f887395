// SPDX-License-Identifier: Apache-2.0
// Inputs that once went wrong, each by the name of what was wrong.
#include <gtest/gtest.h>

#include "delfront/errors.hpp"
#include "support/support.hpp"
#include "surface_fixtures.hpp"

namespace delfront {
namespace {

using fixtures::facets;
using fixtures::model_of;

const std::vector<Point> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const fixtures::Triangles kSides = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

TEST(GeometryFinds, a_triangle_that_repeats_a_corner_does_not_crash_the_turning_of_shells) {
  for (const bool has_solid : {true, false}) {
    fixtures::Triangles sides = has_solid ? kSides : fixtures::Triangles();
    sides.push_back({0, 0, 1});
    sides.push_back({2, 2, 2});
    Model model = model_of(facets(kCorners, sides));
    const auto before = model.triangles;
    Context context;
    EXPECT_EQ(orient_shells(model, context), 0u);
    EXPECT_EQ(model.triangles, before);
    const SurfaceReport report = check_surface(model, context);
    ASSERT_NE(fixtures::find(report, "degenerate_triangles"), nullptr) << fixtures::summary(report);
    EXPECT_EQ(fixtures::find(report, "degenerate_triangles")->count, 2u);
  }
}

TEST(GeometryFinds, a_flipped_tetrahedron_is_turned_beside_a_triangle_that_repeats_a_corner) {
  fixtures::Triangles sides = kSides;
  std::swap(sides[0][0], sides[0][1]);
  sides.push_back({3, 1, 3});
  Model model = model_of(facets(kCorners, sides));
  Context context;
  EXPECT_EQ(orient_shells(model, context), 1u);
}

TEST(GeometryFinds, coordinates_out_of_the_range_of_the_predicates_are_refused_with_their_place) {
  std::vector<Point> corners = kCorners;
  corners[1].x = -1e300;
  try {
    model_of(facets(corners, kSides));
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("1e+300"), std::string::npos) << error.what();
    ASSERT_EQ(error.places.size(), 1u);
    EXPECT_EQ(error.places[0].at, corners[1]);
  }
  for (Point& p : corners = kCorners) p = 1e-200 * p;
  EXPECT_THROW(model_of(facets(corners, kSides)), InputError);
  for (const double scale : {1e-29, 1e29}) {
    for (Point& p : corners = kCorners) p = scale * p;
    EXPECT_EQ(model_of(facets(corners, kSides)).triangles.size(), 4u);
  }
}

}  // namespace
}  // namespace delfront
