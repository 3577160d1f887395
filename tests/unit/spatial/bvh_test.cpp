// SPDX-License-Identifier: Apache-2.0
#include "spatial/bvh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "support/support.hpp"

namespace delfront {
namespace {

constexpr unsigned kSeed = 5;

/// Boxes of very different sizes, some flat, some equal, some empty.
std::vector<Box> random_boxes(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 97 == 3) {
      boxes.push_back(Box{});
      continue;
    }
    if (i % 50 == 7) {
      boxes.push_back(boxes[i / 2]);
      continue;
    }
    const double size = i % 40 == 0 ? 0.5 : 0.02;
    const Point low{unit(random), unit(random), unit(random)};
    boxes.push_back({low, low + size * Point{unit(random), unit(random), i % 3 == 0 ? 0.0 : unit(random)}});
  }
  return boxes;
}

TEST(Bvh, finds_the_same_pairs_as_trying_all) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  for (const std::size_t count : {0u, 1u, 2u, 5u, 1500u}) {
    const std::vector<Box> boxes = random_boxes(count, random);
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected, found;
    for (std::uint32_t i = 0; i < count; ++i)
      for (std::uint32_t j = i + 1; j < count; ++j)
        if (!boxes[i].is_empty() && !boxes[j].is_empty() && boxes[i].overlaps(boxes[j])) expected.insert({i, j});
    Bvh(boxes).for_each_pair([&](std::uint32_t i, std::uint32_t j) {
      EXPECT_LT(i, j);
      EXPECT_TRUE(found.insert({i, j}).second) << "twice: " << i << " " << j;
    });
    EXPECT_EQ(found, expected) << count << " boxes";
  }
}

TEST(Bvh, finds_the_same_overlaps_as_trying_all) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const std::vector<Box> boxes = random_boxes(800, random), queries = random_boxes(60, random);
  const Bvh bvh(boxes);
  for (const Box& query : queries) {
    if (query.is_empty()) continue;
    std::set<std::uint32_t> expected, found;
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
      if (!boxes[i].is_empty() && boxes[i].overlaps(query)) expected.insert(i);
    bvh.for_each_overlap(query, [&](std::uint32_t i) { EXPECT_TRUE(found.insert(i).second); });
    EXPECT_EQ(found, expected);
  }
}

TEST(Bvh, copes_with_many_equal_boxes_and_with_geometric_spacing) {
  const std::vector<Box> equal(5000, Box{{0, 0, 0}, {1, 1, 1}});
  std::size_t visits = 0;
  Bvh(equal).for_each_overlap({{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}}, [&](std::uint32_t) { ++visits; });
  EXPECT_EQ(visits, equal.size());
  std::vector<Box> spaced;  // the classic that drives a tree of spatial splits deep
  for (int i = 0; i < 900; ++i) {
    const double x = std::ldexp(1.0, -i);
    spaced.push_back({{x, 0, 0}, {x, 0, 0}});
  }
  visits = 0;
  Bvh(spaced).for_each_overlap({{0, 0, 0}, {1, 0, 0}}, [&](std::uint32_t) { ++visits; });
  EXPECT_EQ(visits, spaced.size());
}

std::vector<std::array<Point, 3>> triangles_of(const Mesh& mesh) {
  std::vector<std::array<Point, 3>> triangles;
  const CellBlock& block = *mesh.find_block(CellType::triangle);
  for (std::size_t i = 0; i < block.size(); ++i)
    triangles.push_back({mesh.points[block[i][0]], mesh.points[block[i][1]], mesh.points[block[i][2]]});
  return triangles;
}

TEST(TriangleTree, nearest_is_that_of_trying_all_and_the_distance_is_to_the_point_given) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> around(-2, 2);
  const auto triangles = triangles_of(fixtures::sphere_surface(3));
  const TriangleTree tree(triangles);
  for (int i = 0; i < 300; ++i) {
    const Point p{around(random), around(random), around(random)};
    double expected = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : triangles)
      expected = std::min(expected, distance(p, nearest_point_on_triangle(p, a, b, c)));
    const TriangleTree::Hit hit = tree.nearest(p);
    ASSERT_TRUE(hit.found());
    EXPECT_DOUBLE_EQ(hit.distance, expected);
    EXPECT_NEAR(distance(hit.at, p), hit.distance, 1e-15);
    EXPECT_FALSE(tree.nearest_if(
                         p, [](std::uint32_t) { return true; }, 0.999 * expected)
                     .found());
  }
  EXPECT_FALSE(TriangleTree().nearest({0, 0, 0}).found());
}

TEST(TriangleTree, nearest_point_on_a_triangle_by_its_parts) {
  const Point a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
  EXPECT_EQ(nearest_point_on_triangle({1, 1, 5}, a, b, c), (Point{1, 1, 0}));   // face
  EXPECT_EQ(nearest_point_on_triangle({2, -3, 1}, a, b, c), (Point{2, 0, 0}));  // edge
  EXPECT_EQ(nearest_point_on_triangle({4, 4, 0}, a, b, c), (Point{2, 2, 0}));   // long edge
  EXPECT_EQ(nearest_point_on_triangle({-1, -2, -3}, a, b, c), a);               // corner
  EXPECT_EQ(nearest_point_on_triangle({1, 3, 0}, a, b, b), (Point{1, 0, 0}));   // a segment
  EXPECT_EQ(nearest_point_on_triangle({1, 3, 0}, a, a, a), a);                  // a point
}

TEST(TriangleTree, a_ray_from_the_centre_meets_the_sphere_once_and_a_short_one_does_not) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> around(-1, 1);
  const TriangleTree tree(triangles_of(fixtures::sphere_surface(3)));
  const auto all = [](std::uint32_t) { return true; };
  for (int i = 0; i < 300; ++i) {
    const Point way{around(random), around(random), around(random)};
    const TriangleTree::Hit hit = tree.first_on_ray({0, 0, 0}, way, 1e9, all);
    ASSERT_TRUE(hit.found());
    EXPECT_GT(length(hit.at), 0.98);
    EXPECT_LT(length(hit.at), 1.0 + 1e-12);
    EXPECT_FALSE(tree.first_on_ray({0, 0, 0}, way, 0.99 * hit.distance, all).found());
    EXPECT_FALSE(tree.first_on_ray(1.1 * hit.at, way, 1e9, all).found()) << "nothing lies outwards of the sphere";
  }
  EXPECT_TRUE(tree.first_on_ray({0, 0, 0}, {1, 0, 0}, 2, all).found()) << "a ray along an axis";
}

}  // namespace
}  // namespace delfront
