// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "delfront/errors.hpp"
#include "delfront/size_sources.hpp"
#include "mesh/cell_shape.hpp"

namespace delfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A cube of n^3 hexahedra, each of six tetrahedra.
Mesh make_grid(int n) {
  Mesh mesh;
  const auto id = [n](int i, int j, int k) {
    return VertexId(static_cast<std::size_t>((k * (n + 1) + j) * (n + 1) + i));
  };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.points.push_back({double(i) / n, double(j) / n, double(k) / n});
  CellBlock& block = mesh.block(CellType::tetrahedron);
  constexpr int kOrder[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const auto& order : kOrder) {
          int at[3] = {i, j, k};
          block.vertices.push_back(id(at[0], at[1], at[2]));
          for (const int axis : order) {
            ++at[axis];
            block.vertices.push_back(id(at[0], at[1], at[2]));
          }
        }
  return mesh;
}

std::unique_ptr<SizeField> make_field(SizeLaw::Kind kind, double delta0) {
  SizeLaw law;
  law.kind = kind;
  law.delta0 = delta0;
  law.r0 = 0.1;
  law.r1 = 0.05;
  law.gamma = 2;
  Context context;
  return build_source_size_field({{Simplex{{Point{0.3, 0.4, 0.5}}, 1}, law, {}, {}, ""},
                                  {Simplex{{Point{1, 0, 0}, Point{1, 1, 1}}, 2}, law, {}, {}, ""}},
                                 {}, context);
}

TEST(SmoothSizes, S4_neither_growth_nor_the_sources_are_exceeded) {
  const Mesh grid = make_grid(12);
  for (const auto kind : {SizeLaw::Kind::power, SizeLaw::Kind::step}) {
    const auto field = make_field(kind, 0.02);
    for (const double growth : {1.1, 1.5}) {
      Context context;
      const std::vector<double> size = smooth_sizes(grid, *field, growth, context);
      const double slope = (growth - 1) / growth;
      const CellBlock& block = *grid.find_block(CellType::tetrahedron);
      const CellShape& shape = shape_of(block.type);
      for (std::size_t c = 0; c < block.size(); ++c)
        for (std::size_t e = 0; e < 6; ++e) {
          const VertexId a = block[c][std::size_t(shape.edges[e][0])], b = block[c][std::size_t(shape.edges[e][1])];
          ASSERT_LE(std::abs(size[a.index()] - size[b.index()]),
                    slope * distance(grid.points[a], grid.points[b]) + 1e-14);
        }
      for (std::size_t v = 0; v < size.size(); ++v) {
        ASSERT_GT(size[v], 0);
        ASSERT_LE(size[v], field->size(grid.points[VertexId(v)]));
        ASSERT_TRUE(std::isfinite(size[v]));
      }
      EXPECT_EQ(size, smooth_sizes(grid, *field, growth, context));
    }
  }
}

TEST(SmoothSizes, S4_a_constant_field_stays) {
  SizeLaw law;
  law.kind = SizeLaw::Kind::polynomial;
  law.delta0 = 0.25;
  Context context;
  const auto field = build_source_size_field({{Simplex{}, law, {}, {}, ""}}, {}, context);
  for (const double s : smooth_sizes(make_grid(4), *field, 1.2, context)) EXPECT_NEAR(s, 0.25, 1e-14);
}

TEST(SmoothSizes, S4_smooths_kinks) {
  // Two sources meet in a ridge halfway: its second difference along a line is less after smoothing.
  Mesh line;
  constexpr std::size_t kPoints = 41;
  for (std::size_t i = 0; i < kPoints; ++i) line.points.push_back({static_cast<double>(i) / 40, 0, 0});
  CellBlock& block = line.block(CellType::line);
  for (std::size_t i = 0; i + 1 < kPoints; ++i) {
    block.vertices.push_back(VertexId(i));
    block.vertices.push_back(VertexId(i + 1));
  }
  SizeLaw law;
  law.delta0 = 0.1;
  law.r1 = 1;
  Context context;
  const auto field = build_source_size_field(
      {{Simplex{}, law, {}, {}, ""}, {Simplex{{Point{1, 0, 0}}, 1}, law, {}, {}, ""}}, {}, context);
  const std::vector<double> size = smooth_sizes(line, *field, 2, context);
  const auto kink = [&](auto at) { return std::abs(at(19) - 2 * at(20) + at(21)); };
  const double before = kink([&](std::size_t i) { return field->size(line.points[VertexId(i)]); });
  const double after = kink([&](std::size_t i) { return size[i]; });
  EXPECT_GT(before, 1e-3);
  EXPECT_LT(after, 0.6 * before);
}

TEST(SmoothSizes, S4_a_piece_without_sizes_stays_without) {
  Mesh grid = make_grid(2);
  grid.points.push_back({9, 9, 9});
  Context context;
  const std::vector<double> size = smooth_sizes(grid, *make_field(SizeLaw::Kind::step, 0.1), 1.2, context);
  EXPECT_EQ(size.back(), kInfinity);
}

TEST(SmoothSizes, S4_refuses_bad_input) {
  Context context;
  const auto field = make_field(SizeLaw::Kind::power, 0.1);
  EXPECT_THROW(smooth_sizes(make_grid(1), *field, 1, context), UsageError);
  EXPECT_THROW(smooth_sizes(make_grid(1), *field, kInfinity, context), UsageError);
  Mesh bad = make_grid(1);
  bad.points.front().x = std::nan("");
  EXPECT_THROW(smooth_sizes(bad, *field, 1.2, context), InputError);
}

}  // namespace
}  // namespace delfront
