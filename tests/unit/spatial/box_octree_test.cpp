// SPDX-License-Identifier: Apache-2.0
#include "spatial/box_octree.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace delfront {
namespace {

/// Clustered, with equal ones, centres on a line, some far out of the root's box, and sides that vary by 1e6.
std::vector<Box> make_boxes(std::mt19937& random, std::size_t n) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < n; ++i) {
    const double scale = std::pow(10.0, -4 * unit(random));
    Point p = i % 3 == 0 ? Point{0.3, 0.3, 0.3} : scale * Point{unit(random), unit(random), unit(random)};
    if (i % 50 == 1) p.x = 5;
    const double side = 1e-3 * std::pow(10.0, -4 * unit(random)) * (i % 40 == 0 ? 300 : 1);
    const Point half = side * Point{unit(random), unit(random), unit(random)};
    boxes.push_back({p - half, p + half});
  }
  return boxes;
}

std::set<std::uint32_t> overlapping(const std::vector<Box>& boxes, const Box& with) {
  std::set<std::uint32_t> found;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].overlaps(with)) found.insert(i);
  return found;
}

TEST(BoxOctree, gives_every_box_that_touches_and_none_far_off) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  const std::vector<Box> boxes = make_boxes(random, 3000);
  BoxOctree tree;
  tree.clear({{0, 0, 0}, {1, 1, 1}});
  for (std::uint32_t i = 0; i < boxes.size(); ++i) tree.insert(i, boxes[i]);
  for (int q = 0; q < 1000; ++q) {
    const double side = std::pow(10.0, -4 * unit(random));
    Box box;
    box.low = {unit(random), unit(random), unit(random)};
    box.high = box.low + side * Point{unit(random), unit(random), unit(random)};
    if (q % 10 == 0) box.low.x += 4.5, box.high.x += 5;
    std::set<std::uint32_t> found;
    std::size_t calls = 0;
    tree.for_each_overlap(box, [&](std::uint32_t id) { found.insert(id), ++calls; });
    EXPECT_EQ(calls, found.size()) << "a box was given twice";
    const auto needed = overlapping(boxes, box);
    EXPECT_TRUE(std::includes(found.begin(), found.end(), needed.begin(), needed.end())) << "query " << q;
    const Point little{1e-4, 1e-4, 1e-4};
    const auto allowed = overlapping(boxes, {box.low - little, box.high + little});
    EXPECT_TRUE(std::includes(allowed.begin(), allowed.end(), found.begin(), found.end())) << "query " << q;
  }
}

}  // namespace
}  // namespace delfront
