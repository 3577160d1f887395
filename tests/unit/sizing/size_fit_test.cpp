// SPDX-License-Identifier: Apache-2.0
#include "sizing/size_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "delfront/uniform_size.hpp"

namespace delfront {
namespace {

/// A corner of a unit cube: three sides of 1, three of sqrt(2).
Mesh corner() {
  Mesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.block(CellType::tetrahedron).vertices = {VertexId(0), VertexId(1), VertexId(2), VertexId(3)};
  return mesh;
}

/// n^2 squares, each in two triangles.
Mesh squares(std::uint32_t n) {
  Mesh mesh;
  mesh.dimension = 2;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) mesh.points.push_back({double(i), double(j), 0});
  auto& triangles = mesh.block(CellType::triangle).vertices;
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, c = a + n + 2;
      for (const std::uint32_t v : {a, a + 1, c, a, c, c - 1}) triangles.push_back(VertexId(v));
    }
  return mesh;
}

TEST(SizeFit, every_edge_counts_once) {
  Context context;
  const SizeFit fit = measure_size_fit(corner(), UniformSize(1), context);
  EXPECT_EQ(fit.ratio.min, 1);
  EXPECT_EQ(fit.ratio.max, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(fit.ratio.mean, (1 + std::sqrt(2.0)) / 2);
  EXPECT_EQ(fit.share_right, 0.5);  // sqrt(2) is above 1.4
  EXPECT_EQ(std::accumulate(fit.ratio.histogram.begin(), fit.ratio.histogram.end(), std::size_t(0)), 6u);
  EXPECT_EQ(fit.ratio.histogram[10], 3u);
  EXPECT_EQ(fit.ratio.histogram[14], 3u);
  ASSERT_EQ(fit.ratio.worst.size(), 6u);
  EXPECT_EQ(fit.ratio.worst[0].ids, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(fit.ratio.worst[0].at, (Point{0.5, 0.5, 0}));
  EXPECT_EQ(fit.ratio.worst_values[0], std::sqrt(2.0));
}

TEST(SizeFit, what_is_far_too_long_is_in_the_last_bin) {
  Context context;
  const SizeFit fit = measure_size_fit(corner(), UniformSize(0.01), context);
  EXPECT_EQ(fit.ratio.histogram.back(), 6u);
  EXPECT_EQ(fit.share_right, 0);
}

TEST(SizeFit, the_same_for_any_number_of_threads) {
  const std::uint32_t n = 150;
  Context one, many;
  one.threads = 1;
  many.threads = 7;
  const SizeFit a = measure_size_fit(squares(n), UniformSize(1.1), one);
  const SizeFit b = measure_size_fit(squares(n), UniformSize(1.1), many);
  EXPECT_EQ(a.ratio.mean, b.ratio.mean);
  EXPECT_EQ(a.ratio.histogram, b.ratio.histogram);
  EXPECT_EQ(a.ratio.worst_values, b.ratio.worst_values);
  for (std::size_t i = 0; i < a.ratio.worst.size(); ++i) EXPECT_EQ(a.ratio.worst[i].ids, b.ratio.worst[i].ids);
  const std::size_t edges = 2 * n * (n + 1) + n * n;
  EXPECT_EQ(std::accumulate(a.ratio.histogram.begin(), a.ratio.histogram.end(), std::size_t(0)), edges);
  EXPECT_EQ(a.share_right, 1);
}

TEST(SizeFit, a_grid_without_cells_has_none) {
  Context context;
  const SizeFit fit = measure_size_fit(Mesh(), UniformSize(1), context);
  EXPECT_EQ(fit.ratio.max, 0);
  EXPECT_TRUE(fit.ratio.worst.empty());
}

}  // namespace
}  // namespace delfront
