// SPDX-License-Identifier: Apache-2.0
// SU2 native grids: cells, points, one marker a boundary group. Faces inside the grid (interfaces, baffles) are no
// markers for SU2 and are left out, as are region names; both are said.
#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/names.hpp"
#include "io/output.hpp"
#include "io/starter.hpp"

namespace delfront {

namespace {

void write_cell(Output& out, const CellBlock& block, std::size_t cell) {
  out.integer(vtk_number(block.type));
  for (VertexId v : block[cell]) {
    out.character(' ');
    out.integer(static_cast<std::int64_t>(v.index()));
  }
}

void check_cells(const Mesh& mesh) {
  for (const CellBlock& block : mesh.blocks)
    if (num_vertices(block.type) == 0 && block.size() > 0)
      throw InputError(
          fmt::format("SU2 cannot hold {} {} cells; write VTU or OpenFOAM", block.size(), name_of(block.type)));
  if (mesh.num_cells_of_dimension(mesh.dimension) == 0)
    throw InputError(
        fmt::format("SU2 needs a grid of cells of dimension {}, and this mesh has none; surfaces go to "
                    "stl, obj, ply or vtp",
                    mesh.dimension));
}

void write_elements(Output& out, const Mesh& mesh) {
  out.text(fmt::format("NDIME= {}\nNELEM= {}\n", mesh.dimension, mesh.num_cells_of_dimension(mesh.dimension)));
  std::int64_t index = 0;
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) != mesh.dimension) continue;
    for (std::size_t cell = 0; cell < block.size(); ++cell) {
      write_cell(out, block, cell);
      out.character(' ');
      out.integer(index++);
      out.character('\n');
    }
  }
}

void write_points(Output& out, const Mesh& mesh) {
  out.text(fmt::format("NPOIN= {}\n", mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    for (int k = 0; k < mesh.dimension; ++k) {
      out.real(mesh.points[VertexId(i)][k]);
      out.character(' ');
    }
    out.integer(static_cast<std::int64_t>(i));
    out.character('\n');
  }
}

struct Marker {
  std::string name;
  std::vector<std::pair<const CellBlock*, std::size_t>> faces;
  GroupId group = {};  // invalid: of faces without one
};

void write_markers(Output& out, const std::vector<Marker>& markers) {
  out.text(fmt::format("NMARK= {}\n", markers.size()));
  for (const Marker& marker : markers) {
    out.text(fmt::format("MARKER_TAG= {}\nMARKER_ELEMS= {}\n", marker.name, marker.faces.size()));
    for (const auto& [block, cell] : marker.faces) {
      write_cell(out, *block, cell);
      out.character('\n');
    }
  }
}

/// One a group, in the order of mesh.groups; faces without a group make a last one.
std::vector<Marker> make_markers(const Mesh& mesh, std::vector<std::string>& notes) {
  std::vector<std::string> names =
      fit_names(mesh, NameRule::word, "SU2", notes, {mesh.dimension - 1, mesh.dimension - 1});
  for (std::string& name : names)
    if (name == "NONE") {
      std::string other = "NONE_";
      while (std::find(names.begin(), names.end(), other) != names.end()) other += '_';
      notes.push_back(fmt::format("SU2: 'NONE' stands for no marker at all: that boundary is written as '{}'", other));
      name = other;
    }
  std::vector<Marker> by_group(mesh.groups.size() + 1);
  std::size_t num_inner = 0, num_regions = 0;
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) != mesh.dimension - 1) continue;
    for (std::size_t cell = 0; cell < block.size(); ++cell) {
      const std::int64_t group = group_of(block, cell);
      const std::size_t slot = group < 0 ? mesh.groups.size() : static_cast<std::size_t>(group);
      if (group >= 0 && mesh.groups[GroupId(slot)].two_sided) {
        ++num_inner;
        continue;
      }
      by_group[slot].faces.emplace_back(&block, cell);
    }
  }
  std::vector<Marker> markers;
  for (std::size_t i = 0; i < mesh.groups.size(); ++i) {
    const Group& group = mesh.groups[GroupId(i)];
    num_regions += group.dimension == mesh.dimension;
    if (group.dimension == mesh.dimension - 1 && !group.two_sided)
      markers.push_back({names[i], std::move(by_group[i].faces), GroupId(i)});
  }
  if (Marker& rest = by_group.back(); !rest.faces.empty()) {
    notes.push_back(
        fmt::format("SU2: {} boundary faces without a patch are in the marker unnamed_boundary", rest.faces.size()));
    markers.push_back({"unnamed_boundary", std::move(rest.faces), {}});
  }
  if (num_inner > 0) notes.push_back(fmt::format("SU2: {} faces of two-sided inner patches are left out", num_inner));
  if (num_regions > 1)
    notes.push_back(fmt::format("SU2: the {} regions become one zone; their names are left out", num_regions));
  return markers;
}

}  // namespace

std::vector<StarterBoundary> su2_boundaries(const Mesh& mesh) {
  std::vector<std::string> said_by_the_writer;
  const std::vector<Marker> markers = make_markers(mesh, said_by_the_writer);
  std::vector<StarterBoundary> boundaries(markers.size());
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const GroupId group = markers[i].group;
    boundaries[i].name = markers[i].name;
    if (group.is_valid()) boundaries[i].kind = mesh.groups[group].kind;
    if (boundaries[i].kind == "inlet") boundaries[i].inward = inward_direction(mesh, group);
  }
  return boundaries;
}

void write_su2(const Mesh& mesh, Output& out, const WriteOptions&, Context& context, std::vector<std::string>& notes) {
  context.check_limits();
  check_cells(mesh);
  note_left_out_fields(mesh, "SU2", notes);
  note_left_out_kinds(mesh, "SU2", notes);
  note_left_out_curves(mesh, "SU2", notes);
  const std::vector<Marker> markers = make_markers(mesh, notes);
  write_elements(out, mesh);
  write_points(out, mesh);
  write_markers(out, markers);
}

}  // namespace delfront
