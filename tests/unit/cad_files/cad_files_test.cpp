// SPDX-License-Identifier: Apache-2.0
// CAD files that OpenCASCADE itself wrote, through read_cad and grid_brep: areas, volumes, names, units, bad input.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "delfront/cad.hpp"
#include "delfront/model.hpp"
#include "delfront/surface_check.hpp"
#include "delfront/uniform_size.hpp"
#include "occ_files.hpp"
#include "pipeline/geometry_job.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

constexpr double kPi = std::numbers::pi;

struct Read {
  Brep brep;
  CadReport report;
};

Read read(const std::string& path, const CadOptions& options = {}) {
  Context context;
  Read result;
  result.brep = read_cad(path, options, result.report, context);
  return result;
}

SurfaceReport grid(const Brep& brep, double h, Model* made = nullptr) {
  Context context;
  BrepGridReport report;
  Model model = grid_brep(brep, UniformSize(h), {}, report, context);
  const SurfaceReport facts = check_surface(model, context);
  if (made) *made = std::move(model);
  return facts;
}

std::string file(const char* name) { return (fixtures::scratch_folder() / name).string(); }

/// A closed shape by each format: its grid has the area and the volume, within what chords cut off.
void expect_closed(const TopoDS_Shape& shape, const std::string& path, double h, double share) {
  const Read it = read(path);
  EXPECT_EQ(it.report.free_edges, 0u) << path;
  const SurfaceReport facts = grid(it.brep, h);
  EXPECT_TRUE(facts.can_bound_volume) << path;
  EXPECT_TRUE(facts.is_closed) << path;
  EXPECT_NEAR(facts.area, occ::area_of(shape), share * occ::area_of(shape)) << path;
  EXPECT_NEAR(facts.volume, occ::volume_of(shape), share * occ::volume_of(shape)) << path;
}

void expect_closed_in_all(const TopoDS_Shape& shape, double h, double share) {
  const std::string step = file("shape.step"), iges = file("shape.iges"), brep = file("shape.brep");
  occ::write_step(shape, step);
  expect_closed(shape, step, h, share);
  occ::write_brep(shape, brep);
  expect_closed(shape, brep, h, share);
  occ::write_iges(shape, iges);
  expect_closed(shape, iges, h, share);
}

TEST(CadFiles, D1_box) { expect_closed_in_all(occ::box(1, 2, 3), 0.4, 1e-9); }
TEST(CadFiles, D1_cylinder) { expect_closed_in_all(occ::cylinder(1, 2), 0.15, 0.01); }
TEST(CadFiles, D1_sphere) { expect_closed_in_all(occ::sphere(1), 0.15, 0.01); }
TEST(CadFiles, D1_torus) { expect_closed_in_all(occ::torus(2, 0.6), 0.15, 0.02); }
TEST(CadFiles, D1_cone_with_a_tip) { expect_closed_in_all(occ::cone(1, 0, 2), 0.12, 0.01); }
TEST(CadFiles, D1_cone_upside_down) { expect_closed_in_all(occ::cone(0, 1, 2), 0.12, 0.01); }
TEST(CadFiles, D1_cone_cut) { expect_closed_in_all(occ::cone(1, 0.4, 2), 0.12, 0.01); }
TEST(CadFiles, D1_pipe_tee) { expect_closed_in_all(occ::tee(), 0.15, 0.01); }
TEST(CadFiles, D1_bent_plate_of_splines) { expect_closed_in_all(occ::bent_plate(), 0.15, 0.01); }

TEST(CadFiles, D1_revolved_spline_is_an_open_sheet) {
  const std::string path = file("vase.step");
  occ::write_step(occ::revolved_spline(), path);
  const Read it = read(path);
  EXPECT_EQ(it.report.solids, 0u);
  EXPECT_EQ(it.report.free_edges, 2u);
  const SurfaceReport facts = grid(it.brep, 0.15);
  EXPECT_FALSE(facts.is_closed);
  EXPECT_NEAR(facts.area, occ::area_of(occ::revolved_spline()), 0.01 * facts.area);
}

TEST(CadFiles, D1_solids_that_share_a_face_share_its_triangles) {
  for (const bool is_fused : {true, false}) {
    const std::string path = file(is_fused ? "fused.brep" : "apart.step");  // STEP would write the face twice
    if (is_fused)
      occ::write_brep(occ::two_boxes(is_fused), path);
    else
      occ::write_step(occ::two_boxes(is_fused), path);
    const Read it = read(path);
    EXPECT_EQ(it.report.solids, 2u);
    EXPECT_EQ(it.brep.faces.size(), 11u);
    Model model;
    const SurfaceReport facts = grid(it.brep, 0.3, &model);
    EXPECT_TRUE(facts.can_bound_volume);
    // that of the cube and of the other, the face they share once
    EXPECT_NEAR(facts.area, 6 + 10 - 1, 1e-9);
    EXPECT_EQ(it.report.repairs.empty(), is_fused);
  }
}

TEST(CadFiles, D4_an_open_shell_is_gridded_and_said_to_be_open) {
  const std::string path = file("open.step");
  occ::write_step(occ::open_box(), path);
  const Read it = read(path);
  EXPECT_EQ(it.report.free_edges, 4u);
  const SurfaceReport facts = grid(it.brep, 0.3);
  EXPECT_FALSE(facts.is_closed);
  EXPECT_NEAR(facts.area, 5, 1e-9);
}

TEST(CadFiles, D4_loose_faces_are_sewn_and_that_is_said) {
  for (const char* name : {"loose.igs", "loose.brep"}) {
    const std::string path = file(name);
    if (path.ends_with("igs"))
      occ::write_iges(occ::loose_box(), path);
    else
      occ::write_brep(occ::loose_box(), path);
    const Read it = read(path);
    EXPECT_EQ(it.report.free_edges, 0u) << name;
    ASSERT_FALSE(it.report.repairs.empty()) << name;
    EXPECT_EQ(it.report.repairs[0].kind, "sewn");
    EXPECT_EQ(it.brep.edges.size(), 12u) << name;
    EXPECT_EQ(it.brep.corners.size(), 8u) << name;
    EXPECT_TRUE(grid(it.brep, 0.5).can_bound_volume) << name;
    CadOptions as_is;
    as_is.sews = false;
    EXPECT_EQ(read(path, as_is).report.free_edges, 24u) << name;
  }
}

TEST(CadFiles, D6_names_and_colours) {
  const std::string plain = file("plain.step"), coloured = file("coloured.step");
  occ::write_coloured_box("housing", {}, plain);
  for (const BrepFace& face : read(plain).brep.faces) EXPECT_EQ(face.name, "housing");
  occ::write_coloured_box("housing", {{1, 0, 0}, {0, 0, 1}}, coloured);
  const Read it = read(coloured);
  std::multiset<std::string> names;
  for (const BrepFace& face : it.brep.faces) names.insert(face.name);
  EXPECT_EQ(names.count("colour_FF0000"), 1u);
  EXPECT_EQ(names.count("colour_0000FF"), 1u);
  EXPECT_EQ(names.count("housing"), 4u);
  ASSERT_EQ(it.report.faces.size(), 6u);
  for (const CadFace& face : it.report.faces) EXPECT_EQ(face.solids, std::vector<std::string>{"housing"});
}

TEST(CadFiles, D1_coordinates_stay_in_the_unit_of_the_file) {
  const std::string path = file("mm.step");
  occ::write_step(occ::box(1, 2, 3), path);
  const Read it = read(path);
  EXPECT_EQ(it.report.unit, "mm");
  EXPECT_EQ(it.report.metres_per_unit, 1e-3);
  // the same file in inches: the same numbers
  std::ifstream in(path);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string milli = "SI_UNIT(.MILLI.,.METRE.)", metre = "SI_UNIT($,.METRE.)";
  const std::size_t at = text.find(milli);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, milli.size(), metre);
  const std::string in_metres = file("m.step");
  std::ofstream(in_metres) << text;
  const Read other = read(in_metres);
  EXPECT_EQ(other.report.unit, "m");
  EXPECT_NEAR(grid(other.brep, 1).volume, 6, 1e-9);
}

TEST(CadFiles, D4_what_is_no_such_file_is_refused) {
  const std::string whole = file("whole.step");
  occ::write_step(occ::tee(), whole);
  std::ifstream in(whole);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const auto message = [&](const char* name, const std::string& content) -> std::string {
    const std::string path = file(name);
    std::ofstream(path) << content;
    try {
      read(path);
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
      return e.what();
    }
    return {};
  };
  EXPECT_NE(message("cut.step", text.substr(0, text.size() / 2)).find("not whole"), std::string::npos);
  EXPECT_NE(message("text.step", "hello\n").find("no STEP file"), std::string::npos);
  EXPECT_NE(message("empty.step", "").find("empty"), std::string::npos);
  EXPECT_NE(message("text.igs", "hello\n").find("no IGES file"), std::string::npos);
  EXPECT_NE(message("step.brep", text).find("no BREP file"), std::string::npos);
  EXPECT_NE(message("text.egads", "hello\n").find("no EGADS file"), std::string::npos);
  const std::string nothing = text.substr(0, text.find("DATA;") + 5) + "\nENDSEC;\nEND-ISO-10303-21;\n";
  EXPECT_NE(message("nothing.step", nothing).find("no faces"), std::string::npos);
  const std::string brep = file("whole.brep");
  occ::write_brep(occ::tee(), brep);
  std::ifstream in_brep(brep);
  const std::string brep_text((std::istreambuf_iterator<char>(in_brep)), {});
  EXPECT_NE(message("cut.brep", brep_text.substr(0, brep_text.size() / 2)), "");
}

TEST(CadFiles, D4_a_file_cut_anywhere_is_refused_or_read_never_worse) {
  const std::string path = file("whole.brep"), step = file("whole.step");
  occ::write_brep(occ::box(1, 1, 1), path);
  occ::write_step(occ::box(1, 1, 1), step);
  for (const std::string& whole : {path, step}) {
    std::ifstream in(whole);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    for (std::size_t k = 1; k < 40; ++k) {
      const std::string cut = file(whole == path ? "cut.brep" : "cut.step");
      std::ofstream(cut) << text.substr(0, text.size() * k / 40);
      try {
        read(cut);
      } catch (const InputError&) {
      }
    }
  }
}

TEST(CadFiles, P_reading_stops_when_asked) {
  const std::string path = file("tee.step");
  occ::write_step(occ::tee(), path);
  std::atomic<bool> cancel = true;
  Context context;
  context.cancel = &cancel;
  CadReport report;
  EXPECT_THROW(read_cad(path, {}, report, context), Cancelled);
}

}  // namespace
}  // namespace delfront
