// SPDX-License-Identifier: Apache-2.0
#include "sizing/simplex_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/hilbert.hpp"
#include "delfront/errors.hpp"
#include "mesh/cell_shape.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;
constexpr std::uint32_t kNone = SimplexGrid::kNone;

double determinant(Point a, Point b, Point c) { return dot(a, cross(b, c)); }

/// Collects simplices and turns them positive.
class Splitter {
 public:
  Splitter(const Mesh& mesh, SimplexGrid& grid) : mesh_(mesh), grid_(grid) {}

  void add_volume_cell(const CellBlock& block, std::size_t cell) {
    const std::span<const VertexId> v = block[cell];
    if (block.type == CellType::tetrahedron) return add_tet(v[0], v[1], v[2], v[3]);
    if (block.type == CellType::polyhedron) {
      VertexId lowest;
      for_each_stream_face(v, [&](std::span<const VertexId> face) {
        lowest = std::min(lowest, *std::min_element(face.begin(), face.end()));
      });
      for_each_stream_face(v, [&](std::span<const VertexId> face) { add_face_tets(face, lowest); });
      return;
    }
    const VertexId lowest = *std::min_element(v.begin(), v.end());
    const CellShape& shape = shape_of(block.type);
    for (int f = 0; f < shape.num_facets; ++f) {
      const LocalFacet& facet = shape.facets[static_cast<std::size_t>(f)];
      std::array<VertexId, 4> face;
      for (int k = 0; k < facet.num_vertices; ++k)
        face[static_cast<std::size_t>(k)] = v[static_cast<std::size_t>(facet.vertices[static_cast<std::size_t>(k)])];
      add_face_tets({face.data(), static_cast<std::size_t>(facet.num_vertices)}, lowest);
    }
  }

  void add_plane_cell(std::span<const VertexId> v) {
    for_each_fan_triangle(v, [&](VertexId a, VertexId b, VertexId c) {
      const Point u = mesh_.points[b] - mesh_.points[a], w = mesh_.points[c] - mesh_.points[a];
      const double area = u.x * w.y - u.y * w.x;
      if (area > 0) grid_.cells.push_back({a.value, b.value, c.value, kNone});
      if (area < 0) grid_.cells.push_back({a.value, c.value, b.value, kNone});
    });
  }

 private:
  template <class Visit>
  static void for_each_stream_face(std::span<const VertexId> stream, Visit&& visit) {
    for (std::size_t i = 1; i < stream.size(); i += stream[i].index() + 1)
      visit(stream.subspan(i + 1, stream[i].index()));
  }

  template <class Visit>
  static void for_each_fan_triangle(std::span<const VertexId> face, Visit&& visit) {
    const std::size_t n = face.size();
    const auto low = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
    for (std::size_t k = 1; k + 1 < n; ++k) visit(face[low], face[(low + k) % n], face[(low + k + 1) % n]);
  }

  void add_face_tets(std::span<const VertexId> face, VertexId apex) {
    if (std::find(face.begin(), face.end(), apex) != face.end()) return;
    for_each_fan_triangle(face, [&](VertexId a, VertexId b, VertexId c) { add_tet(a, c, b, apex); });
  }

  void add_tet(VertexId a, VertexId b, VertexId c, VertexId d) {
    const Point origin = mesh_.points[a];
    const double volume = determinant(mesh_.points[b] - origin, mesh_.points[c] - origin, mesh_.points[d] - origin);
    if (volume > 0) grid_.cells.push_back({a.value, b.value, c.value, d.value});
    if (volume < 0) grid_.cells.push_back({a.value, c.value, b.value, d.value});
  }

  const Mesh& mesh_;
  SimplexGrid& grid_;
};

bool is_flat(const Mesh& mesh) {
  return std::all_of(mesh.points.begin(), mesh.points.end(), [](const Point& p) { return p.z == 0; });
}

void collect_cells(const Mesh& mesh, const std::string& name, SimplexGrid& grid, Context& context) {
  const bool has_volume = mesh.num_cells_of_dimension(3) > 0;
  const bool is_plane = !has_volume && mesh.num_cells_of_dimension(2) > 0 && is_flat(mesh);
  if (!has_volume && !is_plane)
    throw InputError(fmt::format(
        "{}: it has {} faces, {} lines and no volume cells, and is not in the plane z = 0; give a grid of tetrahedra "
        "(or, in the plane, triangles) that fills the region",
        name, mesh.num_cells_of_dimension(2), mesh.num_cells_of_dimension(1)));
  grid.dimension = is_plane ? 2 : 3;
  Splitter splitter(mesh, grid);
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) != grid.dimension) continue;
    for (std::size_t cell = 0; cell < block.size(); ++cell) {
      if (cell % kCheckEvery == 0) context.check_limits();
      if (is_plane)
        splitter.add_plane_cell(block[cell]);
      else
        splitter.add_volume_cell(block, cell);
    }
  }
  if (grid.cells.empty()) throw InputError(fmt::format("{}: all its cells are flat, without volume", name));
}

void order_cells(SimplexGrid& grid, int threads) {
  std::vector<Point> centres;
  centres.reserve(grid.cells.size());
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell) {
    Point sum;
    for (std::uint32_t v : grid.corners(cell)) sum = sum + grid.points[v];
    centres.push_back(sum / static_cast<double>(grid.num_corners()));
  }
  std::vector<SimplexGrid::Cell> ordered;
  ordered.reserve(grid.cells.size());
  grid.rank = hilbert_order(centres, threads);
  for (std::uint32_t cell : grid.rank) ordered.push_back(grid.cells[cell]);
  grid.cells = std::move(ordered);
}

/// A side of a cell by its sorted vertices.
struct Side {
  std::uint32_t b, c, cell, local;
  bool is_same(const Side& o) const { return b == o.b && c == o.c; }
};

/// The vertices of the face across from a corner, outward (anticlockwise from outside; along the border in the plane).
std::array<std::uint32_t, 3> face_across(const SimplexGrid& grid, std::size_t cell, std::size_t local) {
  static constexpr std::size_t kTet[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  static constexpr std::size_t kTriangle[3][3] = {{1, 2, 2}, {2, 0, 0}, {0, 1, 1}};
  const SimplexGrid::Cell& v = grid.cells[cell];
  const auto& at = grid.dimension == 3 ? kTet[local] : kTriangle[local];
  return {v[at[0]], v[at[1]], v[at[2]]};
}

void join(SimplexGrid& grid, std::span<const Side> sides) {
  if (sides.size() == 1) {
    grid.boundary.push_back(face_across(grid, sides[0].cell, sides[0].local));
  } else if (sides.size() == 2) {
    grid.neighbours[sides[0].cell][sides[0].local] = sides[1].cell;
    grid.neighbours[sides[1].cell][sides[1].local] = sides[0].cell;
  } else {
    grid.has_crowded_faces = true;
  }
}

/// Sides in buckets by their lowest vertex, equal ones side by side.
void find_neighbours(SimplexGrid& grid) {
  grid.neighbours.assign(grid.cells.size(), {kNone, kNone, kNone, kNone});
  std::vector<std::size_t> offsets(grid.points.size() + 1, 0);
  const auto for_each_side = [&](auto&& take) {
    for (std::size_t cell = 0; cell < grid.cells.size(); ++cell)
      for (std::size_t local = 0; local < grid.num_corners(); ++local) {
        std::array<std::uint32_t, 3> face = face_across(grid, cell, local);
        if (face[0] > face[1]) std::swap(face[0], face[1]);
        if (grid.dimension == 3 && face[1] > face[2]) std::swap(face[1], face[2]);
        if (grid.dimension == 3 && face[0] > face[1]) std::swap(face[0], face[1]);
        if (grid.dimension == 2) face[2] = kNone;
        take(face[0], Side{face[1], face[2], static_cast<std::uint32_t>(cell), static_cast<std::uint32_t>(local)});
      }
  };
  for_each_side([&](std::uint32_t lowest, const Side&) { ++offsets[lowest + 1]; });
  for (std::size_t i = 1; i < offsets.size(); ++i) offsets[i] += offsets[i - 1];
  std::vector<Side> sides(offsets.back());
  std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
  for_each_side([&](std::uint32_t lowest, const Side& side) { sides[next[lowest]++] = side; });
  for (std::size_t v = 0; v + 1 < offsets.size(); ++v) {
    const auto begin = sides.begin() + static_cast<std::ptrdiff_t>(offsets[v]);
    const auto end = sides.begin() + static_cast<std::ptrdiff_t>(offsets[v + 1]);
    std::sort(begin, end, [](const Side& p, const Side& q) {
      return std::tie(p.b, p.c, p.cell, p.local) < std::tie(q.b, q.c, q.cell, q.local);
    });
    for (auto first = begin; first != end;) {
      auto last = first + 1;
      while (last != end && last->is_same(*first)) ++last;
      join(grid, {first, last});
      first = last;
    }
  }
}

}  // namespace

double SimplexGrid::measure(std::size_t cell) const {
  const Cell& v = cells[cell];
  const Point a = points[v[0]], u = points[v[1]] - a, w = points[v[2]] - a;
  if (dimension == 2) return 0.5 * (u.x * w.y - u.y * w.x);
  return determinant(u, w, points[v[3]] - a) / 6;
}

std::array<Point, 4> SimplexGrid::gradients(std::size_t cell) const {
  const Cell& v = cells[cell];
  const Point a = points[v[0]], u = points[v[1]] - a, w = points[v[2]] - a;
  std::array<Point, 4> g;
  if (dimension == 2) {
    const double det = u.x * w.y - u.y * w.x;
    g[1] = {w.y / det, -w.x / det, 0};
    g[2] = {-u.y / det, u.x / det, 0};
    g[0] = -1 * (g[1] + g[2]);
    return g;
  }
  const Point t = points[v[3]] - a, normal = cross(w, t);
  const double det = dot(u, normal);
  g[1] = normal / det;
  g[2] = cross(t, u) / det;
  g[3] = cross(u, w) / det;
  g[0] = -1 * (g[1] + g[2] + g[3]);
  return g;
}

std::array<double, 4> SimplexGrid::barycentric(std::size_t cell, Point p) const {
  const Cell& v = cells[cell];
  const Point a = points[v[0]], u = points[v[1]] - a, w = points[v[2]] - a, r = p - a;
  if (dimension == 2) {
    const double det = u.x * w.y - u.y * w.x;
    const double l1 = (r.x * w.y - r.y * w.x) / det, l2 = (u.x * r.y - u.y * r.x) / det;
    return {1 - l1 - l2, l1, l2, 0};
  }
  const Point t = points[v[3]] - a, normal = cross(w, t), side = cross(u, r);
  const double det = dot(u, normal);
  const double l1 = dot(r, normal) / det, l2 = dot(t, side) / det, l3 = -dot(w, side) / det;
  return {1 - l1 - l2 - l3, l1, l2, l3};
}

Box SimplexGrid::box_of(std::size_t cell) const {
  Box box;
  for (std::uint32_t v : corners(cell)) box.add(points[v]);
  return box;
}

SimplexGrid build_simplex_grid(const Mesh& mesh, const std::string& name, Context& context) {
  SimplexGrid grid;
  grid.points.assign(mesh.points.begin(), mesh.points.end());
  collect_cells(mesh, name, grid, context);
  context.check_limits();
  order_cells(grid, context.threads);
  context.check_limits();
  find_neighbours(grid);
  return grid;
}

VertexCells vertex_to_cells(const SimplexGrid& grid) {
  VertexCells result;
  result.offsets.assign(grid.points.size() + 1, 0);
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell)
    for (std::uint32_t v : grid.corners(cell)) ++result.offsets[v + 1];
  for (std::size_t i = 1; i < result.offsets.size(); ++i) result.offsets[i] += result.offsets[i - 1];
  result.cells.resize(result.offsets.back());
  std::vector<std::uint32_t> next(result.offsets.begin(), result.offsets.end() - 1);
  std::vector<std::uint32_t> by_rank(grid.cells.size());
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell)
    by_rank[grid.rank[cell]] = static_cast<std::uint32_t>(cell);
  for (std::uint32_t cell : by_rank)
    for (std::uint32_t v : grid.corners(cell)) result.cells[next[v]++] = cell;
  return result;
}

std::vector<std::array<std::uint32_t, 2>> edges_of(const SimplexGrid& grid) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::size_t cell = 0; cell < grid.cells.size(); ++cell) {
    const std::span<const std::uint32_t> v = grid.corners(cell);
    for (std::size_t i = 0; i < v.size(); ++i)
      for (std::size_t j = i + 1; j < v.size(); ++j) edges.push_back({std::min(v[i], v[j]), std::max(v[i], v[j])});
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

VertexNeighbours::VertexNeighbours(const SimplexGrid& grid) : offsets(grid.points.size() + 1, 0) {
  const std::vector<std::array<std::uint32_t, 2>> edges = edges_of(grid);
  for (const auto& [a, b] : edges) {
    ++offsets[a + 1];
    ++offsets[b + 1];
  }
  for (std::size_t i = 1; i < offsets.size(); ++i) offsets[i] += offsets[i - 1];
  ends.resize(offsets.back());
  std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
  for (const auto& [a, b] : edges) {
    ends[next[a]++] = b;
    ends[next[b]++] = a;
  }
}

OnFace nearest_on_face(Point p, Point a, Point b, Point c) {
  const Point ab = b - a, ac = c - a, ap = p - a, normal = cross(ab, ac);
  const double squared = squared_length(normal);
  if (squared > 0) {
    const double v = dot(cross(ap, ac), normal) / squared, w = dot(cross(ab, ap), normal) / squared;
    if (v >= 0 && w >= 0 && v + w <= 1) return {{1 - v - w, v, w}, a + v * ab + w * ac};
  }
  const std::array<Point, 3> corner = {a, b, c};
  OnFace best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Point along = corner[next] - corner[k];
    const double length2 = squared_length(along);
    const double t = length2 > 0 ? std::clamp(dot(p - corner[k], along) / length2, 0.0, 1.0) : 0.0;
    const Point at = corner[k] + t * along;
    if (!(squared_length(p - at) < least)) continue;
    least = squared_length(p - at);
    best = {{0, 0, 0}, at};
    best.weight[k] = 1 - t;
    best.weight[next] += t;
  }
  return best;
}

}  // namespace delfront
