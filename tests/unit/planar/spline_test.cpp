// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "delfront/planar.hpp"
#include "planar/tri_complex.hpp"
#include "planar_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

double length_of(const std::vector<Point2>& points, std::size_t i) {
  return std::sqrt(squared_length(points[(i + 1) % points.size()] - points[i]));
}

TEST(SampleSpline, D5_a_closed_spline_through_points_of_a_circle_is_nearly_that_circle) {
  const std::vector<Point2> loop = sample_spline(circle({2, -1}, 3, 12), true, 0.05);
  ASSERT_GT(loop.size(), 300u);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    // Cubic splines are off by 5/384 of the fourth derivative times the fourth power of the step, here 30 degrees.
    EXPECT_NEAR(std::sqrt(squared_length(loop[i] - Point2{2, -1})), 3, 3 * 1e-3);
    EXPECT_NEAR(length_of(loop, i), 0.05, 0.002);
  }
}

TEST(SampleSpline, D5_where_it_turns_pieces_are_short) {
  const std::vector<Point2> loop = sample_spline(circle({0, 0}, 1, 8), true, 10);
  EXPECT_GE(loop.size(), 34u);
  EXPECT_LE(loop.size(), 40u);
}

TEST(SampleSpline, D5_an_open_spline_keeps_its_ends_and_is_straight_where_its_points_are) {
  const std::vector<Point2> line = {{0, 0}, {1, 0.5}, {3, 1.5}, {3.5, 1.75}};
  const std::vector<Point2> points = sample_spline(line, false, 0.1);
  EXPECT_EQ(points.front(), line.front());
  EXPECT_EQ(points.back(), line.back());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].y, 0.5 * points[i].x, 1e-14);
    if (i > 0) EXPECT_NEAR(length_of(points, i - 1), 0.1, 0.005);
  }
  EXPECT_EQ(sample_spline(std::vector<Point2>{{0, 0}, {1, 2}}, false, 0).size(), 2u);
}

TEST(SampleSpline, D5_without_a_length_pieces_are_as_the_points_lie_apart) {
  const std::vector<Point2> given = circle({0, 0}, 1, 200);
  const std::vector<Point2> loop = sample_spline(given, true, 0);
  ASSERT_EQ(loop.size(), given.size());
  for (std::size_t i = 0; i < loop.size(); ++i) EXPECT_LT(std::sqrt(squared_length(loop[i] - given[i])), 1e-3);
}

TEST(SampleSpline, D5_through_any_points_it_ends) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    std::vector<Point2> through;
    for (int k = 0; k < 3 + i % 9; ++k) through.push_back({unit(random), std::pow(10, -6 * unit(random))});
    const std::vector<Point2> points = sample_spline(through, i % 2, i % 3 ? 0.01 : 0);
    EXPECT_EQ(points.front(), through.front());
    EXPECT_LT(points.size(), 20000u);
    for (const Point2 p : points) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
  }
}

TEST(SampleSpline, D5_what_is_no_curve_is_refused) {
  const std::vector<Point2> one = {{0, 0}}, two = {{0, 0}, {1, 0}}, again = {{0, 0}, {1, 0}, {1, 0}, {2, 3}},
                            repeated = {{0, 0}, {1, 0}, {1, 1}, {0, 0}};
  EXPECT_THROW(sample_spline(one, false, 0), InputError);
  EXPECT_THROW(sample_spline(two, true, 0), InputError);
  EXPECT_THROW(sample_spline(again, false, 0), InputError);
  EXPECT_THROW(sample_spline(repeated, true, 0), InputError);
}

}  // namespace
}  // namespace delfront
