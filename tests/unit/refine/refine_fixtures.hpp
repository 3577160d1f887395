// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "delfront/refine_grid.hpp"
#include "support/support.hpp"
#include "unit/mesh/grids.hpp"

namespace delfront::refine_fixtures {

/// One cell of each type, all facets plane; volumes (areas, lengths) in the same order.
struct OneCell {
  CellType type;
  std::vector<Point> points;
  double measure;
};
inline std::vector<OneCell> one_of_each() {
  return {{CellType::triangle, {{0, 0, 0}, {3, 0, 0}, {1, 2, 0}}, 3},
          {CellType::quad, {{0, 0, 0}, {3, 0, 0}, {2, 2, 0}, {0, 1, 0}}, 4},
          {CellType::tetrahedron, {{0, 0, 0}, {3, 0, 0}, {1, 2, 0}, {0.5, 0.25, 1}}, 1},
          {CellType::pyramid, {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0.75, 1.5, 3}}, 4},
          {CellType::prism, {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 1}, {2, 0, 1}, {0, 2, 1}}, 2},
          {CellType::hexahedron,
           {{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {1, 1, 0}, {0, 0, 4}, {2, 0, 4}, {3, 1, 4}, {1, 1, 4}},
           8}};
}

/// n^3 bent cubes: columns of prisms, and hexahedra or six pyramids by chance elsewhere; with tetrahedra on some tops;
/// numbered at random. Left half and right half are regions of their own, each side of the box a patch.
inline Mesh mixed_block(int n, unsigned seed, double bend) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-bend, bend);
  Mesh mesh;
  std::vector<std::vector<std::uint32_t>> cells;
  const auto at = [n](int i, int j, int k) { return static_cast<std::uint32_t>((k * (n + 1) + j) * (n + 1) + i); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.points.push_back({i + jitter(random), j + jitter(random), k + jitter(random)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) {
        const std::vector<std::uint32_t> c = {
            at(i, j, k),     at(i + 1, j, k),     at(i + 1, j + 1, k),     at(i, j + 1, k),
            at(i, j, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)};
        if ((i + j) % 3 == 0) {
          cells.push_back({c[0], c[1], c[2], c[4], c[5], c[6]});
          cells.push_back({c[0], c[2], c[3], c[4], c[6], c[7]});
          if (k + 1 < n) continue;
          mesh.points.push_back({i + 0.7, j + 0.3, n + 0.6});
          cells.push_back({c[4], c[5], c[6], static_cast<std::uint32_t>(mesh.points.size() - 1)});
        } else if (random() % 2) {
          cells.push_back(c);
        } else {
          mesh.points.push_back({i + 0.5, j + 0.5, k + 0.5});
          const auto apex = static_cast<std::uint32_t>(mesh.points.size() - 1);
          for (const auto& f : shape_of(CellType::hexahedron).facets)
            cells.push_back({c[f.vertices[3]], c[f.vertices[2]], c[f.vertices[1]], c[f.vertices[0]], apex});
        }
      }
  std::vector<std::uint32_t> number(mesh.points.size());
  std::iota(number.begin(), number.end(), 0u);
  std::shuffle(number.begin(), number.end(), random);
  const Array<VertexId, Point> points = mesh.points;
  for (std::size_t v = 0; v < points.size(); ++v) mesh.points[VertexId(number[v])] = points[VertexId(v)];
  std::shuffle(cells.begin(), cells.end(), random);
  for (std::vector<std::uint32_t>& cell : cells) {
    for (std::uint32_t& v : cell) v = number[v];
    grids::add_cell(mesh,
                    cell.size() == 4   ? CellType::tetrahedron
                    : cell.size() == 5 ? CellType::pyramid
                    : cell.size() == 6 ? CellType::prism
                                       : CellType::hexahedron,
                    cell);
  }
  grids::store_boundary(mesh);
  return mesh;
}

/// Cells by the side of x = `x` that they lie on, faces by the direction in which they look most.
inline void add_groups(Mesh& mesh, double x) {
  const GroupId left = mesh.add_group(3, "left"), right = mesh.add_group(3, "right");
  const char* const names[6] = {"west", "east", "south", "north", "bottom", "top"};
  for (const char* name : names) mesh.add_group(2, name, name == names[0] ? "inlet" : "wall");
  mesh.groups[mesh.find_group(2, "top")].two_sided = true;  // not so, but it must come through
  for (CellBlock& block : mesh.blocks)
    for (std::size_t i = 0; i < block.size(); ++i) {
      Point centre;
      for (const VertexId v : block[i]) centre = centre + mesh.points[v] / double(block[i].size());
      if (dimension(block.type) == 3) {
        block.group.push_back(centre.x < x ? left : right);
        continue;
      }
      const Point a = mesh.points[block[i][0]];
      const Point normal = cross(mesh.points[block[i][1]] - a, mesh.points[block[i][2]] - a);
      int axis = 0;
      for (const int k : {1, 2})
        if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
      block.group.push_back(mesh.find_group(2, names[2 * axis + (normal[axis] > 0)]));
    }
}

/// A fine sphere as a model of one patch.
inline Model sphere_model(int levels, const std::string& name = "sphere") {
  Context context;
  Model model = build_model({{fixtures::sphere_surface(levels), name}}, context);
  model.patches[PatchId(0)].name = name;
  return model;
}

/// The side of a cylinder of radius 1 and its two lids, as a surface: n segments round it.
inline Mesh cylinder_surface(int n, double height) {
  Mesh mesh;
  const auto ring = [&](int i, int top) { return static_cast<std::uint32_t>(2 * (i % n) + top); };
  for (int i = 0; i < n; ++i)
    for (const int top : {0, 1}) {
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.points.push_back({std::cos(angle), std::sin(angle), top * height});
    }
  mesh.points.push_back({0, 0, 0});
  mesh.points.push_back({0, 0, height});
  const GroupId side = mesh.add_group(2, "side"), lids = mesh.add_group(2, "lids");
  for (int i = 0; i < n; ++i) {
    const auto c = static_cast<std::uint32_t>(2 * n);
    grids::add_cell(mesh, CellType::triangle, {ring(i, 0), ring(i + 1, 0), ring(i + 1, 1)});
    grids::add_cell(mesh, CellType::triangle, {ring(i, 0), ring(i + 1, 1), ring(i, 1)});
    grids::add_cell(mesh, CellType::triangle, {c, ring(i + 1, 0), ring(i, 0)});
    grids::add_cell(mesh, CellType::triangle, {c + 1, ring(i, 1), ring(i + 1, 1)});
    for (const GroupId g : {side, side, lids, lids}) mesh.block(CellType::triangle).group.push_back(g);
  }
  return mesh;
}

inline Mesh refined(const Mesh& mesh, int levels = 1, const Model* model = nullptr, RefineGridReport* report = nullptr,
                    int threads = 1) {
  Context context;
  context.threads = threads;
  RefineGridReport mine;
  return refine_grid(mesh, {.levels = levels, .model = model}, report ? *report : mine, context);
}

}  // namespace delfront::refine_fixtures
