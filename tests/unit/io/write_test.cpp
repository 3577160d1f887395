// SPDX-License-Identifier: Apache-2.0
// Where and how files are written: places that cannot be, full disks, what is left behind, OpenFOAM cases, defects.
#include <sys/mount.h>
#include <unistd.h>

#include "io/foam_faces.hpp"
#include "io/output.hpp"
#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;
namespace fs = std::filesystem;

template <class Function>
std::string io_error(Function&& act) {
  try {
    act();
  } catch (const IoError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no IoError";
  return "";
}

std::size_t num_entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(Write, places_that_cannot_be_written_are_said_beforehand_and_when_writing) {
  const fs::path folder = scratch_folder("io_places");
  std::ofstream(folder / "file") << "x";
  struct Bad {
    std::string path;
    std::vector<std::string> words;
  };
  const Bad all[] = {{(folder / "file/out.vtu").string(), {"file is a file, not a folder"}},
                     {(folder / "file/case/").string(), {"file is a file, not a folder"}},
                     {(folder / "file/").string(), {"is a file, not a folder"}},
                     {(folder / "none/deep/out.vtu").string(), {"none does not exist"}},
                     {folder.string(), {"is a folder"}}};
  Context context;
  for (const Bad& bad : all) {
    expect_mentions(io_error([&] { check_writable(bad.path); }), bad.words);
    expect_mentions(
        io_error([&] { write_mesh(two_boxes(), bad.path, context, {}, bad.path.ends_with('/') ? "" : "vtu"); }),
        bad.words);
  }
  EXPECT_EQ(num_entries(folder), 1u);
  check_writable((folder / "new.vtu").string());
  check_writable((folder / "new/").string());
  EXPECT_EQ(num_entries(folder), 1u) << "check_writable left something behind";
}

TEST(Write, a_read_only_folder_is_said) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere; run as another user to test this";
  const fs::path folder = scratch_folder("io_read_only");
  fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
  expect_mentions(io_error([&] { check_writable((folder / "a.vtu").string()); }), {"no permission"});
  fs::permissions(folder, fs::perms::owner_all);
}

Field one_on_points(const Mesh& mesh) {
  return {"t", Field::On::vertices, CellType::vertex, 1, std::vector<double>(mesh.points.size(), 0.5)};
}

TEST(Write, a_full_device_gives_an_error_in_every_format) {
  Context context;
  for (const FormatInfo& format : formats()) {
    if (!format.can_write || format.name == "openfoam") continue;
    const bool by_library = format.name == "cgns" || format.name == "vtkhdf" || format.name == "xdmf";
    Mesh mesh = two_boxes();
    if (format.name.starts_with("sol")) mesh.fields = {one_on_points(mesh)};
    expect_mentions(io_error([&] { write_mesh(mesh, "/dev/full", context, {}, format.name); }),
                    {"/dev/full", by_library ? "regular files" : "No space left"});
  }
}

TEST(Write, a_full_disk_leaves_the_old_file_and_nothing_else) {
  const fs::path folder = scratch_folder("io_tmpfs");
  if (::mount("none", folder.c_str(), "tmpfs", 0, "size=64k") != 0)
    GTEST_SKIP() << "mount is not permitted here: needs root";
  Context context;
  const std::string path = (folder / "a.vtu").string();
  write_mesh(two_boxes(), path, context);
  const std::string before = contents(path);
  const Mesh large = sphere_surface(4);
  const std::string message = io_error([&] { write_mesh(large, path, context); });
  EXPECT_EQ(contents(path), before);
  EXPECT_EQ(num_entries(folder), 1u);
  Mesh many = two_boxes();
  for (int i = 0; i < 10000; ++i) many.points.push_back({1.0 / 3, i / 7.0, 0});
  io_error([&] { write_mesh(many, (folder / "case/").string(), context); });
  EXPECT_EQ(num_entries(folder), 1u) << "a half-written case was left";
  for (const FormatInfo& format : formats())  // of libraries that write themselves
    if (format.name == "vtkhdf" || format.name == "xdmf")
      expect_mentions(io_error([&] { write_mesh(large, (folder / "b.x").string(), context, {}, format.name); }),
                      {"cannot write", "b.", format.name == "xdmf" ? "" : "disk full"});
  EXPECT_EQ(num_entries(folder), 1u) << "a half-written file was left";
  ::umount(folder.c_str());
  expect_mentions(message, {"a.vtu", "No space left"});
}

TEST(Write, links_are_followed_and_devices_not_replaced) {
  const fs::path folder = scratch_folder("io_links");
  std::ofstream(folder / "real.off") << "old";
  fs::create_symlink("real.off", folder / "link.off");
  Context context;
  write_mesh(cube_surface(), (folder / "link.off").string(), context);
  EXPECT_TRUE(fs::is_symlink(folder / "link.off"));
  EXPECT_EQ(read_mesh((folder / "real.off").string(), context).num_cells(CellType::triangle), 12u);
  write_mesh(cube_surface(), "/dev/null", context, {}, "vtu");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(Write, the_same_mesh_gives_the_same_bytes) {
  Context context;
  const fs::path folder = scratch_folder("io_same");
  for (const char* extension :
       {"vtu", "msh", "mesh", "su2", "stl", "meshb", "ugrid", "b8.ugrid", "bdf", "inp", "cgns"}) {
    if (std::string_view(extension) == "cgns" &&
        std::none_of(formats().begin(), formats().end(), [](const auto& f) { return f.name == "cgns"; }))
      continue;
    for (const char* stem : {"a.", "b."}) write_mesh(two_boxes(), (folder / stem).string() + extension, context);
    EXPECT_EQ(contents((folder / "a.").string() + extension), contents((folder / "b.").string() + extension));
  }
}

TEST(Write, formats_refuse_what_they_cannot_hold) {
  Context context;
  const std::string folder = scratch_folder("io_refuse").string();
  Mesh polygon = cube_surface();
  add_cell(polygon, CellType::polygon, std::array{VertexId(0), VertexId(1), VertexId(3), VertexId(2), VertexId(4)},
           GroupId());
  for (const char* name : {"/a.msh", "/a.mesh", "/a.su2"})
    EXPECT_THROW(write_mesh(polygon, folder + name, context), InputError) << name;
  EXPECT_THROW(write_mesh(cube_surface(), folder + "/case/", context), InputError);
  EXPECT_THROW(write_mesh(cube_surface(), folder + "/a.su2", context), InputError);
  EXPECT_THROW(write_mesh(Mesh(), folder + "/a.stl", context), InputError);
  EXPECT_EQ(num_entries(folder), 0u);
}

std::vector<std::int64_t> labels(const fs::path& file) {
  const std::string text = contents(file);
  std::istringstream in(text.substr(text.find("\n(\n") + 3));
  std::vector<std::int64_t> all;
  for (std::int64_t value; in >> value;) all.push_back(value);
  return all;
}

TEST(OpenFoam, faces_are_in_upper_triangular_order_and_zones_name_regions) {
  Context context;
  const fs::path folder = scratch_folder("io_foam");
  const std::vector<std::string> notes = write_mesh(two_boxes(), (folder / "case/").string(), context);
  ASSERT_EQ(notes.size(), 1u);
  expect_mentions(notes[0], {"left wall", "left_wall"});
  const fs::path poly = folder / "case/constant/polyMesh";
  const std::vector<std::int64_t> owner = labels(poly / "owner"), neighbour = labels(poly / "neighbour");
  ASSERT_EQ(owner.size(), 14u + 20u);
  ASSERT_EQ(neighbour.size(), 14u);
  for (std::size_t i = 0; i < neighbour.size(); ++i) {
    EXPECT_LT(owner[i], neighbour[i]);
    if (i > 0) {
      EXPECT_LT(std::pair(owner[i - 1], neighbour[i - 1]), std::pair(owner[i], neighbour[i]));
    }
  }
  expect_mentions(contents(poly / "boundary"),
                  {"left_wall", "type            wall", "nFaces          2", "rest", "nFaces          18"});
  expect_mentions(contents(poly / "cellZones"), {"fluid", "solid"});
  expect_mentions(contents(poly / "faceZones"), {"between", "flipMap"});
  EXPECT_TRUE(fs::exists(folder / "case/system/controlDict"));
  EXPECT_EQ(num_entries(folder / "case/constant"), 1u);
}

TEST(OpenFoam, an_existing_case_keeps_its_files_and_gets_the_new_mesh) {
  Context context;
  const fs::path folder = scratch_folder("io_foam_again");
  fs::create_directories(folder / "case/system");
  std::ofstream(folder / "case/system/controlDict") << "mine";
  const std::string path = (folder / "case/").string();
  write_mesh(two_boxes(), path, context);
  Mesh nameless = mixed_cells();
  for (Group& group : nameless.groups)
    if (group.dimension == 3) group.name = "";
  write_mesh(nameless, path, context);
  EXPECT_EQ(contents(folder / "case/system/controlDict"), "mine");
  EXPECT_EQ(labels(folder / "case/constant/polyMesh/neighbour").size(), 3u);
  EXPECT_FALSE(fs::exists(folder / "case/constant/polyMesh/cellZones"));
  EXPECT_EQ(num_entries(folder / "case/constant"), 1u);
}

TEST(OpenFoam, a_baffle_becomes_two_patches_and_face_normals_leave_the_owner) {
  Mesh mesh = two_boxes();
  for (GroupId& group : mesh.block(CellType::tetrahedron).group) group = GroupId(0);  // one region on both sides
  mesh.groups[mesh.find_group(2, "between")].kind = "wall";
  Context context;
  const FoamFaces faces = build_foam_faces(mesh, context);
  EXPECT_EQ(faces.internal.size(), 14u - 2u);
  EXPECT_EQ(faces.boundary.size(), 20u + 4u);
  const CellBlock& tets = mesh.block(CellType::tetrahedron);
  const auto check_outward = [&](const FoamFace& face) {
    const std::vector<VertexId> c = faces.corners(face);
    Point centre;
    for (VertexId v : tets[face.owner]) centre = centre + 0.25 * mesh.points[v];
    const Point normal = cross(mesh.points[c[1]] - mesh.points[c[0]], mesh.points[c[2]] - mesh.points[c[0]]);
    EXPECT_GT(dot(normal, mesh.points[c[0]] - centre), 0);
  };
  for (const FoamFace& face : faces.internal) check_outward(face);
  for (const FoamFace& face : faces.boundary) check_outward(face);
  const fs::path folder = scratch_folder("io_foam_baffle");
  write_mesh(mesh, (folder / "case/").string(), context);
  expect_mentions(contents(folder / "case/constant/polyMesh/boundary"), {"between_master", "between_slave"});
  EXPECT_FALSE(fs::exists(folder / "case/constant/polyMesh/faceZones"));
}

TEST(Defects, places_become_vertices_edges_lines_and_faces_polygons) {
  const Point a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0.5}, d{1, 1, 1};
  Finding crossing{"self_intersection", Severity::error, 1, "", "", {{{0.25, 0.5, 0.75}, {1, 2}}}};
  crossing.outlines = {{2, {a, b, c}}, {1, {b, c, d}}, {2, {a, b, c}}};  // one triangle in two pairs is drawn once
  Finding open{"open_edges", Severity::warning, 2, "", "", {{{1, 2, 3}, {7}}, {{4, 5, 6}, {}}}};
  open.outlines = {{7, {a, b}}, {7, {b, d}}};
  Context context;
  const std::string path = (scratch_folder("io_defects") / "d.vtp").string();
  write_defects({crossing, open}, path, context);
  const Mesh got = read_mesh(path, context);
  EXPECT_EQ(got.num_cells(CellType::vertex), 3u);
  ASSERT_EQ(got.num_cells(CellType::line), 2u);
  ASSERT_EQ(got.num_cells(CellType::triangle), 2u);
  const auto corners = [&](CellType type, std::size_t cell) {
    std::vector<Point> points;
    for (VertexId v : (*got.find_block(type))[cell]) points.push_back(got.points[v]);
    return points;
  };
  EXPECT_EQ(corners(CellType::vertex, 0), (std::vector<Point>{{0.25, 0.5, 0.75}}));
  EXPECT_EQ(corners(CellType::triangle, 0), (std::vector<Point>{b, c, d}));
  EXPECT_EQ(corners(CellType::triangle, 1), (std::vector<Point>{a, b, c}));
  EXPECT_EQ(corners(CellType::line, 1), (std::vector<Point>{b, d}));
  std::map<std::pair<std::string, CellType>, std::vector<double>> on_cells;
  for (const Field& field : got.fields)
    if (field.on == Field::On::cells) on_cells[{field.name, field.block}] = field.values;
  EXPECT_EQ((on_cells[{"first_id", CellType::vertex}]), (std::vector<double>{1, 7, -1}));
  EXPECT_EQ((on_cells[{"first_id", CellType::triangle}]), (std::vector<double>{1, 2}));
  EXPECT_EQ((on_cells[{"severity", CellType::line}]), (std::vector<double>{1, 1}));
  EXPECT_EQ((on_cells[{"finding", CellType::triangle}]), (std::vector<double>{0, 0}));
  write_defects({}, path, context);
  EXPECT_NE(contents(path).find("NumberOfVerts=\"0\""), std::string::npos);
}

/// Runs a program where it is installed; its output goes to `log`.
bool can_run(const std::string& command) { return std::system((command + " > /dev/null 2>&1").c_str()) == 0; }

TEST(OtherPrograms, meshio_and_vtk_read_our_vtu_with_its_names) {
  const std::string python = "/usr/bin/python3";
  if (!can_run(python + " -c 'import meshio'")) GTEST_SKIP() << "meshio is not installed (python3-meshio)";
  Context context;
  const fs::path folder = scratch_folder("io_meshio");
  for (const auto& [name, options] : {std::pair{"raw", WriteOptions{}},
                                      {"packed", WriteOptions{.binary = true, .version = "", .compress = true}},
                                      {"text", WriteOptions{.binary = false, .version = "", .compress = false}}}) {
    const std::string path = (folder / name).string() + ".vtu";
    write_mesh(two_boxes(), path, context, options);
    const std::string with_meshio =
        python + " -c 'import meshio; m = meshio.read(\"" + path +
        "\"); assert len(m.points) == 12; assert list(m.field_data[\"patch:left wall\"]) == [0, 2]; "
        "assert sum(len(c.data) for c in m.cells) == 34; assert sorted(m.cell_data) == [\"patch_id\", \"region_id\"]'";
    EXPECT_EQ(std::system(with_meshio.c_str()), 0) << name;
    if (!can_run(python + " -c 'import vtk'")) continue;
    const std::string with_vtk = python + " -c 'import vtk; r = vtk.vtkXMLUnstructuredGridReader(); r.SetFileName(\"" +
                                 path +
                                 "\"); r.Update(); g = r.GetOutput(); assert g.GetNumberOfCells() == 34; "
                                 "assert g.GetFieldData().GetArray(\"region:solid\").GetValue(0) == 1'";
    EXPECT_EQ(std::system(with_vtk.c_str()), 0) << name;
  }
}

TEST(OtherPrograms, we_read_every_encoding_that_vtk_writes) {
  if (!can_run("/usr/bin/python3 -c 'import vtk'")) GTEST_SKIP() << "vtk is not installed (python3-vtk9)";
  Context context;
  const fs::path folder = scratch_folder("io_vtk");
  write_mesh(two_boxes(), (folder / "in.vtu").string(), context);
  std::ofstream(folder / "rewrite.py") << R"(
import itertools, vtk
reader = vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName("in.vtu")
reader.Update()
for n, (mode, encode, header, order, pack) in enumerate(itertools.product(range(3), (0, 1), (32, 64), (0, 1), (0, 1))):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName("out%d.vtu" % n)
    writer.SetInputData(reader.GetOutput())
    writer.SetDataMode(mode)
    writer.SetEncodeAppendedData(encode)
    writer.SetHeaderType(header)
    writer.SetByteOrder(order)
    writer.SetCompressorType(1 if pack else 0)
    writer.Write()
)";
  ASSERT_EQ(std::system(("cd " + folder.string() + " && /usr/bin/python3 rewrite.py").c_str()), 0);
  for (int n = 0; n < 48; ++n) {
    SCOPED_TRACE(n);
    const Mesh got = read_mesh((folder / ("out" + std::to_string(n) + ".vtu")).string(), context);
    expect_same(got, two_boxes(), {.kinds = false, .renamed = {}});
  }
}

TEST(OtherPrograms, gmsh_reads_our_msh) {
  if (!can_run("gmsh -version")) GTEST_SKIP() << "gmsh is not installed";
  Context context;
  const fs::path folder = scratch_folder("io_gmsh");
  for (const char* version : {"2.2", "4.1"})
    for (bool binary : {true, false}) {
      const std::string path = (folder / "a.msh").string(), back = (folder / "b.msh").string();
      write_mesh(mixed_cells(), path, context, {.binary = binary, .version = version, .compress = false});
      ASSERT_EQ(std::system(("gmsh -0 " + path + " -format msh41 -o " + back + " > /dev/null 2>&1").c_str()), 0);
      const Mesh got = read_mesh(back, context);
      EXPECT_EQ(got.num_cells_of_dimension(3), 4u);
      EXPECT_EQ(got.num_cells_of_dimension(2), 14u);
      for (const char* name : {"low", "high"}) EXPECT_TRUE(got.find_group(2, name).is_valid()) << name;
      EXPECT_TRUE(got.find_group(3, "air").is_valid());
    }
}

// meshio takes an array for another one where the offsets rise along the file: see vtk_output.hpp.
TEST(Write, vtu_appends_the_last_array_first) {
  const fs::path folder = scratch_folder("io_vtu_order");
  Context context;
  for (const bool compress : {false, true}) {
    const std::string path = (folder / "a.vtu").string();
    write_mesh(two_boxes(), path, context, {.binary = true, .version = "", .compress = compress});
    const std::string text = contents(path);
    std::vector<std::size_t> offsets;
    for (std::size_t at = 0; (at = text.find(" offset=\"", at)) != std::string::npos; ++at)
      offsets.push_back(std::stoul(text.substr(at + 9)));
    ASSERT_GE(offsets.size(), 5u);
    EXPECT_TRUE(std::is_sorted(offsets.rbegin(), offsets.rend()));
    EXPECT_EQ(offsets.back(), 0u);
  }
}

}  // namespace
}  // namespace delfront
