// SPDX-License-Identifier: Apache-2.0
// Lines and points in formats of surfaces: what a reader makes of them, and what goes round.
#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

/// A cube whose top has what `inside` says: polygons beyond the first, and holes.
std::string cube_poly(const std::string& top, const std::string& more_facets = "", int num_more = 0) {
  return "12 3 0 0\n1 0 0 0\n2 4 0 0\n3 4 4 0\n4 0 4 0\n5 0 0 4\n6 4 0 4\n7 4 4 4\n8 0 4 4\n"
         "9 1 1 4\n10 3 1 4\n11 3 3 4\n12 2 2 1\n" +
         std::to_string(6 + num_more) +
         " 1\n1 0 1\n4 4 3 2 1\n1 0 3\n4 1 2 6 5\n1 0 3\n4 2 3 7 6\n1 0 3\n4 3 4 8 7\n1 0 3\n4 4 1 5 8\n" + top +
         more_facets + "0\n0\n";
}

Mesh read_text(const std::string& name, const std::string& text) {
  Context context;
  return read_mesh(write_text(name, text).string(), context);
}

bool has_side(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == 2 && cell < block.size(); ++cell) {
      const auto corners = block[cell];
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const auto ends = std::minmax(corners[k].value, corners[(k + 1) % corners.size()].value);
        if (ends == std::minmax(a, b)) return true;
      }
    }
  return false;
}

TEST(EmbeddedFormats, poly_facets_take_edges_and_points_inside) {
  const Mesh mesh = read_text("a.poly", cube_poly("4 0 2\n4 5 6 7 8\n2 5 9\n2 9 10\n1 11\n"));
  EXPECT_TRUE(has_side(mesh, 4, 8));
  EXPECT_TRUE(has_side(mesh, 8, 9));
  ASSERT_EQ(mesh.num_cells(CellType::line), 2u);
  EXPECT_EQ(mesh.groups[mesh.find_block(CellType::line)->group[0]].name, "curve_2");
  EXPECT_EQ(mesh.num_cells(CellType::triangle), 2u * 3 + 2);  // the top: 4 corners, 3 points inside
  std::set<std::uint32_t> used;
  for (const VertexId v : mesh.find_block(CellType::triangle)->vertices) used.insert(v.value);
  EXPECT_TRUE(used.contains(10));
}

TEST(EmbeddedFormats, poly_edges_from_corner_to_corner_cut_the_polygon) {
  const Mesh mesh = read_text("a.poly", cube_poly("2 0 2\n4 5 6 7 8\n2 5 7\n"));
  EXPECT_TRUE(has_side(mesh, 4, 6));
  EXPECT_EQ(mesh.num_cells(CellType::line), 0u);
  EXPECT_EQ(mesh.num_cells(CellType::triangle), 2u);
}

TEST(EmbeddedFormats, poly_facets_take_holes) {
  const Mesh mesh = read_text("a.poly", cube_poly("2 1 2\n4 5 6 7 8\n3 9 10 11\n1 2.5 1.5 4\n"));
  double area = 0;
  const CellBlock& triangles = *mesh.find_block(CellType::triangle);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Point a = mesh.points[triangles[t][0]];
    const Point n = cross(mesh.points[triangles[t][1]] - a, mesh.points[triangles[t][2]] - a);
    EXPECT_GT(n.z, 0);
    area += 0.5 * n.z;
  }
  EXPECT_EQ(area, 16 - 2);
}

TEST(EmbeddedFormats, poly_facets_without_a_ring_are_edges_and_points_in_space) {
  const Mesh mesh = read_text("a.poly", cube_poly("1 0 2\n4 5 6 7 8\n", "1 0 7\n2 12 1\n1 0\n1 12\n", 2));
  ASSERT_EQ(mesh.num_cells(CellType::line), 1u);
  EXPECT_EQ(mesh.groups[mesh.find_block(CellType::line)->group[0]].name, "curve_7");
  EXPECT_EQ(mesh.num_cells(CellType::vertex), 1u);
}

TEST(EmbeddedFormats, poly_facets_that_cannot_be_name_themselves) {
  const auto message = [](const std::string& top) {
    return message_of_reading<InputError>(write_text("a.poly", cube_poly(top)));
  };
  expect_mentions(message("3 0 2\n4 5 6 7 8\n2 9 11\n2 10 8\n"), {"a.poly", "facet 6", "cross"});
  expect_mentions(message("2 0 2\n4 5 6 7 8\n0\n"), {"a.poly", "polygon without corners"});
  expect_mentions(message("2 1 2\n4 5 6 7 8\n3 9 10 11\n1 nan 1 4\n"), {"a.poly", "hole"});
  expect_mentions(message("2 1 2\n4 5 6 7 8\n3 9 10 11\n1 1.1 2 4\n"), {"a.poly", "facet 6", "outside"});
}

TEST(EmbeddedFormats, obj_lines_and_points) {
  const Mesh mesh =
      read_text("a.obj",
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0.2 0.2 0.2\nv 0.3 0.2 0.2\ng hull\nf 1 3 2\nf 1 2 4\n"
                "f 2 3 4\nf 1 4 3\ng wire\nl 1 5/1 -1\np 5 6\n");
  ASSERT_EQ(mesh.num_cells(CellType::line), 2u);
  const CellBlock& lines = *mesh.find_block(CellType::line);
  EXPECT_EQ(lines[1][0].value, 4u);
  EXPECT_EQ(lines[1][1].value, 5u);
  EXPECT_EQ(mesh.groups[lines.group[0]].name, "wire");
  EXPECT_EQ(mesh.groups[lines.group[0]].dimension, 1);
  EXPECT_EQ(mesh.num_cells(CellType::vertex), 2u);
  expect_mentions(message_of_reading<InputError>(write_text("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1\n")),
                  {"a line needs two"});
  expect_mentions(message_of_reading<InputError>(write_text("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 9\n")),
                  {"out of range"});
}

TEST(EmbeddedFormats, medit_corners_and_required_vertices) {
  const Mesh mesh = read_text("a.mesh",
                              "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
                              "Triangles\n1\n1 2 3 1\nCorners\n2\n1 4\nRequiredVertices\n2\n4 2\nEnd\n");
  EXPECT_EQ(mesh.num_cells(CellType::vertex), 3u);
  expect_mentions(message_of_reading<InputError>(
                      write_text("b.mesh",
                                 "MeshVersionFormatted 2\nDimension 3\nVertices\n3\n0 0 0 0\n1 0 0 0\n0 1 0 0\n"
                                 "Triangles\n1\n1 2 3 1\nCorners\n1\n4\nEnd\n")),
                  {"vertex 4"});
}

TEST(EmbeddedFormats, lines_and_vertices_go_round) {
  Mesh mesh = cube_surface();
  const VertexId inside(mesh.points.size());
  mesh.points.push_back({1. / 3, 0.1, 0.7});
  mesh.block(CellType::line).vertices = {VertexId(0), inside};
  mesh.block(CellType::line).group = {mesh.add_group(1, "wire")};
  mesh.block(CellType::vertex).vertices = {inside};
  mesh.block(CellType::vertex).group = {mesh.add_group(0, "probe")};
  Context context;
  for (const char* name : {"a.vtu", "a.vtp", "a.msh", "a.mesh"}) {
    SCOPED_TRACE(name);
    const std::string path = (scratch_folder("io_round") / name).string();
    write_mesh(mesh, path, context);
    const Mesh back = read_mesh(path, context);
    ASSERT_EQ(back.num_cells(CellType::line), 1u);
    EXPECT_EQ(back.find_block(CellType::line)->vertices, mesh.find_block(CellType::line)->vertices);
    EXPECT_EQ(back.groups[back.find_block(CellType::line)->group[0]].name, "wire");
    ASSERT_EQ(back.num_cells(CellType::vertex), 1u);
    EXPECT_EQ(back.find_block(CellType::vertex)->vertices, mesh.find_block(CellType::vertex)->vertices);
  }
  for (const char* name : {"a.stl", "a.obj", "a.off", "a.ply"}) {
    const auto notes = write_mesh(mesh, (scratch_folder("io_round") / name).string(), context);
    EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
      return note.find("1 line and 1 vertex cells are left out") != std::string::npos;
    })) << name;
  }
}

}  // namespace
}  // namespace delfront
