// SPDX-License-Identifier: Apache-2.0
#include "spatial/box_pairs.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace delfront {
namespace {

using Pairs = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

Pairs found_by(const std::vector<Box>& boxes) {
  Pairs found;
  const BoxPairs pairs(boxes);
  for (std::size_t g = 0; g < pairs.num_groups(); ++g)
    pairs.for_each_pair(g, [&](std::uint32_t i, std::uint32_t j) { found.insert({i, j}); });
  return found;
}

Pairs by_scan(const std::vector<Box>& boxes) {
  Pairs found;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
      if (boxes[i].overlaps(boxes[j])) found.insert({i, j});
  return found;
}

TEST(BoxPairs, gives_each_pair_that_meets_once_and_no_other) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const std::size_t n = seed < 12 ? seed * 3 : seed * 50;  // with groups that are not full, and several levels
    const double far = seed % 3 == 0 ? 1e7 : 0, scale = std::pow(10.0, double(seed % 5) - 2);
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < n; ++i) {
      if (i % 17 == 5) {
        boxes.push_back({});  // meets nothing
        continue;
      }
      const Point p = scale * Point{unit(random), unit(random), 0.1 * unit(random)} + Point{far, -far, far};
      const double side = scale * 0.1 * std::pow(10.0, -3 * unit(random)) * (i % 40 == 0 ? 30 : 1);
      boxes.push_back({p, p + side * Point{unit(random), unit(random), i % 2 ? 0.0 : unit(random)}});
    }
    EXPECT_EQ(found_by(boxes), by_scan(boxes)) << "seed " << seed;
  }
}

TEST(BoxPairs, boxes_that_touch_meet_and_those_a_bit_apart_do_not) {
  const double next = std::nextafter(1.0, 2.0);
  const std::vector<Box> boxes = {
      {{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{next, 0, 0}, {2, 1, 1}}, {{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}}};
  EXPECT_EQ(found_by(boxes), (Pairs{{0, 1}, {1, 2}, {0, 3}}));
}

TEST(BoxPairs, nothing_is_found_where_there_is_nothing) {
  EXPECT_TRUE(found_by({}).empty());
  EXPECT_TRUE(found_by({Box{}, Box{}}).empty());
  EXPECT_TRUE(found_by({Box{{0, 0, 0}, {1, 1, 1}}}).empty());
}

}  // namespace
}  // namespace delfront
