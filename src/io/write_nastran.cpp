// SPDX-License-Identifier: Apache-2.0
// Nastran bulk data: points in large fields (10 digits and more), elements in small ones. A group is the property "its
// place in the mesh + 1"; names stand in comments as HyperMesh and ANSA read them, with kinds in comments of our own.
// Materials and thicknesses are not a grid's to say: properties refer to material 1, which the deck lacks.
#include <fmt/format.h>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/names.hpp"
#include "io/nastran_text.hpp"
#include "io/output.hpp"

namespace delfront {

namespace {

constexpr std::size_t kMostNumbers = 99'999'999;  // eight digits
constexpr std::size_t kFieldsOfLine = 8;

const char* element_name(CellType type) {
  switch (type) {
    case CellType::line:
      return "CROD";
    case CellType::triangle:
      return "CTRIA3";
    case CellType::quad:
      return "CQUAD4";
    case CellType::tetrahedron:
      return "CTETRA";
    case CellType::pyramid:
      return "CPYRAM";
    case CellType::prism:
      return "CPENTA";
    case CellType::hexahedron:
      return "CHEXA";
    default:
      return nullptr;
  }
}

const char* property_name(int dimension) { return dimension == 3 ? "PSOLID" : dimension == 2 ? "PSHELL" : "PROD"; }

void check_numbers(const Mesh& mesh) {
  std::size_t num_cells = 0;
  for (const CellBlock& block : mesh.blocks) num_cells += block.size();
  if (mesh.points.size() > kMostNumbers || num_cells > kMostNumbers)
    throw InputError(
        fmt::format("Nastran numbers at most {} points and elements, and this grid has {} and {}; write cgns, "
                    "vtu or msh",
                    kMostNumbers, mesh.points.size(), num_cells));
}

void write_names(Output& out, const Mesh& mesh, std::vector<std::string>& notes) {
  const std::vector<std::string> names = fit_names(mesh, NameRule::quoted, "Nastran", notes);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Group& group = mesh.groups[GroupId(i)];
    if (group.dimension == 0) {
      notes.push_back(fmt::format("Nastran: the name of the points '{}' is left out", group.name));
      continue;
    }
    const char* property = property_name(group.dimension);
    out.text(fmt::format("${}\n$HMNAME COMP{:>20}\"{}\"\n$ANSA_NAME_COMMENT;{};{};{};\n{:<8}{:<8}1\n",
                         name_line(group, static_cast<std::int64_t>(i) + 1, names[i]), i + 1, names[i], i + 1, property,
                         names[i], property, i + 1));
  }
}

void write_field(Output& out, std::int64_t value) { out.text(fmt::format("{:<8}", value)); }

void write_cells(Output& out, const Mesh& mesh, const CellBlock& block, std::int64_t& next_id) {
  const char* name = element_name(block.type);
  const std::int64_t none = static_cast<std::int64_t>(mesh.groups.size()) + 1 + dimension(block.type);
  for (std::size_t cell = 0; cell < block.size(); ++cell) {
    const std::int64_t group = group_of(block, cell);
    out.text(fmt::format("{:<8}", name));
    write_field(out, next_id++);
    write_field(out, group < 0 ? none : group + 1);
    std::size_t field = 2;
    for (const VertexId v : block[cell]) {
      if (field++ == kFieldsOfLine) out.text("+       \n+       ");
      write_field(out, static_cast<std::int64_t>(v.index()) + 1);
    }
    out.character('\n');
  }
}

}  // namespace

void write_nastran(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                   std::vector<std::string>& notes) {
  refuse_general_cells(mesh, "Nastran");
  check_numbers(mesh);
  note_left_out_fields(mesh, "Nastran", notes);
  if (const std::size_t n = mesh.num_cells(CellType::vertex); n > 0)
    notes.push_back(fmt::format("Nastran: {} vertex cells are left out; VTU and MSH keep them", n));
  out.text("CEND\nBEGIN BULK\n");
  write_names(out, mesh, notes);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (i % 65536 == 0) context.check_limits();
    const Point& p = mesh.points[VertexId(i)];
    out.text(fmt::format("GRID*   {:<16}{:<16}{:<16}{:<16}\n*       {}\n", i + 1, "", nastran_real(p.x),
                         nastran_real(p.y), nastran_real(p.z)));
  }
  std::int64_t next_id = 1;
  for (const CellBlock& block : mesh.blocks) {
    context.check_limits();
    if (element_name(block.type)) write_cells(out, mesh, block, next_id);
  }
  out.text("ENDDATA\n");
}

}  // namespace delfront
