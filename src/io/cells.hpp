// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

/// @brief Append a cell; `vertices` has the type's number, or any for a polygon or a polyhedron's face stream.
void add_cell(Mesh& mesh, CellType type, std::span<const VertexId> vertices, GroupId group);

/// @brief Append a face of three or more corners: triangle, quad or polygon.
void add_face(Mesh& mesh, std::span<const VertexId> vertices, GroupId group);

/// @brief Throws InputError naming the points (and places) that have a coordinate that is not finite.
void check_finite(const Mesh& mesh, const std::string& path);

/// @brief "patch", "region", "curve" or "point": what a group of this dimension is called in this mesh.
/// In 3-D regions are volumes and patches faces; in 2-D regions are faces and patches lines.
const char* role_name(const Mesh& mesh, int group_dimension);

/// @brief Sets dimension 2 where there are no volume cells and all z = 0 (formats that do not say it themselves).
void guess_dimension(Mesh& mesh);

/// @brief The cell's group index, or -1.
inline std::int64_t group_of(const CellBlock& block, std::size_t cell) {
  return cell < block.group.size() && block.group[cell].is_valid() ? std::int64_t(block.group[cell].index()) : -1;
}

/// @brief Numbers the groups of each dimension 0, 1, …: number[group], in the order of mesh.groups.
std::vector<std::int32_t> number_groups_by_dimension(const Mesh& mesh);

/// @brief VTK's number of a type, which SU2 shares.
int vtk_number(CellType type);
std::optional<CellType> type_from_vtk(int number);

/// @brief Cell type of the top dimension's blocks and faces, with a sentence where fields are left out.
void note_left_out_fields(const Mesh& mesh, const char* format, std::vector<std::string>& notes);

/// @brief Adds a sentence where boundary kinds are lost: how many, which, and the formats that keep them.
/// @param keeps  kinds that this format has a place for
void note_left_out_kinds(const Mesh& mesh, const char* format, std::vector<std::string>& notes,
                         std::span<const char* const> keeps = {});

/// @brief A sentence that names regions and patches without cells, for formats that hold a group as its cells.
/// @param has_patches  the format has a place for patches without faces
void note_empty_groups(const Mesh& mesh, const char* format, std::vector<std::string>& notes, bool has_patches = false);

/// @brief A sentence where a mesh in space has lines or vertex cells, for formats that cannot hold them.
void note_left_out_curves(const Mesh& mesh, const char* format, std::vector<std::string>& notes);

/// @brief Hands out groups by a file's integer tag: one group a (dimension, tag), named when the name is known.
class TagGroups {
 public:
  explicit TagGroups(Mesh& mesh) : mesh_(mesh) {}
  /// @brief Give a tag its name (before or after its first use).
  void name(int dimension, std::int64_t tag, const std::string& name, const std::string& kind = "");
  /// @brief The group of that tag, made when first asked for: named "patch_<tag>" and so on where no name came.
  GroupId operator()(int dimension, std::int64_t tag);
  /// @brief The same where 0 says "no marker": those cells share one group without a name.
  GroupId by_marker(int dimension, std::int64_t marker);

 private:
  struct Entry {
    std::int64_t tag;
    GroupId group;
  };
  Mesh& mesh_;
  std::array<std::map<std::int64_t, GroupId>, 4> groups_;
  std::array<GroupId, 4> unmarked_;
  std::array<Entry, 4> last_{};  // the one asked for last: tags come in runs
};

/// @brief Outward faces of a volume cell: calls `face(span)` for each.
template <class Function>
void for_each_face(const CellBlock& block, std::size_t cell, Function&& face);

/// @brief Local faces of the fixed volume types, corners anticlockwise seen from outside; -1 ends a triangle.
std::span<const std::array<int, 4>> local_faces(CellType type);

template <class Function>
void for_each_face(const CellBlock& block, std::size_t cell, Function&& face) {
  const std::span<const VertexId> v = block[cell];
  if (block.type == CellType::polyhedron) {
    for (std::size_t i = 1; i < v.size(); i += v[i].index() + 1) face(v.subspan(i + 1, v[i].index()));
    return;
  }
  for (const std::array<int, 4>& local : local_faces(block.type)) {
    std::array<VertexId, 4> corners;
    std::size_t n = 0;
    for (int k : local)
      if (k >= 0) corners[n++] = v[static_cast<std::size_t>(k)];
    face(std::span<const VertexId>(corners.data(), n));
  }
}

}  // namespace delfront
