// SPDX-License-Identifier: Apache-2.0
// Real and defective files of the shared data: each reads, or is refused, as its README says.
#include <cmath>

#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;

double signed_volume(const Mesh& mesh) {
  double six = 0;
  const CellBlock* triangles = mesh.find_block(CellType::triangle);
  for (std::size_t i = 0; triangles && i < triangles->size(); ++i) {
    const auto v = (*triangles)[i];
    six += dot(mesh.points[v[0]], cross(mesh.points[v[1]], mesh.points[v[2]]));
  }
  return six / 6;
}

TEST(SharedData, readable_facet_files_have_the_counts_and_volumes_of_the_readme) {
  DELFRONT_NEEDS_SHARED_DATA(data);
  struct Expected {
    const char* file;
    std::size_t triangles, patches;
    double volume;  // NaN: not closed
  };
  const double none = std::nan("");
  const Expected all[] = {{"surface/hinge.stl", 1212, 1, 6336.4},
                          {"surface/1002_tray_bottom.STL", 4520, 1, 347866},
                          {"surface/DTC-scaled.stl", 116062, 1, 2.4363},
                          {"surface/featuretype.STL", 3476, 1, none},
                          {"surface/heatedDuct.stl", 44, 8, none},
                          {"surface/turbineSiting_terrain.stl", 21186, 1, none},
                          {"surface/aorta2.stl", 12455, 1, none},
                          {"surface/spot_triangulated.obj", 5856, 1, 0.71826},
                          {"surface/NACA0012.obj", 15988, 1, 0.08171},
                          {"surface/propeller.obj", 37240, 2, none},
                          {"surface/motorBike.obj", 331653, 67, none},
                          {"defects/bad-stl-wing.stl", 842, 1, 7443},
                          {"defects/conrod.stl", 6442, 1, none},
                          {"defects/three_cubes.stl", 36, 1, 24},
                          {"defects/many_small_holes.ply", 3524, 1, none},
                          {"defects/openscad-nonmanifold-crash.obj", 1442, 1, none},
                          {"plc/cgal_three_knives.off", 68, 1, none},
                          {"plc/chazelle_n6.off", 156, 1, 1964.263},
                          {"synthetic/solid_header_binary.stl", 320, 1, 4.04704},
                          {"synthetic/uppercase_crlf_exp3.stl", 320, 1, 4.04704},
                          {"synthetic/one_inch_in_mm_or_in.stl", 12, 1, 16387.064},
                          {"synthetic/dup_degenerate.obj", 363, 1, none},
                          {"synthetic/t_junction.off", 13, 1, none}};
  for (const Expected& expected : all) {
    SCOPED_TRACE(expected.file);
    Recorder recorder;
    const Mesh mesh = read_mesh((*data / expected.file).string(), recorder.context);
    EXPECT_EQ(mesh.num_cells(CellType::triangle), expected.triangles);
    std::size_t patches = 0;
    for (const Group& group : mesh.groups) patches += group.dimension == 2;
    EXPECT_EQ(patches, expected.patches);
    if (!std::isnan(expected.volume)) {
      EXPECT_NEAR(signed_volume(mesh), expected.volume, 1e-4 * expected.volume);  // the README rounds
    }
    EXPECT_TRUE(recorder.warnings.empty()) << recorder.warnings[0];
  }
}

TEST(SharedData, defective_files_are_refused_with_the_reason) {
  DELFRONT_NEEDS_SHARED_DATA(data);
  const auto folder = *data / "synthetic";
  expect_mentions(message_of_reading<InputError>(folder / "truncated_binary.stl"),
                  {"320", "room for 200", "truncated"});
  expect_mentions(message_of_reading<InputError>(folder / "truncated_ascii.stl"), {"195", "line", "truncated"});
  expect_mentions(message_of_reading<InputError>(folder / "decimal_comma.stl"), {"decimal comma", "line 4"});
  expect_mentions(message_of_reading<InputError>(folder / "nan_vertices.stl"),
                  {"3 of 320 facets", "not a finite", "line"});
}

TEST(SharedData, zero_count_is_read_by_size_with_a_warning) {
  DELFRONT_NEEDS_SHARED_DATA(data);
  Recorder recorder;
  const Mesh mesh = read_mesh((*data / "synthetic/zero_count_binary.stl").string(), recorder.context);
  EXPECT_EQ(mesh.num_cells(CellType::triangle), 320u);
  EXPECT_NEAR(signed_volume(mesh), 4.04704, 1e-4);
  ASSERT_EQ(recorder.warnings.size(), 1u);
  expect_mentions(recorder.warnings[0], {"0 facets", "320"});
}

TEST(SharedData, names_of_solids_and_groups_arrive) {
  DELFRONT_NEEDS_SHARED_DATA(data);
  Context context;
  const Mesh duct = read_mesh((*data / "surface/heatedDuct.stl").string(), context);
  for (const char* name : {"metalInlet", "heaterInlet", "fluidInlet", "metalOutlet", "heaterOutlet", "fluidOutlet",
                           "metalExternal", "heaterExternal"})
    EXPECT_TRUE(duct.find_group(2, name).is_valid()) << name;
  const Mesh box = read_mesh((*data / "synthetic/box_with_baffle.obj").string(), context);
  EXPECT_EQ(box.groups.size(), 7u);
  EXPECT_TRUE(box.find_group(2, "floor").is_valid());
  EXPECT_GT(box.num_cells(CellType::polygon), 0u);
  EXPECT_EQ(read_mesh((*data / "surface/hinge.stl").string(), context).groups[GroupId(0)].name, "");
}

TEST(SharedData, grids_of_other_programs) {
  DELFRONT_NEEDS_SHARED_DATA(data);
  Context context;
  const Mesh rae = read_mesh((*data / "adapt/mesh_RAE2822_turb.su2").string(), context);
  EXPECT_EQ(rae.dimension, 2);
  EXPECT_EQ(rae.points.size(), 13937u);
  EXPECT_EQ(rae.num_cells_of_dimension(2), 22842u);
  const GroupId airfoil = rae.find_group(1, "AIRFOIL"), farfield = rae.find_group(1, "FARFIELD");
  std::map<std::uint32_t, std::size_t> count;
  for (GroupId group : rae.find_block(CellType::line)->group) ++count[group.value];
  EXPECT_EQ(count[airfoil.value], 192u);
  EXPECT_EQ(count[farfield.value], 40u);
  const Mesh naca = read_mesh((*data / "adapt/naca-multiSols.mesh").string(), context);
  EXPECT_EQ(naca.dimension, 2);
  EXPECT_EQ(naca.points.size(), 15102u);
  EXPECT_EQ(naca.num_cells(CellType::triangle), 30100u);
  EXPECT_EQ(naca.num_cells(CellType::line), 102u);
  const Mesh plc = read_mesh((*data / "plc/plc_dangling_facets.poly").string(), context);
  EXPECT_EQ(plc.points.size(), 24u);
  EXPECT_EQ(plc.num_cells_of_dimension(2), 14u + 4u);  // four sides are split by the edges of the baffle
  EXPECT_TRUE(plc.find_group(2, "patch_20").is_valid());
  EXPECT_TRUE(plc.find_group(2, "patch_21").is_valid());
}

}  // namespace
}  // namespace delfront
