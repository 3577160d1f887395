// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "delfront/model.hpp"
#include "delfront/surface_check.hpp"

namespace delfront::fixtures {

using Triangles = std::vector<std::array<std::size_t, 3>>;

/// @brief A mesh from lists; one unnamed patch.
inline Mesh facets(const std::vector<Point>& points, const Triangles& triangles) {
  Mesh mesh;
  mesh.points.assign(points.begin(), points.end());
  CellBlock& block = mesh.block(CellType::triangle);
  for (const auto& corners : triangles)
    for (std::size_t v : corners) block.vertices.push_back(VertexId(v));
  return mesh;
}

inline Model model_of(Mesh mesh) {
  Context context;
  return build_model({{std::move(mesh), "body"}}, context);
}

/// @brief Both in one mesh, `second` moved; equal points stay apart until a model welds them.
inline Mesh joined(const Mesh& first, const Mesh& second, Point shift = {}, double scale = 1) {
  Mesh mesh = first;
  mesh.groups.clear();
  CellBlock& block = mesh.block(CellType::triangle);
  block.group.clear();
  const std::size_t offset = mesh.points.size();
  for (Point p : second.points) mesh.points.push_back(scale * p + shift);
  for (VertexId v : second.find_block(CellType::triangle)->vertices)
    block.vertices.push_back(VertexId(v.index() + offset));
  return mesh;
}

inline void turn_triangle(Mesh& mesh, std::size_t triangle) {
  CellBlock& block = mesh.block(CellType::triangle);
  std::swap(block.vertices[3 * triangle], block.vertices[3 * triangle + 1]);
}

/// @brief Facets between cells of a lattice of unit cubes: two triangles wherever is_wall(cell, neighbour).
/// @param is_wall  asked for each two cells that share a face, the lower one first; cells run from -1 to n (n excluded
/// from walls only by what is_wall says)
using LatticeCell = std::array<int, 3>;
inline Mesh lattice_walls(int n, const std::function<bool(LatticeCell, LatticeCell)>& is_wall) {
  std::vector<Point> points;
  Triangles triangles;
  std::map<std::array<int, 3>, std::size_t> index;
  auto vertex = [&](std::array<int, 3> at) {
    const auto [it, is_new] = index.try_emplace(at, points.size());
    if (is_new) points.push_back({double(at[0]), double(at[1]), double(at[2])});
    return it->second;
  };
  for (int i = -1; i < n; ++i)
    for (int j = -1; j < n; ++j)
      for (int k = -1; k < n; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const LatticeCell cell{i, j, k};
          LatticeCell next = cell;
          ++next[axis];
          if (!is_wall(cell, next)) continue;
          const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
          std::array<int, 3> a = next, b = next, c = next, d = next;
          ++b[u], ++c[u], ++c[v], ++d[v];
          triangles.push_back({vertex(a), vertex(b), vertex(c)});
          triangles.push_back({vertex(a), vertex(c), vertex(d)});
        }
  return facets(points, triangles);
}

inline const Finding* find(const SurfaceReport& report, const std::string& kind) {
  const auto it = std::find_if(report.findings.begin(), report.findings.end(),
                               [&](const Finding& finding) { return finding.kind == kind; });
  return it == report.findings.end() ? nullptr : &*it;
}

/// @brief "kind:severity:count …" for messages of failing tests.
inline std::string summary(const SurfaceReport& report) {
  std::string text;
  for (const Finding& finding : report.findings)
    text += finding.kind + ":" + std::to_string(int(finding.severity)) + ":" + std::to_string(finding.count) + " ";
  return text;
}

}  // namespace delfront::fixtures
