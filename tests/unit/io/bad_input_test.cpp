// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <limits>

#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

std::string binary_stl(std::uint32_t claimed, const std::vector<float>& coordinates) {
  std::string bytes(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&claimed), 4);
  for (std::size_t i = 0; i + 9 <= coordinates.size(); i += 9) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(coordinates.data() + i), 36);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST(BadInput, missing_empty_and_folder_are_said) {
  expect_mentions(message_of_reading<InputError>("no/such/file.stl"), {"no/such/file.stl", "No such file"});
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.off", "a.poly", "a.vtu", "a.vtp", "a.msh", "a.mesh", "a.su2",
                           "a.meshb", "a.ugrid", "a.b8.ugrid", "a.bdf", "a.inp"})
    expect_mentions(message_of_reading<InputError>(write_text(name, "")), {name, "empty"});
  const auto folder = scratch_folder("folder.stl");
  expect_mentions(message_of_reading<InputError>(folder), {"folder.stl", "folder, not a file"});
}

TEST(BadInput, unknown_extension_lists_the_known_and_the_nearest) {
  expect_mentions(message_of_reading<UsageError>("a.slt"), {".slt", "did you mean .stl?", ".obj"});
  expect_mentions(message_of_reading<UsageError>("noextension"), {"no extension"});
  Context context;
  EXPECT_THROW(read_mesh("a.stl", context, "nosuchformat"), UsageError);
  EXPECT_THROW(write_mesh(cube_surface(), "a.poly", context), UsageError);
  EXPECT_EQ(format_of("X.STL").name, "stl");
  EXPECT_EQ(format_of("case/", "", true).name, "openfoam");
  EXPECT_EQ(format_of("case/").name, "openfoam");
  EXPECT_EQ(format_of(scratch_folder("a.stl")).name, "openfoam") << "a folder, whatever it is called";
}

TEST(BadInput, stl_header_with_four_billion_facets) {
  const auto path = write_text("a.stl", binary_stl(4000000000u, std::vector<float>(18, 1.0f)));
  expect_mentions(message_of_reading<InputError>(path), {"4000000000", "room for 2", "truncated"});
}

TEST(BadInput, stl_shorter_than_its_header) {
  expect_mentions(message_of_reading<InputError>(write_text("a.stl", std::string(50, 'x'))), {"50"});
}

TEST(BadInput, stl_with_nan_and_inf_names_facets_and_places) {
  std::vector<float> coordinates(36, 2.0f);
  coordinates[10] = std::numeric_limits<float>::quiet_NaN();
  coordinates[27] = -std::numeric_limits<float>::infinity();
  const auto path = write_text("a.stl", binary_stl(4, coordinates));
  expect_mentions(message_of_reading<InputError>(path), {"2 of 4 facets", "facet 1, 3"});
  Context context;
  try {
    read_mesh(path.string(), context);
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.places.size(), 2u);
    EXPECT_EQ(error.places[0].ids, std::vector<std::uint32_t>{1});
    EXPECT_EQ(error.places[0].at, (Point{2, 2, 2}));
  }
}

TEST(BadInput, stl_text_with_a_broken_facet) {
  const std::string head = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  expect_mentions(message_of_reading<InputError>(write_text("a.stl", head)), {"truncated"});
  expect_mentions(message_of_reading<InputError>(write_text("a.stl", head + "endloop\n")), {"line 6", "2 vertices"});
  expect_mentions(message_of_reading<InputError>(write_text("a.stl", head + "vertex 1 x 0\n")), {"line 6", "'x'"});
  expect_mentions(message_of_reading<InputError>(write_text("a.stl", "solid a\nendsolid a\n")), {"no facets"});
  expect_mentions(message_of_reading<InputError>(write_text("a.stl", "solid a\nhello\n")), {"line 2", "hello"});
}

TEST(BadInput, obj_index_out_of_range_names_the_line) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_mentions(message_of_reading<InputError>(write_text("a.obj", vertices + "f 1 2 3\nf 1 2 4\n")),
                  {"line 5", "vertex 4", "3 vertices"});
  expect_mentions(message_of_reading<InputError>(write_text("a.obj", vertices + "f 1 2 0\n")), {"line 4", "vertex 0"});
  expect_mentions(message_of_reading<InputError>(write_text("a.obj", vertices + "f -1 -2 -4\n")),
                  {"line 4", "vertex -4"});
  expect_mentions(message_of_reading<InputError>(write_text("a.obj", vertices + "f 1 2\n")), {"line 4", "2"});
  expect_mentions(message_of_reading<InputError>(write_text("a.obj", vertices)), {"no faces"});
  expect_mentions(message_of_reading<InputError>(write_text("a.obj", "v 0 0,5 1\n")), {"line 1", "decimal comma"});
  expect_mentions(message_of_reading<InputError>(write_text("a.obj", vertices + "v nan 0 0\nf 1 2 3\n")),
                  {"point 3", "not finite"});
}

TEST(BadInput, off_and_ply_indices_and_truncation) {
  expect_mentions(message_of_reading<InputError>(write_text("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")),
                  {"line 6", "3"});
  expect_mentions(message_of_reading<InputError>(write_text("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")),
                  {"truncated"});
  expect_mentions(message_of_reading<InputError>(write_text("a.off", "OFF\n4000000000 2 0\n0 0 0\n")), {"4000000000"});
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  expect_mentions(message_of_reading<InputError>(write_text("a.ply", head + "3 0 1 7\n")), {"face 0", "vertex 7"});
  expect_mentions(message_of_reading<InputError>(write_text("a.ply", head + "3 0 1")), {"truncated"});
}

TEST(BadInput, poly_points_are_numbered_one_after_the_other_from_0_or_1) {
  for (const char* dimension : {"2", "3"}) {
    const auto refused = [&](const char* a, const char* b) {
      const std::string text =
          std::string("2 ") + dimension + " 0 0\n" + a + " 0 0 0\n" + b + " 1 0 0\n1 0\n1 1 2\n0\n0\n";
      return message_of_reading<InputError>(write_text("a.poly", text));
    };
    expect_mentions(refused("1", "3"), {"line 3", "one after the other"});
    expect_mentions(refused("2", "3"), {"neither 0 nor 1"});
    expect_mentions(refused("-9223372036854775807", "9223372036854775807"), {"one after the other"});
  }
}

TEST(BadInput, cut_files_of_every_writer_give_an_error_or_less_never_a_crash) {
  Context context;
  const std::filesystem::path folder = scratch_folder("io_cut");
  for (const char* name : {"a.vtu", "a.msh", "a.mesh", "a.su2", "a.ply", "a.obj", "a.off", "a.stl"}) {
    for (bool binary : {true, false}) {
      const std::string path = (folder / name).string();
      write_mesh(two_boxes(), path, context, {.binary = binary, .version = "", .compress = binary});
      const std::string whole = contents(path);
      std::size_t errors = 0, tried = 0;
      for (std::size_t size = 1; size < whole.size(); size += 1 + whole.size() / 97) {
        std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, size);
        ++tried;
        try {
          read_mesh(path, context);
        } catch (const InputError&) {
          ++errors;
        }
      }
      EXPECT_GT(2 * errors, tried) << name;
    }
  }
}

TEST(BadInput, second_order_and_unknown_cells_are_named) {
  const std::string msh =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 11 2 0 1 1 1 1 1 1 1 1 1 1 "
      "1\n$EndElements\n";
  expect_mentions(message_of_reading<InputError>(write_text("a.msh", msh)), {"type 11", "linear"});
  expect_mentions(message_of_reading<InputError>(write_text("a.msh", "$MeshFormat\n1 0 8\n$EndMeshFormat\n")),
                  {"MSH 1", "4.1"});
  expect_mentions(message_of_reading<InputError>(write_text("a.su2", "NDIME= 3\nNELEM= 1\n22 0 1 2 3\n")),
                  {"line 3", "22"});
}

}  // namespace
}  // namespace delfront
