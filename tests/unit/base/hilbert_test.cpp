// SPDX-License-Identifier: Apache-2.0
#include "base/hilbert.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

namespace delfront {
namespace {

TEST(Hilbert, visits_each_cell_of_a_lattice_once_stepping_to_a_face_neighbour) {
  constexpr int kSide = 16;  // the top four bits of the curve: a complete curve of order 4
  std::vector<Point> points;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) points.push_back({i + 0.5, j + 0.5, k + 0.5});
  const HilbertCurve curve(Box{{0, 0, 0}, {kSide, kSide, kSide}});
  std::vector<std::pair<std::uint64_t, std::uint32_t>> items;
  for (std::size_t i = 0; i < points.size(); ++i) items.push_back({curve.key(points[i]), std::uint32_t(i)});
  radix_sort(items);
  for (std::size_t i = 1; i < items.size(); ++i) {
    ASSERT_LT(items[i - 1].first, items[i].first);
    const Point step = points[items[i].second] - points[items[i - 1].second];
    ASSERT_EQ(std::abs(step.x) + std::abs(step.y) + std::abs(step.z), 1) << "between " << i - 1 << " and " << i;
  }
}

TEST(Hilbert, is_fine_to_21_bits_an_axis_and_uses_63) {
  const HilbertCurve curve(Box{{0, 0, 0}, {1, 1, 1}});
  const double cell = 1.0 / (1 << 21);
  std::set<std::uint64_t> keys;
  for (int i = 0; i < 8; ++i)
    keys.insert(curve.key({0.3 + (i & 1) * cell, 0.4 + (i >> 1 & 1) * cell, (i >> 2) * cell}));
  EXPECT_EQ(keys.size(), 8u);
  EXPECT_LT(*keys.rbegin(), std::uint64_t(1) << 63);
}

TEST(Hilbert, keys_stay_in_range_outside_the_box_and_for_a_flat_or_empty_box) {
  for (const Box& box : {Box{}, Box{{1, 1, 1}, {1, 1, 1}}, Box{{0, 0, 0}, {1, 0, 0}}}) {
    const HilbertCurve curve(box);
    for (double x : {-1e300, 0.0, 1.0, 1e300}) EXPECT_LT(curve.key({x, -x, x}), std::uint64_t(1) << 63);
  }
}

TEST(Hilbert, order_is_a_permutation_with_equal_points_by_index) {
  constexpr unsigned kSeed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::vector<Point> points;
  for (int i = 0; i < 3000; ++i) points.push_back({double(random() % 7), double(random() % 7), double(random() % 7)});
  const std::vector<std::uint32_t> order = hilbert_order(points);
  std::vector<std::uint32_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (std::uint32_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
  std::size_t runs = 1;
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (points[order[i]] == points[order[i - 1]])
      ASSERT_LT(order[i - 1], order[i]);
    else
      ++runs;
  }
  EXPECT_EQ(runs, 343u) << "equal points must stand together";
  EXPECT_TRUE(hilbert_order(std::vector<Point>()).empty());
}

TEST(RadixSort, agrees_with_a_stable_sort) {
  constexpr unsigned kSeed = 12;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (const std::uint64_t mask : {std::uint64_t(0xff), ~std::uint64_t(0), std::uint64_t(0xff) << 56}) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> items;
    for (std::uint32_t i = 0; i < 5000; ++i) items.push_back({random() & mask, i});
    auto expected = items;
    std::stable_sort(expected.begin(), expected.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    radix_sort(items);
    EXPECT_EQ(items, expected);
  }
}

}  // namespace
}  // namespace delfront
