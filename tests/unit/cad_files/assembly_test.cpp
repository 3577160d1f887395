// SPDX-License-Identifier: Apache-2.0
// Assemblies: what solids have in common is there once, however they lie in space; regions have the names of products
// in the order of the file, whatever the sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "bad_shapes.hpp"
#include "delfront/cad.hpp"
#include "delfront/generate.hpp"
#include "delfront/surface_check.hpp"
#include "delfront/uniform_size.hpp"
#include "occ_files.hpp"
#include "pipeline/geometry_job.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

constexpr double kPi = std::numbers::pi;

std::string file(const std::string& name) { return (fixtures::scratch_folder() / name).string(); }

Brep read(const std::string& path, CadReport& report) {
  Context context;
  return read_cad(path, {}, report, context);
}

struct Solid {
  std::string name;
  double volume;
};

/// The regions of a grid, in its order.
std::vector<Solid> grid_regions(const Brep& brep, double h) {
  Context context;
  BrepGridReport report;
  const Model grid = grid_brep(brep, UniformSize(h), {}, report, context);
  Options options;
  options.surface.method = "keep";
  options.size.hmax = Length{h, ""};
  const Outcome outcome = generate(build_model({named_surface(grid, brep, "part")}, context), options, context);
  const CellBlock& tets = *outcome.mesh.find_block(CellType::tetrahedron);
  std::vector<Solid> solids;
  std::vector<std::size_t> number(outcome.mesh.groups.size());
  for (std::size_t g = 0; g < outcome.mesh.groups.size(); ++g) {
    number[g] = solids.size();
    if (outcome.mesh.groups[GroupId(g)].dimension == 3) solids.push_back({outcome.mesh.groups[GroupId(g)].name, 0});
  }
  for (std::size_t t = 0; t < tets.size(); ++t) {
    Point p[4];
    for (std::size_t k = 0; k < 4; ++k) p[k] = outcome.mesh.points[tets[t][k]];
    solids[number[tets.group[t].index()]].volume += dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6;
  }
  return solids;
}

void expect_regions(const std::vector<Solid>& is, const std::vector<Solid>& wanted, double share = 1e-9) {
  ASSERT_EQ(is.size(), wanted.size());
  for (std::size_t i = 0; i < is.size(); ++i) {
    EXPECT_EQ(is[i].name, wanted[i].name) << i;
    EXPECT_NEAR(is[i].volume, wanted[i].volume, share * wanted[i].volume) << wanted[i].name;
  }
}

TEST(Assembly, D4_a_lattice_has_each_corner_edge_and_face_once_however_it_is_turned) {
  constexpr std::size_t n = 4;
  for (const double turn : {0.0, 0.7, 2.1}) {
    const std::string path = file("lattice.brep");
    occ::write_brep(occ::lattice(n, turn), path);
    CadReport report;
    const Brep brep = read(path, report);
    EXPECT_EQ(brep.corners.size(), (n + 1) * (n + 1) * (n + 1)) << turn;
    EXPECT_EQ(brep.edges.size(), 3 * n * (n + 1) * (n + 1)) << turn;
    EXPECT_EQ(brep.faces.size(), 3 * n * n * (n + 1)) << turn;
    EXPECT_EQ(report.solids, n * n * n);
    EXPECT_EQ(report.free_edges, 0u);
    std::size_t between = 0;
    std::set<std::uint32_t> bounded;
    for (const BrepFace& face : brep.faces) {
      EXPECT_TRUE(face.regions[0].is_valid());
      EXPECT_NE(face.regions[0], face.regions[1]);
      between += face.regions[1].is_valid();
      bounded.insert(face.regions[0].value);
    }
    EXPECT_EQ(between, 3 * n * n * (n - 1)) << turn;
    Context context;
    BrepGridReport made;
    const SurfaceReport facts = check_surface(grid_brep(brep, UniformSize(1), {}, made, context), context);
    EXPECT_TRUE(facts.can_bound_volume) << turn;
    EXPECT_NEAR(facts.area, double(brep.faces.size()), 1e-9 * facts.area);
  }
}

TEST(Assembly, D4_solids_apart_stay_as_they_are) {
  const std::string path = file("apart.step");
  occ::write_boxes(27, 0.01, path);
  CadReport report;
  const Brep brep = read(path, report);
  EXPECT_EQ(brep.faces.size(), 6 * 27u);
  EXPECT_TRUE(report.repairs.empty());
}

/// A bore and a pin have the same circles and the same side where their seams lie the same way, else other ones.
TEST(Assembly, D4_a_pin_in_a_bore_shares_its_side_whichever_way_it_is_turned) {
  for (const double turn : {0.0, 1.0}) {
    const std::string path = file("pin.brep");
    occ::write_brep(occ::pin_in_a_block(turn), path);
    CadReport report;
    const Brep brep = read(path, report);
    EXPECT_EQ(report.solids, 2u) << turn;
    Context context;
    BrepGridReport made;
    const Model model = grid_brep(brep, UniformSize(0.15), {}, made, context);
    const SurfaceReport facts = check_surface(model, context);
    EXPECT_TRUE(facts.can_bound_volume) << turn;
    EXPECT_NEAR(facts.area, 2 * 4 + 8 + kPi, 0.01 * 19) << turn;
    EXPECT_EQ(std::count_if(facts.findings.begin(), facts.findings.end(),
                            [](const Finding& f) { return f.severity == Severity::error; }),
              0);
  }
}

/// Bricks in a bond: no face coincides with one of the next row.
TEST(Assembly, D4_faces_that_overlap_in_part_are_cut_by_each_other) {
  const std::string path = file("bond.step");
  occ::write_assembly({{"lower", occ::box(2, 1, 1), {{0, 0, 0}, {2, 0, 0}}}, {"upper", occ::box(2, 1, 1), {{1, 0, 1}}}},
                      path);
  CadReport report;
  const Brep brep = read(path, report);
  EXPECT_EQ(report.solids, 3u);
  double area = 0;
  Context context;
  BrepGridReport made;
  area = check_surface(grid_brep(brep, UniformSize(0.5), {}, made, context), context).area;
  EXPECT_NEAR(area, 3 * 10 - 3, 1e-9);  // one face of 1 x 1 between the lower ones, two of those below the upper one
}

TEST(Assembly, D4_overlapping_solids_are_cut_and_the_common_part_has_both_names) {
  const std::string path = file("overlap.step");
  occ::write_assembly({{"a", occ::box(1, 1, 1), {{0, 0, 0}}}, {"b", occ::box(1, 1, 1), {{0.75, 0.25, 0.25}}}}, path);
  CadReport report;
  const Brep brep = read(path, report);
  const double common = 0.25 * 0.75 * 0.75;
  std::vector<Solid> regions = grid_regions(brep, 0.3);
  std::sort(regions.begin(), regions.end(), [](const Solid& x, const Solid& y) { return x.name < y.name; });
  expect_regions(regions, {{"a", 1 - common}, {"a-b", common}, {"b", 1 - common}});
}

TEST(Assembly, D4_a_propeller_of_a_hub_and_blades_is_joined) {
  const std::string path = file("propeller.step");
  occ::write_step(occ::propeller(3), path);
  CadReport report;
  const Brep brep = read(path, report);
  EXPECT_EQ(report.solids, 7u);  // the hub without roots, three roots in it, three blades
  EXPECT_EQ(report.free_edges, 0u);
  // the hub's side and ends; of each blade its root's end and side, the hub's side between root and blade, which one
  // blade has on either side of the hub's seam, the blade's side and its tip
  EXPECT_EQ(brep.faces.size(), 3 + 3 * 5 + 1u);
  std::map<std::uint32_t, int> faces;
  for (const BrepFace& face : brep.faces)
    for (const RegionId region : face.regions)
      if (region.is_valid()) ++faces[region.value];
  EXPECT_EQ(faces.size(), 7u);
}

TEST(Assembly, D6_regions_have_the_names_of_products_in_the_order_of_the_file_for_any_size) {
  const std::string path = file("named.step");
  occ::write_assembly({{"shaft", occ::box(1, 1, 3), {{0, 0, 0}}},
                       {"nut", occ::box(1, 1, 1), {{1, 0, 0}, {1, 0, 1}}},
                       {"Gehäuse (links) #2", occ::box(2, 1, 1), {{0, 1, 0}}}},
                      path);
  CadReport report;
  const Brep brep = read(path, report);
  EXPECT_EQ(brep.regions, (std::vector<std::string>{"shaft", "nut", "nut", "Gehäuse (links) #2"}));
  for (const double h : {1.0, 0.4, 0.25})
    expect_regions(grid_regions(brep, h), {{"shaft", 3}, {"nut", 1}, {"nut_2", 1}, {"Gehäuse (links) #2", 2}});
}

TEST(Assembly, D6_two_solids_that_share_a_face) {
  const std::string path = file("two.step");
  occ::write_assembly({{"big", occ::box(2, 2, 2), {{0, 0, 0}}}, {"small", occ::box(1, 2, 2), {{2, 0, 0}}}}, path);
  CadReport report;
  const Brep brep = read(path, report);
  EXPECT_EQ(brep.faces.size(), 11u);
  EXPECT_EQ(std::count_if(brep.faces.begin(), brep.faces.end(),
                          [](const BrepFace& f) { return f.regions[0].is_valid() && f.regions[1].is_valid(); }),
            1);
  for (const double h : {2.0, 0.5}) expect_regions(grid_regions(brep, h), {{"big", 8}, {"small", 4}});
}

/// The inner one's faces say nothing of what lies ahead of them.
TEST(Assembly, D6_a_solid_within_another_leaves_it_its_name) {
  const std::string path = file("nested.step");
  occ::write_assembly({{"core", occ::box(1, 1, 1), {{1, 1, 1}}}, {"mould", occ::box(3, 3, 3), {{0, 0, 0}}}}, path);
  CadReport report;
  for (const double h : {1.0, 0.5}) expect_regions(grid_regions(read(path, report), h), {{"core", 1}, {"mould", 26}});
}

TEST(Assembly, D6_a_solid_without_a_name_is_fluid) {
  const std::string path = file("plain.brep");
  occ::write_brep(occ::box(1, 1, 1), path);
  CadReport report;
  expect_regions(grid_regions(read(path, report), 0.5), {{"fluid", 1}});
  occ::write_brep(occ::two_boxes(true), path);
  expect_regions(grid_regions(read(path, report), 0.5), {{"fluid", 1}, {"region_2", 2}});
}

}  // namespace
}  // namespace delfront
