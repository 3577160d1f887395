// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

const WriteOptions kText{.binary = false, .version = "", .compress = false};
const WriteOptions kPacked{.binary = true, .version = "", .compress = true};

TEST(RoundTrip, vtu_keeps_everything_in_each_encoding) {
  for (const Mesh& mesh : {two_boxes(), mixed_cells(), plane_grid(), cube_surface()})
    for (const WriteOptions& options : {WriteOptions{}, kText, kPacked}) {
      std::vector<std::string> notes;
      expect_same(round_trip(mesh, "a.vtu", options, &notes), mesh);
      EXPECT_TRUE(notes.empty());
    }
}

TEST(RoundTrip, vtp_keeps_faces_and_lines) {
  for (const Mesh& mesh : {plane_grid(), cube_surface(), sphere_surface(2)})
    for (const WriteOptions& options : {WriteOptions{}, kText, kPacked})
      expect_same(round_trip(mesh, "a.vtp", options), mesh);
}

TEST(RoundTrip, vtu_keeps_fields_on_vertices_and_on_one_block) {
  Mesh mesh = two_boxes();
  Field on_vertices{"velocity", Field::On::vertices, CellType::vertex, 3, {}};
  for (std::size_t i = 0; i < 3 * mesh.points.size(); ++i) on_vertices.values.push_back(1.0 / double(i + 1));
  Field on_tets{"quality", Field::On::cells, CellType::tetrahedron, 1, {}};
  for (std::size_t i = 0; i < mesh.num_cells(CellType::tetrahedron); ++i)
    on_tets.values.push_back(std::sqrt(double(i)));
  mesh.fields = {on_vertices, on_tets};
  for (const WriteOptions& options : {WriteOptions{}, kText, kPacked}) {
    const Mesh got = round_trip(mesh, "a.vtu", options);
    ASSERT_EQ(got.fields.size(), 2u);
    EXPECT_EQ(got.fields[0].name, "velocity");
    EXPECT_EQ(got.fields[0].components, 3);
    EXPECT_EQ(got.fields[0].values, on_vertices.values);
    EXPECT_EQ(got.fields[1].name, "quality");
    EXPECT_EQ(got.fields[1].block, CellType::tetrahedron);
    EXPECT_EQ(got.fields[1].values, on_tets.values);
  }
}

TEST(RoundTrip, vtu_keeps_polygons_and_polyhedra) {
  Mesh mesh = two_boxes();
  std::vector<VertexId> stream = {VertexId(4)};  // the first tetrahedron as a polyhedron
  for_each_face(mesh.block(CellType::tetrahedron), 0, [&](std::span<const VertexId> corners) {
    stream.push_back(VertexId(corners.size()));
    stream.insert(stream.end(), corners.begin(), corners.end());
  });
  add_cell(mesh, CellType::polyhedron, stream, mesh.find_group(3, "solid"));
  add_cell(mesh, CellType::polyhedron, stream, GroupId());
  std::vector<VertexId> polygon;
  for (std::size_t i = 0; i < 5; ++i) polygon.push_back(VertexId(i));
  add_cell(mesh, CellType::polygon, polygon, mesh.find_group(2, "rest"));
  for (const WriteOptions& options : {WriteOptions{}, kText, kPacked})
    expect_same(round_trip(mesh, "a.vtu", options), mesh);
}

TEST(RoundTrip, vtu_escapes_names_and_numbers_double_ones) {
  Mesh mesh = cube_surface();
  mesh.groups[GroupId(0)].name = "a<b>&\"c\": é";
  mesh.groups[GroupId(1)].name = "ymin";
  std::vector<std::string> notes;
  const Mesh got = round_trip(mesh, "a.vtu", {}, &notes);
  EXPECT_EQ(got.groups[GroupId(0)].name, "a<b>&\"c\": é");
  EXPECT_EQ(got.groups[GroupId(1)].name, "ymin");
  EXPECT_EQ(got.groups[GroupId(2)].name, "ymin_2");
  ASSERT_EQ(notes.size(), 1u);
  expect_mentions(notes[0], {"ymin", "ymin_2"});
}

TEST(RoundTrip, msh_keeps_cells_order_and_names_in_each_version_and_encoding) {
  for (const Mesh& mesh : {two_boxes(), mixed_cells(), plane_grid(), cube_surface()})
    for (const char* version : {"2.2", "4.1"})
      for (bool binary : {true, false}) {
        SCOPED_TRACE(std::string(version) + (binary ? " binary" : " text"));
        expect_same(round_trip(mesh, "a.msh", {.binary = binary, .version = version, .compress = false}), mesh,
                    {.kinds = false, .renamed = {}});
      }
}

TEST(RoundTrip, msh_keeps_cells_without_a_group) {
  Mesh mesh = two_boxes();
  CellBlock& tets = mesh.block(CellType::tetrahedron);
  tets.group[3] = tets.group[7] = GroupId();
  for (const char* version : {"2.2", "4.1"})
    expect_same(round_trip(mesh, "a.msh", {.binary = true, .version = version, .compress = false}), mesh,
                {.kinds = false, .renamed = {}});
}

TEST(RoundTrip, medit_keeps_cells_names_and_kinds) {
  for (const Mesh& mesh : {two_boxes(), mixed_cells(), plane_grid(), cube_surface()})
    expect_same(round_trip(mesh, "a.mesh"), mesh);
}

TEST(RoundTrip, su2_keeps_cells_and_markers) {
  for (const Mesh& mesh : {mixed_cells(), plane_grid()})
    expect_same(round_trip(mesh, "a.su2"), mesh, {.kinds = false, .regions = false, .renamed = {}});
}

TEST(RoundTrip, su2_says_what_it_cannot_hold) {
  Mesh mesh = two_boxes();
  std::vector<std::string> notes;
  const Mesh got = round_trip(mesh, "a.su2", {}, &notes);
  EXPECT_TRUE(got.find_group(2, "left_wall").is_valid());
  EXPECT_FALSE(got.find_group(2, "between").is_valid());
  EXPECT_EQ(got.num_cells(CellType::triangle), mesh.num_cells(CellType::triangle) - 2);
  ASSERT_EQ(notes.size(), 4u);  // the kinds, the name, the inner faces, the regions
  expect_mentions(notes[0], {"SU2", "2 groups", "interface, wall", "VTU"});
  expect_mentions(notes[1], {"left wall", "left_wall"});
}

TEST(RoundTrip, obj_and_ply_keep_faces_and_patches) {
  Mesh mesh = cube_surface();
  for (Point& p : mesh.points) p = p * (1.0 / 3);
  expect_same(round_trip(mesh, "a.obj"), mesh);
  expect_same(round_trip(mesh, "a.ply"), mesh);
  expect_same(round_trip(mesh, "a.ply", kText), mesh);
}

TEST(RoundTrip, off_keeps_faces_and_says_that_names_are_lost) {
  const Mesh mesh = cube_surface();
  std::vector<std::string> notes;
  const Mesh got = round_trip(mesh, "a.off", {}, &notes);
  EXPECT_EQ(got.points, mesh.points);
  EXPECT_EQ(got.find_block(CellType::triangle)->vertices, mesh.find_block(CellType::triangle)->vertices);
  EXPECT_EQ(notes.size(), 1u);
}

TEST(RoundTrip, polygons_survive_obj_ply_off) {
  Mesh mesh;
  for (int i = 0; i < 7; ++i) mesh.points.push_back({std::cos(i / 3.0), std::sin(i / 3.0), 1.0 / (i + 1)});
  const GroupId group = mesh.add_group(2, "");
  std::vector<VertexId> all;
  for (std::size_t i = 0; i < 7; ++i) all.push_back(VertexId(i));
  add_face(mesh, all, group);
  add_face(mesh, std::span(all).first(5), group);
  add_face(mesh, std::span(all).first(4), group);
  for (const char* name : {"a.ply", "a.off"}) expect_same(round_trip(mesh, name), mesh);
  expect_same(round_trip(mesh, "a.obj"), mesh, {.renamed = {{"", "patch"}}});
}

std::vector<Point> corners_in_order(const Mesh& mesh) {
  std::vector<Point> corners;
  for (VertexId v : mesh.find_block(CellType::triangle)->vertices) corners.push_back(mesh.points[v]);
  return corners;
}

TEST(RoundTrip, stl_text_keeps_exact_coordinates_and_solids) {
  Mesh mesh = cube_surface();
  for (Point& p : mesh.points) p = p * (1.0 / 3);
  const Mesh got = round_trip(mesh, "a.stl");
  EXPECT_EQ(corners_in_order(got), corners_in_order(mesh));
  expect_same_groups(got, mesh, {});
}

TEST(RoundTrip, stl_is_binary_only_where_nothing_is_lost) {
  Mesh mesh = cube_surface();
  mesh.groups.clear();
  const GroupId body = mesh.add_group(2, "body");
  for (GroupId& group : mesh.block(CellType::triangle).group) group = body;
  std::vector<std::string> notes;
  const Mesh got = round_trip(mesh, "a.stl", {}, &notes);
  EXPECT_EQ(std::filesystem::file_size(scratch_folder("x").parent_path() / "io_round_trip" / "a.stl"), 84u + 12 * 50);
  EXPECT_EQ(corners_in_order(got), corners_in_order(mesh));
  EXPECT_EQ(got.groups[GroupId(0)].name, "body");
  EXPECT_TRUE(notes.empty());
  mesh.points[VertexId(0)].x = 0.1;
  round_trip(mesh, "a.stl", {}, &notes);
  ASSERT_EQ(notes.size(), 1u);
  expect_mentions(notes[0], {"single precision"});
}

TEST(RoundTrip, stl_splits_polygons_without_flat_triangles) {
  Mesh mesh;  // an L of eight corners, two of them in the middle of sides
  const double xy[8][2] = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}};
  std::vector<VertexId> all;
  for (const auto& p : xy) {
    all.push_back(mesh.points.next_id());
    mesh.points.push_back({p[0], p[1], 1.0 / 3});
  }
  add_face(mesh, all, mesh.add_group(2, "ell"));
  const Mesh got = round_trip(mesh, "a.stl");
  const std::vector<Point> corners = corners_in_order(got);
  ASSERT_EQ(corners.size(), 3u * 6);
  double area = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const double twice = cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]).z;
    EXPECT_GT(twice, 0.1);
    area += twice / 2;
  }
  EXPECT_DOUBLE_EQ(area, 3);
}

TEST(RoundTrip, volume_grids_written_as_surfaces_keep_only_the_points_of_faces) {
  Mesh mesh = two_boxes();
  mesh.points.push_back({9, 9, 9});
  std::vector<std::string> notes;
  const Mesh got = round_trip(mesh, "a.obj", {}, &notes);
  EXPECT_EQ(got.points.size(), mesh.points.size() - 1);
  EXPECT_EQ(got.num_cells(CellType::triangle), mesh.num_cells(CellType::triangle));
  ASSERT_EQ(notes.size(), 2u);
  expect_mentions(notes[0], {"12 volume cells"});
  expect_mentions(notes[1], {"the boundary kinds of 2 groups are left out"});
}

TEST(RoundTrip, kinds_that_a_format_loses_are_said) {
  Mesh mesh = two_boxes();
  mesh.groups[mesh.find_group(2, "rest")].kind = "farfield";
  const auto losses = [&](const std::string& name) {
    Context context;
    std::size_t n = 0;
    for (const std::string& note : write_mesh(mesh, (scratch_folder("io_kinds") / name).string(), context))
      n += note.find("left out (") != std::string::npos && note.find("farfield") != std::string::npos;
    return n;
  };
  for (const char* name : {"a.su2", "a.msh", "a.stl", "a.obj", "a.ply", "a.off", "case/"}) EXPECT_EQ(losses(name), 1u);
  for (const char* name : {"a.vtu", "a.vtp", "a.mesh"}) EXPECT_EQ(losses(name), 0u) << name;
}

}  // namespace
}  // namespace delfront
