// SPDX-License-Identifier: Apache-2.0
#include "report/cell_pictures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "support/support.hpp"

namespace delfront {
namespace {

/// Two tetrahedra with a common face; each has a boundary face of its own name. The first is flat at its edge (0, 1).
Mesh two_tets() {
  Mesh mesh;
  mesh.points = {{0, 0, 0}, {0, 0, 1}, {1, 0.05, 0.5}, {1, -0.05, 0.5}, {2, 0, 2}};
  CellBlock& tets = mesh.block(CellType::tetrahedron);
  for (const std::uint32_t v : {0, 1, 2, 3, 1, 2, 3, 4}) tets.vertices.push_back(VertexId(v));
  tets.group.assign(2, mesh.add_group(3, "fluid"));
  CellBlock& faces = mesh.block(CellType::triangle);
  for (const std::uint32_t v : {0, 1, 2, 1, 2, 4}) faces.vertices.push_back(VertexId(v));
  faces.group = {mesh.add_group(2, "of the first"), mesh.add_group(2, "of the second")};
  return mesh;
}

TEST(CellPictures, a_cell_its_neighbour_and_what_it_touches) {
  const std::vector<CellPicture> pictures = draw_cells(two_tets(), {{0}, {1}, {0, 1}, {7}, {}});
  ASSERT_EQ(pictures.size(), 5u);
  for (const CellPicture* single : {&pictures[0], &pictures[1]}) {
    EXPECT_EQ(fixtures::count_of(single->svg, "class=\"near\""), 6u);
    EXPECT_EQ(fixtures::count_of(single->svg, "class=\"sharp\""), 1u);
    EXPECT_EQ(fixtures::count_of(single->svg, "class=\"edge"), 5u);
  }
  EXPECT_EQ(pictures[0].touches, std::vector<std::string>{"of the first"});
  EXPECT_EQ(pictures[1].touches, std::vector<std::string>{"of the second"});
  EXPECT_EQ(fixtures::count_of(pictures[2].svg, "class=\"near\""), 0u);  // both are drawn themselves
  EXPECT_EQ(
      fixtures::count_of(pictures[2].svg, "class=\"edge") + fixtures::count_of(pictures[2].svg, "class=\"sharp\""),
      12u);
  EXPECT_EQ(pictures[2].touches.size(), 2u);
  EXPECT_TRUE(pictures[3].svg.empty());  // there is no such cell
  EXPECT_TRUE(pictures[4].svg.empty());
}

/// Corners of the filled facets.
std::vector<std::array<double, 2>> corners_of(const std::string& svg) {
  std::vector<std::array<double, 2>> corners;
  const std::regex pair(R"((-?[\d.]+),(-?[\d.]+))");
  for (std::sregex_iterator it(svg.begin(), svg.end(), pair), end; it != end; ++it)
    corners.push_back({std::stod((*it)[1]), std::stod((*it)[2])});
  return corners;
}

TEST(CellPictures, a_cell_fills_the_picture_and_stays_in_it_whatever_its_size_and_place) {
  for (const double scale : {1e-9, 1.0, 1e9}) {
    Mesh mesh = two_tets();
    for (Point& p : mesh.points) p = scale * (p + Point{3, -5, 2});
    const auto corners = corners_of(draw_cells(mesh, {{0}})[0].svg);
    ASSERT_GE(corners.size(), 3u);
    double left = 1e9, right = 0, top = 1e9, bottom = 0;
    for (const auto& [x, y] : corners) {
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = std::max(bottom, y);
    }
    EXPECT_GE(left, 0);
    EXPECT_LE(right, 180);
    EXPECT_GE(top, 0);
    EXPECT_LE(bottom, 126);
    EXPECT_NEAR(std::max((right - left) / 180, (bottom - top) / 126), 0.78, 0.01);
  }
}

TEST(CellPictures, degenerate_cells_and_grids_without_cells_do_no_harm) {
  Mesh flat = two_tets();
  for (Point& p : flat.points) p = {1, 1, 1};
  const std::string svg = draw_cells(flat, {{0}})[0].svg;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_TRUE(draw_cells(Mesh(), {{0}})[0].svg.empty());
}

TEST(CellPictures, a_triangle_is_seen_from_its_front) {
  Mesh mesh;
  mesh.dimension = 2;
  mesh.points = {{0, 0, 0}, {4, 0, 0}, {0, 2, 0}};
  mesh.block(CellType::triangle).vertices = {VertexId(0), VertexId(1), VertexId(2)};
  mesh.block(CellType::triangle).group = {mesh.add_group(2, "fluid")};
  const auto corners = corners_of(draw_cells(mesh, {{0}})[0].svg);
  ASSERT_EQ(corners.size(), 3u);
  EXPECT_LT(corners[0][0], corners[1][0]);  // x to the right
  EXPECT_GT(corners[0][1], corners[2][1]);  // y upwards
  EXPECT_NEAR(corners[0][1], corners[1][1], 0.1);
  EXPECT_NEAR((corners[1][0] - corners[0][0]) / (corners[0][1] - corners[2][1]), 2, 0.01);
}

}  // namespace
}  // namespace delfront
