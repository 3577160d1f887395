// SPDX-License-Identifier: Apache-2.0
#include "io/grid_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"

namespace delfront {

FacetKey facet_key(std::span<const VertexId> corners) {
  constexpr std::uint32_t kNone = Id<VertexTag>::kNone;
  FacetKey least = {kNone, kNone, kNone, kNone};
  for (const VertexId v : corners) {
    std::uint32_t value = v.value;
    for (std::uint32_t& place : least)
      if (value < place) std::swap(value, place);
  }
  return least;
}

std::size_t FacetKeyHash::operator()(const FacetKey& key) const {
  std::uint64_t h = 1469598103934665603u;
  for (const std::uint32_t v : key) h = (h ^ v) * 1099511628211u;
  return static_cast<std::size_t>(h ^ (h >> 29));
}

void check_vertices(const Mesh& mesh, const std::string& path, std::size_t first_number) {
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t i = 0; i < block.vertices.size(); ++i)
      if (block.vertices[i].index() >= mesh.points.size())
        throw InputError(fmt::format("{}: {} {} has the vertex {}, but the file has {} points (counted from {})", path,
                                     name_of(block.type), i / static_cast<std::size_t>(num_vertices(block.type)),
                                     block.vertices[i].index() + first_number, mesh.points.size(), first_number));
}

void mark_inner_groups(Mesh& mesh) {
  const int top = mesh.dimension;
  std::unordered_map<FacetKey, int, FacetKeyHash> num_sides;
  std::vector<bool> is_on(mesh.points.size(), false);  // most faces of cells have a corner that no stored face has
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == top - 1 && cell < block.size(); ++cell)
      if (group_of(block, cell) >= 0) {
        num_sides.emplace(facet_key(block[cell]), 0);
        for (const VertexId v : block[cell]) is_on[v.index()] = true;
      }
  if (num_sides.empty()) return;
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == top && cell < block.size(); ++cell)
      for_each_facet(block, cell, [&](std::span<const VertexId> corners) {
        for (const VertexId v : corners)
          if (!is_on[v.index()]) return;
        if (const auto found = num_sides.find(facet_key(corners)); found != num_sides.end()) ++found->second;
      });
  std::vector<bool> is_inner(mesh.groups.size(), true), has_faces(mesh.groups.size(), false);
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == top - 1 && cell < block.size(); ++cell)
      if (const std::int64_t group = group_of(block, cell); group >= 0) {
        has_faces[static_cast<std::size_t>(group)] = true;
        if (num_sides[facet_key(block[cell])] < 2) is_inner[static_cast<std::size_t>(group)] = false;
      }
  for (std::size_t i = 0; i < mesh.groups.size(); ++i)
    if (has_faces[i] && is_inner[i]) mesh.groups[GroupId(i)].two_sided = true;
}

void refuse_general_cells(const Mesh& mesh, const char* format) {
  if (mesh.top_dimension() < 0) throw InputError(fmt::format("{}: there are no cells to write", format));
  for (const CellBlock& block : mesh.blocks)
    if (num_vertices(block.type) == 0 && block.size() > 0)
      throw InputError(fmt::format("{} cannot hold {} {} cells; write VTU, or triangulate them first", format,
                                   block.size(), name_of(block.type)));
}

int axis_of_group(const Mesh& mesh, GroupId group) {
  std::array<double, 3> area{};
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == mesh.dimension - 1 && cell < block.size(); ++cell) {
      if (group_of(block, cell) != static_cast<std::int64_t>(group.index())) continue;
      const std::span<const VertexId> v = block[cell];
      const Point a = mesh.points[v[0]], b = mesh.points[v[1]];
      Point normal{b.y - a.y, a.x - b.x, 0};  // of a line in the plane
      if (v.size() > 2) normal = cross(b - a, mesh.points[v[2]] - a);
      for (int k = 0; k < 3; ++k) area[static_cast<std::size_t>(k)] += std::abs(normal[k]);
    }
  return static_cast<int>(std::max_element(area.begin(), area.end()) - area.begin());
}

std::string name_line(const Group& group, std::int64_t number, const std::string& name) {
  return fmt::format("#delfront {} {} {} {} {}", group.dimension, number, group.two_sided ? 2 : 1,
                     group.kind.empty() ? "-" : group.kind, name);
}

bool parse_name_line(std::string_view text, NamedNumber& found) {
  Cursor line(text, "");
  const std::string_view dimension = line.next_on_line(), number = line.next_on_line();
  const std::string_view sides = line.next_on_line(), kind = line.next_on_line();
  found = {};
  found.dimension = -1;
  std::from_chars(dimension.data(), dimension.data() + dimension.size(), found.dimension);
  std::from_chars(number.data(), number.data() + number.size(), found.number);
  found.two_sided = sides == "2";
  found.kind = kind == "-" ? "" : std::string(kind);
  found.name = line.rest_of_line();
  return found.dimension >= 0 && found.dimension <= 3 && found.number > 0 && !found.name.empty();
}

}  // namespace delfront
