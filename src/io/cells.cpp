// SPDX-License-Identifier: Apache-2.0
#include "io/cells.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "delfront/errors.hpp"
#include "delfront/findings.hpp"

namespace delfront {

namespace {

constexpr std::array<int, 4> kTetFaces[] = {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}};
constexpr std::array<int, 4> kPyramidFaces[] = {
    {0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}};
constexpr std::array<int, 4> kPrismFaces[] = {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
constexpr std::array<int, 4> kHexFaces[] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                            {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

constexpr int kVtkNumbers[kNumCellTypes] = {1, 3, 5, 9, 10, 14, 13, 12, 7, 42};

}  // namespace

void add_cell(Mesh& mesh, CellType type, std::span<const VertexId> vertices, GroupId group) {
  CellBlock& block = mesh.block(type);
  block.vertices.insert(block.vertices.end(), vertices.begin(), vertices.end());
  if (num_vertices(type) == 0) {
    if (block.offsets.empty()) block.offsets.push_back(0);
    block.offsets.push_back(block.vertices.size());
  }
  block.group.push_back(group);
}

void add_face(Mesh& mesh, std::span<const VertexId> vertices, GroupId group) {
  const CellType type = vertices.size() == 3   ? CellType::triangle
                        : vertices.size() == 4 ? CellType::quad
                                               : CellType::polygon;
  add_cell(mesh, type, vertices, group);
}

void check_finite(const Mesh& mesh, const std::string& path) {
  std::vector<Place> places;
  std::size_t count = 0;
  std::string ids;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Point& p = mesh.points[VertexId(i)];
    if (is_finite(p)) continue;
    if (++count <= 5) ids += fmt::format("{}{} ({:g}, {:g}, {:g})", count > 1 ? ", " : "", i, p.x, p.y, p.z);
    if (places.size() < kMaxPlaces) places.push_back({{0, 0, 0}, {static_cast<std::uint32_t>(i)}});
  }
  if (count > 0)
    throw InputError(fmt::format("{}: {} of {} points have a coordinate that is not finite: point {}{}; export again",
                                 path, count, mesh.points.size(), ids, count > 5 ? ", …" : ""),
                     std::move(places));
}

const char* role_name(const Mesh& mesh, int group_dimension) {
  const int codimension = std::clamp(mesh.dimension - group_dimension, 0, 3);
  if (group_dimension == 0) return "point";
  return codimension == 0 ? "region" : codimension == 1 ? "patch" : "curve";
}

void guess_dimension(Mesh& mesh) {
  if (mesh.top_dimension() > 2) return;
  for (const Point& p : mesh.points)
    if (p.z != 0) return;
  if (mesh.top_dimension() == 2) mesh.dimension = 2;
}

std::vector<std::int32_t> number_groups_by_dimension(const Mesh& mesh) {
  std::array<std::int32_t, 4> next{};
  std::vector<std::int32_t> number;
  for (const Group& group : mesh.groups) number.push_back(next[static_cast<std::size_t>(group.dimension)]++);
  return number;
}

int vtk_number(CellType type) { return kVtkNumbers[static_cast<int>(type)]; }

std::optional<CellType> type_from_vtk(int number) {
  for (int i = 0; i < kNumCellTypes; ++i)
    if (kVtkNumbers[i] == number) return static_cast<CellType>(i);
  return std::nullopt;
}

void note_left_out_fields(const Mesh& mesh, const char* format, std::vector<std::string>& notes) {
  if (!mesh.fields.empty())
    notes.push_back(fmt::format("{}: {} field(s) are left out; VTU keeps them", format, mesh.fields.size()));
}

void note_left_out_kinds(const Mesh& mesh, const char* format, std::vector<std::string>& notes,
                         std::span<const char* const> keeps) {
  std::size_t num_groups = 0;
  std::set<std::string> kinds;
  for (const Group& group : mesh.groups) {
    if (group.kind.empty() || std::find(keeps.begin(), keeps.end(), group.kind) != keeps.end()) continue;
    ++num_groups;
    kinds.insert(group.kind);
  }
  if (num_groups > 0)
    notes.push_back(fmt::format("{}: {} left out ({}); VTU, VTP and Medit .mesh keep them, files of --solver use them",
                                format,
                                num_groups == 1 ? "the boundary kind of 1 group is"
                                                : fmt::format("the boundary kinds of {} groups are", num_groups),
                                fmt::join(kinds, ", ")));
}

void note_empty_groups(const Mesh& mesh, const char* format, std::vector<std::string>& notes, bool has_patches) {
  std::vector<bool> has_cells(mesh.groups.size(), false);
  for (const CellBlock& block : mesh.blocks)
    for (const GroupId group : block.group)
      if (group.is_valid()) has_cells[group.index()] = true;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < mesh.groups.size(); ++i) {
    const Group& group = mesh.groups[GroupId(i)];
    if (!has_cells[i] && group.dimension >= mesh.dimension - (has_patches ? 0 : 1))
      names.push_back(fmt::format("'{}'", group.name));
  }
  if (!names.empty())
    notes.push_back(fmt::format("{}: {} without cells left out: {}; VTU and MSH keep them", format,
                                names.size() == 1 ? "a group" : fmt::format("{} groups", names.size()),
                                fmt::join(names, ", ")));
}

void note_left_out_curves(const Mesh& mesh, const char* format, std::vector<std::string>& notes) {
  const std::size_t lines = mesh.num_cells(CellType::line), points = mesh.num_cells(CellType::vertex);
  if (mesh.dimension == 3 && lines + points > 0)
    notes.push_back(
        fmt::format("{}: {} line and {} vertex cells are left out; VTU and MSH keep them", format, lines, points));
}

void TagGroups::name(int dimension, std::int64_t tag, const std::string& name, const std::string& kind) {
  Group& group = mesh_.groups[(*this)(dimension, tag)];
  group.name = name;
  group.kind = kind;
}

GroupId TagGroups::operator()(int dimension, std::int64_t tag) {
  const auto d = static_cast<std::size_t>(dimension);
  if (last_[d].group.is_valid() && last_[d].tag == tag) return last_[d].group;
  const auto [it, is_new] = groups_[d].try_emplace(tag, mesh_.groups.size());
  if (is_new) mesh_.groups.push_back({fmt::format("{}_{}", role_name(mesh_, dimension), tag), dimension, "", false});
  last_[d] = {tag, it->second};
  return it->second;
}

GroupId TagGroups::by_marker(int dimension, std::int64_t marker) {
  if (marker != 0) return (*this)(dimension, marker);
  GroupId& unmarked = unmarked_[static_cast<std::size_t>(dimension)];
  if (!unmarked.is_valid()) {
    unmarked = mesh_.groups.next_id();
    mesh_.groups.push_back({"", dimension, "", false});
  }
  return unmarked;
}

std::span<const std::array<int, 4>> local_faces(CellType type) {
  switch (type) {
    case CellType::tetrahedron:
      return kTetFaces;
    case CellType::pyramid:
      return kPyramidFaces;
    case CellType::prism:
      return kPrismFaces;
    case CellType::hexahedron:
      return kHexFaces;
    default:
      return {};
  }
}

}  // namespace delfront
