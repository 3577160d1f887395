// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "io_fixtures.hpp"

namespace delfront::fixtures {

/// @brief A block of nx * ny * nz hexahedra with endless decimals; `region` names a cell by its place.
inline Mesh hex_block(int nx, int ny, int nz, const std::function<std::string(int, int, int)>& region) {
  Mesh mesh;
  const auto id = [&](int i, int j, int k) { return VertexId(std::size_t(i + (nx + 1) * (j + (ny + 1) * k))); };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) mesh.points.push_back({i / 3.0 - 1.7, j / 7.0 + 1e-5, k / 11.0 + 100});
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const std::array<VertexId, 8> v = {
            id(i, j, k),     id(i + 1, j, k),     id(i + 1, j + 1, k),     id(i, j + 1, k),
            id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)};
        add_cell(mesh, CellType::hexahedron, v, mesh.add_group(3, region(i, j, k)));
      }
  return mesh;
}

/// @brief Six patches of the kinds that a solver has, by the side of a box.
inline void add_sides(Mesh& mesh) {
  const Box box = mesh.bounding_box();
  const std::array<GroupId, 6> sides = {mesh.add_group(2, "inlet", "inlet"),     mesh.add_group(2, "outlet", "outlet"),
                                        mesh.add_group(2, "floor", "wall"),      mesh.add_group(2, "sky", "farfield"),
                                        mesh.add_group(2, "mirror", "symmetry"), mesh.add_group(2, "rest")};
  add_boundary(mesh, [&](Point centre) {
    std::size_t best = 0;
    double least = 1e300;
    for (int axis = 0; axis < 3; ++axis)
      for (int high = 0; high < 2; ++high) {
        const double away =
            std::abs(centre[axis] - (high ? box.high[axis] : box.low[axis])) / (box.high[axis] - box.low[axis]);
        if (away < least) {
          least = away;
          best = std::size_t(2 * axis + high);
        }
      }
    return sides[best];
  });
}

/// @brief Two regions and the patch between them.
inline Mesh two_region_block() {
  Mesh mesh = hex_block(4, 2, 2, [](int i, int, int) { return i < 2 ? "fluid" : "solid"; });
  add_sides(mesh);
  const GroupId between = mesh.add_group(2, "between", "interface");
  mesh.groups[between].two_sided = true;
  for (std::size_t cell = 0; cell < 16; ++cell) {
    const auto v = mesh.find_block(CellType::hexahedron)->operator[](cell);
    if (cell % 4 == 1) add_cell(mesh, CellType::quad, std::array{v[1], v[2], v[6], v[5]}, between);
  }
  return mesh;
}

/// @brief One region with a wall in it.
inline Mesh baffle_block() {
  Mesh mesh = hex_block(3, 3, 2, [](int, int, int) { return "air"; });
  add_sides(mesh);
  const GroupId baffle = mesh.add_group(2, "baffle", "wall");
  mesh.groups[baffle].two_sided = true;
  const auto v = mesh.find_block(CellType::hexahedron)->operator[](4);
  add_cell(mesh, CellType::quad, std::array{v[1], v[2], v[6], v[5]}, baffle);
  return mesh;
}

/// @brief Each hexahedron cut into two prisms, or into six pyramids about its centre.
inline Mesh cut_block(bool into_pyramids) {
  const Mesh block = hex_block(2, 2, 1, [](int i, int j, int) { return "part_" + std::to_string(i + 2 * j); });
  Mesh mesh;
  mesh.points = block.points;
  mesh.groups = block.groups;
  const CellBlock& hexes = *block.find_block(CellType::hexahedron);
  for (std::size_t cell = 0; cell < hexes.size(); ++cell) {
    const auto v = hexes[cell];
    if (!into_pyramids) {
      add_cell(mesh, CellType::prism, std::array{v[0], v[1], v[2], v[4], v[5], v[6]}, hexes.group[cell]);
      add_cell(mesh, CellType::prism, std::array{v[0], v[2], v[3], v[4], v[6], v[7]}, hexes.group[cell]);
      continue;
    }
    Point centre;
    for (const VertexId corner : v) centre = centre + block.points[corner] / 8.0;
    const VertexId apex = mesh.points.next_id();
    mesh.points.push_back(centre);
    for_each_face(hexes, cell, [&](std::span<const VertexId> f) {
      add_cell(mesh, CellType::pyramid, std::array{f[0], f[3], f[2], f[1], apex}, hexes.group[cell]);
    });
  }
  add_sides(mesh);
  return mesh;
}

/// @brief A plate of quads, each second one cut into triangles; three regions, and the lines between them.
inline Mesh plate(int n, bool has_regions) {
  Mesh mesh;
  mesh.dimension = 2;
  const auto id = [&](int i, int j) { return VertexId(std::size_t(i + (n + 1) * j)); };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.points.push_back({i / 3.0, j / 7.0 - 0.3, 0});
  const auto name = [&](int i) {
    return !has_regions ? "plane" : i < n / 3 ? "left" : i < 2 * n / 3 ? "middle" : "right";
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const GroupId region = mesh.add_group(2, name(i));
      if ((i + j) % 2 == 0) {
        add_cell(mesh, CellType::quad, std::array{id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)}, region);
      } else {
        add_cell(mesh, CellType::triangle, std::array{id(i, j), id(i + 1, j), id(i + 1, j + 1)}, region);
        add_cell(mesh, CellType::triangle, std::array{id(i, j), id(i + 1, j + 1), id(i, j + 1)}, region);
      }
    }
  const GroupId in = mesh.add_group(1, "in", "inlet"), out = mesh.add_group(1, "out", "outlet");
  const GroupId wall = mesh.add_group(1, "wall", "wall"), axis = mesh.add_group(1, "axis", "symmetry");
  for (int i = 0; i < n; ++i) {
    add_cell(mesh, CellType::line, std::array{id(i, 0), id(i + 1, 0)}, axis);
    add_cell(mesh, CellType::line, std::array{id(n, i), id(n, i + 1)}, out);
    add_cell(mesh, CellType::line, std::array{id(i + 1, n), id(i, n)}, wall);
    add_cell(mesh, CellType::line, std::array{id(0, i + 1), id(0, i)}, in);
  }
  if (!has_regions) return mesh;
  const GroupId between = mesh.add_group(1, "between", "interface");
  mesh.groups[between].two_sided = true;
  for (int j = 0; j < n; ++j)
    for (const int i : {n / 3, 2 * n / 3}) add_cell(mesh, CellType::line, std::array{id(i, j), id(i, j + 1)}, between);
  return mesh;
}

/// @brief Ten grids: 2-D and 3-D, each cell type, mixed ones, several regions, two-sided groups, kinds, endless
/// decimals.
inline std::vector<std::pair<std::string, Mesh>> ten_grids() {
  Mesh lone = two_boxes();  // one region without a name, no inner patch
  lone.groups.clear();
  const GroupId skin = lone.add_group(2, "skin", "wall");
  for (CellBlock& block : lone.blocks)
    std::fill(block.group.begin(), block.group.end(), dimension(block.type) == 2 ? skin : GroupId());
  CellBlock& faces = lone.block(CellType::triangle);
  faces.vertices.resize(faces.vertices.size() - 6);  // without those between the boxes
  faces.group.resize(faces.group.size() - 2);
  Mesh block = hex_block(3, 2, 2, [](int, int, int) { return "air"; });
  add_sides(block);
  return {{"two_boxes", two_boxes()},          {"mixed_cells", mixed_cells()},
          {"plane_grid", plane_grid()},        {"one_block", block},
          {"two_regions", two_region_block()}, {"baffle", baffle_block()},
          {"prisms", cut_block(false)},        {"pyramids", cut_block(true)},
          {"plate", plate(3, false)},          {"plate_of_three", plate(6, true)}};
}

}  // namespace delfront::fixtures
