// SPDX-License-Identifier: Apache-2.0
// Real files: with no sizes given each has a valid surface grid, whose points lie on the geometry by OpenCASCADE's own
// projection.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_Transform.hxx>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <gp_Trsf.hxx>
#include <map>

#include "delfront/cad.hpp"
#include "delfront/surface_check.hpp"
#include "occ_files.hpp"
#include "pipeline/geometry_job.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

constexpr std::size_t kSampled = 60;  ///< points a file that are projected

struct Expected {
  const char* file;
  std::size_t solids;
  bool is_closed;  ///< bounds a volume
};
constexpr Expected kFiles[] = {
    {"A319.brep", 0, true},         {"Pump_TopCover.brep", 1, true},
    {"as1-oc-214.stp", 18, true},   {"cube-in.step", 1, true},
    {"featuretype.STEP", 1, true},  {"geom_oneram6.IGS", 0, true},
    {"hammer.iges", 0, true},       {"linkrods.step", 1, true},
    {"mesh_T106_V3.step", 0, true}, {"onera-m6-sharp-te.egads", 1, true},
    {"tigl_nacelle.stp", 0, false}, {"wing_fuselage.step", 2, true},
};

double tolerance_of(const Brep& brep, const VertexEntity& v) {
  if (v.dimension == 0) return brep.corners[CornerId(std::size_t(v.id))].tolerance;
  if (v.dimension == 1) return brep.edges[EdgeId(std::size_t(v.id))].tolerance;
  return brep.faces[FaceId(std::size_t(v.id))].tolerance;
}

class SharedCad : public testing::TestWithParam<Expected> {};

TEST_P(SharedCad, D1_S11_has_a_valid_grid_on_the_geometry) {
  DELFRONT_NEEDS_SHARED_DATA(shared);
  const Expected expected = GetParam();
  const std::filesystem::path path = *shared / "cad" / expected.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  Context context;
  CadReport cad;
  const Brep brep = read_cad(path.string(), {}, cad, context);
  EXPECT_EQ(cad.solids, expected.solids);
  EXPECT_EQ(cad.free_edges == 0, expected.is_closed);
  const Options usual;
  BrepGridReport report;
  const auto size = geometry_sizes(brep, look_at_brep(brep, context), usual, nullptr, context);
  const double hmin = accuracy_numbers("").hmin_share * measure_extent(brep).body;
  const Model model = grid_brep(brep, *size, {.least_size = hmin, .bridge_below = hmin}, report, context);
  const SurfaceReport facts = check_surface(model, context);
  EXPECT_EQ(facts.can_bound_volume, expected.is_closed);
  for (const Finding& finding : facts.findings)
    EXPECT_TRUE(finding.severity != Severity::error || finding.kind == "open_edges") << finding.message;

  const std::map<std::string, std::string> codes = {{"mm", "MM"}, {"m", "M"}, {"in", "INCH"}, {"", "MM"}};
  const TopoDS_Shape shape = occ::read(path.string(), codes.at(cad.unit));
  const double diagonal = model.bounding_box().diagonal();
  const std::size_t step = std::max<std::size_t>(1, model.points.size() / kSampled);
  for (std::size_t i = 0; i < model.points.size(); i += step) {
    const Point p = model.points[VertexId(i)];
    const double allowed = std::max(1e-7 * diagonal, tolerance_of(brep, report.entity[i]));
    EXPECT_LE(occ::distance_to(shape, p), allowed)
        << "point " << i << " of dimension " << int(report.entity[i].dimension) << ", entity " << report.entity[i].id
        << ", at " << p.x << " " << p.y << " " << p.z << ", parameters " << report.entity[i].u << " "
        << report.entity[i].v;
  }
}

/// OpenCASCADE works to 1e-7: a thousandth of a unit wide, these were sewn wrongly.
TEST(TinyCad, D4_faces_of_a_tiny_part_are_sewn_as_those_of_a_large_one) {
  DELFRONT_NEEDS_SHARED_DATA(shared);
  const std::filesystem::path path = *shared / "cad" / "mesh_T106_V3.step";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const std::string small = (fixtures::scratch_folder() / "small.brep").string();
  gp_Trsf smaller;
  smaller.SetScaleFactor(0.001);
  occ::write_brep(BRepBuilderAPI_Transform(occ::read(path.string(), "M"), smaller, true).Shape(), small);
  Context context;
  std::vector<double> volume;
  for (const std::string& file : {path.string(), small}) {
    CadReport cad;
    const Brep brep = read_cad(file, {}, cad, context);
    EXPECT_EQ(cad.free_edges, 0u) << file;
    const BrepLook look = look_at_brep(brep, context);
    const SurfaceReport facts = check_surface(look.grid, context);
    EXPECT_TRUE(facts.can_bound_volume) << file;
    volume.push_back(facts.volume);
  }
  EXPECT_NEAR(volume[1] * 1e9 / volume[0], 1, 1e-4);
}

std::string name_of(const testing::TestParamInfo<Expected>& info) {
  std::string name = info.param.file;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Files, SharedCad, testing::ValuesIn(kFiles), name_of);

}  // namespace
}  // namespace delfront
