// SPDX-License-Identifier: Apache-2.0
// What takes the place of the front: the same promises, asked of every region of surfaces that the front can grid too.
#include "surface/remesh.hpp"

#include "surface/region_check.hpp"
#include "surface/region_mesh.hpp"
#include "surface_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

void expect_remeshed(const Model& model, double h) {
  SCOPED_TRACE(h);
  Context context;
  const UniformSize size(h);
  const SurfaceParts parts(model, size, context);
  LineDivision division;
  divide_lines(parts, size, std::vector<bool>(parts.lines.size(), true), std::vector<bool>(parts.lines.size(), false),
               division, context);
  const LinePoints lines = make_line_points(parts, division, context);
  for (const SurfaceRegion& region : parts.regions) {
    const SurfaceSupport support(parts, region);
    const RegionBorder border = find_border(parts, region, lines, division);
    RegionGrid grid = remesh_region(parts, region, support, border, lines, division, size);
    const RegionFit fit = check_region(support, border, grid);
    EXPECT_EQ(grid.gave_up, "");
    EXPECT_LT(fit.distance, 0.35 * h * h + 0.01);
    double area = 0, longest = 0;
    for (const auto& [a, b, c] : grid.triangles) {
      const Point p = grid.points[a], q = grid.points[b], r = grid.points[c];
      area += 0.5 * length(cross(q - p, r - p));
      longest = std::max({longest, distance(p, q), distance(q, r), distance(r, p)});
    }
    EXPECT_NEAR(area / support.area(), 1, 0.25 * h * h + 0.01);
    EXPECT_LE(longest, 1.7 * h);
  }
}

TEST(Remesh, BoxesGetTheirNewBorders) {
  for (const double h : {0.5, 0.2, 0.1}) expect_remeshed(model_of(cube_surface()), h);
}

TEST(Remesh, FinerAndCoarserThanTheGivenSphere) {
  for (const double h : {0.3, 0.1}) expect_remeshed(model_of(sphere_surface(3)), h);
}

TEST(Remesh, LongTrianglesOfACylinder) {
  for (const double h : {0.5, 0.2}) expect_remeshed(cylinder_model(), h);
}

/// A region mesh of a flat square of n x n points, its border included.
RegionGrid square(std::uint32_t n) {
  RegionGrid grid;
  const auto is_border = [&](std::uint32_t i, std::uint32_t j) { return i == 0 || j == 0 || i == n - 1 || j == n - 1; };
  std::vector<std::uint32_t> id(n * n);
  for (const bool border : {true, false}) {
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < n; ++j) {
        if (is_border(i, j) != border) continue;
        id[n * i + j] = static_cast<std::uint32_t>(grid.points.size());
        grid.points.push_back({double(i) / (n - 1), double(j) / (n - 1), 0});
      }
    if (border) grid.num_border = grid.points.size();
  }
  grid.triangle_of_point.assign(grid.points.size(), kNoTriangle);
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t j = 0; j + 1 < n; ++j) {
      const std::uint32_t a = id[n * i + j], b = id[n * (i + 1) + j], c = id[n * (i + 1) + j + 1],
                          d = id[n * i + j + 1];
      grid.triangles.push_back({a, b, c});
      grid.triangles.push_back({a, c, d});
    }
  return grid;
}

double area_of(const RegionGrid& grid) {
  double area = 0;
  for (const auto& [a, b, c] : grid.triangles)
    area += 0.5 * cross(grid.points[b] - grid.points[a], grid.points[c] - grid.points[a]).z;
  return area;
}

TEST(RegionMesh, SplitsAndCollapsesKeepTheSquareCovered) {
  const Model cube = model_of(cube_surface());
  Context context;
  const UniformSize size(0.1);
  const SurfaceParts parts(cube, size, context);
  const SurfaceSupport support(parts, parts.regions[0]);
  RegionMesh mesh(support, square(6));
  const auto num_sides = static_cast<std::uint32_t>(mesh.num_sides());
  for (std::uint32_t s = 0; s < num_sides; s += 7) {
    const auto [a, b] = mesh.ends(s);
    mesh.split(s, mesh.add_point(0.5 * (mesh.place(a) + mesh.place(b)), kNoTriangle));
  }
  std::size_t collapsed = 0;
  for (std::uint32_t s = 0; s < mesh.num_sides(); s += 5) {
    if (!mesh.is_alive(s)) continue;
    const auto [a, b] = mesh.ends(s);
    if (mesh.is_inner(a)) collapsed += mesh.collapse(a, b);
  }
  EXPECT_GT(collapsed, 5u);
  mesh.flip_to_delaunay(10);
  const RegionGrid grid = mesh.take();
  EXPECT_NEAR(area_of(grid), 1, 1e-12);
  for (const auto& [a, b, c] : grid.triangles)
    EXPECT_GT(cross(grid.points[b] - grid.points[a], grid.points[c] - grid.points[a]).z, 0);
}

TEST(RegionCheck, NamesWhatIsWrong) {
  const Model cube = model_of(cube_surface());
  Context context;
  const UniformSize size(0.3);
  const SurfaceParts parts(cube, size, context);
  LineDivision division;
  divide_lines(parts, size, std::vector<bool>(12, true), std::vector<bool>(12, false), division, context);
  const LinePoints lines = make_line_points(parts, division, context);
  const SurfaceSupport support(parts, parts.regions[0]);
  const RegionBorder border = find_border(parts, parts.regions[0], lines, division);
  const RegionGrid good = SurfaceFront(support, size).grid(border, context);
  const auto verdict = [&](RegionGrid grid) {
    check_region(support, border, grid);
    return grid.gave_up;
  };
  EXPECT_EQ(verdict(good), "");
  RegionGrid torn = good;
  torn.triangles.pop_back();
  EXPECT_NE(verdict(torn), "");
  RegionGrid doubled = good;
  doubled.triangles.push_back(doubled.triangles.front());
  EXPECT_EQ(verdict(doubled), "a side is used twice");
  RegionGrid loose = good;
  loose.points.push_back({0.5, 0.5, 0.5});
  EXPECT_EQ(verdict(loose), "the grid has another topology than the surface");
  RegionGrid folded = good;  // an inner point far outside of its neighbours
  folded.points.back() = folded.points.back() + Point{2, 2, 2};
  EXPECT_NE(verdict(folded), "");
}

}  // namespace
}  // namespace delfront
