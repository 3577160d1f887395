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

}  // namespace
}  // namespace delfront
#endif
