// SPDX-License-Identifier: Apache-2.0
// Formats of other programs, byte by byte: what is read, and what is refused with its place.
#include <cmath>
#include <cstring>
#include <random>

#include "io/formats.hpp"
#include "io/nastran_text.hpp"
#include "ten_grids.hpp"

namespace delfront {
namespace {

using namespace fixtures;

Mesh read_bytes(Reader reader, const std::string& bytes, const std::string& name = "file") {
  Context context;
  return reader(bytes, name, context);
}
std::string refusal(Reader reader, const std::string& bytes, const std::string& name = "file") {
  return message_of<InputError>([&] { read_bytes(reader, bytes, name); });
}

template <class T>
void put(std::string& bytes, T value, bool swaps = false) {
  if (swaps) value = Cursor::swapped(value);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string written(const Mesh& mesh, const std::string& file, const std::string& format = "") {
  Context context;
  const std::filesystem::path path = scratch_folder() / file;
  write_mesh(mesh, path.string(), context, {}, format);
  return contents(path);
}

// -- UGRID

/// One tetrahedron with a face, in any encoding.
template <class Integer, class Real>
std::string binary_ugrid(bool swaps) {
  std::string bytes;
  for (const int n : {4, 1, 0, 1, 0, 0, 0}) put(bytes, Integer(n), swaps);
  for (const double x : {0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., .25}) put(bytes, Real(x), swaps);
  for (const int v : {1, 2, 3, 7, 1, 2, 3, 4}) put(bytes, Integer(v), swaps);
  return bytes;
}

TEST(Ugrid, each_encoding_is_known_by_its_name_and_without) {
  const std::pair<const char*, std::string> all[] = {{"a.b8.ugrid", binary_ugrid<std::int32_t, double>(true)},
                                                     {"a.lb8.ugrid", binary_ugrid<std::int32_t, double>(false)},
                                                     {"a.b4.ugrid", binary_ugrid<std::int32_t, float>(true)},
                                                     {"a.lb4.ugrid", binary_ugrid<std::int32_t, float>(false)},
                                                     {"a.b8l.ugrid", binary_ugrid<std::int64_t, double>(true)},
                                                     {"a.lb8l.ugrid", binary_ugrid<std::int64_t, double>(false)}};
  for (const auto& [name, bytes] : all)
    for (const char* path : {name, "a.ugrid"}) {
      SCOPED_TRACE(std::string(name) + " as " + path);
      const Mesh mesh = read_bytes(read_ugrid, bytes, path);
      EXPECT_EQ(mesh.points[VertexId(3)].z, .25);
      ASSERT_EQ(mesh.num_cells(CellType::tetrahedron), 1u);
      ASSERT_EQ(mesh.num_cells(CellType::triangle), 1u);
      EXPECT_TRUE(mesh.find_group(2, "patch_7").is_valid());
      const auto face = (*mesh.find_block(CellType::triangle))[0];  // looks into the grid there, out of it here
      EXPECT_EQ((std::vector<VertexId>(face.begin(), face.end())),
                (std::vector<VertexId>{VertexId(0), VertexId(2), VertexId(1)}));
    }
}

TEST(Ugrid, what_is_wrong_is_said_with_its_place) {
  const std::string good = binary_ugrid<std::int32_t, double>(false);
  expect_mentions(refusal(read_ugrid, good.substr(0, good.size() - 1), "a.lb8.ugrid"),
                  {"a.lb8.ugrid", "byte 0", "truncated"});
  expect_mentions(refusal(read_ugrid, good, "a.b8.ugrid"), {".b8.", "wrong encoding"});
  expect_mentions(refusal(read_ugrid, "3 1 0 0 0 0 0\n0 0 0\n1 0 0\n0 1 0\n1 2 4\n1\n"),
                  {"line 5", "node 4", "1 to 3"});
  expect_mentions(refusal(read_ugrid, "4000000 1 0 0 0 0 0\n0 0 0\n"), {"line 1", "4000000", "truncated"});
  expect_mentions(refusal(read_ugrid, "3 1 0 0 0 0 0\n0 0 0\n1 0 0\n0 x 0\n1 2 3\n1\n"), {"line 4", "'x'"});
}

TEST(Ugrid, mapbc_has_the_numbers_of_fun3d_and_symmetry_by_axis) {
  Mesh mesh = hex_block(1, 1, 1, [](int, int, int) { return "air"; });
  add_sides(mesh);  // the mirror is normal to z
  Context context;
  const std::filesystem::path folder = scratch_folder("io_mapbc");
  const auto notes = write_mesh(mesh, (folder / "a.b8.ugrid").string(), context);
  EXPECT_EQ(contents(folder / "a.mapbc"),
            "6\n1 7011 inlet\n2 7012 outlet\n3 4000 floor\n4 5000 sky\n5 6663 mirror\n6 0 rest\n# volume 1 air\n");
  EXPECT_TRUE(
      std::any_of(notes.begin(), notes.end(), [](const auto& n) { return n.find("1 surfaces is 0") != n.npos; }));
  std::ofstream(folder / "a.mapbc") << "2\n1 6662 left half\n9 4000 nowhere\n";
  Recorder recorder;
  const Mesh got = read_mesh((folder / "a.b8.ugrid").string(), recorder.context);
  ASSERT_TRUE(got.find_group(2, "left half").is_valid());
  EXPECT_EQ(got.groups[got.find_group(2, "left half")].kind, "symmetry");
  EXPECT_EQ(recorder.warnings.size(), 1u);
}

// -- binary Medit

std::string gmf(std::int32_t version, bool swaps) {
  std::string bytes;
  const auto integer = [&](std::int64_t v) {
    version < 4 ? put(bytes, static_cast<std::int32_t>(v), swaps) : put(bytes, v, swaps);
  };
  const auto real = [&](double x) { version < 2 ? put(bytes, static_cast<float>(x), swaps) : put(bytes, x, swaps); };
  const auto begin = [&](std::int32_t keyword, std::size_t length) {
    const std::size_t next = bytes.size() + (version < 3 ? 8 : 12) + length;
    put(bytes, keyword, swaps);
    version < 3 ? put(bytes, static_cast<std::int32_t>(next), swaps)
                : put(bytes, static_cast<std::int64_t>(next), swaps);
  };
  const std::size_t i = version < 4 ? 4 : 8, r = version < 2 ? 4 : 8;
  put(bytes, std::int32_t{1}, swaps);
  put(bytes, version, swaps);
  begin(3, 4);
  put(bytes, std::int32_t{3}, swaps);
  begin(4, i + 4 * (3 * r + i));
  integer(4);
  for (const auto& p : {Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, .25}}) {
    for (int k = 0; k < 3; ++k) real(p[k]);
    integer(0);
  }
  begin(20, 2 * i);  // normals: jumped over
  integer(1);
  integer(77);
  begin(8, i + 5 * i);
  for (const int v : {1, 1, 2, 3, 4, 6}) integer(v);
  put(bytes, std::int32_t{54}, swaps);
  integer(0);
  return bytes;
}

TEST(Meshb, each_version_and_byte_order_is_read) {
  for (const std::int32_t version : {1, 2, 3, 4})
    for (const bool swaps : {false, true}) {
      SCOPED_TRACE(version);
      const Mesh mesh = read_bytes(read_meshb, gmf(version, swaps));
      ASSERT_EQ(mesh.points.size(), 4u);
      EXPECT_EQ(mesh.points[VertexId(3)].z, .25);
      ASSERT_EQ(mesh.num_cells(CellType::tetrahedron), 1u);
      EXPECT_TRUE(mesh.find_group(3, "region_6").is_valid());
    }
}

TEST(Meshb, what_is_wrong_is_said_with_its_place) {
  const std::string good = gmf(2, false);
  expect_mentions(refusal(read_meshb, "MeshVersionFormatted 2"), {"byte 4", "begins with the number 1"});
  for (std::size_t n = 8; n + 12 < good.size(); n += 4) EXPECT_NE(refusal(read_meshb, good.substr(0, n)), "") << n;
  std::string many = good;
  many.replace(28, 4, "\xff\xff\xff\x7f");  // the number of vertices
  expect_mentions(refusal(read_meshb, many), {"byte", "2147483647", "truncated or damaged"});
  std::string back = good;
  back.replace(24, 4, std::string("\x08\0\0\0", 4));  // the next keyword before this one
  expect_mentions(refusal(read_meshb, back), {"next one is at byte 8"});
}

TEST(Meshb, solutions_beside_it_are_read) {
  Mesh mesh = two_boxes();
  const std::filesystem::path folder = scratch_folder("io_solb");
  Context context;
  write_mesh(mesh, (folder / "a.meshb").string(), context);
  std::string bytes;
  for (const std::int32_t v : {1, 2, 3, 20, 3, 62, 0, static_cast<std::int32_t>(mesh.points.size()), 2, 1, 3})
    put(bytes, v);
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    for (int k = 0; k < 7; ++k) put(bytes, double(10 * i) + k);
  std::ofstream(folder / "a.solb", std::ios::binary) << bytes;
  const Mesh got = read_mesh((folder / "a.meshb").string(), context);
  ASSERT_EQ(got.fields.size(), 2u);
  EXPECT_EQ(got.fields[0].values[1], 10);
  EXPECT_EQ(std::vector<double>(got.fields[1].values.begin(), got.fields[1].values.begin() + 6),
            (std::vector<double>{1, 3, 6, 2, 5, 4}));  // m11 m12 m22 m13 m23 m33 -> xx yy zz xy yz xz
}

// -- Nastran

TEST(Nastran, reals_keep_ten_digits_in_sixteen_characters) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-30, 30), mantissa(-10, 10);
  for (int i = 0; i < 20000; ++i) {
    const double value = mantissa(random) * std::pow(10, std::round(exponent(random)));
    const std::string text = nastran_real(value);
    ASSERT_LE(text.size(), 16u) << text;
    ASSERT_NE(text.find('.'), std::string::npos) << text;
    const std::string line = "GRID*,1,," + text + ",0.\n*,0.\nCROD,1,1,1,1\n";
    const Mesh mesh = read_bytes(read_nastran, line);
    ASSERT_NEAR(mesh.points[VertexId(0)].x, value, 1e-10 * std::abs(value)) << text;
  }
  for (const char* text : {"0.", "1.", "0.1", "-2.5"}) EXPECT_EQ(nastran_real(std::stod(text)), text);
}

TEST(Nastran, fields_free_small_large_and_continued_are_one) {
  const std::string small =
      "BEGIN BULK\nGRID    1               0.0     0.0     0.0\nGRID    2               1.0     0.0     0.0\n"
      "GRID    3               0.0     1.0     0.0\nGRID    4               0.0     0.0     2.5-1\n"
      "CTETRA  9       5       1       2       3       4\nENDDATA\nrubbish\n";
  const std::string free =
      "grid,1,,0.,0.,0.\ngrid,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID, 4, 0, 0., 0., .25\nctetra,9,5,1,2,+\n$ "
      "between\n+,3,4\n";
  const std::string large =
      "GRID*   1                               0.0             0.0\n*       0.0\n"
      "GRID*   2                               1.0D+0          0.0\n*       0.0\n"
      "GRID*   3                               0.0             1.0\n*       0.0\n"
      "GRID*   4                               0.0             0.0\n*       2.5E-1\n"
      "CTETRA* 9               5               1               2\n*       3               4\n";
  // The free one breaks after four nodes' fields by hand; the others are whole.
  for (const std::string& text : {small, large}) {
    const Mesh mesh = read_bytes(read_nastran, text);
    ASSERT_EQ(mesh.points.size(), 4u);
    EXPECT_EQ(mesh.points[VertexId(3)].z, .25);
    EXPECT_TRUE(mesh.find_group(3, "region_5").is_valid());
  }
  EXPECT_NE(refusal(read_nastran, free), "") << "fields are eight a line, filled or not";
}

TEST(Nastran, names_of_hypermesh_ansa_femap_and_patran_are_found) {
  const std::string grid = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,1.\nCTRIA3,1,5,1,2,3\n";
  const std::pair<const char*, std::string> all[] = {
      {"the wall", "$HMNAME COMP                   5\"the wall\" 4 \"PSHELL\" 4\n" + grid},
      {"wing", "$HMNAME COMP                   5\"other\"\n$HMNAME PROP                   5\"wing\" 4\n" + grid},
      {"wing", "$ANSA_NAME_COMMENT;5;PSHELL;wing;;NO;NO;NO;NO;\n" + grid},
      {"wing", "$ANSA_NAME;5;PSHELL;~\n$wing\nPSHELL,5,1,1.\n" + grid},
      {"wing", "$ Femap with NX Nastran Property 5 : wing\n" + grid},
      {"wing", "$ Elements and Element Properties for region : wing\nPSHELL,5,1,1.\n" + grid}};
  for (const auto& [name, text] : all) {
    const Mesh mesh = read_bytes(read_nastran, text);
    EXPECT_TRUE(mesh.find_group(2, name).is_valid()) << text;
  }
}

TEST(Nastran, what_is_wrong_is_said_with_its_line) {
  expect_mentions(refusal(read_nastran, "$\nGRID,1,4,0.,0.,0.\n"), {"line 2", "coordinate system 4"});
  expect_mentions(refusal(read_nastran, "GRID,1,,0.,0.,0.\nGRID,1,,0.,0.,0.\n"), {"line 2", "twice"});
  expect_mentions(refusal(read_nastran, "GRID,1,,0.,a.,0.\n"), {"line 1", "'a.'", "field 5"});
  expect_mentions(refusal(read_nastran, "GRID,1,,0.,0.,0.\nCTRIA3,7,1,1,1,9\n"), {"element 7", "point 9"});
  expect_mentions(refusal(read_nastran, "CTRIA6,7,1,1,2,3,4,5,6\n"), {"line 1", "linear"});
  expect_mentions(refusal(read_nastran, "CTETRA,7,1,1,2,3,4,5,6\n+,7,8,9,10\n"), {"line 1", "linear"});
  expect_mentions(refusal(read_nastran, "nothing\n"), {"no elements"});
}

// -- Abaqus

TEST(Abaqus, sets_surfaces_and_continued_elements_are_read) {
  const std::string text =
      "*HEADING\n**#comment\n*Node, nset=all\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 1., 0.\n 14, 0., 0., 1.\n*ELEMENT, "
      "type=C3D4, "
      "ELSET=Solid\n7, 1, 2,\n3, 14\n*ELSET, ELSET=air, GENERATE\n1, 9, 2\n*SURFACE, NAME=floor\n7, S1\n*SURFACE, "
      "NAME=side\n"
      "Solid, S2\n*MATERIAL, NAME=x\n1., 2.\n";
  const Mesh mesh = read_bytes(read_abaqus, text);
  ASSERT_EQ(mesh.num_cells(CellType::tetrahedron), 1u);
  EXPECT_EQ(cell_group_name(mesh, *mesh.find_block(CellType::tetrahedron), 0), "air");
  ASSERT_EQ(mesh.num_cells(CellType::triangle), 2u);
  const CellBlock& faces = *mesh.find_block(CellType::triangle);
  EXPECT_EQ(cell_group_name(mesh, faces, 0), "floor");
  EXPECT_EQ(cell_group_name(mesh, faces, 1), "side");
  for (std::size_t i = 0; i < 2; ++i) {  // outward
    const Point a = mesh.points[faces[i][0]], b = mesh.points[faces[i][1]], c = mesh.points[faces[i][2]];
    EXPECT_LT(dot(cross(b - a, c - a), Point{.2, .2, .2} - a), 0);
  }
}

TEST(Abaqus, what_is_wrong_is_said_with_its_line) {
  const std::string nodes = "*NODE\n1, 0., 0.\n2, 1., 0.\n3, 0., 1.\n";
  expect_mentions(refusal(read_abaqus, nodes + "*ELEMENT, TYPE=C3D10\n"), {"line 5", "C3D10", "linear"});
  expect_mentions(refusal(read_abaqus, nodes + "*ELEMENT, TYPE=CPS3\n1, 1, 2, 3, 1\n"),
                  {"line 6", "4 nodes", "needs 3"});
  expect_mentions(refusal(read_abaqus, nodes + "*ELEMENT, TYPE=CPS3\n1, 1, 2\n"), {"element 1 has 2 nodes"});
  expect_mentions(refusal(read_abaqus, nodes + "*ELEMENT, TYPE=CPS3\n1, 1, 2, 8\n"), {"element 1", "node 8"});
  expect_mentions(refusal(read_abaqus, nodes + "3, 0., 0.\n"), {"line 5", "node 3 is there twice"});
  expect_mentions(refusal(read_abaqus, nodes + "*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n*SURFACE, NAME=a\n5, S1\n"),
                  {"line 8", "element 5"});
  expect_mentions(refusal(read_abaqus, nodes + "*INCLUDE, INPUT=a\n"), {"line 5", "INCLUDE"});
}

// -- Fluent

TEST(Fluent, is_told_from_gmsh_by_its_first_byte) {
  const Mesh mesh = mixed_cells();
  const std::string bytes = written(mesh, "a.msh", "fluent");
  EXPECT_EQ(bytes[0], '(');
  const auto path = write_text("b.msh", bytes);
  Context context;
  EXPECT_EQ(read_mesh(path.string(), context).num_cells(CellType::pyramid), 1u);
}

std::string fluent_plane(const std::string& points, const std::string& faces) {
  return "(2 2)(10 (0 1 3 0 2))\n" + points + "(12 (2 1 1 1 1))" + faces +
         "(45 (3 velocity-inlet in)())\n(39 (4 wall hot)())";
}

TEST(Fluent, text_and_binary_sections_of_the_plane_are_read_whichever_way_they_turn) {
  std::string single = "(2010 (1 1 3 1 2)(", wide = "(3010 (1 1 3 1 2)(";
  for (const double x : {0., 0., 1., 0., 0., 1.}) {
    put(single, static_cast<float>(x));
    put(wide, x);
  }
  single += ")End of Binary Section   2010)";
  wide += ")End of Binary Section   3010)";
  const std::string text = "(10 (1 1 3 1 2)(0 0\n1 0\n0 1))";
  std::string narrow_faces = "(2013 (4 1 3 3 2)(", wide_faces = "(3013 (4 1 3 3 2)(";
  for (const int v : {2, 1, 1, 0, 3, 2, 1, 0, 1, 3, 1, 0}) {
    put(narrow_faces, std::int32_t(v));
    put(wide_faces, std::int64_t(v));
  }
  narrow_faces += ")End of Binary Section   2013)";
  wide_faces += ")End of Binary Section   3013)";
  const std::string faces = "(13 (3 1 1 a 2)(\n2 1 1 0))(13 (4 2 3 3 0)(2 3 2 1 0\n2 1 3 1 0\n))";
  const std::string turned = "(13 (3 1 1 a 2)(\n1 2 1 0))(13 (4 2 3 3 0)(2 2 3 1 0\n2 3 1 1 0\n))";
  const std::string second = "(13 (4 1 3 3 2)(1 2 0 1 2 3 0 1 3 1 0 1))";  // the cell on the left alone
  for (const std::string& points : {text, single, wide})
    for (const std::string& sides : {faces, turned, narrow_faces, wide_faces, second}) {
      const Mesh mesh = read_bytes(read_fluent, fluent_plane(points, sides));
      EXPECT_EQ(mesh.dimension, 2);
      ASSERT_EQ(mesh.num_cells(CellType::triangle), 1u);
      const auto v = (*mesh.find_block(CellType::triangle))[0];
      EXPECT_GT(cross(mesh.points[v[1]] - mesh.points[v[0]], mesh.points[v[2]] - mesh.points[v[0]]).z, 0);
      EXPECT_EQ(mesh.num_cells(CellType::line), 3u);
      const GroupId hot = mesh.find_group(1, "hot");
      ASSERT_TRUE(hot.is_valid());
      EXPECT_EQ(mesh.groups[hot].kind, "wall");
    }
}

TEST(Fluent, what_is_wrong_is_said_with_its_line) {
  const std::string points = "(10 (1 1 3 1 2)(0 0\n1 0\n0 1))\n";
  expect_mentions(refusal(read_fluent, fluent_plane(points, "(13 (4 1 3 3 2)(1 2 1 0 2 9 1 0 3 1 1 0))")),
                  {"node 9", "3 points"});
  expect_mentions(refusal(read_fluent, fluent_plane(points, "(13 (4 1 2 3 2)(1 2 1 0 2 3 1 0))")),
                  {"cell 1", "no ring"});
  expect_mentions(refusal(read_fluent, fluent_plane(points, "(13 (4 1 f00 3 2)(1 2 1 0 2 3 1 0))")),
                  {"line 5", "3840", "truncated"});
  expect_mentions(refusal(read_fluent, fluent_plane(points, "(13 (4 1 2 3 2)(1 2 1 0 2 x 1 0))")), {"line 5", "'x'"});
  expect_mentions(refusal(read_fluent, "(2 3)\n(58 (1 1 1)())"), {"line 2", "hanging"});
  expect_mentions(refusal(read_fluent, "(2 3)\n(13 (4 1 2 3 2)(1"), {"line 2"});
  expect_mentions(refusal(read_fluent, "(2 3)"), {"no faces"});
}

}  // namespace
}  // namespace delfront
