// SPDX-License-Identifier: Apache-2.0
#include "report/overview.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "support/support.hpp"

namespace delfront {
namespace {

constexpr int kWidth = 120, kHeight = 90;

std::vector<std::string> names_of(const Overview& overview) {
  std::vector<std::string> names;
  for (const Overview::Name& name : overview.names) names.push_back(name.name);
  return names;
}

/// How much of each dot is drawn, 0 to 255, by a reader of its own.
std::vector<int> alphas(const std::string& png) {
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  std::string data;
  for (std::size_t at = 8; at < png.size();) {
    const auto number = [&](std::size_t i) {
      std::uint32_t n = 0;
      for (std::size_t k = 0; k < 4; ++k) n = n << 8 | static_cast<unsigned char>(png[i + k]);
      return n;
    };
    const std::size_t size = number(at);
    const std::string type = png.substr(at + 4, 4), body = png.substr(at + 8, size);
    EXPECT_EQ(number(at + 8 + size), crc32(0, reinterpret_cast<const Bytef*>(png.data() + at + 4), uInt(size + 4)));
    if (type == "IHDR") {
      EXPECT_EQ(number(at + 8), std::uint32_t(kWidth));
      EXPECT_EQ(number(at + 12), std::uint32_t(kHeight));
    }
    if (type == "IDAT") data += body;
    at += 12 + size;
  }
  const std::size_t row = 1 + 4 * kWidth;
  std::vector<unsigned char> rows(row * kHeight);
  uLongf size = rows.size();
  EXPECT_EQ(uncompress(rows.data(), &size, reinterpret_cast<const Bytef*>(data.data()), data.size()), Z_OK);
  EXPECT_EQ(size, rows.size());
  std::vector<int> result;
  std::vector<unsigned char> above(row, 0);
  for (std::size_t y = 0; y < kHeight; ++y) {
    EXPECT_EQ(rows[y * row], 2);  // the filter "up"
    for (std::size_t i = 1; i < row; ++i) above[i] = static_cast<unsigned char>(above[i] + rows[y * row + i]);
    for (std::size_t x = 0; x < kWidth; ++x) result.push_back(above[4 + 4 * x]);
  }
  return result;
}

void add(Mesh& mesh, const Mesh& other, double factor, const std::string& prefix, bool is_turned, const char* kind) {
  const std::size_t first = mesh.points.size();
  for (const Point& p : other.points) mesh.points.push_back(factor * (p - Point{0.5, 0.5, 0.5}));
  const CellBlock& from = *other.find_block(CellType::triangle);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const GroupId group = mesh.add_group(2, prefix + other.groups[from.group[i]].name, kind);
    CellBlock& to = mesh.block(CellType::triangle);
    for (const int k : {0, is_turned ? 2 : 1, is_turned ? 1 : 2})
      to.vertices.push_back(VertexId(first + from[i][std::size_t(k)].index()));
    to.group.push_back(group);
  }
}

TEST(Overview, three_sides_of_a_cube_are_seen) {
  const Overview seen = draw_overview(fixtures::cube_surface(), kWidth, kHeight);
  EXPECT_EQ(names_of(seen), (std::vector<std::string>{"xmin", "ymin", "zmax"}));
  EXPECT_FALSE(seen.is_cut_open);
  const std::vector<int> alpha = alphas(seen.png);
  ASSERT_EQ(alpha.size(), std::size_t(kWidth * kHeight));
  EXPECT_EQ(alpha.front(), 0);
  EXPECT_EQ(alpha.back(), 0);
  EXPECT_EQ(alpha[kHeight / 2 * kWidth + kWidth / 2], 255);
  // towards the reader is (-0.9, -1.1, 0.75); the cube's height on paper is 92 % of the paper's
  const double long2 = 0.9 * 0.9 + 1.1 * 1.1, size = std::sqrt(long2 + 0.75 * 0.75);
  const double height = (std::sqrt(long2) + 0.75 * (0.9 + 1.1) / std::sqrt(long2)) / size;
  const double area = (0.9 + 1.1 + 0.75) / size * std::pow(0.92 * kHeight / height, 2);
  double drawn = 0;
  for (const int a : alpha) drawn += a / 255.0;
  EXPECT_NEAR(drawn, area, 0.02 * area);
}

TEST(Overview, what_lies_round_a_body_is_shown_behind_it) {
  const auto seen_in = [](double size, const char* kind) {
    Mesh mesh;
    add(mesh, fixtures::cube_surface(), size, "far_", false, kind);
    add(mesh, fixtures::cube_surface(), 1, "", true, "");
    const Overview seen = draw_overview(mesh, kWidth, kHeight);
    EXPECT_TRUE(seen.is_cut_open);
    return names_of(seen);
  };
  EXPECT_EQ(seen_in(3, "farfield"),
            (std::vector<std::string>{"far_xmax", "far_ymax", "far_zmin", "xmin", "ymin", "zmax"}));
  EXPECT_EQ(seen_in(30, ""), (std::vector<std::string>{"far_ymax", "xmin", "ymin", "zmax"}));
}

TEST(Overview, a_large_hole_is_no_body) {
  Mesh mesh;
  add(mesh, fixtures::cube_surface(), 10, "outer_", false, "");
  add(mesh, fixtures::cube_surface(), 1, "inner_", true, "");
  const Overview seen = draw_overview(mesh, kWidth, kHeight);
  EXPECT_FALSE(seen.is_cut_open);
  EXPECT_EQ(names_of(seen), (std::vector<std::string>{"outer_xmin", "outer_ymin", "outer_zmax"}));
}

TEST(Overview, in_the_plane_lines_have_the_names) {
  Mesh mesh;
  mesh.dimension = 2;
  mesh.points = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}};
  CellBlock& quads = mesh.block(CellType::quad);
  for (const std::uint32_t v : {0, 1, 2, 3}) quads.vertices.push_back(VertexId(v));
  quads.group = {mesh.add_group(2, "fluid")};
  CellBlock& lines = mesh.block(CellType::line);
  for (const std::uint32_t v : {0, 1, 2, 3}) {
    lines.vertices.push_back(VertexId(v));
    lines.vertices.push_back(VertexId((v + 1) % 4));
    lines.group.push_back(mesh.add_group(1, v % 2 ? "sides" : "walls"));
  }
  const Overview seen = draw_overview(mesh, kWidth, kHeight);
  EXPECT_EQ(names_of(seen), (std::vector<std::string>{"walls", "sides"}));
  const std::vector<int> alpha = alphas(seen.png);  // 4 x 3 fits the paper: 92 % of it each way
  EXPECT_NEAR(double(std::count(alpha.begin(), alpha.end(), 255)), 0.92 * 0.92 * kWidth * kHeight, 400);
}

TEST(Overview, nothing_and_what_is_nowhere) {
  EXPECT_TRUE(draw_overview(Mesh(), kWidth, kHeight).png.empty());
  Mesh mesh = fixtures::cube_surface();
  const std::string whole = draw_overview(mesh, kWidth, kHeight).png;
  EXPECT_EQ(draw_overview(mesh, kWidth, kHeight).png, whole);
  mesh.points.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  for (const std::uint32_t v : {0, 1, 8}) mesh.block(CellType::triangle).vertices.push_back(VertexId(v));
  mesh.block(CellType::triangle).group.push_back(GroupId());
  EXPECT_EQ(draw_overview(mesh, kWidth, kHeight).png, whole);
  for (Point& p : mesh.points) p = {1, 1, 1};
  EXPECT_TRUE(draw_overview(mesh, kWidth, kHeight).png.empty());
}

}  // namespace
}  // namespace delfront
