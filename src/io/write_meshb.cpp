// SPDX-License-Identifier: Apache-2.0
// Binary Medit (GMF), little endian: version 2, and where its 4-byte places do not reach, 3. A group is the reference
// "number in its dimension + 1"; its name and kind stand behind the end in the words of the comments that write_medit
// makes.
#include <fmt/format.h>

#include <limits>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/gmf.hpp"
#include "io/gmf_output.hpp"
#include "io/grid_parts.hpp"
#include "io/names.hpp"

namespace delfront {

namespace {

std::uint64_t bytes_of(const Mesh& mesh) {
  std::uint64_t bytes = 1000 + mesh.points.size() * static_cast<std::uint64_t>(8 * mesh.dimension + 4);
  for (const CellBlock& block : mesh.blocks) bytes += 4 * (block.vertices.size() + block.size());
  return bytes;
}

/// Behind the end, where other programs do not look: not all of them pass over the keyword of comments.
void write_names(Output& out, const Mesh& mesh, const std::vector<std::int32_t>& number,
                 std::vector<std::string>& notes) {
  const std::vector<std::string> names = fit_names(mesh, NameRule::line, "Medit", notes);
  for (std::size_t i = 0; i < names.size(); ++i)
    out.text(fmt::format("\n{}", name_line(mesh.groups[GroupId(i)], number[i] + 1, names[i])));
}

void write_cells(GmfWriter& gmf, const CellBlock& block, const std::vector<std::int32_t>& number) {
  const bool is_points = block.type == CellType::vertex;
  const std::size_t each = static_cast<std::size_t>(num_vertices(block.type)) + (is_points ? 0 : 1);
  gmf.begin(is_points ? gmf::kRequiredVertices : *gmf::keyword(block.type), 4 + 4 * each * block.size());
  gmf.integer(static_cast<std::int64_t>(block.size()));
  for (std::size_t cell = 0; cell < block.size(); ++cell) {
    for (const VertexId v : block[cell]) gmf.integer(static_cast<std::int64_t>(v.index()) + 1);
    const std::int64_t group = group_of(block, cell);
    if (!is_points) gmf.integer(group < 0 ? 0 : number[static_cast<std::size_t>(group)] + 1);
  }
}

}  // namespace

void write_meshb(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                 std::vector<std::string>& notes) {
  refuse_general_cells(mesh, "Medit");
  if (mesh.points.size() > std::numeric_limits<std::int32_t>::max())
    throw InputError("binary Medit is written with at most 2^31 - 1 vertices; write .mesh");
  note_left_out_fields(mesh, "Medit", notes);
  for (const Group& group : mesh.groups)
    if (group.dimension == 0)
      notes.push_back(fmt::format("Medit: the name of the points '{}' is left out", group.name));
  const std::vector<std::int32_t> number = number_groups_by_dimension(mesh);
  GmfWriter gmf(out, bytes_of(mesh) < std::numeric_limits<std::int32_t>::max() ? 2 : 3);
  gmf.begin(gmf::kDimension, 4);
  gmf.integer(mesh.dimension);
  gmf.begin(gmf::kVertices, 4 + mesh.points.size() * static_cast<std::uint64_t>(8 * mesh.dimension + 4));
  gmf.integer(static_cast<std::int64_t>(mesh.points.size()));
  for (const Point& p : mesh.points) {
    for (int k = 0; k < mesh.dimension; ++k) gmf.real(p[k]);
    gmf.integer(0);
  }
  for (const CellBlock& block : mesh.blocks) {
    context.check_limits();
    if (block.size() > 0) write_cells(gmf, block, number);
  }
  gmf.end();
  write_names(out, mesh, number, notes);
}

}  // namespace delfront
