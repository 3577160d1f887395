// SPDX-License-Identifier: Apache-2.0
#include "sizing/asked_sizes.hpp"

#include <gtest/gtest.h>

namespace delfront {
namespace {

/// The field far away from two points, where nothing but its largest size is left.
double far_size(const SizeOptions& options, double largest) {
  Context context;
  BoundarySizes boundary;
  boundary.points = {{0, 0, 0}, {1, 0, 0}};
  boundary.size = {0.5, 0.25};
  return build_asked_size_field(boundary, options, largest, context)->size({1e6, 0, 0});
}

TEST(AskedSizes, without_options_no_size_exceeds_the_boundarys) { EXPECT_DOUBLE_EQ(far_size({}, 0.5), 0.5); }

TEST(AskedSizes, hmax_goes_before_the_boundarys_largest) {
  EXPECT_DOUBLE_EQ(far_size({.hmin = {}, .hmax = Length{3, ""}, .growth = {}}, 0.5), 3);
  EXPECT_DOUBLE_EQ(far_size({.hmin = {}, .hmax = Length{3, ""}, .growth = 1.5}, 0.5), 3);
}

TEST(AskedSizes, a_growth_lifts_the_bound_and_is_kept) {
  EXPECT_NEAR(far_size({.hmin = {}, .hmax = {}, .growth = 1.25}, 0.5), (1e6 - 1) * 0.2, 1);
}

TEST(AskedSizes, hmin_above_the_largest_lifts_it) {
  EXPECT_DOUBLE_EQ(far_size({.hmin = Length{2, ""}, .hmax = {}, .growth = {}}, 0.5), 2);
}

TEST(AskedSizes, largest_of_none_is_nothing) {
  EXPECT_EQ(largest_size({}), 0);
  BoundarySizes boundary;
  boundary.size = {0.5, 2, 1};
  EXPECT_EQ(largest_size(boundary), 2);
}

}  // namespace
}  // namespace delfront
