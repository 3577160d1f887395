// SPDX-License-Identifier: Apache-2.0
// Bad CAD files, made here: each is mended and that is said, or refused with what to try; none crashes or hangs what is
// ours, and none is read in silence.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "bad_shapes.hpp"
#include "occ_files.hpp"
#include "outcome.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using fixtures::find_outcome;
using fixtures::Outcome;
using Way = Outcome::Way;

std::string file(const std::string& name) { return (fixtures::scratch_folder() / name).string(); }

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string write(const TopoDS_Shape& shape, const std::string& suffix) {
  const std::string path = file("bad" + suffix);
  if (suffix == ".brep") occ::write_brep(shape, path);
  if (suffix == ".step") occ::write_step(shape, path);
  if (suffix == ".iges") occ::write_iges(shape, path);
  return path;
}

Outcome outcome_of(const TopoDS_Shape& shape, const std::string& suffix) { return find_outcome(write(shape, suffix)); }

const std::vector<std::string> kAll = {".brep", ".step", ".iges"};

void expect_unit_box(const Outcome& o, const std::string& what) {
  EXPECT_EQ(o.way, Way::gridded) << what << ": " << o.message;
  EXPECT_TRUE(o.is_closed) << what;
  EXPECT_EQ(o.free_edges, 0u) << what;
  EXPECT_NEAR(o.area, 6, 1e-9) << what;
  EXPECT_NEAR(std::abs(o.volume), 1, 1e-9) << what;
}

TEST(BadCad, D4_a_missing_face_is_said_by_the_edges_that_are_free) {
  for (const std::string& suffix : kAll) {
    const Outcome o = outcome_of(occ::box_with_a_face_missing(), suffix);
    EXPECT_EQ(o.way, Way::gridded) << suffix << o.message;
    EXPECT_EQ(o.free_edges, 4u) << suffix;
    EXPECT_FALSE(o.is_closed) << suffix;
    EXPECT_NEAR(o.area, 5, 1e-9) << suffix;
  }
}

TEST(BadCad, D4_a_wire_that_crosses_itself_is_mended_and_that_is_said) {
  for (const std::string& suffix : kAll) {
    const Outcome o = outcome_of(occ::crossing_wire(), suffix);
    EXPECT_EQ(o.way, Way::gridded) << suffix << o.message;
    EXPECT_GT(o.num_notes, 0u) << suffix;
    EXPECT_NEAR(o.area, 0.5, 1e-9) << suffix;
  }
}

TEST(BadCad, D4_an_edge_without_length_is_taken_out) {
  for (const double length : {0.0, 1e-9}) {
    const Outcome o = outcome_of(occ::box_with_a_tiny_edge(length), ".brep");
    expect_unit_box(o, std::to_string(length));
    EXPECT_TRUE(o.has("removed_edge")) << o.notes;
  }
  for (const std::string& suffix : kAll) expect_unit_box(outcome_of(occ::box_with_a_tiny_edge(1e-9), suffix), suffix);
  // OpenCASCADE's writer leaves out the two faces at an edge of no length
  EXPECT_GT(outcome_of(occ::box_with_a_tiny_edge(0), ".step").free_edges, 0u);
}

TEST(BadCad, D4_a_parameter_curve_of_another_place_is_found_again) {
  for (const double by : {0.3, 3.0}) {
    const Outcome o = outcome_of(occ::cylinder_with_a_moved_parameter_curve(by), ".brep");
    EXPECT_EQ(o.way, Way::gridded) << o.message;
    EXPECT_TRUE(o.has("dropped_parameter_curve")) << o.notes;
    EXPECT_FALSE(o.has("loose_tolerance")) << o.notes;
    EXPECT_NEAR(o.volume, 2 * M_PI, 0.01);
    // of two curves that disagree the reader of IGES takes the one in the parameters: said, gridded or not
    const Outcome iges = outcome_of(occ::cylinder_with_a_moved_parameter_curve(by), ".iges");
    EXPECT_TRUE(iges.way == Way::gridded || iges.has_place) << iges.message;
    EXPECT_GT(iges.num_notes, 0u);
  }
}

TEST(BadCad, D4_a_face_that_is_there_twice_is_there_once) {
  for (const std::string& suffix : kAll)
    for (const bool is_copied : {false, true}) {
      const Outcome o = outcome_of(occ::box_with_a_double_face(is_copied), suffix);
      expect_unit_box(o, suffix);
      EXPECT_EQ(o.faces, 6u);
      EXPECT_GT(o.num_notes, 0u);
    }
}

TEST(BadCad, D4_what_is_inside_out_or_turned_in_part_is_turned) {
  const Outcome o = outcome_of(occ::inside_out_box(), ".brep");
  EXPECT_TRUE(o.has("turned_solid")) << o.notes;
  EXPECT_NEAR(o.volume, 1, 1e-9);
  for (const std::string& suffix : kAll) {
    expect_unit_box(outcome_of(occ::inside_out_box(), suffix), suffix);
    const Outcome turned = outcome_of(occ::box_with_a_turned_face(), suffix);
    expect_unit_box(turned, suffix);
    EXPECT_GT(turned.num_notes, 0u) << suffix;
  }
}

TEST(BadCad, D4_solids_that_overlap_in_a_sliver_are_cut_by_each_other) {
  for (const double layer : {1e-3, 1e-6, 1e-8})
    for (const std::string& suffix : kAll) {
      const Outcome o = outcome_of(occ::overlapping_boxes(layer), suffix);
      EXPECT_EQ(o.way, Way::gridded) << layer << suffix << o.message;
      EXPECT_TRUE(o.has("imprinted")) << layer << suffix << o.notes;
    }
}

TEST(BadCad, D4_a_sheet_through_a_solid_is_cut_by_it) {
  for (const std::string& suffix : kAll) {
    const Outcome o = outcome_of(occ::sheet_through_a_box(), suffix);
    EXPECT_EQ(o.way, Way::gridded) << suffix << o.message;
    EXPECT_TRUE(o.has("imprinted")) << suffix << o.notes;
    EXPECT_NEAR(o.area, 6 + 4, 1e-9) << suffix;
  }
}

TEST(BadCad, D4_an_edge_of_no_face_is_left_out_and_that_is_said) {
  for (const std::string& suffix : kAll) {
    const Outcome o = outcome_of(occ::box_and_an_edge(), suffix);
    expect_unit_box(o, suffix);
    EXPECT_TRUE(o.has("loose_edges")) << suffix << o.notes;
  }
}

TEST(BadCad, D4_what_holds_no_faces_is_refused_with_what_to_try) {
  for (const std::string& suffix : kAll) {
    const Outcome empty = outcome_of(occ::empty_compound(), suffix), curves = outcome_of(occ::curves_only(), suffix);
    EXPECT_EQ(empty.way, Way::input_error) << suffix;
    EXPECT_EQ(curves.way, Way::input_error) << suffix;
    EXPECT_NE(empty.message.find("holds no faces"), std::string::npos) << empty.message;
    EXPECT_NE(curves.message.find("2 edges; curves alone bound nothing"), std::string::npos) << curves.message;
    for (const Outcome& o : {empty, curves}) EXPECT_NE(o.message.find("export"), std::string::npos) << o.message;
  }
}

TEST(BadCad, D4_places_that_are_none_are_refused_with_their_line) {
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300})
    for (const char* suffix : {".brep", ".step"}) {  // IGES has no corners
      const Outcome o = outcome_of(occ::box_with_a_corner_at(x), suffix);
      EXPECT_EQ(o.way, Way::input_error) << x << suffix;
      EXPECT_NE(o.message.find("line "), std::string::npos) << o.message;
    }
}

TEST(BadCad, D4_a_corner_far_from_its_edges_is_refused_with_its_place) {
  for (const char* suffix : {".brep", ".step"}) {
    const Outcome o = outcome_of(occ::box_with_a_corner_at(1e6), suffix);
    EXPECT_EQ(o.way, Way::input_error) << suffix << o.message;
    EXPECT_NE(o.message.find("contradicts itself"), std::string::npos) << o.message;
    EXPECT_NE(o.message.find(" at (1e+06, 0, 0)"), std::string::npos) << o.message;
  }
}

TEST(BadCad, D4_far_from_the_origin_coordinates_have_too_few_digits) {
  for (const std::string& suffix : kAll) {
    expect_unit_box(outcome_of(occ::box_at(1e6), suffix), suffix);
    for (const double x : {1e14, 1e30}) {
      const Outcome o = outcome_of(occ::box_at(x), suffix);
      EXPECT_EQ(o.way, Way::input_error) << x << suffix << o.message;
      EXPECT_NE(o.message.find("move it to the origin"), std::string::npos) << o.message;
    }
  }
}

/// Ours never crashes, and nothing goes on for ever. What crashes OpenCASCADE is for the command line's parent process.
void expect_civil(const Outcome& o, const std::string& what) {
  EXPECT_NE(o.way, Way::crashed) << what << ": " << o.message;
  EXPECT_NE(o.way, Way::other_error) << what << ": " << o.message;
  EXPECT_NE(o.way, Way::endless) << what;
  EXPECT_TRUE(o.way != Way::input_error || o.message.size() > 20) << what;
}

TEST(BadCad, D4_a_step_file_that_is_cut_is_refused_and_one_that_was_closed_again_is_civil) {
  const std::string text = text_of(write(occ::tee(), ".step"));
  for (std::size_t k = 1; k <= 20; ++k) {
    const std::string start = text.substr(0, text.size() * k / 21);
    const std::string cut = file("cut.step");
    std::ofstream(cut) << start;
    const Outcome o = find_outcome(cut, 20, false);
    EXPECT_EQ(o.way, Way::input_error) << k;
    EXPECT_NE(o.message.find("not whole"), std::string::npos) << o.message;
    std::ofstream(cut) << start.substr(0, start.rfind(";\n") + 2) << "ENDSEC;\nEND-ISO-10303-21;\n";
    const Outcome closed = find_outcome(cut, 20, false);
    expect_civil(closed, "cut at " + std::to_string(k) + " of 21");
    EXPECT_TRUE(closed.way != Way::gridded || closed.num_notes > 0 || closed.free_edges > 0) << k;
  }
}

TEST(BadCad, D4_references_to_entities_of_another_type) {
  const std::string text = text_of(write(occ::cylinder(1, 2), ".step"));
  const std::size_t data = text.find("DATA;");
  std::vector<std::size_t> references;
  for (std::size_t i = text.find('#', data); i != std::string::npos; i = text.find('#', i + 1))
    if (text[i - 1] != '\n') references.push_back(i);
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 60; ++round) {
    const std::size_t at = references[random() % references.size()], from = references[random() % references.size()];
    const auto word = [&](std::size_t i) { return text.substr(i, text.find_first_not_of("0123456789", i + 1) - i); };
    const std::string bad = file("wrong.step");
    std::ofstream(bad) << text.substr(0, at) << word(from) << text.substr(at + word(at).size());
    expect_civil(find_outcome(bad, 20, false), "seed 5, round " + std::to_string(round));
  }
}

TEST(BadCad, D4_bytes_changed_at_random) {
  constexpr unsigned kSeed = 7;
  const unsigned rounds = fixtures::setting("DELFRONT_BAD_CAD_ROUNDS", 100);
  for (const std::string& suffix : kAll) {
    const std::string text = text_of(write(occ::tee(), suffix));
    std::mt19937 random(kSeed);
    std::map<Way, unsigned> count;
    for (unsigned round = 0; round < rounds; ++round) {
      std::string bad = text;
      for (unsigned k = 0; k < 1 + round % 4; ++k) bad[random() % bad.size()] = char(random() % 256);
      const std::string path = file("bytes" + suffix);
      std::ofstream(path, std::ios::binary) << bad;
      const Outcome o = find_outcome(path, 20, false);
      expect_civil(o, suffix + ", seed 7, round " + std::to_string(round));
      ++count[o.way];
    }
    std::string summary = suffix;
    for (const auto& [way, n] : count) summary += ", " + fixtures::name_of(way) + " " + std::to_string(n);
    SCOPED_TRACE(summary);
    std::puts(summary.c_str());
    EXPECT_GT(count[Way::gridded], 0u);  // a digit in the header, say
  }
}

TEST(BadCad, D4_an_assembly_of_many_boxes) {
  for (const double gap : {0.5, 0.0}) {
    const std::string path = file("wall.step");
    const std::size_t side = fixtures::setting("DELFRONT_BOXES_A_SIDE", 7), n = side * side * side;
    occ::write_boxes(n, gap, path);
    const Outcome o = find_outcome(path, 600, false);
    EXPECT_EQ(o.way, Way::gridded) << o.message;
    EXPECT_EQ(o.faces, gap > 0 ? 6 * n : 3 * side * side * (side + 1)) << gap;
    EXPECT_EQ(o.has("imprinted"), gap == 0);
  }
}

}  // namespace
}  // namespace delfront
