// SPDX-License-Identifier: Apache-2.0
// Numbers that should be whole are refused where they are not: never cut off.
#include "io/whole_numbers.hpp"

#include <limits>

#include "base/base64.hpp"
#include "io/exodus/netcdf.hpp"
#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

TEST(WholeNumbers, are_told_from_others) {
  for (const double whole : {0.0, -1.0, 3.0, 0x1p62, -0x1p62}) EXPECT_TRUE(is_whole(whole)) << whole;
  for (const double other :
       {0.5, 1e19, -1e19, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(is_whole(other)) << other;
}

std::string triangle_vtu(const std::string& corners) {
  return "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt32\"><UnstructuredGrid><Piece "
         "NumberOfPoints=\"3\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
         "format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points><Cells>" +
         corners +
         "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray><DataArray type=\"UInt8\" "
         "Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
}

std::string binary_corners(double last) {
  const double corners[] = {0, 1, last};
  const std::uint32_t size = sizeof(corners);
  std::string bytes(reinterpret_cast<const char*>(&size), sizeof(size));
  bytes.append(reinterpret_cast<const char*>(corners), size);
  return "<DataArray type=\"Float64\" Name=\"connectivity\" format=\"binary\">" + to_base64(bytes) + "</DataArray>";
}

TEST(WholeNumbers, corners_of_vtu_cells) {
  const auto path_of = [](const std::string& corners) { return write_text("corners.vtu", triangle_vtu(corners)); };
  const std::string text = "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 ";
  Context context;
  for (const std::string& good : {text + "2</DataArray>", text + "2.0</DataArray>", binary_corners(2)})
    EXPECT_EQ(read_mesh(path_of(good), context).num_cells(CellType::triangle), 1u);
  expect_mentions(message_of_reading<InputError>(path_of(text + "1.7</DataArray>")), {"'1.7'", "no whole number"});
  expect_mentions(message_of_reading<InputError>(path_of(binary_corners(1.7))), {"value 2 is 1.7"});
}

TEST(WholeNumbers, reals_of_a_netcdf_file) {
  const std::string path = (scratch_folder("io_whole") / "a.nc").string();
  Output out(path, path);
  NetcdfWriter file(out);
  const std::size_t two = file.add_dimension("two", 2);
  for (const auto& [name, last] : {std::pair{"good", 4.0}, {"bad", 4.5}})
    file.add_variable(name, NetcdfWriter::Type::real, {two}, [last = last](NetcdfWriter& to) {
      to.put(3.0);
      to.put(last);
    });
  file.write();
  out.close();
  const std::string bytes = contents(path);
  const auto source = open_netcdf_classic(bytes, path);
  EXPECT_EQ(source->integers("good"), (std::vector<std::int64_t>{3, 4}));
  EXPECT_EQ(source->reals("bad"), (std::vector<double>{3, 4.5}));
  try {
    source->integers("bad");
    ADD_FAILURE() << "4.5 was taken";
  } catch (const InputError& e) {
    expect_mentions(e.what(), {"bad", "value 1 is 4.5"});
  }
}

}  // namespace
}  // namespace delfront
