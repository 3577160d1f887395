// SPDX-License-Identifier: Apache-2.0
#include "io/vtk_blocks.hpp"

#include <fmt/format.h>

#include <limits>
#include <map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/vtk_names.hpp"

namespace delfront {

Blocks blocks_of(const Mesh& mesh, int low, int high) {
  Blocks blocks;
  for (int d = low; d <= high; ++d)
    for (const CellBlock& block : mesh.blocks)
      if (dimension(block.type) == d && block.size() > 0) blocks.push_back(&block);
  return blocks;
}

std::size_t num_cells(const Blocks& blocks) {
  std::size_t n = 0;
  for (const CellBlock* block : blocks) n += block->size();
  return n;
}

std::span<const std::uint32_t> raw_ids(const std::vector<VertexId>& vertices) {
  static_assert(sizeof(VertexId) == sizeof(std::uint32_t));
  return {reinterpret_cast<const std::uint32_t*>(vertices.data()), vertices.size()};
}

std::span<const double> raw_coordinates(const Mesh& mesh) {
  static_assert(sizeof(Point) == 3 * sizeof(double));
  return {reinterpret_cast<const double*>(mesh.points.data()), 3 * mesh.points.size()};
}

std::vector<IdArray> id_arrays(const Mesh& mesh, const Blocks& blocks) {
  const std::vector<std::int32_t> number = number_groups_by_dimension(mesh);
  std::vector<IdArray> arrays;
  for (int d = mesh.dimension; d >= 0; --d) {
    bool is_needed = d >= mesh.dimension - 1;
    for (const Group& group : mesh.groups) is_needed |= group.dimension == d;
    if (!is_needed) continue;
    std::vector<std::int32_t> ids;
    ids.reserve(num_cells(blocks));
    for (const CellBlock* block : blocks)
      for (std::size_t cell = 0; cell < block->size(); ++cell) {
        const std::int64_t group = dimension(block->type) == d ? group_of(*block, cell) : -1;
        ids.push_back(group < 0 ? -1 : number[static_cast<std::size_t>(group)]);
      }
    arrays.push_back({vtk_id_array(mesh, d), std::move(ids)});
  }
  return arrays;
}

std::vector<VtkName> group_names(const Mesh& mesh, NameRule rule, const char* format, std::vector<std::string>& notes) {
  const std::vector<std::string> fitted = fit_names(mesh, rule, format, notes);
  const std::vector<std::int32_t> number = number_groups_by_dimension(mesh);
  std::vector<VtkName> names;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const Group& group = mesh.groups[GroupId(i)];
    names.push_back({fmt::format("{}:{}", role_name(mesh, group.dimension), fitted[i]), number[i], group.dimension,
                     group.kind, group.two_sided});
  }
  return names;
}

std::vector<std::pair<std::string, int>> cell_field_names(const Mesh& mesh) {
  std::map<std::string, int> components;
  for (const Field& field : mesh.fields)
    if (field.on == Field::On::cells) components.emplace(field.name, field.components);
  return {components.begin(), components.end()};
}

std::vector<double> cell_field(const Mesh& mesh, const Blocks& blocks, const std::string& name, int components) {
  std::vector<double> values;
  for (const CellBlock* block : blocks) {
    const std::size_t wanted = values.size() + block->size() * static_cast<std::size_t>(components);
    for (const Field& field : mesh.fields)
      if (field.on == Field::On::cells && field.block == block->type && field.name == name &&
          field.components == components)
        values.insert(values.end(), field.values.begin(), field.values.end());
    values.resize(wanted, std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

void check_size(const Mesh& mesh, const char* format) {
  if (mesh.points.size() > std::size_t(std::numeric_limits<std::int32_t>::max()))
    throw InputError(fmt::format("{}: more than 2^31 - 1 points are not supported", format));
}

}  // namespace delfront
