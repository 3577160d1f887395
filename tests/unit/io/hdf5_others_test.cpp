// SPDX-License-Identifier: Apache-2.0
// XDMF, VTKHDF and Exodus that other programs made, changed or moved: what is refused, what is said.
#if __has_include(<hdf5.h>)
#include <hdf5.h>

#include <cmath>
#include <functional>

#include "io/hdf5/hdf5_writer.hpp"
#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;
namespace fs = std::filesystem;

TEST(Xdmf, any_name_of_a_file_finds_its_arrays) {
  const fs::path folder = scratch_folder("io_xdmf_names");
  Context context;
  for (const char* name : {"R&D.xdmf", "a<b>\"c\"'d'.xdmf", " lead.xdmf", "trail .xdmf", "\ttab.xmf", "&amp;.xdmf",
                           "a:b.xdmf", "new\nline.xdmf"}) {
    SCOPED_TRACE(name);
    write_mesh(two_boxes(), (folder / name).string(), context);
    expect_same(read_mesh((folder / name).string(), context), two_boxes());
  }
  fs::rename(folder / "R&D.h5", folder / "R'D.h5");
  std::string text = contents(folder / "R&D.xdmf");
  for (std::size_t at = text.find("&amp;"); at != std::string::npos; at = text.find("&amp;"))
    text.replace(at, 5, "&#x27;");
  std::ofstream(folder / "other.xdmf", std::ios::binary) << text;
  expect_same(read_mesh((folder / "other.xdmf").string(), context), two_boxes());
}

std::string xdmf_of(const std::string& points, const std::string& corners, const std::string& geometry = "XYZ") {
  return "<Xdmf Version=\"3.0\"><Domain><Grid>\n<Geometry GeometryType=\"" + geometry + "\">" + points +
         "</Geometry>\n<Topology TopologyType=\"Triangle\"><DataItem>" + corners +
         "</DataItem></Topology></Grid></Domain></Xdmf>\n";
}
const char* const kThreePoints = "<DataItem Dimensions=\"3 3\">0 0 0 1 0 0 0 1 0</DataItem>";

TEST(Xdmf, corners_that_are_no_whole_numbers_are_refused) {
  Context context;
  const auto message = [](const std::string& corners) {
    return message_of_reading<InputError>(write_text("fraction.xdmf", xdmf_of(kThreePoints, corners)));
  };
  expect_mentions(message("0 1 1.7"), {"line 3", "'1.7'", "no whole number"});
  expect_mentions(message("0 1 nan"), {"'nan'", "no whole number"});
  expect_mentions(message("0 1 1e300"), {"'1e300'", "no whole number"});
  EXPECT_EQ(
      read_mesh(write_text("whole.xdmf", xdmf_of(kThreePoints, "0 1.0 2e0")), context).num_cells(CellType::triangle),
      1u);
}

TEST(Xdmf, points_in_the_plane_have_two_numbers_and_those_in_space_three) {
  const auto message = [](const std::string& points, const std::string& type) {
    return message_of_reading<InputError>(write_text("extents.xdmf", xdmf_of(points, "0 1 2", type)));
  };
  const std::string six = "<DataItem Dimensions=\"2 3\">0 0 0 1 0 0</DataItem>";
  expect_mentions(message(six, "XY"), {"line 2", "XY", "2 3"});
  expect_mentions(message("<DataItem Dimensions=\"3 2\">0 0 1 0 1 1</DataItem>", "XYZ"), {"line 2", "XYZ", "3 2"});
}

/// A triangle as VTKHDF, whose arrays of whole numbers may hold anything.
struct Triangle {
  std::vector<double> types = {5}, offsets = {0, 3}, corners = {0, 1, 2};
  std::vector<double> ids = {0};                   ///< patch_id
  std::vector<double> name = {0, 3};               ///< number and dimension of "region:air", which no cell has
  std::function<void(hid_t)> also = [](hid_t) {};  ///< with the open file
};

std::string write_triangle(const Triangle& parts) {
  const std::string path = (scratch_folder("io_hdf5_triangle") / "a.vtkhdf").string();
  const Hdf5Turn turn;
  {
    Hdf5Writer file(path, path, false);
    const std::vector<std::int64_t> version = {2, 0}, three = {3}, one = {1};
    for (const char* group : {"/VTKHDF", "/VTKHDF/CellData", "/VTKHDF/FieldData"}) file.add_group(group);
    file.add_attribute("/VTKHDF", "Version", version);
    file.add_attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
    file.add<std::int64_t>("/VTKHDF/NumberOfPoints", three);
    file.add<std::int64_t>("/VTKHDF/NumberOfCells", one);
    file.add<std::int64_t>("/VTKHDF/NumberOfConnectivityIds", three);
    const std::vector<double> points = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    file.add<double>("/VTKHDF/Points", points, 3);
    file.add<double>("/VTKHDF/Types", parts.types);
    file.add<double>("/VTKHDF/Offsets", parts.offsets);
    file.add<double>("/VTKHDF/Connectivity", parts.corners);
    file.add<double>("/VTKHDF/CellData/region_id", parts.ids);
    file.add<double>("/VTKHDF/CellData/patch_id", parts.ids);
    file.add<double>("/VTKHDF/FieldData/region:air", parts.name);
    file.close();
  }
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  parts.also(file);
  return path;
}

TEST(Hdf5Formats, arrays_of_whole_numbers_hold_no_fractions) {
  Context context;
  EXPECT_EQ(read_mesh(write_triangle({}), context).num_cells(CellType::triangle), 1u);
  const auto message = [](Triangle parts) { return message_of_reading<InputError>(write_triangle(parts)); };
  Triangle corners, offsets, types;
  corners.corners = {0, 1, 1.5};
  offsets.offsets = {0, 3.25};
  types.types = {std::nan("")};
  expect_mentions(message(corners), {"/VTKHDF/Connectivity", "1.5", "whole number", "value 2"});
  expect_mentions(message(offsets), {"/VTKHDF/Offsets", "3.25", "whole number"});
  expect_mentions(message(types), {"/VTKHDF/Types", "nan", "whole number"});
}

std::vector<std::string> warnings_of(const std::string& path) {
  Recorder recorder;
  read_mesh(path, recorder.context);
  return recorder.warnings;
}

TEST(Hdf5Formats, group_numbers_that_cannot_be_used_are_said) {
  for (const auto& [value, shown] :
       {std::pair(std::nan(""), "nan"), {0.5, "0.5"}, {-7.0, "-7"}, {3e9, "3000000000"}, {1e300, "1e+300"}}) {
    Triangle parts;
    parts.ids = {value};
    const std::vector<std::string> warnings = warnings_of(write_triangle(parts));
    ASSERT_EQ(warnings.size(), 1u) << shown;
    expect_mentions(warnings[0], {"a.vtkhdf", "_id", "1 cells", shown});
  }
  Triangle none;
  none.ids = {-1};
  EXPECT_TRUE(warnings_of(write_triangle(none)).empty());
  Triangle two;
  two.ids = {0, 0};
  two.also = [](hid_t file) {
    for (const char* name : {"/VTKHDF/CellData/region_id", "/VTKHDF/CellData/patch_id"}) {
      H5Ldelete(file, name, H5P_DEFAULT);
      const hsize_t extents[] = {1, 2};
      const Hdf5Handle space(H5Screate_simple(2, extents, nullptr), H5Sclose);
      const Hdf5Handle array(H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                             H5Dclose);
      const double values[] = {0, 0};
      H5Dwrite(array, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    }
  };
  const std::vector<std::string> of_two = warnings_of(write_triangle(two));
  ASSERT_EQ(of_two.size(), 1u);
  expect_mentions(of_two[0], {"_id", "2 components"});
  Triangle text;
  text.also = [](hid_t file) {
    for (const char* name : {"/VTKHDF/CellData/region_id", "/VTKHDF/CellData/patch_id"}) {
      H5Ldelete(file, name, H5P_DEFAULT);
      const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
      const Hdf5Handle array(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
      H5Dwrite(array, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, "x");
    }
  };
  const std::vector<std::string> of_text = warnings_of(write_triangle(text));
  ASSERT_EQ(of_text.size(), 2u);
  expect_mentions(of_text[0], {"region_id", "text"});
}

TEST(Hdf5Formats, names_of_groups_that_cannot_be_used_are_said) {
  for (const std::vector<double>& bad : {std::vector<double>{0, 9}, {-3, 3}, {0.5, 3}, {0}, {std::nan(""), 3}}) {
    Triangle parts;
    parts.name = bad;
    const std::vector<std::string> warnings = warnings_of(write_triangle(parts));
    ASSERT_EQ(warnings.size(), 1u);
    expect_mentions(warnings[0], {"a.vtkhdf", "region:air", "left out"});
  }
  Triangle twice;
  twice.also = [](hid_t file) {
    H5Lcreate_hard(file, "/VTKHDF/FieldData/region:air", file, "/VTKHDF/FieldData/region:water", H5P_DEFAULT,
                   H5P_DEFAULT);
  };
  const std::vector<std::string> warnings = warnings_of(write_triangle(twice));
  ASSERT_EQ(warnings.size(), 1u);
  expect_mentions(warnings[0], {"region:air", "region:water", "number 0"});
  const std::string information =
      "<Information Name=\"I\"><![CDATA[<main><map key=\"patch:a\" dim=\"2\">99999999999999999999</map></main>]]>"
      "</Information></Grid>";
  std::string text = xdmf_of(kThreePoints, "0 1 2");
  text.replace(text.find("</Grid>"), 7, information);
  const std::vector<std::string> of_xdmf = warnings_of(write_text("names.xdmf", text));
  ASSERT_EQ(of_xdmf.size(), 1u);
  expect_mentions(of_xdmf[0], {"patch:a", "left out"});
  const std::string vtu =
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><FieldData><DataArray type=\"Int32\" Name=\"patch:a\" "
      "NumberOfTuples=\"3\" format=\"ascii\">0 2 5</DataArray></FieldData><Piece NumberOfPoints=\"3\" "
      "NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 "
      "1 "
      "0</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray><DataArray type=\"UInt8\" "
      "Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
  const std::vector<std::string> of_vtu = warnings_of(write_text("names.vtu", vtu));
  ASSERT_EQ(of_vtu.size(), 1u);
  expect_mentions(of_vtu[0], {"patch:a", "left out"});
}

TEST(Hdf5Formats, groups_and_data_in_another_file_are_refused) {
  for (const char* name :
       {"/VTKHDF/CellData/patch_id", "/VTKHDF/FieldData/region:air", "/VTKHDF/CellData", "/VTKHDF/FieldData"}) {
    Triangle parts;
    parts.also = [&](hid_t file) {
      H5Ldelete(file, name, H5P_DEFAULT);
      H5Lcreate_external("other.h5", "/x", file, name, H5P_DEFAULT, H5P_DEFAULT);
    };
    expect_mentions(message_of_reading<InputError>(write_triangle(parts)), {name, "links to other files"});
  }
}

/// two_boxes() as Exodus with some bytes replaced, all of the same length: in every place, or in the first.
std::string changed_exodus(const std::string& from, const std::string& to, bool everywhere = false) {
  const fs::path path = scratch_folder("io_exodus_changed") / "a.e";
  Context context;
  write_mesh(two_boxes(), path.string(), context);
  std::string bytes = contents(path);
  std::size_t at = bytes.find(from), num_changed = 0;
  for (; at != std::string::npos && (everywhere || num_changed == 0); at = bytes.find(from, at + 1), ++num_changed)
    bytes.replace(at, to.size(), to);
  EXPECT_GT(num_changed, 0u);
  std::ofstream(path, std::ios::binary) << bytes;
  return path.string();
}

/// The kind of the patch of that name, "two-sided" behind it; "(none)" where there is no such patch with faces.
std::string patch_of(const Mesh& mesh, const std::string& name) {
  const GroupId found = mesh.find_group(2, name);
  const CellBlock* faces = mesh.find_block(CellType::triangle);
  if (!found.is_valid() || std::find(faces->group.begin(), faces->group.end(), found) == faces->group.end())
    return "(none)";
  return mesh.groups[found].kind + (mesh.groups[found].two_sided ? " two-sided" : "");
}

TEST(Exodus, the_tables_of_the_file_stand_above_what_the_attribute_notes) {
  const auto expect_patches = [](const std::string& path, const std::vector<std::pair<std::string, std::string>>& want,
                                 const std::string& warned) {
    SCOPED_TRACE(warned);
    Recorder recorder;
    const Mesh mesh = read_mesh(path, recorder.context);
    for (const auto& [name, kind] : want) EXPECT_EQ(patch_of(mesh, name), kind) << name;
    ASSERT_EQ(recorder.warnings.size(), warned.empty() ? 0u : 1u);
    if (!warned.empty()) expect_mentions(recorder.warnings[0], {"a.e", "delfront_groups", warned});
  };
  const auto set_3 = std::string("#delfront 2 3 2 interface between");
  expect_patches(changed_exodus("wall left wall", "wall left wall"),
                 {{"left wall", "wall"}, {"rest", ""}, {"between", "interface two-sided"}}, "");
  // Renamed in the attribute: what a file is like whose side set another program named.
  expect_patches(changed_exodus("wall left wall", "wall left wing"),
                 {{"left wall", ""}, {"rest", ""}, {"between", "interface two-sided"}}, "left wing");
  expect_patches(changed_exodus(set_3, "#delfront 2 9 2 interface between"),
                 {{"left wall", "wall"}, {"rest", ""}, {"between", " two-sided"}}, "between");
  expect_patches(changed_exodus(set_3, "#delfront x 3 2 interface between"),
                 {{"left wall", "wall"}, {"rest", ""}, {"between", " two-sided"}}, "1 line");
  expect_patches(changed_exodus("#delfront 3 2", "#delfront 7 2"), {{"left wall", "wall"}, {"rest", ""}}, "1 line");
  const std::string without_names = changed_exodus("ss_names", "ss_namez");
  expect_patches(without_names, {{"patch_1", ""}, {"patch_2", ""}, {"patch_3", " two-sided"}}, "left wall");
  Context context;
  EXPECT_TRUE(read_mesh(changed_exodus("eb_names", "eb_namez"), context).find_group(3, "region_2").is_valid());
}

TEST(Exodus, cells_without_a_group_stay_so) {
  Mesh mesh = two_boxes();
  for (const CellType type : {CellType::tetrahedron, CellType::triangle})
    for (std::size_t cell = 0; cell < 2; ++cell) mesh.block(type).group[cell] = GroupId();
  Context context;
  const std::string path = (scratch_folder("io_exodus_none") / "a.e").string();
  write_mesh(mesh, path, context);
  const Mesh got = read_mesh(path, context);
  for (const CellType type : {CellType::tetrahedron, CellType::triangle}) {
    const auto& groups = got.find_block(type)->group;
    EXPECT_EQ(std::count(groups.begin(), groups.end(), GroupId()), 2);
  }
  expect_same_groups(got, mesh, {});
}

TEST(Exodus, an_axis_that_is_missing_is_named) {
  for (const char* axis : {"coordx", "coordy", "coordz"}) {
    const std::string other = std::string(axis).substr(0, 5) + "q";
    expect_mentions(message_of_reading<InputError>(changed_exodus(axis, other)), {axis, "missing", "3 axes"});
  }
}

TEST(Xdmf, what_is_wrong_with_its_arrays_names_both_files) {
  const fs::path folder = scratch_folder("io_xdmf_pair");
  Context context;
  write_mesh(two_boxes(), (folder / "a.xdmf").string(), context);
  write_mesh(mixed_cells(), (folder / "b.xdmf").string(), context);
  const auto message = [&] { return message_of_reading<InputError>(folder / "a.xdmf"); };
  fs::copy_file(folder / "b.h5", folder / "a.h5", fs::copy_options::overwrite_existing);
  expect_mentions(message(), {"a.xdmf", "a.h5", "together"});
  {
    const Hdf5Turn turn;
    Hdf5Writer((folder / "a.h5").string(), "a.h5", false).close();
  }
  expect_mentions(message(), {"a.xdmf", "a.h5", "/data0", "together"});
  std::ofstream(folder / "a.h5", std::ios::trunc) << "no HDF5";
  expect_mentions(message(), {"a.xdmf", "a.h5", "no HDF5", "together"});
  fs::remove(folder / "a.h5");
  expect_mentions(message(), {"a.xdmf", "a.h5", "No such file", "together"});
}

TEST(Hdf5Formats, compressing_makes_small_files_no_larger_and_large_ones_smaller) {
  Mesh large;
  for (std::size_t i = 0; i < 6000; ++i) large.points.push_back({double(i / 2), double(i % 2), 0});
  for (std::size_t i = 0; i + 2 < 6000; ++i)
    add_cell(large, CellType::triangle, std::array{VertexId(i), VertexId(i + 1), VertexId(i + 2)}, GroupId());
  const fs::path folder = scratch_folder("io_hdf5_compress");
  Context context;
  const auto size = [&](const Mesh& mesh, const std::string& name, bool compress) {
    write_mesh(mesh, (folder / name).string(), context, {.binary = true, .version = "", .compress = compress});
    return double(fs::file_size(folder / (name == "a.xdmf" ? "a.h5" : name)));
  };
  for (const char* name : {"a.vtkhdf", "a.xdmf"}) {
    EXPECT_LE(size(two_boxes(), name, true), 1.05 * size(two_boxes(), name, false)) << name;
    EXPECT_LT(size(large, name, true), 0.5 * size(large, name, false)) << name;
  }
}

}  // namespace
}  // namespace delfront
#endif
