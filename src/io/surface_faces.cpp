// SPDX-License-Identifier: Apache-2.0
#include "io/surface_faces.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "io/cells.hpp"

namespace delfront {

namespace {

Point newell_normal(const Mesh& mesh, std::span<const VertexId> corners) {
  Point normal;
  const Point origin = mesh.points[corners[0]];
  for (std::size_t i = 0; i < corners.size(); ++i)
    normal = normal + cross(mesh.points[corners[i]] - origin, mesh.points[corners[(i + 1) % corners.size()]] - origin);
  return normal;
}

/// Twice the area times the sign of the turn, over the squared edges: 0 flat, negative reflex.
double shape(Point a, Point b, Point c, Point normal) {
  const double edges = squared_length(b - a) + squared_length(c - b) + squared_length(a - c);
  return edges > 0 ? dot(cross(b - a, c - a), normal) / edges : 0;
}

bool is_inside(Point p, Point a, Point b, Point c, Point normal) {
  return dot(cross(b - a, p - a), normal) >= 0 && dot(cross(c - b, p - b), normal) >= 0 &&
         dot(cross(a - c, p - c), normal) >= 0;
}

/// The best ear: convex, no other corner in it; where there is none (not planar, crossing) the best shape alone.
std::size_t best_ear(const Mesh& mesh, const std::vector<VertexId>& ring, Point normal) {
  std::size_t best = 0, fallback = 0;
  double best_shape = 0, fallback_shape = -1e300;
  const std::size_t n = ring.size();
  for (std::size_t i = 0; i < n; ++i) {
    const VertexId before = ring[(i + n - 1) % n], after = ring[(i + 1) % n];
    const Point a = mesh.points[before], b = mesh.points[ring[i]], c = mesh.points[after];
    const double here = shape(a, b, c, normal);
    if (here > fallback_shape) fallback = i, fallback_shape = here;
    if (here <= best_shape) continue;
    const bool is_blocked = std::any_of(ring.begin(), ring.end(), [&](VertexId v) {
      const Point p = mesh.points[v];
      return p != a && p != b && p != c && is_inside(p, a, b, c, normal);
    });
    if (!is_blocked) best = i, best_shape = here;
  }
  return best_shape > 0 ? best : fallback;
}

}  // namespace

SurfaceFaces::SurfaceFaces(const Mesh& mesh, const char* format, std::vector<std::string>& notes) : mesh_(mesh) {
  for (std::uint32_t b = 0; b < mesh.blocks.size(); ++b)
    if (dimension(mesh.blocks[b].type) == 2)
      for (std::uint32_t cell = 0; cell < mesh.blocks[b].size(); ++cell) faces_.push_back({b, cell});
  if (faces_.empty())
    throw InputError(
        fmt::format("{} holds faces only, and this mesh has none; write a volume format (vtu, msh)", format));
  std::stable_sort(faces_.begin(), faces_.end(), [this](Face a, Face b) { return group(a).value < group(b).value; });
  const std::size_t volumes = mesh.num_cells_of_dimension(3);
  if (volumes > 0)
    notes.push_back(fmt::format("{}: {} volume cells are left out, faces only are written", format, volumes));
  note_left_out_fields(mesh, format, notes);
  note_left_out_kinds(mesh, format, notes);
  note_left_out_curves(mesh, format, notes);
  if (const std::size_t lines = mesh.num_cells(CellType::line); mesh.dimension == 2 && lines > 0)
    notes.push_back(fmt::format("{}: the boundary, {} lines with their names, is left out; VTU, MSH and SU2 keep it",
                                format, lines));
  if (volumes == 0) {
    for (std::size_t i = 0; i < mesh.points.size(); ++i) points_.push_back(VertexId(i));
    return;
  }
  number_.assign(mesh.points.size(), 0);
  for (const Face& face : faces_)
    for (VertexId v : corners(face)) number_[v.index()] = 1;
  for (std::size_t i = 0; i < number_.size(); ++i) {
    if (number_[i] == 0) continue;
    number_[i] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(VertexId(i));
  }
}

GroupId SurfaceFaces::group(Face face) const {
  const CellBlock& block = mesh_.blocks[face.block];
  return face.cell < block.group.size() ? block.group[face.cell] : GroupId();
}

std::vector<std::array<VertexId, 3>> split_polygon(const Mesh& mesh, std::span<const VertexId> corners) {
  std::vector<std::array<VertexId, 3>> triangles;
  std::vector<VertexId> ring(corners.begin(), corners.end());
  const Point normal = newell_normal(mesh, corners);
  while (ring.size() > 3) {
    const std::size_t n = ring.size(), i = best_ear(mesh, ring, normal);
    triangles.push_back({ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (ring.size() == 3) triangles.push_back({ring[0], ring[1], ring[2]});
  return triangles;
}

}  // namespace delfront
