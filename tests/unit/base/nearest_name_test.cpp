// SPDX-License-Identifier: Apache-2.0
#include "base/nearest_name.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace delfront {
namespace {

const std::vector<std::string> kNames = {"growth", "hmin", "hmax", "feature_angle", "min_dihedral", "max_dihedral"};

TEST(NearestName, finds_typing_errors_and_swapped_letters) {
  EXPECT_EQ(nearest_name("grwoth", kNames), "growth");
  EXPECT_EQ(nearest_name("min_dihedrl", kNames), "min_dihedral");
  EXPECT_EQ(nearest_name("feature-angle", kNames), "feature_angle");
  EXPECT_EQ(nearest_name("HMAX", kNames), "hmax");
}

TEST(NearestName, accepts_the_beginning_of_a_name) { EXPECT_EQ(nearest_name("feat", kNames), "feature_angle"); }

TEST(NearestName, is_silent_where_nothing_is_near) {
  EXPECT_EQ(nearest_name("curvature", kNames), "");
  EXPECT_EQ(nearest_name("", kNames), "");
  EXPECT_EQ(nearest_name("x", kNames), "");
  EXPECT_EQ(nearest_name("growth", {}), "");
}

TEST(NearestName, takes_the_first_of_equally_near_names) { EXPECT_EQ(nearest_name("hmxn", kNames), "hmin"); }

}  // namespace
}  // namespace delfront
