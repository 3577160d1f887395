// SPDX-License-Identifier: Apache-2.0
#include "volume/to_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "delfront/grid_check.hpp"
#include "delfront/model.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

struct Recovered {
  Model model;
  BoundaryGrid grid;
};

Recovered recovered_sphere(int levels) {
  Context context;
  std::vector<NamedMesh> input;
  input.push_back({fixtures::sphere_surface(levels), "sphere"});
  Recovered result{build_model(input, context), {}};
  RecoveryReport report;
  const std::vector<bool> far_field(result.model.patches.size(), false);
  result.grid = tetrahedralize_boundary(result.model, DomainOptions(), far_field, report, context);
  return result;
}

using Corners = std::array<std::array<double, 3>, 4>;

Corners sorted_corners(const std::array<Point, 4>& points) {
  Corners corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = {points[i].x, points[i].y, points[i].z};
  std::sort(corners.begin(), corners.end());
  return corners;
}

TEST(ToMesh, holds_the_tets_of_the_complex_each_once_by_their_last_vertex) {
  const Recovered sphere = recovered_sphere(4);
  const TetComplex& c = sphere.grid.complex;
  std::multiset<Corners> expected, found;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    const std::uint32_t* n = &c.node[4 * t];
    expected.insert(sorted_corners({c.point(n[0]), c.point(n[1]), c.point(n[2]), c.point(n[3])}));
  }
  const Mesh mesh = to_mesh(sphere.grid, sphere.model, 2);
  const CellBlock& tets = *mesh.find_block(CellType::tetrahedron);
  VertexId last_before(0);
  for (std::size_t cell = 0; cell < tets.size(); ++cell) {
    const auto v = tets[cell];
    found.insert(sorted_corners({mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]}));
    const VertexId last = *std::max_element(v.begin(), v.end());
    EXPECT_LE(last_before, last);
    last_before = last;
  }
  EXPECT_EQ(found, expected);
  EXPECT_TRUE(check(mesh).empty());
  EXPECT_EQ(mesh.num_cells(CellType::triangle), sphere.model.triangles.size());
}

TEST(ToMesh, any_number_of_threads_gives_the_same_mesh) {
  const Recovered sphere = recovered_sphere(4);
  const Mesh expected = to_mesh(sphere.grid, sphere.model);
  for (const int threads : {2, 5}) {
    const Mesh mesh = to_mesh(sphere.grid, sphere.model, threads);
    EXPECT_EQ(mesh.points, expected.points);
    ASSERT_EQ(mesh.blocks.size(), expected.blocks.size());
    for (std::size_t i = 0; i < mesh.blocks.size(); ++i) {
      EXPECT_EQ(mesh.blocks[i].vertices, expected.blocks[i].vertices);
      EXPECT_EQ(mesh.blocks[i].group, expected.blocks[i].group);
    }
    ASSERT_EQ(mesh.vertex_entity.size(), expected.vertex_entity.size());
    for (std::size_t v = 0; v < mesh.vertex_entity.size(); ++v) {
      EXPECT_EQ(mesh.vertex_entity[v].dimension, expected.vertex_entity[v].dimension);
      EXPECT_EQ(mesh.vertex_entity[v].id, expected.vertex_entity[v].id);
    }
  }
}

}  // namespace
}  // namespace delfront
