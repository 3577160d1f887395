// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "planar/front_metric.hpp"
#include "planar/side_grid.hpp"

namespace delfront {
namespace {

bool overlaps(const FrontSide& s, Point2 low, Point2 high) {
  return std::max(s.a.x, s.b.x) >= low.x && std::min(s.a.x, s.b.x) <= high.x && std::max(s.a.y, s.b.y) >= low.y &&
         std::min(s.a.y, s.b.y) <= high.y;
}

/// Sides of lengths over seven decades come and go; every query gives just those that a scan gives.
TEST(SideGrid, F13_gives_what_a_scan_gives) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const double scale = std::exp2(double(20 * (int(seed) - 3)));
    const auto place = [&] { return Point2{scale * (unit(random) - 7), scale * unit(random)}; };
    const auto length = [&] { return scale * std::pow(10, -7 * unit(random)); };
    SideGrid grid;
    grid.clear({-7 * scale, 0}, {-6 * scale, scale});
    std::vector<FrontSide> all;
    for (std::uint32_t step = 0; step < 6000; ++step) {
      if (step % 3 == 2 && !all.empty()) {
        const std::size_t i = random() % all.size();
        grid.remove(all[i]);
        all[i] = all.back();
        all.pop_back();
      } else {
        const Point2 a = place(), d = {length(), length()};
        const Point2 b = {std::min(a.x + d.x, -6 * scale), std::max(a.y - d.y, 0.0)};
        all.push_back({a, random() % 8 ? b : a, step, step, step});
        grid.insert(all.back());
      }
      if (step % 10 != 0) continue;
      const Point2 low = place(), high = low + Point2{length(), length()};
      std::vector<std::uint32_t> found, wanted;
      grid.for_each_near(low, high, [&](const FrontSide& s) { found.push_back(s.id); });
      for (const FrontSide& s : all)
        if (overlaps(s, low, high)) wanted.push_back(s.id);
      std::sort(found.begin(), found.end());
      std::sort(wanted.begin(), wanted.end());
      ASSERT_EQ(found, wanted) << "step " << step;
    }
    while (!all.empty()) {
      grid.remove(all.back());
      all.pop_back();
    }
    std::size_t left = 0;
    grid.for_each_near({-8 * scale, -scale}, {0, 2 * scale}, [&](const FrontSide&) { ++left; });
    EXPECT_EQ(left, 0u);
  }
}

TEST(FrontMetric, F7_root_gives_the_length_in_the_metric) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const double turn = 7 * unit(random), c = std::cos(turn), s = std::sin(turn);
    const Metric metric =
        stretched_metric(std::pow(10, -3 * unit(random)), {std::pow(10, 3 * unit(random)), 1, {c, s, 0}, {-s, c, 0}});
    const Point2 edge = {unit(random) - 0.5, unit(random) - 0.5};
    const double length = length_in(metric, {edge.x, edge.y, 0});
    EXPECT_NEAR(std::sqrt(squared_length(FrontMetric::root_of(metric).map(edge))), length, 1e-10 * length);
    const FrontFrame frame({1, 2}, Point2{1, 2} + edge, FrontMetric::root_of(metric));
    EXPECT_NEAR(frame.length, length, 1e-10 * length);
    const Point2 end = frame.to_frame(Point2{1, 2} + edge), back = frame.from_frame(frame.to_frame({3, -1}));
    EXPECT_NEAR(end.x, 0.5 * length, 1e-9 * length);
    EXPECT_NEAR(end.y, 0, 1e-9 * length);
    EXPECT_NEAR(back.x, 3, 1e-6);
    EXPECT_NEAR(back.y, -1, 1e-6);
  }
}

}  // namespace
}  // namespace delfront
