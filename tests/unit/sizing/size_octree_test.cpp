// SPDX-License-Identifier: Apache-2.0
#include "sizing/size_octree.hpp"

#include <gtest/gtest.h>

#include "unit/sizing/function_field.hpp"

namespace delfront {
namespace {

using fixtures::FunctionField;
using fixtures::step_field;

FunctionField cone_field(Point tip, double h, double slope) {
  return {[=](Point p) { return h + slope * distance(p, tip); },
          [=](const Box& box) {
            Point nearest = tip;
            for (int k = 0; k < 3; ++k) nearest[k] = std::clamp(tip[k], box.low[k], box.high[k]);
            return h + slope * distance(nearest, tip);
          }};
}

double measure(const SizeOctree& octree) {
  double sum = 0;
  for (const OctreeLeaf& leaf : octree.leaves()) sum += std::pow(octree.side(leaf), octree.dimension());
  return sum;
}

TEST(SizeOctree, leaves_fill_the_cube_and_are_as_small_as_sizes) {
  Context context;
  const FunctionField field = cone_field({0.3, 0.2, 0.1}, 0.01, 0.2);
  const SizeOctree octree(field, {{0, 0, 0}, {1, 1, 1}}, {}, context);
  EXPECT_NEAR(measure(octree), 1, 1e-12);
  EXPECT_FALSE(octree.is_cut_short());
  for (const OctreeLeaf& leaf : octree.leaves()) {
    EXPECT_LE(octree.side(leaf), 2 * leaf.low);
    for (int c = 0; c < 8; ++c) {
      const std::uint32_t corner = leaf.corner[static_cast<std::size_t>(c)];
      const Box box = octree.box(leaf);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(octree.corners()[corner][k], (c >> k & 1 ? box.high : box.low)[k], 1e-15);
      EXPECT_EQ(octree.corner_sizes()[corner], field.size(octree.corners()[corner]));
    }
  }
}

TEST(SizeOctree, of_one_size_is_one_leaf_where_no_size_can_be_larger) {
  Context context;
  const auto field = std::make_shared<const FunctionField>(step_field({{5, 5, 5}, {6, 6, 6}}, 0.1, 0.2));
  const Box cube{{0, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(SizeOctree(*combine_size_fields({field}, 0, 0.2), cube, {}, context).leaves().size(), 1u);
  EXPECT_GT(SizeOctree(*field, cube, {}, context).leaves().size(), 1u);  // a little is looked at
}

/// All corners of the cube have the least size.
TEST(SizeOctree, finds_larger_sizes_between_corners) {
  Context context;
  const FunctionField hump = {[](Point p) { return 0.1 + 0.2 * (0.5 - std::abs(p.x - 0.5)); },
                              [](const Box& box) {
                                return 0.1 +
                                       0.2 * (0.5 - std::max(std::abs(box.low.x - 0.5), std::abs(box.high.x - 0.5)));
                              }};
  const SizeOctree octree(hump, {{0, 0, 0}, {1, 1, 1}}, {}, context);
  double greatest = 0;
  for (const double h : octree.corner_sizes()) greatest = std::max(greatest, h);
  EXPECT_NEAR(greatest, 0.2, 1e-12);
}

TEST(SizeOctree, asks_within_the_domain_only) {
  Context context;
  const Box domain{{0, 0, 0}, {1, 0.3, 0.7}};
  bool is_within = true;
  const auto see = [&](Point p) { is_within = is_within && domain.overlaps({p, p}); };
  const FunctionField field = {[&](Point p) {
                                 see(p);
                                 return 0.01 + 0.1 * p.x;
                               },
                               [&](const Box& box) {
                                 see(box.low);
                                 see(box.high);
                                 return 0.01 + 0.1 * box.low.x;
                               }};
  const SizeOctree octree(field, domain, {}, context);
  double sum = 0;
  for (const OctreeLeaf& leaf : octree.leaves()) {
    const Point side = octree.box(leaf).high - octree.box(leaf).low;
    EXPECT_GT(std::min({side.x, side.y, side.z}), 0);
    sum += side.x * side.y * side.z;
  }
  EXPECT_TRUE(is_within);
  EXPECT_NEAR(sum, 0.21, 1e-12);
}

TEST(SizeOctree, finds_what_lies_between_corners) {
  Context context;
  const SizeOctree octree(step_field({{0.71, 0.33, 0.52}, {0.7101, 0.3301, 0.5201}}, 1e-4, 1), {{0, 0, 0}, {1, 1, 1}},
                          {}, context);
  double least = 1;
  for (const OctreeLeaf& leaf : octree.leaves()) least = std::min(least, octree.side(leaf));
  EXPECT_LE(least, 2e-4);
}

TEST(SizeOctree, is_flat_in_the_plane) {
  Context context;
  const SizeOctree octree(cone_field({0, 0, 0}, 0.01, 0.2), {{0, 0, 0}, {1, 0.5, 0}}, {}, context);
  EXPECT_EQ(octree.dimension(), 2);
  EXPECT_GE(measure(octree), 0.5);
  EXPECT_LE(measure(octree), 0.75);  // whole squares along the upper side
}

TEST(SizeOctree, stops_at_its_limit_and_says_so) {
  Context context;
  SizeOctreeOptions options;
  options.max_leaves = 1000;
  const SizeOctree octree(cone_field({0, 0, 0}, 1e-4, 0.1), {{0, 0, 0}, {1, 1, 1}}, options, context);
  EXPECT_TRUE(octree.is_cut_short());
  EXPECT_LE(octree.leaves().size(), 1000u);
  EXPECT_NEAR(measure(octree), 1, 1e-12);
}

TEST(SizeOctree, is_the_same_for_any_number_of_threads) {
  Context one, two;
  two.threads = 2;
  const FunctionField field = cone_field({0.3, 0.2, 0.1}, 0.005, 0.3);
  const SizeOctree a(field, {{0, 0, 0}, {1, 1, 1}}, {}, one), b(field, {{0, 0, 0}, {1, 1, 1}}, {}, two);
  ASSERT_EQ(a.leaves().size(), b.leaves().size());
  EXPECT_EQ(a.corner_sizes(), b.corner_sizes());
}

}  // namespace
}  // namespace delfront
