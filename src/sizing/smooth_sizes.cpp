// SPDX-License-Identifier: Apache-2.0
// Source sizes smoothed on a background grid.
//
// 1. Sizes of the field at the vertices, limited along the edges: no vertex exceeds a neighbour by more than the slope
//    times the length of the edge. Done from the least size up (as in Dijkstra's search), so once is enough.
// 2. Diffusion of u = log(size) with those as data d: u_i + kWeight (u_i - mean of the neighbours) = d_i, by
//    Gauss-Seidel in the order of the vertices; the mean is weighted by 1 / length. Diagonally dominant: the error at
//    least halves in each sweep.
// 3. Sizes are lowered to the field where diffusion lifted them, and limited along the edges again, which only lowers.
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "delfront/errors.hpp"
#include "delfront/size_sources.hpp"
#include "fmt/format.h"
#include "mesh/cell_shape.hpp"

namespace delfront {
namespace {

constexpr double kWeight = 1;
constexpr double kConverged = 1e-12;
constexpr int kMaxSweeps = 200;

struct Neighbours {
  std::vector<std::size_t> offset;
  std::vector<std::uint32_t> vertex;
  std::vector<double> length;
  std::size_t size() const { return offset.size() - 1; }
};

void add_edges(const CellBlock& block, std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges) {
  auto add = [&](VertexId a, VertexId b) {
    edges.emplace_back(a.value, b.value);
    edges.emplace_back(b.value, a.value);
  };
  const CellShape& shape = shape_of(block.type);
  if (shape.num_edges == 0 && block.type != CellType::line && block.type != CellType::vertex && block.size() > 0)
    throw InputError(
        fmt::format("background grid: it has cells of type {}; take triangles, quads, tetrahedra, "
                    "pyramids, prisms or hexahedra",
                    name_of(block.type)));
  for (std::size_t c = 0; c < block.size(); ++c) {
    const auto cell = block[c];
    if (block.type == CellType::line) add(cell[0], cell[1]);
    for (std::size_t e = 0; e < static_cast<std::size_t>(shape.num_edges); ++e)
      add(cell[static_cast<std::size_t>(shape.edges[e][0])], cell[static_cast<std::size_t>(shape.edges[e][1])]);
  }
}

Neighbours find_neighbours(const Mesh& grid) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const CellBlock& block : grid.blocks) add_edges(block, edges);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Neighbours result;
  result.offset.assign(grid.points.size() + 1, 0);
  for (const auto& [from, to] : edges) {
    ++result.offset[from + 1];
    result.vertex.push_back(to);
    result.length.push_back(distance(grid.points[VertexId(from)], grid.points[VertexId(to)]));
  }
  for (std::size_t v = 0; v < grid.points.size(); ++v) result.offset[v + 1] += result.offset[v];
  return result;
}

void limit_growth(const Neighbours& neighbours, double slope, std::vector<double>& size) {
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t v = 0; v < size.size(); ++v) queue.emplace(size[v], static_cast<std::uint32_t>(v));
  while (!queue.empty()) {
    const auto [value, v] = queue.top();
    queue.pop();
    if (value > size[v]) continue;
    for (std::size_t k = neighbours.offset[v]; k < neighbours.offset[v + 1]; ++k) {
      const double allowed = value + slope * neighbours.length[k];
      double& other = size[neighbours.vertex[k]];
      if (!(allowed < other)) continue;
      other = allowed;
      queue.emplace(allowed, neighbours.vertex[k]);
    }
  }
}

/// @return whether the largest change of a sweep was below kConverged
bool sweep(const Neighbours& neighbours, const std::vector<double>& data, std::vector<double>& u) {
  double largest = 0;
  for (std::size_t v = 0; v < u.size(); ++v) {
    double sum = 0, weights = 0;
    for (std::size_t k = neighbours.offset[v]; k < neighbours.offset[v + 1]; ++k) {
      if (!(neighbours.length[k] > 0)) continue;
      sum += u[neighbours.vertex[k]] / neighbours.length[k];
      weights += 1 / neighbours.length[k];
    }
    if (!(weights > 0) || !std::isfinite(data[v])) continue;
    const double next = (data[v] + kWeight * sum / weights) / (1 + kWeight);
    largest = std::max(largest, std::abs(next - u[v]));
    u[v] = next;
  }
  return largest < kConverged;
}

}  // namespace

std::vector<double> smooth_sizes(const Mesh& grid, const SizeField& sources, double growth, Context& context) {
  if (!(growth > 1) || !std::isfinite(growth))
    throw UsageError(fmt::format("growth is {}; it must be a number greater than 1, e.g. 1.2", growth));
  for (std::size_t v = 0; v < grid.points.size(); ++v) {
    const Point p = grid.points[VertexId(v)];
    if (!is_finite(p))
      throw InputError(
          fmt::format("background grid: vertex {} is at ({}, {}, {}); all must be numbers", v, p.x, p.y, p.z),
          {{p, {static_cast<std::uint32_t>(v)}}});
  }
  const double slope = (growth - 1) / growth;
  const Neighbours neighbours = find_neighbours(grid);
  std::vector<double> field(grid.points.size());
  sources.sizes(grid.points, field);
  std::vector<double> size = field;
  limit_growth(neighbours, slope, size);
  std::vector<double> data;
  data.reserve(size.size());
  for (const double s : size) data.push_back(std::log(s));
  std::vector<double> u = data;
  for (int i = 0; i < kMaxSweeps; ++i) {
    context.check_limits();
    if (sweep(neighbours, data, u)) break;
  }
  for (std::size_t v = 0; v < size.size(); ++v) size[v] = std::min(std::exp(u[v]), field[v]);
  limit_growth(neighbours, slope, size);
  return size;
}

}  // namespace delfront
