// SPDX-License-Identifier: Apache-2.0
#include "volume/partial.hpp"

#include <algorithm>

namespace delfront {

namespace {

constexpr VertexIndex kBrickCorners = 8;

using Face = std::array<VertexIndex, 3>;

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

std::vector<Face> faces_of(const std::vector<std::array<VertexIndex, 4>>& tets) {
  std::vector<Face> faces;
  for (const auto& [a, b, c, d] : tets)
    for (const Face& face : {Face{a, b, c}, Face{a, b, d}, Face{a, c, d}, Face{b, c, d}}) faces.push_back(sorted(face));
  std::sort(faces.begin(), faces.end());
  return faces;
}

std::vector<std::array<VertexIndex, 4>> tets_of_model(const TetComplex& complex, VertexIndex num_points) {
  const auto is_brick = [&](VertexIndex v) { return v >= num_points && v < num_points + kBrickCorners; };
  std::vector<std::array<VertexIndex, 4>> tets;
  for (TetIndex t = 0; t < complex.num_slots(); ++t) {
    if (complex.is_dead(t) || complex.is_ghost(t)) continue;
    const std::uint32_t* n = &complex.node[4 * t];
    if (std::none_of(n, n + 4, is_brick)) tets.push_back({n[0], n[1], n[2], n[3]});
  }
  return tets;
}

}  // namespace

Mesh mesh_unfinished(const TetComplex& complex, const Model& model) {
  Mesh mesh;
  std::vector<VertexId> new_id(std::max(complex.num_vertices(), model.points.size()));
  const auto add_vertex = [&](VertexIndex v) {
    if (!new_id[v].is_valid()) {
      new_id[v] = mesh.points.next_id();
      mesh.points.push_back(v < model.points.size() ? model.points[VertexId(v)] : complex.point(v));
    }
    return new_id[v];
  };
  const auto tets = tets_of_model(complex, static_cast<VertexIndex>(model.points.size()));
  const GroupId region = mesh.add_group(3, "unfinished");
  for (const Patch& patch : model.patches) mesh.groups.push_back({patch.name, 2, patch.kind, false});
  const GroupId missing = mesh.groups.next_id();
  mesh.groups.push_back({"missing_or_divided", 2, "", false});
  CellBlock& cells = mesh.block(CellType::tetrahedron);
  for (const auto& tet : tets) {
    for (const VertexIndex v : tet) cells.vertices.push_back(add_vertex(v));
    cells.group.push_back(region);
  }
  const std::vector<Face> faces = faces_of(tets);
  CellBlock& triangles = mesh.block(CellType::triangle);
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    const auto [a, b, c] = model.triangles[TriangleId(t)];
    for (const VertexId v : {a, b, c}) triangles.vertices.push_back(add_vertex(v.value));
    const bool is_there = std::binary_search(faces.begin(), faces.end(), sorted({a.value, b.value, c.value}));
    const std::size_t patch = model.patch_of_triangle[TriangleId(t)].index();
    triangles.group.push_back(is_there ? GroupId(1 + patch) : missing);
  }
  return mesh;
}

}  // namespace delfront
