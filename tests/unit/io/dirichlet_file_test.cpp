// SPDX-License-Identifier: Apache-2.0
// Dirichlet cells as VTU polyhedra (T6): what is written reads back as the same cells.
#include <gtest/gtest.h>

#include <random>

#include "delfront/dirichlet.hpp"
#include "delfront/io.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

TEST(DirichletFile, T6_cells_come_back_from_vtu) {
  std::mt19937 random(61);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> points;
  for (int i = 0; i < 60; ++i) points.push_back({uniform(random), uniform(random), uniform(random)});
  Context context;
  const Mesh mesh = mesh_of(dirichlet(points, context, Box{{0, 0, 0}, {1, 1, 1}}));
  ASSERT_EQ(mesh.num_cells(CellType::polyhedron), points.size());
  const std::string path = fixtures::scratch_folder("dirichlet") / "cells.vtu";
  for (const bool binary : {true, false}) {
    EXPECT_TRUE(write_mesh(mesh, path, context, {.binary = binary, .version = "", .compress = false}).empty());
    const Mesh back = read_mesh(path, context);
    EXPECT_TRUE(back.points == mesh.points);
    ASSERT_NE(back.find_block(CellType::polyhedron), nullptr);
    EXPECT_TRUE(back.find_block(CellType::polyhedron)->vertices == mesh.find_block(CellType::polyhedron)->vertices);
    EXPECT_EQ(back.find_block(CellType::polyhedron)->offsets, mesh.find_block(CellType::polyhedron)->offsets);
    ASSERT_EQ(back.fields.size(), 2u);
    for (const Field& field : back.fields)
      EXPECT_EQ(field.values, mesh.fields[field.name == "point" ? 0 : 1].values) << field.name;
  }
}

}  // namespace
}  // namespace delfront
