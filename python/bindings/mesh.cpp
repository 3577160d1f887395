// SPDX-License-Identifier: Apache-2.0
// Mesh: its arrays as views, made from arrays, its quality.
#include <fmt/format.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "core.hpp"
#include "delfront/grid_check.hpp"
#include "pipeline/facts_text.hpp"
#include "pipeline/report_json.hpp"
#include "runner.hpp"

namespace delfront::python {

using namespace nb::literals;

namespace {

/// By CellType; the names of meshio.
constexpr std::array<const char*, kNumCellTypes> kTypeNames = {
    "vertex", "line", "triangle", "quad", "tetra", "pyramid", "wedge", "hexahedron", "polygon", "polyhedron"};

const char* name_of_type(CellType type) { return kTypeNames[static_cast<std::size_t>(type)]; }

CellType type_of(const std::string& name) {
  const auto it = std::find(kTypeNames.begin(), kTypeNames.end(), name);
  if (it == kTypeNames.end())
    throw UsageError(fmt::format("unknown type of cells '{}'; there are {}", name,
                                 "vertex, line, triangle, quad, tetra, pyramid, wedge, hexahedron"));
  return static_cast<CellType>(it - kTypeNames.begin());
}

// Ids and points are plain numbers in memory: that is what makes views of them possible.
static_assert(sizeof(VertexId) == sizeof(std::uint32_t) && sizeof(GroupId) == sizeof(std::uint32_t));
static_assert(sizeof(Point) == 3 * sizeof(double));
const std::uint32_t* plain(const std::vector<VertexId>& ids) {
  return reinterpret_cast<const std::uint32_t*>(ids.data());
}
const std::uint32_t* plain(const std::vector<GroupId>& ids) {
  return reinterpret_cast<const std::uint32_t*>(ids.data());
}

using MeshHandle = nb::handle_t<Mesh>;
const Mesh& mesh_of(MeshHandle self) { return *nb::inst_ptr<Mesh>(self); }

NumpyArray<const double> points(MeshHandle self) {
  const Mesh& mesh = mesh_of(self);
  return view_of(reinterpret_cast<const double*>(mesh.points.data()), {mesh.points.size(), 3}, self);
}

/// Cells of any number of vertices as (offsets, vertices).
nb::object cells_of(const CellBlock& block, MeshHandle self) {
  const auto columns = static_cast<std::size_t>(num_vertices(block.type));
  if (columns > 0) return nb::cast(view_of(plain(block.vertices), {block.size(), columns}, self));
  return nb::make_tuple(view_of(block.offsets.data(), {block.offsets.size()}, self),
                        view_of(plain(block.vertices), {block.vertices.size()}, self));
}

nb::dict cells(MeshHandle self) {
  nb::dict result;
  for (const CellBlock& block : mesh_of(self).blocks)
    if (block.size() > 0) result[name_of_type(block.type)] = cells_of(block, self);
  return result;
}

nb::dict cell_groups(MeshHandle self) {
  nb::dict result;
  for (const CellBlock& block : mesh_of(self).blocks)
    if (block.size() > 0 && block.group.size() == block.size())
      result[name_of_type(block.type)] = view_of(plain(block.group), {block.group.size()}, self);
  return result;
}

nb::list groups(const Mesh& mesh) {
  nb::list result;
  for (const Group& group : mesh.groups)
    result.append(nb::make_tuple(text_of(group.name), group.dimension, text_of(group.kind), group.two_sided));
  return result;
}

NumpyArray<const double> values_of(const Field& field, MeshHandle self) {
  const auto columns = static_cast<std::size_t>(std::max(field.components, 1));
  if (columns == 1) return view_of(field.values.data(), {field.values.size()}, self);
  return view_of(field.values.data(), {field.values.size() / columns, columns}, self);
}

nb::dict point_data(MeshHandle self) {
  nb::dict result;
  for (const Field& field : mesh_of(self).fields)
    if (field.on == Field::On::vertices) result[text_of(field.name)] = values_of(field, self);
  return result;
}

nb::dict cell_data(MeshHandle self) {
  nb::dict result;
  for (const Field& field : mesh_of(self).fields) {
    if (field.on != Field::On::cells) continue;
    const nb::str name = text_of(field.name);
    if (!result.contains(name)) result[name] = nb::dict();
    result[name][name_of_type(field.block)] = values_of(field, self);
  }
  return result;
}

/// Dimension, id, u, v of the model's entity that each point lies on; None where the grid does not know.
nb::object entities(MeshHandle self) {
  const std::vector<VertexEntity>& all = mesh_of(self).vertex_entity;
  if (all.empty()) return nb::none();
  constexpr auto kBytes = static_cast<std::int64_t>(sizeof(VertexEntity));
  const std::size_t n = all.size();
  return nb::make_tuple(view_of(&all[0].dimension, {n}, self, {kBytes}), view_of(&all[0].id, {n}, self, {kBytes / 4}),
                        view_of(&all[0].u, {n}, self, {kBytes / 8}), view_of(&all[0].v, {n}, self, {kBytes / 8}));
}

// --- made from arrays ---------------------------------------------------------------------------------------------

struct GivenCells {
  std::string type;
  GivenArray<std::uint32_t, 2> vertices;
  nb::object group;  ///< one a cell, or None
};

void check_indices(const GivenCells& given, std::size_t num_points) {
  const std::uint32_t* const first = given.vertices.data();
  const std::uint32_t* const last = first + given.vertices.size();
  const auto bad = std::find_if(first, last, [&](std::uint32_t v) { return v >= num_points; });
  if (bad != last)
    throw InputError(fmt::format("{} {} has point {}, and there are {} points", given.type,
                                 std::size_t(bad - first) / given.vertices.shape(1), *bad, num_points));
}

void add_cells(Mesh& mesh, const GivenCells& given) {
  const CellType type = type_of(given.type);
  const auto columns = static_cast<std::size_t>(num_vertices(type));
  if (columns == 0) throw UsageError(fmt::format("cells of type {} cannot be given as an array", given.type));
  if (given.vertices.shape(1) != columns)
    throw UsageError(
        fmt::format("cells of type {} have {} points, got {}", given.type, columns, given.vertices.shape(1)));
  check_indices(given, mesh.points.size());
  CellBlock& block = mesh.block(type);
  if (block.size() > 0) throw UsageError(fmt::format("cells of type {} are given twice", given.type));
  const auto* const first = reinterpret_cast<const VertexId*>(given.vertices.data());
  block.vertices.assign(first, first + given.vertices.size());
  if (given.group.is_none()) {
    block.group.assign(given.vertices.shape(0), GroupId());
    return;
  }
  const auto group = nb::cast<GivenArray<std::uint32_t, 1>>(given.group);
  if (group.size() != block.size())
    throw UsageError(fmt::format("{} groups for {} cells of type {}", group.size(), block.size(), given.type));
  for (std::size_t i = 0; i < group.size(); ++i) {
    const std::uint32_t g = group.data()[i];
    const bool is_none = g == GroupId::kNone;
    if (!is_none && (g >= mesh.groups.size() || mesh.groups[GroupId(g)].dimension != dimension(type)))
      throw InputError(
          fmt::format("{} {} has group {}, which is none of dimension {}", given.type, i, g, dimension(type)));
    block.group.push_back(is_none ? GroupId() : GroupId(g));
  }
}

void add_point_data(Mesh& mesh, const nb::dict& data) {
  for (const auto [name, values] : data) {
    const auto array = nb::cast<GivenArray<double, 2>>(values);
    if (array.shape(0) != mesh.points.size())
      throw UsageError(fmt::format("point data '{}': {} rows for {} points", nb::cast<std::string>(name),
                                   array.shape(0), mesh.points.size()));
    mesh.fields.push_back({nb::cast<std::string>(name), Field::On::vertices, CellType::vertex, int(array.shape(1)),
                           std::vector<double>(array.data(), array.data() + array.size())});
  }
}

/// Points with two columns lie in the plane.
Mesh make_mesh(const GivenArray<double, 2>& at, const nb::list& cells, const nb::list& groups, const nb::dict& data) {
  Mesh mesh;
  const std::size_t columns = at.shape(1);
  if (columns != 2 && columns != 3) throw UsageError(fmt::format("points have 2 or 3 columns, got {}", columns));
  mesh.dimension = static_cast<int>(columns);
  mesh.points.reserve(at.shape(0));
  for (const double* p = at.data(); p != at.data() + at.size(); p += columns)
    mesh.points.push_back({p[0], p[1], columns == 3 ? p[2] : 0.0});
  for (const nb::handle group : groups)
    mesh.groups.push_back({nb::cast<std::string>(group[0]), nb::cast<int>(group[1]), nb::cast<std::string>(group[2]),
                           nb::cast<bool>(group[3])});
  for (const nb::handle given : cells)
    add_cells(mesh, {nb::cast<std::string>(given[0]), nb::cast<GivenArray<std::uint32_t, 2>>(given[1]), given[2]});
  add_point_data(mesh, data);
  return mesh;
}

nb::tuple box_of(const Mesh& mesh) {
  const Box box = mesh.bounding_box();
  return nb::make_tuple(nb::make_tuple(box.low.x, box.low.y, box.low.z),
                        nb::make_tuple(box.high.x, box.high.y, box.high.z));
}

void add_quality(nb::module_& module) {
  nb::class_<QualityReport>(module, "Quality", "Quality of a grid, as measured once.")
      .def(
          "json", [](const QualityReport& self) { return text_of(to_json(self).dump()); }, "All of it as JSON.")
      .def(
          "text", [](const QualityReport& self, std::size_t worst) { return text_of(quality_text(self, worst)); },
          "worst"_a, "A table, with so many of the worst cells.")
      .def(
          "failed_gates",
          [](const QualityReport& self, const std::string& gates) { return texts_list(failed_gates(self, gates)); },
          "gates"_a);
}

}  // namespace

void add_mesh(nb::module_& module) {
  add_quality(module);
  nb::class_<Mesh>(module, "Mesh", "A grid; its arrays are views, which keep it alive.")
      .def_prop_ro("dimension", [](const Mesh& self) { return self.dimension; })
      .def_prop_ro("top_dimension", &Mesh::top_dimension)
      .def_prop_ro("points", &points)
      .def_prop_ro("cells", &cells)
      .def_prop_ro("cell_groups", &cell_groups)
      .def_prop_ro("groups", &groups)
      .def_prop_ro("point_data", &point_data)
      .def_prop_ro("cell_data", &cell_data)
      .def_prop_ro("entities", &entities)
      .def_prop_ro("box", &box_of)
      .def(
          "text", [](const Mesh& self) { return text_of(mesh_facts_text(self)); }, "Counts, groups and box.")
      .def(
          "check",
          [](const Mesh& self, const Hooks& hooks) {
            return findings_list(run_released(hooks, [&](Context&) { return check(self); }));
          },
          "hooks"_a, "What is wrong with it as a grid.")
      .def(
          "quality",
          [](const Mesh& self, const Hooks& hooks) {
            return run_released(hooks, [&](Context& context) { return measure_quality(self, context); });
          },
          "hooks"_a)
      .def(
          "gate_failures",
          [](const Mesh& self, const std::string& gates, const Hooks& hooks) {
            return findings_list(
                run_released(hooks, [&](Context& context) { return find_gate_failures(self, gates, context); }));
          },
          "gates"_a, "hooks"_a);
  module.def(
      "make_mesh", &make_mesh, "points"_a, "cells"_a, "groups"_a, "point_data"_a,
      "A mesh of arrays: cells as (type, vertices, groups or None), groups as (name, dimension, kind, two_sided).");
}

}  // namespace delfront::python
