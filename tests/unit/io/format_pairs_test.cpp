// SPDX-License-Identifier: Apache-2.0
// Ten grids through every pair of formats that hold grids: nothing that both can hold is lost or changed.
#include <cmath>
#include <tuple>

#include "ten_grids.hpp"

namespace delfront {
namespace {

using namespace fixtures;

/// What a format keeps of a grid.
struct FormatCase {
  std::string file;
  std::string format = "";
  double precision = 0;  // of coordinates, relative to the largest
  bool plane = true;     // grids in the plane, with their boundary
  bool volume = true;
  bool regions = true;
  bool inner = true;                 // faces of inner patches
  std::set<std::string> kinds = {};  // that come back
  bool loose_names = true;           // cells without a group stay so
};

void PrintTo(const FormatCase& format, std::ostream* out) { *out << format.file << " " << format.format; }

const std::set<std::string> kAllKinds = {"wall", "inlet", "outlet", "farfield", "symmetry", "interface", "cyclic"};
const std::set<std::string> kSolverKinds = {"wall", "inlet", "outlet", "farfield", "symmetry", "cyclic"};

std::vector<FormatCase> all_formats() {
  std::vector<FormatCase> all = {{.file = "a.vtu", .kinds = kAllKinds},
                                 {.file = "a.msh"},
                                 {.file = "a.mesh", .kinds = kAllKinds},
                                 {.file = "a.meshb", .kinds = kAllKinds},
                                 {.file = "a.bdf", .precision = 1e-10, .kinds = kAllKinds},
                                 {.file = "a.inp", .kinds = kAllKinds},
                                 {.file = "f.msh", .format = "fluent", .kinds = kAllKinds},
                                 {.file = "a.su2", .regions = false, .inner = false},
                                 {.file = "case/", .plane = false, .kinds = {"wall", "symmetry"}},
                                 {.file = "a.ugrid", .plane = false, .kinds = kSolverKinds, .loose_names = false},
                                 {.file = "a.b8.ugrid", .plane = false, .kinds = kSolverKinds, .loose_names = false},
                                 {.file = "a.lb8.ugrid", .plane = false, .kinds = kSolverKinds, .loose_names = false}};
  all.push_back({.file = "a.exo", .kinds = kAllKinds});
  for (const char* name : {"cgns", "vtkhdf", "xdmf"})  // where their libraries are
    if (std::any_of(formats().begin(), formats().end(), [&](const FormatInfo& f) { return f.name == name; }))
      all.push_back({.file = std::string("a.") + name, .kinds = kAllKinds});
  return all;
}

std::string as_word(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

/// Cells by type and group, each by its sorted vertices: formats may sort cells and turn them.
using Cells = std::map<std::pair<CellType, std::string>, std::multiset<std::vector<std::uint32_t>>>;

Cells cells_of(const Mesh& mesh, const FormatCase& keeps) {
  Cells cells;
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; cell < block.size(); ++cell) {
      const std::int64_t group = group_of(block, cell);
      const bool is_boundary = dimension(block.type) == mesh.dimension - 1;
      std::string name;
      if (group >= 0) {
        const Group& of_cell = mesh.groups[GroupId(std::size_t(group))];
        if (is_boundary && of_cell.two_sided && !keeps.inner) continue;
        if (is_boundary || keeps.regions) name = as_word(of_cell.name);
      }
      if (is_boundary && mesh.dimension == 2 && !keeps.plane) continue;
      std::vector<std::uint32_t> key;
      for (const VertexId v : block[cell]) key.push_back(v.value);
      std::sort(key.begin(), key.end());
      cells[{block.type, name}].insert(key);
    }
  return cells;
}

std::set<std::tuple<int, std::string, std::string, bool>> groups_of(const Mesh& mesh, const FormatCase& keeps) {
  std::set<std::tuple<int, std::string, std::string, bool>> all;
  for (const Group& group : mesh.groups) {
    const bool is_region = group.dimension == mesh.dimension;
    if (is_region ? !keeps.regions : group.two_sided && !keeps.inner) continue;
    const std::string kind = keeps.kinds.contains(group.kind) ? group.kind : "";
    all.insert({group.dimension, as_word(group.name), is_region ? "" : kind, group.two_sided && !is_region});
  }
  return all;
}

/// Twice the signed area, or six times the signed volume: no cell may turn over.
double least_measure(const Mesh& mesh) {
  double least = 1e300;
  const auto corner = [&](const CellBlock& block, std::size_t cell, std::size_t k) {
    return mesh.points[block[cell][k]];
  };
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == mesh.dimension && cell < block.size(); ++cell) {
      const Point a = corner(block, cell, 0), b = corner(block, cell, 1) - a;
      const bool is_tensor = block.type == CellType::hexahedron || block.type == CellType::pyramid;
      const Point c = corner(block, cell, is_tensor || block.type == CellType::quad ? 3 : 2) - a;
      if (mesh.dimension == 2) {
        least = std::min(least, cross(b, c).z);
        continue;
      }
      const std::size_t up = block.type == CellType::tetrahedron || block.type == CellType::prism ? 3 : 4;
      least = std::min(least, dot(cross(b, c), corner(block, cell, up) - a));
    }
  return least;
}

FormatCase both(const FormatCase& a, const FormatCase& b) {
  FormatCase keeps = a;
  keeps.precision = std::max(a.precision, b.precision);
  keeps.plane = a.plane && b.plane;
  keeps.volume = a.volume && b.volume;
  keeps.regions = a.regions && b.regions;
  keeps.inner = a.inner && b.inner;
  keeps.kinds.clear();
  std::set_intersection(a.kinds.begin(), a.kinds.end(), b.kinds.begin(), b.kinds.end(),
                        std::inserter(keeps.kinds, keeps.kinds.end()));
  return keeps;
}

Mesh through(const Mesh& mesh, const FormatCase& format, const std::filesystem::path& folder) {
  Context context;
  const std::string path = (folder / format.file).string();
  write_mesh(mesh, path, context, {}, format.format);
  return read_mesh(path, context);
}

void expect_kept(const Mesh& got, const Mesh& want, const FormatCase& keeps) {
  ASSERT_EQ(got.dimension, want.dimension);
  ASSERT_EQ(got.points.size(), want.points.size());
  const Box box = want.bounding_box();
  const double scale = std::max(length(box.low), length(box.high));
  for (std::size_t i = 0; i < got.points.size(); ++i)
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(got.points[VertexId(i)][k], want.points[VertexId(i)][k], keeps.precision * scale) << "point " << i;
  EXPECT_EQ(cells_of(got, keeps), cells_of(want, keeps));
  EXPECT_EQ(groups_of(got, keeps), groups_of(want, keeps));
  EXPECT_GT(least_measure(got), 0);
}

class FormatPairs : public testing::TestWithParam<FormatCase> {};

TEST_P(FormatPairs, ten_grids_go_there_and_on_to_every_other) {
  const FormatCase first = GetParam();
  const std::filesystem::path folder = scratch_folder();
  for (const auto& [name, mesh] : ten_grids()) {
    if (mesh.dimension == 2 && !first.plane) continue;
    SCOPED_TRACE(name + " through " + first.file + " " + first.format);
    const Mesh once = through(mesh, first, folder);
    ASSERT_NO_FATAL_FAILURE(expect_kept(once, mesh, both(first, first)));
    for (const FormatCase& second : all_formats()) {
      if (mesh.dimension == 2 && !second.plane) continue;
      SCOPED_TRACE("and then " + second.file + " " + second.format);
      ASSERT_NO_FATAL_FAILURE(expect_kept(through(once, second, folder), mesh, both(first, second)));
    }
  }
}

TEST_P(FormatPairs, groups_without_cells_stay_or_are_named) {
  Mesh mesh = two_region_block();
  mesh.add_group(2, "ghost_patch", "wall");
  mesh.add_group(3, "ghost_region");
  const std::string path = (scratch_folder() / GetParam().file).string();
  Context context;
  const std::vector<std::string> notes = write_mesh(mesh, path, context, {}, GetParam().format);
  std::string known;
  for (const std::string& note : notes) known += note + "\n";
  for (const Group& group : read_mesh(path, context).groups) known += group.name + "\n";
  EXPECT_NE(known.find("ghost_patch"), std::string::npos) << known;
  EXPECT_TRUE(!GetParam().regions || known.find("ghost_region") != std::string::npos) << known;
}

INSTANTIATE_TEST_SUITE_P(Formats, FormatPairs, testing::ValuesIn(all_formats()), [](const auto& test) {
  std::string name = test.param.file + test.param.format;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
}  // namespace delfront
