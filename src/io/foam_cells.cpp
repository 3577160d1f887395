// SPDX-License-Identifier: Apache-2.0
// A cell's type is guessed from its counts of faces and corners, its vertices are put in order from one face and the
// edges that leave it, and then all faces of that type must be those of the cell; what does not fit is a polyhedron.
#include "io/foam_cells.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>

#include "delfront/errors.hpp"
#include "io/cells.hpp"

namespace delfront {

namespace {

using Ring = std::vector<VertexId>;

/// All faces of one cell, outward.
std::vector<Ring> outward_faces(const FoamFaceList& faces, std::span<const std::uint32_t> of_cell, std::uint32_t cell) {
  std::vector<Ring> rings;
  for (const std::uint32_t face : of_cell) {
    const auto corners = faces[face];
    rings.emplace_back(corners.begin(), corners.end());
    if (faces.owner[face] != cell) std::reverse(rings.back().begin(), rings.back().end());
  }
  return rings;
}

/// The ring from its smallest vertex on, so that equal turns are equal.
Ring from_smallest(Ring ring) {
  std::rotate(ring.begin(),
              std::min_element(ring.begin(), ring.end(), [](VertexId a, VertexId b) { return a.value < b.value; }),
              ring.end());
  return ring;
}

CellType guess_type(const std::vector<Ring>& rings, std::size_t num_corners) {
  const auto num_triangles = std::count_if(rings.begin(), rings.end(), [](const Ring& r) { return r.size() == 3; });
  const auto num_quads = std::count_if(rings.begin(), rings.end(), [](const Ring& r) { return r.size() == 4; });
  if (static_cast<std::size_t>(num_triangles + num_quads) != rings.size()) return CellType::polyhedron;
  if (num_triangles == 4 && num_quads == 0 && num_corners == 4) return CellType::tetrahedron;
  if (num_triangles == 4 && num_quads == 1 && num_corners == 5) return CellType::pyramid;
  if (num_triangles == 2 && num_quads == 3 && num_corners == 6) return CellType::prism;
  if (num_triangles == 0 && num_quads == 6 && num_corners == 8) return CellType::hexahedron;
  return CellType::polyhedron;
}

/// The vertex that an edge joins to `v` and that is not on the base.
std::optional<VertexId> above(const std::vector<Ring>& rings, const Ring& base, VertexId v) {
  const auto is_on_base = [&](VertexId w) { return std::find(base.begin(), base.end(), w) != base.end(); };
  for (const Ring& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (ring[i] != v) continue;
      for (const VertexId w : {ring[(i + 1) % ring.size()], ring[(i + ring.size() - 1) % ring.size()]})
        if (!is_on_base(w)) return w;
    }
  return std::nullopt;
}

/// Vertices in the order of `type`: its first face, seen from inside, then what stands above.
std::optional<Ring> vertices_in_order(CellType type, const std::vector<Ring>& rings) {
  const std::size_t base_size = type == CellType::tetrahedron || type == CellType::prism ? 3 : 4;
  const auto base = std::find_if(rings.begin(), rings.end(), [&](const Ring& r) { return r.size() == base_size; });
  Ring vertices(base->rbegin(), base->rend());
  const bool has_apex = type == CellType::tetrahedron || type == CellType::pyramid;
  for (std::size_t i = 0; i < (has_apex ? 1 : base_size); ++i) {
    const auto top = above(rings, *base, vertices[i]);
    if (!top) return std::nullopt;
    vertices.push_back(*top);
  }
  return vertices;
}

bool has_these_faces(CellType type, const Ring& vertices, const std::vector<Ring>& rings) {
  const CellBlock block{type, vertices, {}, {}};
  std::vector<Ring> wanted, given;
  for_each_face(block, 0, [&](std::span<const VertexId> face) {
    wanted.push_back(from_smallest({face.begin(), face.end()}));
  });
  for (const Ring& ring : rings) given.push_back(from_smallest(ring));
  const auto is_before = [](const Ring& a, const Ring& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                        [](VertexId v, VertexId w) { return v.value < w.value; });
  };
  std::sort(wanted.begin(), wanted.end(), is_before);
  std::sort(given.begin(), given.end(), is_before);
  return wanted == given;
}

std::size_t count_corners(const std::vector<Ring>& rings) {
  std::vector<std::uint32_t> all;
  for (const Ring& ring : rings)
    for (const VertexId v : ring) all.push_back(v.value);
  std::sort(all.begin(), all.end());
  return static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
}

/// Every edge in both directions, once each: what a closed cell with outward faces has.
bool is_closed(const std::vector<Ring>& rings) {
  std::vector<std::array<std::uint32_t, 2>> ways, back;
  for (const Ring& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const std::uint32_t a = ring[i].value, b = ring[(i + 1) % ring.size()].value;
      ways.push_back({a, b});
      back.push_back({b, a});
    }
  std::sort(ways.begin(), ways.end());
  std::sort(back.begin(), back.end());
  return ways == back && std::adjacent_find(ways.begin(), ways.end()) == ways.end();
}

void add_one(const std::vector<Ring>& rings, GroupId group, Mesh& mesh) {
  const CellType type = guess_type(rings, count_corners(rings));
  if (type != CellType::polyhedron) {
    const auto vertices = vertices_in_order(type, rings);
    if (vertices && has_these_faces(type, *vertices, rings)) return add_cell(mesh, type, *vertices, group);
  }
  Ring stream = {VertexId(rings.size())};
  for (const Ring& ring : rings) {
    stream.push_back(VertexId(ring.size()));
    stream.insert(stream.end(), ring.begin(), ring.end());
  }
  add_cell(mesh, CellType::polyhedron, stream, group);
}

}  // namespace

void add_foam_cells(const FoamFaceList& faces, std::span<const GroupId> group, const std::string& path, Mesh& mesh) {
  std::vector<std::size_t> begin(group.size() + 1, 0);
  for (const auto& cells : {faces.owner, faces.neighbour})
    for (const std::uint32_t cell : cells) ++begin[cell + 1];
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<std::uint32_t> of_cell(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (const auto& cells : {faces.owner, faces.neighbour})
    for (std::size_t face = 0; face < cells.size(); ++face)
      of_cell[next[cells[face]]++] = static_cast<std::uint32_t>(face);
  for (std::uint32_t cell = 0; cell < group.size(); ++cell) {
    const std::span<const std::uint32_t> here(of_cell.data() + begin[cell], begin[cell + 1] - begin[cell]);
    const std::vector<Ring> rings = outward_faces(faces, here, cell);
    if (!is_closed(rings))
      throw InputError(
          fmt::format("{}: cell {} is not closed: one of its faces ({}) is turned, missing, there twice or "
                      "has a point twice",
                      path, cell, fmt::join(here, ", ")));
    add_one(rings, group[cell], mesh);
  }
}

}  // namespace delfront
