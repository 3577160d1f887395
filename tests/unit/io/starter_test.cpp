// SPDX-License-Identifier: Apache-2.0
#include "io/starter.hpp"

#include <gtest/gtest.h>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

/// One tetrahedron, its face at x = 0 in the group "in".
Mesh tet_with_inlet(bool is_turned) {
  Mesh mesh;
  mesh.points = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  mesh.block(CellType::tetrahedron).vertices = {VertexId(3), VertexId(1), VertexId(0), VertexId(2)};
  mesh.block(CellType::tetrahedron).group = {mesh.add_group(3, "fluid")};
  CellBlock& faces = mesh.block(CellType::triangle);
  faces.vertices = {VertexId(0), VertexId(is_turned ? 2 : 1), VertexId(is_turned ? 1 : 2)};
  faces.group = {mesh.add_group(2, "in", "inlet")};
  return mesh;
}

TEST(InwardDirection, is_told_by_the_cell_however_the_face_is_stored) {
  for (const bool is_turned : {false, true}) {
    const Mesh mesh = tet_with_inlet(is_turned);
    const Point inward = inward_direction(mesh, mesh.find_group(2, "in"));
    EXPECT_EQ(inward.x, 1) << is_turned;
    EXPECT_EQ(inward.y, 0);
    EXPECT_EQ(inward.z, 0);
  }
}

TEST(InwardDirection, is_that_of_lines_in_the_plane) {
  Mesh mesh;
  mesh.dimension = 2;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.block(CellType::triangle).vertices = {VertexId(0), VertexId(1), VertexId(2)};
  mesh.block(CellType::triangle).group = {mesh.add_group(2, "fluid")};
  mesh.block(CellType::line).vertices = {VertexId(1), VertexId(0)};
  mesh.block(CellType::line).group = {mesh.add_group(1, "in", "inlet")};
  const Point inward = inward_direction(mesh, mesh.find_group(1, "in"));
  EXPECT_EQ(inward.x, 0);
  EXPECT_EQ(inward.y, 1);
}

TEST(InwardDirection, of_a_closed_surface_is_none_and_x_is_taken) {
  Mesh mesh = tet_with_inlet(false);
  CellBlock& faces = mesh.block(CellType::triangle);
  const GroupId in = mesh.find_group(2, "in");
  for (const int v : {0, 3, 1, 0, 2, 3, 1, 3, 2}) faces.vertices.push_back(VertexId(v));
  faces.group.assign(4, in);
  EXPECT_EQ(inward_direction(mesh, in).x, 1);
}

TEST(StarterFiles, are_refused_for_another_solver_or_format) {
  Context context;
  const Mesh mesh = tet_with_inlet(false);
  EXPECT_THROW(write_starter_files(mesh, "a.su2", "fluent", context), UsageError);
  EXPECT_THROW(write_starter_files(mesh, "a.vtu", "su2", context), UsageError);
  EXPECT_THROW(write_starter_files(mesh, "nowhere/", "openfoam", context), InputError);
}

}  // namespace
}  // namespace delfront
