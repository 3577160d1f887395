// SPDX-License-Identifier: Apache-2.0
// VTKHDF, XDMF and Exodus: what comes back, and what damaged or hostile files give. Files are made by HDF5 itself.
#if __has_include(<hdf5.h>)
#include <hdf5.h>

#include <functional>

#include "io/formats.hpp"
#include "io/hdf5/hdf5_writer.hpp"
#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;
namespace fs = std::filesystem;

Mesh with_fields() {
  Mesh mesh = mixed_cells();
  const std::size_t n = mesh.points.size();
  Field scalar{"t", Field::On::vertices, CellType::vertex, 1, {}};
  Field vector{"u v", Field::On::vertices, CellType::vertex, 3, {}};
  for (std::size_t i = 0; i < n; ++i) scalar.values.push_back(double(i) / 7);
  for (std::size_t i = 0; i < 3 * n; ++i) vector.values.push_back(1 / (double(i) + 3));
  Field on_prisms{"q", Field::On::cells, CellType::prism, 2, {}};
  for (std::size_t i = 0; i < 2 * mesh.num_cells(CellType::prism); ++i) on_prisms.values.push_back(double(i) / 3);
  mesh.fields = {scalar, vector, on_prisms};
  return mesh;
}

TEST(Hdf5Formats, fields_come_back_plain_and_compressed) {
  const fs::path folder = scratch_folder("io_hdf5");
  const Mesh mesh = with_fields();
  for (const char* name : {"a.vtkhdf", "a.hdf", "a.xdmf", "a.xmf"})
    for (const bool compress : {false, true}) {
      SCOPED_TRACE(name);
      Context context;
      const std::string path = (folder / name).string();
      EXPECT_TRUE(write_mesh(mesh, path, context, {.binary = true, .version = "", .compress = compress}).empty());
      const Mesh got = read_mesh(path, context);
      ASSERT_EQ(got.fields.size(), mesh.fields.size());
      for (const Field& want : mesh.fields) {
        const auto found = std::find_if(got.fields.begin(), got.fields.end(),
                                        [&](const Field& field) { return field.name == want.name; });
        ASSERT_NE(found, got.fields.end()) << want.name;
        EXPECT_EQ(found->on, want.on);
        EXPECT_EQ(found->block, want.block);
        EXPECT_EQ(found->components, want.components);
        EXPECT_EQ(found->values, want.values);
      }
    }
}

TEST(Hdf5Formats, the_same_mesh_gives_the_same_bytes_a_second_later) {
  const fs::path folder = scratch_folder("io_hdf5_same");
  Context context;
  for (const char* name : {"a.vtkhdf", "a.xdmf", "a.e"})
    for (const char* part : {"one", "two"}) {
      fs::create_directories(folder / part);
      write_mesh(with_fields(), (folder / part / name).string(), context);
    }
  for (const char* name : {"a.vtkhdf", "a.xdmf", "a.h5", "a.e"})
    EXPECT_EQ(contents(folder / "one" / name), contents(folder / "two" / name)) << name;
  // HDF5 keeps times in seconds: nothing of the clock may stand in the files.
  const std::string bytes = contents(folder / "one" / "a.vtkhdf");
  const auto now = static_cast<std::uint32_t>(std::time(nullptr));
  for (std::uint32_t second = now - 3; second <= now; ++second)
    EXPECT_EQ(bytes.find(std::string(reinterpret_cast<const char*>(&second), 4)), std::string::npos);
}

TEST(Hdf5Formats, names_with_a_slash_are_changed_and_said) {
  Mesh mesh = two_boxes();
  mesh.groups[GroupId(0)].name = "wing/upper";
  mesh.fields.push_back(
      {"a/b", Field::On::vertices, CellType::vertex, 1, std::vector<double>(mesh.points.size(), 0.5)});
  Context context;
  const std::string path = (scratch_folder("io_hdf5_names") / "a.vtkhdf").string();
  const std::vector<std::string> notes = write_mesh(mesh, path, context);
  ASSERT_EQ(notes.size(), 2u);
  expect_mentions(notes[0], {"wing/upper", "wing_upper"});
  expect_mentions(notes[1], {"a/b", "a_b"});
  EXPECT_TRUE(read_mesh(path, context).find_group(3, "wing_upper").is_valid());
}

TEST(Hdf5Formats, polyhedra_and_polygons_go_through_xdmf_and_vtkhdf_says_that_it_has_none) {
  Mesh mesh;
  for (const Point& p : {Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}, Point{1, 1, 0}})
    mesh.points.push_back(p);
  const auto v = [](std::size_t i) { return VertexId(i); };
  add_cell(mesh, CellType::polygon, std::array{v(0), v(1), v(4), v(2), v(3)}, mesh.add_group(2, "side"));
  Context context;
  const fs::path folder = scratch_folder("io_hdf5_general");
  for (const char* name : {"a.vtkhdf", "a.xdmf"}) {
    write_mesh(mesh, (folder / name).string(), context);
    const Mesh got = read_mesh((folder / name).string(), context);
    EXPECT_EQ(got.find_block(CellType::polygon)->vertices, mesh.find_block(CellType::polygon)->vertices);
  }
  add_cell(
      mesh, CellType::polyhedron,
      std::array{v(4), v(3), v(0), v(2), v(1), v(3), v(0), v(1), v(3), v(3), v(1), v(2), v(3), v(3), v(2), v(0), v(3)},
      mesh.add_group(3, "cell"));
  write_mesh(mesh, (folder / "a.xdmf").string(), context);
  const Mesh got = read_mesh((folder / "a.xdmf").string(), context);
  EXPECT_EQ(got.find_block(CellType::polyhedron)->vertices, mesh.find_block(CellType::polyhedron)->vertices);
  try {
    write_mesh(mesh, (folder / "b.vtkhdf").string(), context);
    FAIL() << "polyhedra in VTKHDF";
  } catch (const InputError& error) {
    expect_mentions(error.what(), {"1 polyhedra", "VTU"});
  }
  EXPECT_FALSE(fs::exists(folder / "b.vtkhdf"));
}

/// What a hand-made VTKHDF of one triangle holds; each test changes a part.
struct Parts {
  std::vector<std::int64_t> version = {2, 0}, num_points = {3}, num_cells = {1}, num_corners = {3};
  std::vector<std::int64_t> types = {5}, offsets = {0, 3}, corners = {0, 1, 2};
  std::vector<double> points = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::string type = "UnstructuredGrid", leave_out;
  std::function<void(hid_t)> also = {};  ///< with the open file
};

std::string write_parts(const Parts& parts) {
  const std::string path = (scratch_folder("io_hdf5_parts") / "a.vtkhdf").string();
  const Hdf5Turn turn;
  {
    Hdf5Writer file(path, path, false);
    file.add_group("/VTKHDF");
    file.add_attribute("/VTKHDF", "Version", parts.version);
    file.add_attribute("/VTKHDF", "Type", parts.type);
    const auto add = [&](const char* name, const auto& values) {
      using Value = typename std::decay_t<decltype(values)>::value_type;
      if (parts.leave_out != name) file.add<Value>(std::string("/VTKHDF/") + name, values);
    };
    add("NumberOfPoints", parts.num_points);
    add("NumberOfCells", parts.num_cells);
    add("NumberOfConnectivityIds", parts.num_corners);
    add("Types", parts.types);
    add("Offsets", parts.offsets);
    add("Connectivity", parts.corners);
    add("Points", parts.points);
    file.close();
  }
  if (parts.also) {
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    parts.also(file);
  }
  return path;
}

template <class Change>
std::string message_of(Change&& change) {
  Parts parts;
  change(parts);
  return message_of_reading<InputError>(write_parts(parts));
}

TEST(Hdf5Formats, vtkhdf_by_hand_is_read) {
  Context context;
  EXPECT_EQ(read_mesh(write_parts({}), context).num_cells(CellType::triangle), 1u);
  Parts two;  // two partitions, corners count within each
  two.num_points = {3, 3};
  two.num_cells = {1, 1};
  two.num_corners = {3, 3};
  two.types = {5, 5};
  two.offsets = {0, 3, 0, 3};
  two.corners = {0, 1, 2, 2, 1, 0};
  two.points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 5, 1, 0, 5, 0, 1, 5};
  const Mesh got = read_mesh(write_parts(two), context);
  ASSERT_EQ(got.num_cells(CellType::triangle), 2u);
  EXPECT_EQ((*got.find_block(CellType::triangle))[1][0], VertexId(5));
}

TEST(Hdf5Formats, vtkhdf_says_what_is_wrong_and_where) {
  expect_mentions(message_of([](Parts& p) { p.version = {3, 0}; }), {"/VTKHDF", "version 3.0"});
  expect_mentions(message_of([](Parts& p) { p.type = "PolyData"; }), {"PolyData"});
  expect_mentions(message_of([](Parts& p) {
                    p.corners = {0, 1, 3};
                  }),
                  {"/VTKHDF/Connectivity", "vertex 3", "3 points"});
  expect_mentions(message_of([](Parts& p) { p.corners = {0, 1, -1}; }), {"vertex -1"});
  expect_mentions(message_of([](Parts& p) { p.offsets = {0, 4}; }), {"/VTKHDF/Offsets", "corners 0 to 4"});
  expect_mentions(message_of([](Parts& p) { p.offsets = {2, 1}; }), {"/VTKHDF/Offsets"});
  expect_mentions(message_of([](Parts& p) { p.types = {10}; }), {"tetrahedron with 3"});
  expect_mentions(message_of([](Parts& p) { p.types = {22}; }), {"VTK type 22", "linear"});
  expect_mentions(message_of([](Parts& p) { p.types = {42}; }), {"polyhedra", "VTU"});
  expect_mentions(message_of([](Parts& p) { p.num_points = {4}; }), {"/VTKHDF/Points", "12 numbers", "9 are there"});
  expect_mentions(message_of([](Parts& p) { p.num_cells = {std::int64_t{1} << 41}; }), {"/VTKHDF/Types"});
  expect_mentions(message_of([](Parts& p) { p.num_cells = {std::int64_t{1} << 60}; }), {"NumberOfCells", "cannot be"});
  expect_mentions(message_of([](Parts& p) { p.num_points = {-3}; }), {"NumberOfPoints", "-3"});
  expect_mentions(message_of([](Parts& p) { p.num_corners = {3, 0}; }), {"partitions"});
  for (const char* name : {"NumberOfCells", "Types", "Offsets", "Points"})
    expect_mentions(message_of([&](Parts& p) { p.leave_out = name; }), {name, "not there"});
}

/// In place of the points.
template <class Make>
std::string message_with_points(Make&& make) {
  return message_of([&](Parts& parts) {
    parts.leave_out = "Points";
    parts.also = make;
  });
}

TEST(Hdf5Formats, nothing_outside_the_file_is_opened_and_no_size_is_believed) {
  const std::string other = (scratch_folder("io_hdf5_other") / "other.h5").string();
  {
    const Hdf5Turn turn;
    Hdf5Writer file(other, other, false);
    const std::vector<double> points = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    file.add<double>("/Points", points, 3);
    file.close();
  }
  const char* const name = "/VTKHDF/Points";
  expect_mentions(message_with_points([&](hid_t file) {
                    H5Lcreate_external(other.c_str(), "/Points", file, name, H5P_DEFAULT, H5P_DEFAULT);
                  }),
                  {name, "links to other files"});
  expect_mentions(message_with_points([&](hid_t file) {  // the same by a detour
                    H5Lcreate_external(other.c_str(), "/", file, "/there", H5P_DEFAULT, H5P_DEFAULT);
                    H5Lcreate_soft("/there/Points", file, name, H5P_DEFAULT, H5P_DEFAULT);
                  }),
                  {name, "links to other files"});
  expect_mentions(message_with_points([&](hid_t file) {
                    H5Lcreate_soft("/VTKHDF/Ring", file, name, H5P_DEFAULT, H5P_DEFAULT);
                    H5Lcreate_soft(name, file, "/VTKHDF/Ring", H5P_DEFAULT, H5P_DEFAULT);
                  }),
                  {name, "not there"});
  expect_mentions(
      message_with_points([&](hid_t file) { H5Lcreate_hard(file, "/VTKHDF", file, name, H5P_DEFAULT, H5P_DEFAULT); }),
      {name, "array"});
  const auto make = [&](hid_t file, hid_t type, std::vector<hsize_t> extents, const std::function<void(hid_t)>& how) {
    const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    how(creation);
    const Hdf5Handle space(H5Screate_simple(int(extents.size()), extents.data(), nullptr), H5Sclose);
    const Hdf5Handle array(H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
  };
  const hsize_t huge = hsize_t{1} << 40;
  expect_mentions(message_with_points([&](hid_t file) {  // never written: nothing is stored
                    make(file, H5T_NATIVE_DOUBLE, {huge, 3}, [](hid_t) {});
                  }),
                  {name, "0 bytes are stored"});
  expect_mentions(message_with_points([&](hid_t file) {
                    make(file, H5T_NATIVE_DOUBLE, {huge, huge}, [](hid_t) {});
                  }),
                  {name, "size cannot be"});
  expect_mentions(
      message_with_points([&](hid_t file) {
        make(file, H5T_NATIVE_DOUBLE, {3, 3}, [&](hid_t creation) { H5Pset_external(creation, other.c_str(), 0, 72); });
      }),
      {name, "another file"});
  expect_mentions(message_with_points([&](hid_t file) {
                    make(file, H5T_NATIVE_DOUBLE, {3, 3}, [&](hid_t creation) {
                      const hsize_t chunk[] = {3, 3};
                      H5Pset_chunk(creation, 2, chunk);
                      H5Pset_scaleoffset(creation, H5Z_SO_FLOAT_DSCALE, 2);
                    });
                  }),
                  {name, "compressed by filter", "h5repack"});
  expect_mentions(message_with_points([&](hid_t file) {
                    make(file, H5T_STD_REF_OBJ, {3, 3}, [](hid_t) {});
                  }),
                  {name, "type that is not read"});
  expect_mentions(message_with_points([&](hid_t file) {
                    const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
                    H5Tset_size(type, 8);
                    make(file, type, {3, 3}, [](hid_t creation) { H5Pset_layout(creation, H5D_COMPACT); });
                  }),
                  {name, "text where numbers"});
}

TEST(Hdf5Formats, cut_and_foreign_files_are_refused) {
  Context context;
  const fs::path folder = scratch_folder("io_hdf5_cut");
  write_mesh(two_boxes(), (folder / "a.vtkhdf").string(), context);
  write_mesh(two_boxes(), (folder / "a.xdmf").string(), context);
  write_mesh(two_boxes(), (folder / "a.e").string(), context);
  for (const auto& [cut, read] : {std::pair("a.vtkhdf", "a.vtkhdf"), std::pair("a.h5", "a.xdmf"),
                                  std::pair("a.e", "a.e"), std::pair("a.xdmf", "a.xdmf")}) {
    const std::string whole = contents(folder / cut);
    std::size_t errors = 0, tried = 0;
    for (std::size_t size = 1; size + 40 < whole.size(); size += 1 + whole.size() / 97) {
      std::ofstream(folder / cut, std::ios::binary | std::ios::trunc) << whole.substr(0, size);
      ++tried;
      try {
        read_mesh((folder / read).string(), context);
      } catch (const InputError&) {
        ++errors;
      }
    }
    EXPECT_EQ(errors, tried) << cut;
    std::ofstream(folder / cut, std::ios::binary | std::ios::trunc) << whole;
  }
  fs::copy_file(folder / "a.xdmf", folder / "b.vtkhdf");
  expect_mentions(message_of_reading<InputError>(folder / "b.vtkhdf"), {"no HDF5 file"});
  fs::copy_file(folder / "a.h5", folder / "c.vtkhdf");
  expect_mentions(message_of_reading<InputError>(folder / "c.vtkhdf"), {"/VTKHDF", "no VTKHDF"});
  fs::remove(folder / "a.h5");
  expect_mentions(message_of_reading<InputError>(folder / "a.xdmf"), {"a.h5", "No such file"});
}

std::string xdmf(const std::string& topology, const std::string& more = "", const std::string& geometry = "XY",
                 const std::string& points = "0 0 1 0 1 1 0 1") {
  return "<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\"><Domain><Grid>\n"
         "<Geometry GeometryType=\"" +
         geometry + "\"><DataItem Format=\"XML\">" + points + "</DataItem></Geometry>\n" + topology + more +
         "</Grid></Domain></Xdmf>\n";
}

const char* const kMixed =
    "<Topology TopologyType=\"Mixed\"><DataItem Dimensions=\"11\">4 0 1 2 2 2 0 1 1 1 3"
    "</DataItem></Topology>";

TEST(Xdmf, data_in_the_xml_are_read) {
  Context context;
  const std::string names =
      "<Information Name=\"I\"><![CDATA[<main><map key=\"patch:a&amp;b\" dim=\"1\" kind=\"wall\">7</map></main>]]>"
      "</Information>";
  const std::string ids =
      "<Attribute Name=\"patch_id\" Center=\"Cell\"><DataItem>-1 7 -1</DataItem></Attribute>"
      "<Attribute Name=\"t\" Center=\"Node\"><DataItem>1 2 3 4</DataItem></Attribute>";
  const Mesh mesh = read_mesh(write_text("a.xmf", xdmf(kMixed, names + ids)), context);
  EXPECT_EQ(mesh.dimension, 2);
  EXPECT_EQ(mesh.num_cells(CellType::triangle), 1u);
  EXPECT_EQ(mesh.num_cells(CellType::line), 1u);
  EXPECT_EQ(mesh.num_cells(CellType::vertex), 1u);
  const GroupId group = mesh.find_group(1, "a&b");
  ASSERT_TRUE(group.is_valid());
  EXPECT_EQ(mesh.groups[group].kind, "wall");
  EXPECT_EQ(mesh.find_block(CellType::line)->group[0], group);
  ASSERT_EQ(mesh.fields.size(), 1u);
  const std::string collection =
      "<Xdmf Version=\"3.0\"><Domain><Grid GridType=\"Collection\" CollectionType=\"Spatial\"><Grid><Geometry "
      "Type=\"XYZ\">"
      "<DataItem>0 0 0 1 0 0 0 1 5</DataItem></Geometry><Topology Type=\"triangle\" NumberOfElements=\"1\"><DataItem>0 "
      "1 2"
      "</DataItem></Topology></Grid><Grid><Geometry><DataItem>0 0 0 1 0 0</DataItem></Geometry><Topology "
      "TopologyType=\"Polyline\" NodesPerElement=\"2\"><DataItem>0 "
      "1</DataItem></Topology></Grid></Grid></Domain></Xdmf>";
  const Mesh both = read_mesh(write_text("b.xdmf", collection), context);
  EXPECT_EQ(both.points.size(), 5u);
  EXPECT_EQ((*both.find_block(CellType::line))[0][1], VertexId(4));
}

TEST(Xdmf, what_is_wrong_is_said_with_its_line) {
  const auto message = [](const std::string& text) {
    return message_of_reading<InputError>(write_text("a.xdmf", text));
  };
  const auto topology = [](const std::string& type, const std::string& item) {
    return "<Topology " + type + ">" + item + "</Topology>";
  };
  const auto of = [&](const std::string& type, const std::string& numbers) {
    return message(xdmf(topology("TopologyType=\"" + type + "\"", "<DataItem>" + numbers + "</DataItem>")));
  };
  expect_mentions(of("Mixed", "4 0 1"), {"line 5", "ends within cell 0"});
  expect_mentions(of("Mixed", "4 0 1 9"), {"vertex 9", "4 points"});
  expect_mentions(of("Mixed", "36 0 1 2 0 1 2"), {"type 36"});
  expect_mentions(of("Mixed", "3 99999999999 0 1"), {"ends within cell 0"});
  expect_mentions(of("Mixed", "16 4 3 0 1 2 3"), {"ends within polyhedron 0"});
  expect_mentions(of("Mixed", "16 9223372036854775807 3 0 1 2"), {"ends within polyhedron 0"});
  expect_mentions(of("Triangle_6", "0 1 2 0 1 2"), {"Triangle_6", "linear"});
  expect_mentions(of("Triangle", "0 1 2 0"), {"4 numbers are no cells of 3"});
  expect_mentions(of("Triangle", "0 1 x"), {"'x' is no number"});
  expect_mentions(message(xdmf(topology("TopologyType=\"Polygon\"", "<DataItem>0 1 2</DataItem>"))), {"no cells of 0"});
  expect_mentions(message(xdmf(topology("Type=\"Triangle\" NumberOfElements=\"2\"", "<DataItem>0 1 2</DataItem>"))),
                  {"2 cells are announced, 1"});
  expect_mentions(message(xdmf(topology("Type=\"Triangle\"", "<DataItem Dimensions=\"2 3\">0 1 2</DataItem>"))),
                  {"3 values", "2 3"});
  expect_mentions(message(xdmf(topology("Type=\"Triangle\"", ""))), {"<DataItem> is missing"});
  expect_mentions(message(xdmf(topology("Type=\"Triangle\"", "<DataItem Reference=\"XML\">/Xdmf</DataItem>"))),
                  {"references are not followed"});
  expect_mentions(message(xdmf(topology("Type=\"Triangle\"", "<DataItem Format=\"Binary\">a.bin</DataItem>"))),
                  {"Binary"});
  expect_mentions(message(xdmf(topology("Type=\"Triangle\"", "<DataItem ItemType=\"HyperSlab\"></DataItem>"))),
                  {"HyperSlab"});
  expect_mentions(message(xdmf(topology("Type=\"Triangle\"", "<DataItem Format=\"HDF\">a.h5</DataItem>"))),
                  {"NAME.h5"});
  expect_mentions(message(xdmf(topology("Type=\"Triangle\"", "<DataItem Format=\"HDF\">gone.h5:/a</DataItem>"))),
                  {"gone.h5", "No such file"});
  expect_mentions(
      message(xdmf(kMixed, "<Attribute Name=\"t\" Center=\"Node\"><DataItem>1 2 3 4 5</DataItem></Attribute>")),
      {"'t'", "5 numbers for 4"});
  expect_mentions(message(xdmf(kMixed, "", "XYZ")), {"8 numbers are no points in space"});
  expect_mentions(message(xdmf(kMixed, "", "VXVYVZ")), {"VXVYVZ"});
  expect_mentions(message(xdmf(kMixed, "", "XY", "0 0 nan 0 1 1 0 1")), {"not finite"});
  expect_mentions(
      message("<Xdmf><Domain><Grid GridType=\"Collection\" CollectionType=\"Temporal\"><Grid/><Grid/></Grid>"
              "</Domain></Xdmf>"),
      {"2 time steps"});
  expect_mentions(message("<Xdmf><Domain/></Xdmf>"), {"no cells"});
  expect_mentions(message("<VTKFile/>"), {"no XDMF"});
}

TEST(Exodus, damage_is_named_with_its_variable) {
  Context context;
  const fs::path path = scratch_folder("io_exodus") / "a.e";
  write_mesh(mixed_cells(), path.string(), context);
  const std::string whole = contents(path);
  const auto offset_of = [&](const std::string& variable) {  // of its values: the last number of its entry
    const auto be32 = [&](std::size_t at) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(whole[at + i]);
      return value;
    };
    std::size_t at = 0;
    for (at = whole.find(variable); be32(at - 4) != variable.size(); at = whole.find(variable, at + 1)) {
    }
    at += (variable.size() + 3) / 4 * 4;
    at += 4 + 4 * be32(at);  // dimensions
    const std::uint32_t num_attributes = be32(at + 4);
    at += 8;
    for (std::uint32_t i = 0; i < num_attributes; ++i) {
      at += 4 + (be32(at) + 3) / 4 * 4;
      at += 8 + (be32(at + 4) + 3) / 4 * 4;  // of text
    }
    return std::size_t{be32(at + 12)};
  };
  const auto message = [&](const std::string& variable, std::uint32_t value) {
    std::string bytes = whole;
    const std::size_t at = offset_of(variable);
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (8 * (3 - i)));
    std::ofstream(path, std::ios::binary) << bytes;
    return message_of_reading<InputError>(path);
  };
  expect_mentions(message("connect1", 0), {"connect1", "element 1 has the node 0"});
  expect_mentions(message("connect1", 1000), {"connect1", "node 1000"});
  expect_mentions(message("elem_ss1", 0), {"elem_ss1", "element 0"});
  expect_mentions(message("elem_ss1", 77), {"elem_ss1", "element 77"});
  expect_mentions(message("side_ss1", 9), {"elem_ss1", "number 9 of a"});
  expect_mentions(message("coordx", 0x7ff80000), {"not finite"});
  std::ofstream(path, std::ios::binary) << std::string("CDF\1\0\0\0\0", 8);
  expect_mentions(message_of_reading<InputError>(path), {"truncated"});
  std::ofstream(path, std::ios::binary) << "something else";
  expect_mentions(message_of_reading<InputError>(path), {"no netCDF"});
}

TEST(Exodus, blocks_and_sets_keep_long_names_and_empty_groups) {
  Mesh mesh = two_boxes();
  const std::string name(100, 'n');
  mesh.groups[GroupId(0)].name = name;
  mesh.add_group(2, "nothing", "wall");
  Context context;
  const std::string path = (scratch_folder("io_exodus") / "a.exo").string();
  EXPECT_TRUE(write_mesh(mesh, path, context).empty());
  const Mesh got = read_mesh(path, context);
  EXPECT_TRUE(got.find_group(3, name).is_valid());
  const GroupId empty = got.find_group(2, "nothing");
  ASSERT_TRUE(empty.is_valid());
  EXPECT_EQ(got.groups[empty].kind, "wall");
}

}  // namespace
}  // namespace delfront
#endif
