// SPDX-License-Identifier: Apache-2.0
// Medit (.mesh, ASCII, version 2). A group is the reference "number in its dimension + 1", 0 for cells without one; its
// name and kind stand in a comment at the top, which other programs skip.
#include <fmt/format.h>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/names.hpp"
#include "io/output.hpp"

namespace delfront {

namespace {

const char* keyword(CellType type) {
  switch (type) {
    case CellType::vertex:
      return "RequiredVertices";
    case CellType::line:
      return "Edges";
    case CellType::triangle:
      return "Triangles";
    case CellType::quad:
      return "Quadrilaterals";
    case CellType::tetrahedron:
      return "Tetrahedra";
    case CellType::pyramid:
      return "Pyramids";
    case CellType::prism:
      return "Prisms";
    case CellType::hexahedron:
      return "Hexahedra";
    default:
      return nullptr;
  }
}

void write_vertices(Output& out, const Mesh& mesh) {
  out.text(fmt::format("\nVertices\n{}\n", mesh.points.size()));
  for (const Point& p : mesh.points) {
    for (int k = 0; k < mesh.dimension; ++k) {
      out.real(p[k]);
      out.character(' ');
    }
    out.text("0\n");
  }
}

void write_block(Output& out, const CellBlock& block, const std::vector<std::int32_t>& number) {
  out.text(fmt::format("\n{}\n{}\n", keyword(block.type), block.size()));
  for (std::size_t cell = 0; cell < block.size(); ++cell) {
    for (VertexId v : block[cell]) {
      out.integer(static_cast<std::int64_t>(v.index()) + 1);
      out.character(' ');
    }
    if (block.type != CellType::vertex) {  // which have no reference
      const std::int64_t group = group_of(block, cell);
      out.integer(group < 0 ? 0 : number[static_cast<std::size_t>(group)] + 1);
    }
    out.character('\n');
  }
}

}  // namespace

void write_medit(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                 std::vector<std::string>& notes) {
  note_left_out_fields(mesh, "Medit", notes);
  for (const Group& group : mesh.groups)
    if (group.dimension == 0)
      notes.push_back(fmt::format("Medit: the name of the points '{}' is left out", group.name));
  for (const CellBlock& block : mesh.blocks) {
    if (block.size() == 0 || keyword(block.type)) continue;
    throw InputError(fmt::format("Medit cannot hold {} {} cells; write VTU, or triangulate them first", block.size(),
                                 name_of(block.type)));
  }
  const std::vector<std::string> names = fit_names(mesh, NameRule::line, "Medit", notes);
  const std::vector<std::int32_t> number = number_groups_by_dimension(mesh);
  out.text(fmt::format("MeshVersionFormatted 2\n\nDimension {}\n\n", mesh.dimension));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Group& group = mesh.groups[GroupId(i)];
    out.text(fmt::format("#delfront {} {} {} {} {}\n", group.dimension, number[i] + 1, group.two_sided ? 2 : 1,
                         group.kind.empty() ? "-" : group.kind, names[i]));
  }
  write_vertices(out, mesh);
  for (const CellBlock& block : mesh.blocks) {
    context.check_limits();
    if (block.size() > 0 && keyword(block.type)) write_block(out, block, number);
  }
  out.text("\nEnd\n");
}

}  // namespace delfront
