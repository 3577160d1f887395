// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
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

void show(const std::string& name, const Outcome& o) {
  std::printf("%-28s %-15s %5.2f s notes%s(%zu) free %zu faces %zu closed %d area %g volume %g place %d: %s\n",
              name.c_str(), fixtures::name_of(o.way).c_str(), o.seconds, o.notes.c_str(), o.num_notes, o.free_edges,
              o.faces, o.is_closed, o.area, o.volume, o.has_place, o.message.c_str());
}

TEST(BadCad, explore) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, TopoDS_Shape>> all = {
      {"good", occ::box(1, 1, 1)},
      {"missing", occ::box_with_a_face_missing()},
      {"crossing", occ::crossing_wire()},
      {"zero_edge", occ::box_with_a_tiny_edge(0)},
      {"tiny_edge_1e-9", occ::box_with_a_tiny_edge(1e-9)},
      {"tiny_edge_1e-4", occ::box_with_a_tiny_edge(1e-4)},
      {"moved_0.3", occ::cylinder_with_a_moved_parameter_curve(0.3)},
      {"moved_3", occ::cylinder_with_a_moved_parameter_curve(3)},
      {"double", occ::box_with_a_double_face(false)},
      {"double_copied", occ::box_with_a_double_face(true)},
      {"inside_out", occ::inside_out_box()},
      {"turned", occ::box_with_a_turned_face()},
      {"overlap_1e-3", occ::overlapping_boxes(1e-3)},
      {"overlap_1e-6", occ::overlapping_boxes(1e-6)},
      {"overlap_1e-8", occ::overlapping_boxes(1e-8)},
      {"sheet", occ::sheet_through_a_box()},
      {"box_and_edge", occ::box_and_an_edge()},
      {"empty", occ::empty_compound()},
      {"curves", occ::curves_only()},
      {"corner_nan", occ::box_with_a_corner_at(nan)},
      {"corner_1e300", occ::box_with_a_corner_at(1e300)},
      {"corner_1e6", occ::box_with_a_corner_at(1e6)},
      {"box_at_1e9", occ::box_at(1e9)},
      {"box_at_1e14", occ::box_at(1e14)},
      {"box_at_1e30", occ::box_at(1e30)},
      {"inner_edge", occ::box_with_an_inner_edge()},
  };
  for (const auto& [name, shape] : all)
    for (const char* suffix : {".brep", ".step", ".iges"}) {
      const std::string path = file(name + suffix);
      try {
        if (suffix[1] == 'b')
          occ::write_brep(shape, path);
        else if (suffix[1] == 's')
          occ::write_step(shape, path);
        else
          occ::write_iges(shape, path);
      } catch (...) {
        std::printf("%s%s cannot be written\n", name.c_str(), suffix);
        continue;
      }
      show(name + suffix, find_outcome(path, 5));
    }
}

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(BadCad, flips) {
  for (const char* suffix : {".brep", ".step", ".iges"}) {
    const std::string whole = file(std::string("whole") + suffix);
    if (suffix[1] == 'b')
      occ::write_brep(occ::tee(), whole);
    else if (suffix[1] == 's')
      occ::write_step(occ::tee(), whole);
    else
      occ::write_iges(occ::tee(), whole);
    const std::string text = text_of(whole);
    std::map<std::string, int> count;
    std::mt19937 random(7);
    for (int i = 0; i < 100; ++i) {
      std::string bad = text;
      for (int k = 0; k < 1 + i % 4; ++k) bad[random() % bad.size()] = char(random() % 256);
      const std::string path = file(std::to_string(i) + suffix);
      std::ofstream(path, std::ios::binary) << bad;
      const Outcome o = find_outcome(path, 8, false);
      ++count[fixtures::name_of(o.way)];
      if (o.way != Way::gridded && o.way != Way::input_error) show(path, o);
    }
    for (const auto& [way, n] : count) std::printf("%s %s %d\n", suffix, way.c_str(), n);
  }
}

}  // namespace
}  // namespace delfront
