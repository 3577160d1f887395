// SPDX-License-Identifier: Apache-2.0
// VTK XML unstructured grids (.vtu: all cells, boundary faces among them) and surfaces (.vtp: faces, lines, vertices).
// Names and ids of groups as vtk_names.hpp says; kind and two_sided are attributes that other readers skip.
#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/names.hpp"
#include "io/vtk_blocks.hpp"
#include "io/vtk_output.hpp"
#include "io/xml.hpp"

namespace delfront {

namespace {

/// Points first seen in the face stream of a polyhedron, in its order: VTK wants them in `connectivity`.
std::vector<std::uint32_t> points_of_polyhedron(std::span<const VertexId> stream) {
  std::vector<std::uint32_t> points;
  for (std::size_t i = 1; i < stream.size(); i += stream[i].index() + 1)
    for (std::size_t k = 1; k <= stream[i].index(); ++k) points.push_back(stream[i + k].value);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// connectivity and offsets of these blocks; polyhedra are gathered in `scratch`.
void write_connectivity(VtkOutput& vtk, const Blocks& blocks, std::deque<std::vector<std::uint32_t>>& scratch) {
  std::vector<std::span<const std::uint32_t>> pieces;
  std::vector<std::int64_t> offsets;
  offsets.reserve(num_cells(blocks));
  std::int64_t end = 0;
  for (const CellBlock* block : blocks) {
    if (block->type != CellType::polyhedron) {
      pieces.push_back(raw_ids(block->vertices));
      for (std::size_t cell = 0; cell < block->size(); ++cell)
        offsets.push_back(end += static_cast<std::int64_t>((*block)[cell].size()));
      continue;
    }
    std::vector<std::uint32_t>& points = scratch.emplace_back();
    for (std::size_t cell = 0; cell < block->size(); ++cell) {
      const std::vector<std::uint32_t> here = points_of_polyhedron((*block)[cell]);
      points.insert(points.end(), here.begin(), here.end());
      offsets.push_back(end += static_cast<std::int64_t>(here.size()));
    }
    pieces.push_back(points);
  }
  vtk.array("connectivity", 1, pieces);
  vtk.own("offsets", 1, offsets);
}

void write_types_and_faces(VtkOutput& vtk, const Blocks& blocks) {
  std::vector<std::uint8_t> types;
  std::vector<std::int64_t> faces, face_offsets;
  bool has_polyhedra = false;
  for (const CellBlock* block : blocks) {
    types.insert(types.end(), block->size(), static_cast<std::uint8_t>(vtk_number(block->type)));
    has_polyhedra |= block->type == CellType::polyhedron;
  }
  vtk.own("types", 1, types);
  if (!has_polyhedra) return;
  for (const CellBlock* block : blocks)
    for (std::size_t cell = 0; cell < block->size(); ++cell) {
      if (block->type == CellType::polyhedron)
        for (VertexId entry : (*block)[cell]) faces.push_back(entry.value);
      face_offsets.push_back(block->type == CellType::polyhedron ? static_cast<std::int64_t>(faces.size()) : -1);
    }
  vtk.own("faces", 1, faces);
  vtk.own("faceoffsets", 1, face_offsets);
}

void write_names(VtkOutput& vtk, const Mesh& mesh, const char* format, std::vector<std::string>& notes) {
  const std::vector<VtkName> names = group_names(mesh, NameRule::line, format, notes);
  if (names.empty()) return;
  vtk.open("FieldData");
  for (const VtkName& name : names)
    vtk.line(
        fmt::format("<DataArray type=\"Int32\" Name=\"{}\" NumberOfComponents=\"1\" NumberOfTuples=\"2\""
                    "{}{} format=\"ascii\">{} {}</DataArray>",
                    escape_xml(name.label), name.kind.empty() ? "" : fmt::format(" kind=\"{}\"", escape_xml(name.kind)),
                    name.two_sided ? " two_sided=\"1\"" : "", name.id, name.dimension));
  vtk.close("FieldData");
}

void write_data(VtkOutput& vtk, const Mesh& mesh, const Blocks& blocks) {
  vtk.open("PointData");
  for (const Field& field : mesh.fields)
    if (field.on == Field::On::vertices)
      vtk.array(field.name, field.components, std::vector{std::span<const double>(field.values)});
  vtk.close("PointData");
  vtk.open("CellData");
  for (const IdArray& ids : id_arrays(mesh, blocks)) vtk.own(ids.name, 1, ids.values);
  for (const auto& [name, components] : cell_field_names(mesh))
    vtk.own(name, components, cell_field(mesh, blocks, name, components));
  vtk.close("CellData");
}

void write_points(VtkOutput& vtk, const Mesh& mesh) {
  vtk.open("Points");
  vtk.array("Points", 3, std::vector{raw_coordinates(mesh)});
  vtk.close("Points");
}

}  // namespace

void write_vtu(const Mesh& mesh, Output& out, const WriteOptions& options, Context& context,
               std::vector<std::string>& notes) {
  context.check_limits();
  check_size(mesh, "VTU");
  const Blocks blocks = blocks_of(mesh, 0, 3);
  std::deque<std::vector<std::uint32_t>> scratch;
  VtkOutput vtk(out, options, "UnstructuredGrid");
  vtk.open(fmt::format("UnstructuredGrid dimension=\"{}\"", mesh.dimension));
  write_names(vtk, mesh, "VTU", notes);
  vtk.open(fmt::format("Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", mesh.points.size(), num_cells(blocks)));
  write_points(vtk, mesh);
  vtk.open("Cells");
  write_connectivity(vtk, blocks, scratch);
  write_types_and_faces(vtk, blocks);
  vtk.close("Cells");
  write_data(vtk, mesh, blocks);
  vtk.close("Piece");
  vtk.close("UnstructuredGrid");
  vtk.finish();
}

void write_vtp(const Mesh& mesh, Output& out, const WriteOptions& options, Context& context,
               std::vector<std::string>& notes) {
  context.check_limits();
  check_size(mesh, "VTP");
  const Blocks blocks = blocks_of(mesh, 0, 2);
  if (const std::size_t left_out = mesh.num_cells_of_dimension(3); left_out > 0)
    notes.push_back(fmt::format("VTP: {} volume cells are left out, faces and lines only are written", left_out));
  if (blocks.empty()) throw InputError("VTP holds faces, lines and vertices only, and this mesh has none; write VTU");
  std::deque<std::vector<std::uint32_t>> scratch;
  VtkOutput vtk(out, options, "PolyData");
  vtk.open(fmt::format("PolyData dimension=\"{}\"", mesh.dimension));
  write_names(vtk, mesh, "VTP", notes);
  const Blocks verts = blocks_of(mesh, 0, 0), lines = blocks_of(mesh, 1, 1), polys = blocks_of(mesh, 2, 2);
  vtk.open(
      fmt::format("Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
                  "NumberOfPolys=\"{}\"",
                  mesh.points.size(), num_cells(verts), num_cells(lines), num_cells(polys)));
  write_points(vtk, mesh);
  const std::pair<const char*, const Blocks*> parts[] = {{"Verts", &verts}, {"Lines", &lines}, {"Polys", &polys}};
  for (const auto& [tag, part] : parts) {
    vtk.open(tag);
    write_connectivity(vtk, *part, scratch);
    vtk.close(tag);
  }
  write_data(vtk, mesh, blocks);
  vtk.close("Piece");
  vtk.close("PolyData");
  vtk.finish();
}

}  // namespace delfront
