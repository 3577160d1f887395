// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "delfront/mesh.hpp"
#include "io/cells.hpp"
#include "support/errors.hpp"
#include "support/support.hpp"

namespace delfront::fixtures {

/// @brief A context that keeps the warnings.
struct Recorder {
  Context context;
  std::vector<std::string> warnings;
  Recorder() {
    context.on_log = [this](LogLevel level, const std::string& text) {
      if (level == LogLevel::warning) warnings.push_back(text);
    };
  }
};

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream all;
  all << file.rdbuf();
  return all.str();
}

inline std::filesystem::path write_text(const std::string& name, const std::string& text) {
  const std::filesystem::path path = scratch_folder("io_input") / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

/// @brief Append every face with one cell, as a cell of a group chosen by `patch(centre)`.
template <class Function>
void add_boundary(Mesh& mesh, Function&& patch) {
  std::map<std::vector<std::uint32_t>, std::pair<int, std::vector<VertexId>>> faces;
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) != 3) continue;
    for (std::size_t cell = 0; cell < block.size(); ++cell)
      for_each_face(block, cell, [&](std::span<const VertexId> corners) {
        std::vector<std::uint32_t> key;
        for (VertexId v : corners) key.push_back(v.value);
        std::sort(key.begin(), key.end());
        auto& entry = faces[key];
        ++entry.first;
        entry.second.assign(corners.begin(), corners.end());
      });
  }
  for (const auto& [key, entry] : faces) {
    Point centre;
    for (VertexId v : entry.second) centre = centre + mesh.points[v];
    if (entry.first == 1) add_face(mesh, entry.second, patch(centre / double(entry.second.size())));
  }
}

/// @brief Two boxes side by side, six tetrahedra each: regions "fluid" and "solid", named patches, the face between
/// them as a two-sided group, endless decimals everywhere.
inline Mesh two_boxes() {
  Mesh mesh;
  const double a = 1.0 / 3, b = 3.14159265358979312e-3, c = 1e6 / 7;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 3; ++i) mesh.points.push_back({a * i + 0.1, b * j - 0.7, c * k});
  const auto id = [](int i, int j, int k) { return VertexId(std::size_t(i + 3 * (j + 2 * k))); };
  const GroupId regions[2] = {mesh.add_group(3, "fluid"), mesh.add_group(3, "solid")};
  const GroupId wall = mesh.add_group(2, "left wall", "wall"), rest = mesh.add_group(2, "rest");
  const GroupId between = mesh.add_group(2, "between", "interface");
  mesh.groups[between].two_sided = true;
  static constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int box = 0; box < 2; ++box)
    for (int n = 0; n < 6; ++n) {  // Kuhn's split: from corner to corner along the axes in each order
      int at[3] = {box, 0, 0};
      std::vector<VertexId> tet = {id(at[0], at[1], at[2])};
      for (int axis : kOrders[n]) {
        ++at[axis];
        tet.push_back(id(at[0], at[1], at[2]));
      }
      if (n >= 3) std::swap(tet[1], tet[2]);  // odd permutations are turned over
      add_cell(mesh, CellType::tetrahedron, tet, regions[box]);
    }
  add_boundary(mesh, [&](Point centre) { return centre.x < 0.1 + 1e-9 ? wall : rest; });
  add_cell(mesh, CellType::triangle, std::array{id(1, 0, 0), id(1, 1, 0), id(1, 1, 1)}, between);
  add_cell(mesh, CellType::triangle, std::array{id(1, 0, 0), id(1, 1, 1), id(1, 0, 1)}, between);
  return mesh;
}

/// @brief A hexahedron, a prism beside it, a pyramid on it and a tetrahedron on that; one region, two patches.
inline Mesh mixed_cells() {
  Mesh mesh;
  const double t = 1.0 / 3;
  const Point points[] = {{0, 0, 0}, {t, 0, 0}, {t, t, 0},     {0, t, 0},     {0, 0, t},           {t, 0, t},
                          {t, t, t}, {0, t, t}, {0.7, 0.1, 0}, {0.7, 0.1, t}, {t / 2, t / 2, 0.7}, {0.5, 0.2, 0.6}};
  for (Point p : points) mesh.points.push_back(p);
  const auto cell = [&](CellType type, std::vector<std::size_t> v, GroupId group) {
    std::vector<VertexId> ids;
    for (std::size_t i : v) ids.push_back(VertexId(i));
    add_cell(mesh, type, ids, group);
  };
  const GroupId region = mesh.add_group(3, "air");
  cell(CellType::tetrahedron, {5, 6, 10, 11}, region);
  cell(CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}, region);
  cell(CellType::prism, {1, 8, 2, 5, 9, 6}, region);
  cell(CellType::pyramid, {4, 5, 6, 7, 10}, region);
  const GroupId low = mesh.add_group(2, "low", "wall"), high = mesh.add_group(2, "high");
  add_boundary(mesh, [&](Point centre) { return centre.z < 0.2 ? low : high; });
  return mesh;
}

/// @brief Unit square of two triangles and a quad beside it: region "plane", markers "in" and "out", all z = 0.
inline Mesh plane_grid() {
  Mesh mesh;
  mesh.dimension = 2;
  const double t = 1.0 / 7;
  for (Point p :
       {Point{0, 0, 0}, Point{t, 0, 0}, Point{2 * t, 0, 0}, Point{0, t, 0}, Point{t, t, 0}, Point{2 * t, t, 0}})
    mesh.points.push_back(p);
  const auto v = [](std::size_t i) { return VertexId(i); };
  const GroupId plane = mesh.add_group(2, "plane"), in = mesh.add_group(1, "in"), out = mesh.add_group(1, "out");
  add_cell(mesh, CellType::triangle, std::array{v(0), v(1), v(4)}, plane);
  add_cell(mesh, CellType::triangle, std::array{v(0), v(4), v(3)}, plane);
  add_cell(mesh, CellType::quad, std::array{v(1), v(2), v(5), v(4)}, plane);
  add_cell(mesh, CellType::line, std::array{v(3), v(0)}, in);
  for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 5}, {5, 4}, {4, 3}})
    add_cell(mesh, CellType::line, std::array{v(std::size_t(a)), v(std::size_t(b))}, out);
  return mesh;
}

/// @brief What a format keeps of groups.
struct Keeps {
  bool kinds = true;    // kind and two_sided
  bool regions = true;  // groups of the top dimension
  bool group_order = true;
  std::map<std::string, std::string> renamed;
};

inline std::string cell_group_name(const Mesh& mesh, const CellBlock& block, std::size_t cell) {
  const std::int64_t group = group_of(block, cell);
  return group < 0 ? "(none)" : mesh.groups[GroupId(std::size_t(group))].name;
}

inline void expect_same_groups(const Mesh& got, const Mesh& want, const Keeps& keeps) {
  const auto list = [&](const Mesh& mesh, bool rename) {
    std::vector<std::string> all;
    for (const Group& group : mesh.groups) {
      if (!keeps.regions && group.dimension == mesh.dimension) continue;
      std::string name = group.name;
      if (const auto it = keeps.renamed.find(name); rename && it != keeps.renamed.end()) name = it->second;
      std::string line = std::to_string(group.dimension) + " " + name;
      if (keeps.kinds) line += " kind=" + group.kind + (group.two_sided ? " two-sided" : "");
      all.push_back(line);
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(list(got, false), list(want, true));
}

/// @brief Points bit for bit, cells in order, the name of every cell's group, the groups.
inline void expect_same(const Mesh& got, const Mesh& want, const Keeps& keeps = {}) {
  EXPECT_EQ(got.dimension, want.dimension);
  ASSERT_EQ(got.points.size(), want.points.size());
  for (std::size_t i = 0; i < got.points.size(); ++i)
    ASSERT_EQ(got.points[VertexId(i)], want.points[VertexId(i)]) << "point " << i;
  for (const CellBlock& block : want.blocks) {
    const CellBlock* found = got.find_block(block.type);
    ASSERT_TRUE(found || block.size() == 0) << name_of(block.type);
    if (!found) continue;
    EXPECT_EQ(found->vertices, block.vertices) << name_of(block.type);
    if (num_vertices(block.type) == 0) {
      EXPECT_EQ(found->offsets, block.offsets) << name_of(block.type);
    }
    ASSERT_EQ(found->size(), block.size());
    if (!keeps.regions && dimension(block.type) == want.dimension) continue;
    for (std::size_t cell = 0; cell < block.size(); ++cell) {
      std::string name = cell_group_name(want, block, cell);
      if (const auto it = keeps.renamed.find(name); it != keeps.renamed.end()) name = it->second;
      ASSERT_EQ(cell_group_name(got, *found, cell), name) << name_of(block.type) << " " << cell;
    }
  }
  std::size_t num_got = 0, num_want = 0;
  for (const CellBlock& block : got.blocks) num_got += block.size();
  for (const CellBlock& block : want.blocks) num_want += block.size();
  EXPECT_EQ(num_got, num_want);
  expect_same_groups(got, want, keeps);
}

/// @brief Write, look for leftovers, read back.
inline Mesh round_trip(const Mesh& mesh, const std::string& name, const WriteOptions& options = {},
                       std::vector<std::string>* notes = nullptr) {
  Context context;
  const std::filesystem::path folder = scratch_folder("io_round_trip");
  const std::vector<std::string> said = write_mesh(mesh, (folder / name).string(), context, options);
  if (notes) *notes = said;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "a temporary file was left behind";
  return read_mesh((folder / name).string(), context);
}

/// @brief The message of the error of this type that reading gives; fails the test where there is none.
template <class Error>
std::string message_of_reading(const std::filesystem::path& path) {
  SCOPED_TRACE(path);
  Context context;
  return message_of<Error>([&] { read_mesh(path.string(), context); });
}

}  // namespace delfront::fixtures
