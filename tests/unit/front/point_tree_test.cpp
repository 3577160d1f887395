// SPDX-License-Identifier: Apache-2.0
#include "front/point_tree.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace delfront {
namespace {

template <int kDim>
struct Cloud {
  std::vector<std::array<double, kDim>> at;
  std::vector<double> reach;

  /// All that a query must give: those whose cubes overlap the box.
  std::set<std::uint32_t> near(const std::array<double, kDim>& low, const std::array<double, kDim>& high) const {
    std::set<std::uint32_t> found;
    for (std::uint32_t i = 0; i < at.size(); ++i) {
      bool overlaps = true;
      for (int k = 0; k < kDim; ++k)
        overlaps = overlaps && at[i][k] + reach[i] >= low[k] && at[i][k] - reach[i] <= high[k];
      if (overlaps) found.insert(i);
    }
    return found;
  }
};

/// Clustered, with equal points, points on a line, some far out of the box, and reaches that vary by 1e4.
template <int kDim>
Cloud<kDim> make_cloud(std::mt19937& random, std::size_t n) {
  std::uniform_real_distribution<double> unit(0, 1);
  Cloud<kDim> cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double scale = std::pow(10.0, -4 * unit(random));
    std::array<double, kDim> p;
    for (int k = 0; k < kDim; ++k) p[k] = i % 3 == 0 ? 0.3 : scale * unit(random);
    if (i % 50 == 1) p[0] = 5;
    cloud.at.push_back(p);
    cloud.reach.push_back(1e-3 * std::pow(10.0, -4 * unit(random)) * (i % 40 == 0 ? 300 : 1));
  }
  return cloud;
}

template <int kDim>
void expect_none_missed(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto cloud = make_cloud<kDim>(random, 3000);
  PointTree<kDim> tree;
  std::array<double, kDim> zero{}, one;
  one.fill(1);
  tree.clear(zero, one);
  for (std::uint32_t i = 0; i < cloud.at.size(); ++i) tree.insert(i, cloud.at[i], cloud.reach[i]);
  for (int q = 0; q < 500; ++q) {
    std::array<double, kDim> low, high;
    const double side = std::pow(10.0, -4 * unit(random));
    for (int k = 0; k < kDim; ++k) low[k] = unit(random), high[k] = low[k] + side * unit(random);
    std::set<std::uint32_t> found;
    std::size_t calls = 0;
    tree.for_each_near(low, high, [&](std::uint32_t id) { found.insert(id), ++calls; });
    EXPECT_EQ(calls, found.size()) << "a point was given twice";
    const auto needed = cloud.near(low, high);
    EXPECT_TRUE(std::includes(found.begin(), found.end(), needed.begin(), needed.end())) << "seed " << seed;
    for (int k = 0; k < kDim; ++k) low[k] -= 1e-4, high[k] += 1e-4;
    const auto allowed = cloud.near(low, high);
    EXPECT_TRUE(std::includes(allowed.begin(), allowed.end(), found.begin(), found.end())) << "seed " << seed;
  }
}

TEST(PointTree, gives_every_point_whose_reach_touches_the_box_in_the_plane) { expect_none_missed<2>(1); }
TEST(PointTree, gives_every_point_whose_reach_touches_the_box_in_space) { expect_none_missed<3>(2); }

}  // namespace
}  // namespace delfront
