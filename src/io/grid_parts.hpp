// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "delfront/mesh.hpp"
#include "io/cells.hpp"

namespace delfront {

/// @brief The four smallest vertices of a face or side: what says which it is, whatever its turn.
using FacetKey = std::array<std::uint32_t, 4>;
FacetKey facet_key(std::span<const VertexId> corners);
struct FacetKeyHash {
  std::size_t operator()(const FacetKey& key) const;
};

/// @brief Calls `facet(corners)` for the faces of a volume cell, or the sides of a cell in the plane.
template <class Function>
void for_each_facet(const CellBlock& block, std::size_t cell, Function&& facet) {
  if (dimension(block.type) == 3) return for_each_face(block, cell, facet);
  const std::span<const VertexId> v = block[cell];
  for (std::size_t k = 0; k < v.size(); ++k) {
    const std::array<VertexId, 2> side = {v[k], v[(k + 1) % v.size()]};
    facet(std::span<const VertexId>(side));
  }
}

/// @brief Throws InputError naming the first cell with a vertex beyond the points; for files whose cells may come
/// first.
/// @param first_number  what the file calls its first point
void check_vertices(const Mesh& mesh, const std::string& path, std::size_t first_number);

/// @brief Groups of faces (of lines in the plane) that all have cells on both sides become two-sided, for formats that
/// do not say it. @par Cost  O(faces of cells), memory O(stored faces)
void mark_inner_groups(Mesh& mesh);

/// @brief Throws InputError where the mesh has polygons or polyhedra, or no cells at all.
void refuse_general_cells(const Mesh& mesh, const char* format);

/// @return 0, 1 or 2: the axis that the group's faces (lines in the plane) are most nearly normal to
int axis_of_group(const Mesh& mesh, GroupId group);

/// @brief What the lines "#delfront <dimension> <number> <sides> <kind or -> <name>" of comments hold.
struct NamedNumber {
  int dimension = 0;
  std::int64_t number = 0;
  bool two_sided = false;
  std::string kind, name;
};
/// @param numbers  of each group, as the file has them
std::string name_line(const Group& group, std::int64_t number, const std::string& name);
/// @return false where the text behind "#delfront " is no such line
bool parse_name_line(std::string_view text, NamedNumber& found);

}  // namespace delfront
