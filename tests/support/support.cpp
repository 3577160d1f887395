// SPDX-License-Identifier: Apache-2.0
#include "support/support.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>

namespace delfront::fixtures {

namespace fs = std::filesystem;

std::optional<fs::path> shared_data() {
  const char* given = std::getenv("DELFRONT_SHARED");
  const fs::path root = given ? fs::path(given) : fs::path(DELFRONT_SOURCE_DIR) / ".." / "shared";
  if (fs::is_directory(root / "data")) return root / "data";
  return std::nullopt;
}

fs::path scratch_folder(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() / ("delfront_test_" + std::to_string(::getpid())) / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

fs::path scratch_folder() { return scratch_folder(testing::UnitTest::GetInstance()->current_test_info()->name()); }

unsigned setting(const char* name, unsigned usual) {
  const char* given = std::getenv(name);
  return given ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : usual;
}

std::size_t count_of(std::string_view text, std::string_view piece) {
  std::size_t n = 0;
  for (std::size_t at = text.find(piece); at != std::string_view::npos; at = text.find(piece, at + 1)) ++n;
  return n;
}

Mesh cube_surface() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.points.push_back({double(i & 1), double((i >> 1) & 1), double(i >> 2)});
  struct Side {
    const char* name;
    std::array<int, 4> corners;  // anticlockwise seen from outside
  };
  const Side sides[6] = {{"xmin", {0, 4, 6, 2}}, {"xmax", {1, 3, 7, 5}}, {"ymin", {0, 1, 5, 4}},
                         {"ymax", {2, 6, 7, 3}}, {"zmin", {0, 2, 3, 1}}, {"zmax", {4, 5, 7, 6}}};
  CellBlock& triangles = mesh.block(CellType::triangle);
  for (const Side& side : sides) {
    const GroupId group = mesh.add_group(2, side.name);
    for (const std::array<int, 3>& corner : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      for (int k : corner) triangles.vertices.push_back(VertexId(std::size_t(side.corners[std::size_t(k)])));
      triangles.group.push_back(group);
    }
  }
  return mesh;
}

Mesh sphere_surface(int levels) {
  Mesh mesh;
  const double phi = (1 + std::sqrt(5.0)) / 2;
  const double corners[12][3] = {{-1, phi, 0},  {1, phi, 0},  {-1, -phi, 0}, {1, -phi, 0}, {0, -1, phi},  {0, 1, phi},
                                 {0, -1, -phi}, {0, 1, -phi}, {phi, 0, -1},  {phi, 0, 1},  {-phi, 0, -1}, {-phi, 0, 1}};
  auto on_sphere = [](Point p) { return p / length(p); };
  for (const auto& c : corners) mesh.points.push_back(on_sphere({c[0], c[1], c[2]}));
  std::vector<std::array<std::size_t, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middle;
    auto midpoint = [&](std::size_t a, std::size_t b) {
      const auto key = std::minmax(a, b);
      const auto [it, is_new] = middle.try_emplace({key.first, key.second}, mesh.points.size());
      if (is_new) mesh.points.push_back(on_sphere(mesh.points[VertexId(a)] + mesh.points[VertexId(b)]));
      return it->second;
    };
    std::vector<std::array<std::size_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::size_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  CellBlock& triangles = mesh.block(CellType::triangle);
  const GroupId group = mesh.add_group(2, "sphere");
  for (const auto& face : faces) {
    for (std::size_t v : face) triangles.vertices.push_back(VertexId(v));
    triangles.group.push_back(group);
  }
  return mesh;
}

}  // namespace delfront::fixtures
