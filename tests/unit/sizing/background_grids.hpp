// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "delfront/background.hpp"
#include "delfront/mesh.hpp"

namespace delfront::fixtures {

/// @brief n^3 cubes of six tetrahedra over [0,1]^3, inner points moved by up to jitter / n; cubes that `keep` (of the
/// centre) refuses are left out.
inline Mesh kuhn_box(
    int n, double jitter = 0, unsigned seed = 1, const std::function<bool(Point)>& keep = [](Point) { return true; }) {
  Mesh mesh;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(-jitter / n, jitter / n);
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const auto moved = [&](int a) { return double(a) / n + (a > 0 && a < n ? offset(random) : 0); };
        const double x = moved(i), y = moved(j), z = moved(k);
        mesh.points.push_back({x, y, z});
      }
  const auto id = [&](int i, int j, int k) { return VertexId(std::size_t(i + (n + 1) * (j + (n + 1) * k))); };
  static constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  CellBlock& block = mesh.block(CellType::tetrahedron);
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        if (!keep({(i + 0.5) / n, (j + 0.5) / n, (k + 0.5) / n})) continue;
        for (int order = 0; order < 6; ++order) {
          int at[3] = {i, j, k};
          std::vector<VertexId> tet = {id(i, j, k)};
          for (int axis : kOrders[order]) {
            ++at[axis];
            tet.push_back(id(at[0], at[1], at[2]));
          }
          if (order >= 3) std::swap(tet[1], tet[2]);
          block.vertices.insert(block.vertices.end(), tet.begin(), tet.end());
          block.group.push_back(GroupId());
        }
      }
  return mesh;
}

/// @brief n^2 squares of two triangles over [0,1]^2, inner points moved by up to jitter / n.
inline Mesh square_grid(
    int n, double jitter = 0, unsigned seed = 1, const std::function<bool(Point)>& keep = [](Point) { return true; }) {
  Mesh mesh;
  mesh.dimension = 2;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(-jitter / n, jitter / n);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const auto moved = [&](int a) { return double(a) / n + (a > 0 && a < n ? offset(random) : 0); };
      const double x = moved(i), y = moved(j);
      mesh.points.push_back({x, y, 0});
    }
  const auto id = [&](int i, int j) { return VertexId(std::size_t(i + (n + 1) * j)); };
  CellBlock& block = mesh.block(CellType::triangle);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (!keep({(i + 0.5) / n, (j + 0.5) / n, 0})) continue;
      for (VertexId v : {id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j), id(i + 1, j + 1), id(i, j + 1)})
        block.vertices.push_back(v);
      block.group.insert(block.group.end(), 2, GroupId());
    }
  return mesh;
}

/// @brief Append a field on the nodes: `value(point)` gives a number, or an array of them.
template <class Function>
void add_node_field(Mesh& mesh, const std::string& name, Function&& value) {
  Field field{name, Field::On::vertices, CellType::vertex, 1, {}};
  for (const Point& p : mesh.points) {
    const auto v = value(p);
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(v)>>) {
      field.values.push_back(v);
    } else {
      field.components = static_cast<int>(v.size());
      field.values.insert(field.values.end(), v.begin(), v.end());
    }
  }
  mesh.fields.push_back(std::move(field));
}

inline std::vector<Point> random_points(std::size_t n, double low, double high, unsigned seed, bool is_plane = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(low, high);
  std::vector<Point> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = at(random), y = at(random), z = at(random);
    points.push_back({x, y, is_plane ? 0 : z});
  }
  return points;
}

}  // namespace delfront::fixtures
