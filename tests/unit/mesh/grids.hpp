// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "delfront/mesh.hpp"
#include "mesh/cell_shape.hpp"

namespace delfront::grids {

inline void add_cell(Mesh& mesh, CellType type, const std::vector<std::uint32_t>& vertices) {
  for (const std::uint32_t v : vertices) mesh.block(type).vertices.emplace_back(v);
}

/// Store every side that has one cell, pointing outwards (by brute force over a map).
inline void store_boundary(Mesh& mesh) {
  const int dimension = mesh.top_dimension();
  std::map<std::vector<std::uint32_t>, std::vector<std::uint32_t>> alone;
  for (const CellBlock& block : mesh.blocks) {
    if (delfront::dimension(block.type) != dimension) continue;
    const CellShape& shape = shape_of(block.type);
    for (std::size_t cell = 0; cell < block.size(); ++cell)
      for (int f = 0; f < shape.num_facets; ++f) {
        std::vector<std::uint32_t> side;
        for (int i = 0; i < shape.facets[f].num_vertices; ++i)
          side.push_back(block[cell][static_cast<std::size_t>(shape.facets[f].vertices[i])].value);
        std::vector<std::uint32_t> key = side;
        std::sort(key.begin(), key.end());
        if (!alone.emplace(key, side).second) alone.erase(key);
      }
  }
  for (const auto& [key, side] : alone)
    add_cell(mesh, side.size() == 2 ? CellType::line : side.size() == 3 ? CellType::triangle : CellType::quad, side);
}

inline Mesh single_cell(CellType type, const std::vector<Point>& points) {
  Mesh mesh;
  mesh.dimension = dimension(type);
  mesh.points.assign(points.begin(), points.end());
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  add_cell(mesh, type, all);
  store_boundary(mesh);
  return mesh;
}

inline Mesh regular_tet() {
  return single_cell(CellType::tetrahedron, {{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}});
}
inline Mesh corner_tet() { return single_cell(CellType::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}); }

/// [0, 1]^3 in n^3 cubes of six tetrahedra each (Kuhn), without the stored boundary.
inline Mesh cube_cells(int n) {
  Mesh mesh;
  const auto at = [n](int i, int j, int k) { return static_cast<std::uint32_t>((k * (n + 1) + j) * (n + 1) + i); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.points.push_back({double(i) / n, double(j) / n, double(k) / n});
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (int order = 0; order < 6; ++order) {
          int step[3] = {i, j, k};
          std::vector<std::uint32_t> tet = {at(i, j, k)};
          for (const int axis : kOrders[order]) {
            ++step[axis];
            tet.push_back(at(step[0], step[1], step[2]));
          }
          if (order >= 3) std::swap(tet[1], tet[2]);
          add_cell(mesh, CellType::tetrahedron, tet);
        }
  return mesh;
}
inline Mesh cube(int n) {
  Mesh mesh = cube_cells(n);
  store_boundary(mesh);
  return mesh;
}

/// A hexahedron, a pyramid on its top, a prism at its side and a tetrahedron on the prism's end.
inline Mesh mixed_cells() {
  Mesh mesh;
  for (const Point p :
       {Point{0, 0, 0}, Point{1, 0, 0}, Point{1, 1, 0}, Point{0, 1, 0}, Point{0, 0, 1}, Point{1, 0, 1}, Point{1, 1, 1},
        Point{0, 1, 1}, Point{0.5, 0.5, 1.7}, Point{2, 0, 0.5}, Point{2, 1, 0.5}, Point{1.4, 2, 0.5}})
    mesh.points.push_back(p);
  add_cell(mesh, CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  add_cell(mesh, CellType::pyramid, {4, 5, 6, 7, 8});
  add_cell(mesh, CellType::prism, {1, 5, 9, 2, 6, 10});
  add_cell(mesh, CellType::tetrahedron, {2, 6, 10, 11});
  store_boundary(mesh);
  return mesh;
}

/// The unit square of n x n quads, the right half split into triangles.
inline Mesh square(int n) {
  Mesh mesh;
  mesh.dimension = 2;
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.points.push_back({double(i) / n, double(j) / n, 0});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (2 * i < n) {
        add_cell(mesh, CellType::quad, {a, b, c, d});
      } else {
        add_cell(mesh, CellType::triangle, {a, b, c});
        add_cell(mesh, CellType::triangle, {a, c, d});
      }
    }
  store_boundary(mesh);
  return mesh;
}

}  // namespace delfront::grids
