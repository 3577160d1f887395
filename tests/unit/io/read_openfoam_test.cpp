// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "delfront/dirichlet.hpp"
#include "delfront/grid_check.hpp"
#include "io/formats.hpp"
#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;
namespace fs = std::filesystem;

/// A case that holds this mesh.
fs::path write_case(const Mesh& mesh) {
  const fs::path folder = scratch_folder("io_read_foam") / "case";
  Context context;
  write_mesh(mesh, folder.string() + "/", context);
  return folder;
}

Mesh read_back(const Mesh& mesh) {
  Context context;
  return read_mesh(write_case(mesh).string(), context);
}

double volume_of(const Mesh& mesh) {
  Context context;
  return measure_quality(mesh, context).volume;
}

/// Replace the first `from` in a file of the case.
void change(const fs::path& folder, const std::string& name, const std::string& from, const std::string& to) {
  const fs::path file = folder / "constant/polyMesh" / name;
  std::string text = contents(file);
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << name << " lacks " << from;
  std::ofstream(file, std::ios::binary) << text.replace(at, from.size(), to);
}

TEST(ReadOpenFoam, keeps_points_cells_names_and_regions) {
  const Mesh mesh = two_boxes();
  const Mesh got = read_back(mesh);
  EXPECT_EQ(got.points, mesh.points);
  EXPECT_TRUE(check(got).empty());
  ASSERT_EQ(got.num_cells(CellType::tetrahedron), 12u);
  EXPECT_EQ(got.num_cells(CellType::triangle), mesh.num_cells(CellType::triangle));
  EXPECT_NEAR(volume_of(got) / volume_of(mesh), 1, 1e-14);
  expect_same_groups(got, mesh, {.kinds = false, .renamed = {{"left wall", "left_wall"}}});
  const CellBlock& tets = *got.find_block(CellType::tetrahedron);
  for (std::size_t cell = 0; cell < 12; ++cell)
    EXPECT_EQ(cell_group_name(got, tets, cell), cell_group_name(mesh, *mesh.find_block(CellType::tetrahedron), cell));
  EXPECT_EQ(got.groups[got.find_group(2, "left_wall")].kind, "wall");
  EXPECT_TRUE(got.groups[got.find_group(2, "between")].two_sided);
}

TEST(ReadOpenFoam, finds_each_type_of_cell) {
  const Mesh mesh = mixed_cells();
  const Mesh got = read_back(mesh);
  for (const CellType type :
       {CellType::tetrahedron, CellType::pyramid, CellType::prism, CellType::hexahedron, CellType::polyhedron})
    EXPECT_EQ(got.num_cells(type), type == CellType::polyhedron ? 0u : 1u) << name_of(type);
  EXPECT_TRUE(check(got).empty());
  EXPECT_NEAR(volume_of(got) / volume_of(mesh), 1, 1e-14);
}

TEST(ReadOpenFoam, what_is_written_again_is_the_same_case) {
  const fs::path folder = write_case(two_boxes());
  std::map<std::string, std::string> before;  // not faces: one may begin with another corner
  for (const char* name : {"points", "owner", "neighbour", "boundary", "cellZones", "faceZones"})
    before[name] = contents(folder / "constant/polyMesh" / name);
  Context context;
  write_mesh(read_mesh(folder.string(), context), folder.string() + "/", context);
  for (const auto& [name, text] : before) EXPECT_EQ(contents(folder / "constant/polyMesh" / name), text) << name;
}

TEST(ReadOpenFoam, two_patches_of_a_baffle_become_one_group_again) {
  Mesh mesh = two_boxes();
  for (GroupId& group : mesh.block(CellType::tetrahedron).group) group = GroupId(0);
  mesh.groups[mesh.find_group(2, "between")].kind = "wall";
  const Mesh got = read_back(mesh);
  EXPECT_TRUE(check(got).empty());
  ASSERT_TRUE(got.find_group(2, "between").is_valid());
  EXPECT_TRUE(got.groups[got.find_group(2, "between")].two_sided);
  EXPECT_FALSE(got.find_group(2, "between_slave").is_valid());
  EXPECT_EQ(got.num_cells(CellType::triangle), mesh.num_cells(CellType::triangle));
}

TEST(ReadOpenFoam, other_cells_become_polyhedra) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point> points;
  for (int i = 0; i < 40; ++i) points.push_back({uniform(random), uniform(random), uniform(random)});
  Context context;
  const Mesh mesh = mesh_of(dirichlet(points, context, Box{{0, 0, 0}, {1, 1, 1}}));
  const Mesh got = read_back(mesh);
  EXPECT_EQ(got.num_cells_of_dimension(3), points.size()) << "seed " << kSeed;
  EXPECT_GT(got.num_cells(CellType::polyhedron), points.size() / 2);
  EXPECT_FALSE(has_errors(check(got)));
  EXPECT_EQ(measure_quality(got, context).num_cells, points.size());
}

TEST(ReadOpenFoam, the_folder_of_the_mesh_does_too) {
  Context context;
  const fs::path folder = write_case(mixed_cells());
  EXPECT_EQ(read_mesh((folder / "constant/polyMesh").string(), context).num_cells_of_dimension(3), 4u);
  expect_mentions(message_of_reading<InputError>(scratch_folder("io_no_case")), {"no OpenFOAM case", "polyMesh"});
}

TEST(ReadOpenFoam, text_as_other_writers_have_it) {
  const fs::path folder = write_case(mixed_cells());
  change(folder, "points", "FoamFile", "/* a\nlogo */ // and a line\nFoamFile");
  change(folder, "boundary", "type            wall;", "type wall; inGroups 1(wall); more { of \"it;\"; }");
  Context context;
  EXPECT_EQ(read_mesh(folder.string(), context).groups[GroupId(1)].kind, "wall");
}

TEST(ReadOpenFoam, damage_is_named_with_file_and_line) {
  const auto refused = [](const std::string& name, const std::string& from, const std::string& to) {
    const fs::path folder = write_case(two_boxes());
    change(folder, name, from, to);
    return message_of_reading<InputError>(folder);
  };
  expect_mentions(refused("points", "ascii", "binary"), {"points: line", "binary", "foamFormatConvert"});
  expect_mentions(refused("faces", "faceList", "faceCompactList"), {"faceCompactList", "only faceList"});
  expect_mentions(refused("faces", "3(0 ", "3(99 "), {"faces: line", "point 99"});
  expect_mentions(refused("owner", "34\n(\n0\n", "34\n(\n5\n"), {"cell", "is not closed"});
  expect_mentions(refused("points", "12\n", "4000000000\n"), {"4000000000", "room for"});
  expect_mentions(refused("owner", "34\n(\n0\n", "34\n(\n77\n"), {"owner", "more cells than"});
  expect_mentions(refused("neighbour", "14\n(", "15\n("), {"neighbour"});
  expect_mentions(refused("boundary", "startFace       14", "startFace       3"), {"boundary: line", "left_wall"});
  expect_mentions(refused("cellZones", "0\n1\n", "0\n50\n"), {"cellZones: line", "50"});
}

TEST(ReadOpenFoam, cut_files_give_an_error_never_a_crash) {
  for (const char* name : {"points", "faces", "owner", "neighbour", "boundary", "cellZones", "faceZones"}) {
    const fs::path folder = write_case(two_boxes());
    const fs::path file = folder / "constant/polyMesh" / name;
    const std::string whole = contents(file);
    const std::size_t last = whole.find_last_of(')');
    for (std::size_t size = 1; size <= last; size += 1 + whole.size() / 60) {
      std::ofstream(file, std::ios::binary) << whole.substr(0, size);
      EXPECT_FALSE(message_of_reading<InputError>(folder).empty()) << name << " " << size;
    }
  }
}

}  // namespace
}  // namespace delfront
