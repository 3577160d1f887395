// SPDX-License-Identifier: Apache-2.0
#include "io/vtk_grid.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/vtk_names.hpp"

namespace delfront {

namespace {

constexpr std::size_t kMaxComponents = 256;  // pieces without an array are filled up: this bounds by how much

/// "region_id" and so on (vtk_names.hpp).
bool is_id_array(const std::string& name) {
  return name.ends_with("_id") && is_vtk_role(std::string_view(name).substr(0, name.size() - 3));
}

}  // namespace

bool VtkName::is_label(const std::string& label) {
  const std::size_t colon = label.find(':');
  return colon != std::string::npos && is_vtk_role(label.substr(0, colon));
}

VtkName VtkName::of(const std::string& label, std::span<const double> values, const std::string& kind, bool two_sided) {
  const auto is_whole = [](double value) { return std::abs(value) < 9e18 && value == std::trunc(value); };
  if (values.size() != 2 || !is_whole(values[0]) || !is_whole(values[1])) return {label, -1, -1, kind, two_sided};
  return {label, static_cast<std::int64_t>(values[0]), static_cast<std::int64_t>(values[1]), kind, two_sided};
}

void VtkGrid::add_points(std::span<const double> coordinates, const Fail& fail) {
  if (mesh_.points.size() + coordinates.size() / 3 >= Id<VertexTag>::kNone)
    fail("more than 2^32 - 1 points are not supported");
  for (std::size_t i = 0; i + 2 < coordinates.size(); i += 3)
    mesh_.points.push_back({coordinates[i], coordinates[i + 1], coordinates[i + 2]});
}

void VtkGrid::end_piece() {
  first_point_ = mesh_.points.size();
  first_cell_ = num_cells_;
}

VertexId VtkGrid::vertex(std::int64_t index, const Fail& fail) const {
  const auto num_points = static_cast<std::int64_t>(mesh_.points.size() - first_point_);
  if (index < 0 || index >= num_points)
    fail(fmt::format("cell {} has the vertex {}, but there are {} points", num_cells_of_piece(), index, num_points));
  return VertexId(first_point_ + static_cast<std::size_t>(index));
}

void VtkGrid::add(CellType type, std::span<const VertexId> vertices) {
  delfront::add_cell(mesh_, type, vertices, GroupId());
  source_[static_cast<std::size_t>(type)].push_back(static_cast<std::uint32_t>(num_cells_));
}

void VtkGrid::add_cell(std::int64_t type, std::span<const std::int64_t> corners, const Fail& fail) {
  corners_.clear();
  for (const std::int64_t corner : corners) corners_.push_back(vertex(corner, fail));
  const std::size_t n = corners_.size();
  const auto v = [&](std::size_t k) { return corners_[k]; };
  if (type == kPolyVertex) {
    for (std::size_t k = 0; k < n; ++k) add(CellType::vertex, {&corners_[k], 1});
  } else if (type == kPolyLine) {
    for (std::size_t k = 0; k + 1 < n; ++k) add(CellType::line, {&corners_[k], 2});
  } else if (type == kStrip) {
    for (std::size_t k = 0; k + 2 < n; ++k)
      add(CellType::triangle, std::array{v(k + k % 2), v(k + 1 - k % 2), v(k + 2)});
  } else if (type == kPixel && n == 4) {
    add(CellType::quad, std::array{v(0), v(1), v(3), v(2)});
  } else if (type == kVoxel && n == 8) {
    add(CellType::hexahedron, std::array{v(0), v(1), v(3), v(2), v(4), v(5), v(7), v(6)});
  } else if (type == vtk_number(CellType::polygon)) {
    add_polygon(fail);
  } else {
    add_plain_cell(type, fail);
  }
  ++num_cells_;
}

void VtkGrid::add_polygon(const Fail& fail) {
  const std::size_t n = corners_.size();
  if (n < 3) fail(fmt::format("polygon {} has {} corners", num_cells_of_piece(), n));
  add(n == 3 ? CellType::triangle : n == 4 ? CellType::quad : CellType::polygon, corners_);
}

void VtkGrid::add_plain_cell(std::int64_t number, const Fail& fail) {
  const std::size_t cell = num_cells_of_piece();
  const std::optional<CellType> type =
      number >= 0 && number < 256 ? type_from_vtk(static_cast<int>(number)) : std::nullopt;
  if (!type || *type == CellType::polyhedron)
    return fail(fmt::format("cell {} has the VTK type {}, which is not supported; linear cells are", cell, number));
  if (corners_.size() != static_cast<std::size_t>(num_vertices(*type)))
    fail(fmt::format("cell {} is a {} with {} vertices", cell, name_of(*type), corners_.size()));
  add(*type, corners_);
}

void VtkGrid::add_polyhedron(std::span<const std::int64_t> stream, const Fail& fail) {
  const auto fail_stream = [&] { fail(fmt::format("the faces of polyhedron {} are damaged", num_cells_of_piece())); };
  if (stream.empty() || stream[0] < 4 || stream[0] > static_cast<std::int64_t>(stream.size())) fail_stream();
  corners_.clear();
  corners_.push_back(VertexId(static_cast<std::size_t>(stream[0])));
  std::size_t i = 1;
  for (std::int64_t face = 0; face < stream[0]; ++face) {
    if (i >= stream.size() || stream[i] < 3 || stream[i] > static_cast<std::int64_t>(stream.size() - i - 1))
      fail_stream();
    const auto n = static_cast<std::size_t>(stream[i]);
    corners_.push_back(VertexId(n));
    for (std::size_t k = 1; k <= n; ++k) corners_.push_back(vertex(stream[i + k], fail));
    i += n + 1;
  }
  if (i != stream.size()) fail_stream();
  add(CellType::polyhedron, corners_);
  ++num_cells_;
}

void VtkGrid::add_data(Field::On on, const std::string& name, std::size_t components, std::span<const double> values,
                       const Fail& fail) {
  const bool is_of_points = on == Field::On::vertices;
  const std::size_t count = is_of_points ? num_points_of_piece() : num_cells_of_piece();
  const std::size_t before = is_of_points ? first_point_ : first_cell_;
  components = std::max<std::size_t>(components, 1);
  if (components > kMaxComponents) fail(fmt::format("{} components are not supported", components));
  if (values.size() / components != count || values.size() % components != 0)
    fail(fmt::format("{} numbers for {} entries of {} components", values.size(), count, components));
  if (count == 0) return;
  Data& data = (is_of_points ? point_data_ : cell_data_)[name];
  if (!data.values.empty() && data.components != static_cast<int>(components))
    fail("its number of components differs between pieces");
  data.components = static_cast<int>(components);
  const bool has_groups = !is_of_points && is_id_array(name);
  data.values.resize(before * components, has_groups ? -1 : std::numeric_limits<double>::quiet_NaN());
  data.values.insert(data.values.end(), values.begin(), values.end());
}

Mesh VtkGrid::finish(int dimension, bool is_surface, std::span<const VtkName> names, Context& context) {
  if (num_cells_ == 0) throw InputError(fmt::format("{}: the file has no cells", path_));
  check_finite(mesh_, path_);
  if (dimension == 2 || dimension == 3)
    mesh_.dimension = dimension;
  else if (!is_surface)
    guess_dimension(mesh_);
  set_groups(names, context);
  set_fields();
  return std::move(mesh_);
}

void VtkGrid::leave_out_text(Field::On on, const std::string& name, Context& context) const {
  if (on == Field::On::cells && is_id_array(name))
    context.warn(
        fmt::format("{}: the cell array {} holds text, not the numbers of groups: it is left out", path_, name));
}

void VtkGrid::name_groups(TagGroups& groups, std::span<const VtkName> names, Context& context) {
  std::map<std::pair<int, std::int64_t>, const std::string*> taken;
  for (const VtkName& name : names) {
    if (!VtkName::is_label(name.label)) continue;
    if (name.id < 0 || name.dimension < 0 || name.dimension > 3) {
      context.warn(fmt::format("{}: the name \"{}\" is left out: it needs a number from 0 and a dimension from 0 to 3",
                               path_, name.label));
      continue;
    }
    const int d = static_cast<int>(name.dimension);
    const auto [first, is_new] = taken.try_emplace({d, name.id}, &name.label);
    if (!is_new) {
      if (*first->second != name.label)
        context.warn(fmt::format("{}: \"{}\" and \"{}\" have the same number {}: the second name is left out", path_,
                                 *first->second, name.label, name.id));
      continue;
    }
    groups.name(d, name.id, name.label.substr(name.label.find(':') + 1), name.kind);
    mesh_.groups[groups(d, name.id)].two_sided = name.two_sided;
  }
}

void VtkGrid::set_groups(std::span<const VtkName> names, Context& context) {
  struct Unusable {
    std::size_t count = 0, components = 1;
    std::uint32_t first = 0;  // cell of the file
    double value = 0;
  };
  TagGroups groups(mesh_);
  name_groups(groups, names, context);
  std::array<Unusable, 4> unusable;
  for (CellBlock& block : mesh_.blocks) {
    const int d = dimension(block.type);
    const auto found = cell_data_.find(vtk_id_array(mesh_, d));
    if (found == cell_data_.end()) continue;
    const Data& data = found->second;
    Unusable& left_out = unusable[static_cast<std::size_t>(d)];
    left_out.components = static_cast<std::size_t>(data.components);
    const std::vector<std::uint32_t>& source = source_[static_cast<std::size_t>(block.type)];
    for (std::size_t cell = 0; data.components == 1 && cell < source.size(); ++cell) {
      const double id = source[cell] < data.values.size() ? data.values[source[cell]] : -1;
      if (id >= 0 && id < 2147483648.0 && id == std::trunc(id)) {
        block.group[cell] = groups(d, static_cast<std::int64_t>(id));
      } else if (id != -1 && left_out.count++ == 0) {
        left_out.first = source[cell];
        left_out.value = id;
      }
    }
  }
  for (int d = 0; d <= 3; ++d) {
    const Unusable& left_out = unusable[static_cast<std::size_t>(d)];
    const std::string array = vtk_id_array(mesh_, d);
    if (left_out.components != 1)
      context.warn(fmt::format("{}: the cell array {} has {} components, not one number: it is left out", path_, array,
                               left_out.components));
    if (left_out.count > 0)
      context.warn(
          fmt::format("{}: {} cells have no number of a group in {} (the first is cell {} with {}): they are in "
                      "no group",
                      path_, left_out.count, array, left_out.first, left_out.value));
    cell_data_.erase(array);
  }
}

void VtkGrid::set_fields() {
  for (auto& [name, data] : point_data_) {
    data.values.resize(mesh_.points.size() * static_cast<std::size_t>(data.components),
                       std::numeric_limits<double>::quiet_NaN());
    mesh_.fields.push_back({name, Field::On::vertices, CellType::vertex, data.components, std::move(data.values)});
  }
  for (const auto& [name, data] : cell_data_)
    for (const CellBlock& block : mesh_.blocks) set_cell_field(name, data, block.type);
}

/// Left out where all values are NaN: writers fill blocks that lack a field with it.
void VtkGrid::set_cell_field(const std::string& name, const Data& data, CellType type) {
  const auto n = static_cast<std::size_t>(data.components);
  Field field{name, Field::On::cells, type, data.components, {}};
  bool has_value = false;
  for (const std::uint32_t cell : source_[static_cast<std::size_t>(type)])
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t at = cell * n + k;
      field.values.push_back(at < data.values.size() ? data.values[at] : std::numeric_limits<double>::quiet_NaN());
      has_value |= !std::isnan(field.values.back());
    }
  if (has_value) mesh_.fields.push_back(std::move(field));
}

}  // namespace delfront
