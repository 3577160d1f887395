// SPDX-License-Identifier: Apache-2.0
// Gmsh MSH 4.1 (default) and 2.2, ASCII or binary. A group is one physical group and one entity of the same tag; cells
// without a group get an entity of their own, in a physical group without a name where there are groups at all (readers
// want all cells or none to be in one). All nodes belong to one entity of the top
// dimension. The tag of a cell is its place in the mesh, so that read_msh finds the order again.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/msh_types.hpp"
#include "io/names.hpp"
#include "io/output.hpp"

namespace delfront {

namespace {

/// Cells of one block and one group (one entity), in mesh order.
struct Batch {
  const CellBlock* block;
  std::int32_t entity;    // number of the group in its dimension + 1; one more than all groups for those without
  std::int32_t physical;  // the same, 0 for those without
  std::size_t first_tag;  // tag of the block's cell 0
  std::vector<std::uint32_t> cells;
};

/// Numbers in the encoding asked for.
class MshOutput {
 public:
  MshOutput(Output& out, bool is_text) : out_(out), is_text_(is_text) {}
  void text(std::string_view line) { out_.text(line); }
  void int32(std::int64_t value) { is_text_ ? spaced(value) : out_.binary(static_cast<std::int32_t>(value)); }
  void int64(std::int64_t value) { is_text_ ? spaced(value) : out_.binary(value); }
  void real(double value) {
    if (!is_text_) return out_.binary(value);
    out_.real(value);
    out_.character(' ');
  }
  void end_line() {
    if (is_text_) out_.character('\n');
  }
  void end_binary() {
    if (!is_text_) out_.character('\n');
  }
  bool is_text() const { return is_text_; }

 private:
  void spaced(std::int64_t value) {
    out_.integer(value);
    out_.character(' ');
  }
  Output& out_;
  bool is_text_;
};

std::vector<Batch> make_batches(const Mesh& mesh) {
  const std::vector<std::int32_t> number = number_groups_by_dimension(mesh);
  std::array<std::int32_t, 4> num_groups{};
  for (const Group& group : mesh.groups) ++num_groups[static_cast<std::size_t>(group.dimension)];
  std::vector<Batch> batches;
  std::size_t tag = 1;
  for (const CellBlock& block : mesh.blocks) {
    if (!msh_number(block.type) && block.size() > 0)
      throw InputError(fmt::format("MSH cannot hold {} {} cells; write VTU, or triangulate them first", block.size(),
                                   name_of(block.type)));
    const std::size_t first_batch = batches.size();
    const std::int32_t none = num_groups[static_cast<std::size_t>(dimension(block.type))];
    std::vector<std::uint32_t> batch_of(mesh.groups.size() + 1, Id<struct BatchTag>::kNone);
    for (std::size_t cell = 0; cell < block.size(); ++cell) {
      const std::int64_t group = group_of(block, cell);
      std::uint32_t& batch = batch_of[group < 0 ? mesh.groups.size() : static_cast<std::size_t>(group)];
      if (batch == Id<struct BatchTag>::kNone) {
        batch = static_cast<std::uint32_t>(batches.size());
        const std::int32_t place = group < 0 ? none : number[static_cast<std::size_t>(group)];
        batches.push_back({&block, place + 1, mesh.groups.empty() ? 0 : place + 1, tag, {}});
      }
      batches[batch].cells.push_back(static_cast<std::uint32_t>(cell));
    }
    std::sort(batches.begin() + static_cast<std::ptrdiff_t>(first_batch), batches.end(),
              [](const Batch& a, const Batch& b) { return a.entity < b.entity; });
    tag += block.size();
  }
  return batches;
}

void write_head(MshOutput& msh, const Mesh& mesh, const char* version, std::vector<std::string>& notes) {
  msh.text(fmt::format("$MeshFormat\n{} {} 8\n", version, msh.is_text() ? 0 : 1));
  if (!msh.is_text()) msh.int32(1);
  msh.end_binary();
  msh.text("$EndMeshFormat\n");
  if (mesh.groups.empty()) return;
  const std::vector<std::string> names = fit_names(mesh, NameRule::quoted, "MSH", notes);
  const std::vector<std::int32_t> number = number_groups_by_dimension(mesh);
  msh.text(fmt::format("$PhysicalNames\n{}\n", names.size()));
  for (int d = 0; d <= 3; ++d)
    for (std::size_t i = 0; i < names.size(); ++i)
      if (mesh.groups[GroupId(i)].dimension == d) msh.text(fmt::format("{} {} \"{}\"\n", d, number[i] + 1, names[i]));
  msh.text("$EndPhysicalNames\n");
}

void write_point(MshOutput& msh, const Point& p) {
  msh.real(p.x);
  msh.real(p.y);
  msh.real(p.z);
}

void write_nodes2(MshOutput& msh, const Mesh& mesh) {
  msh.text(fmt::format("$Nodes\n{}\n", mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    msh.int32(static_cast<std::int64_t>(i) + 1);
    write_point(msh, mesh.points[VertexId(i)]);
    msh.end_line();
  }
  msh.end_binary();
  msh.text("$EndNodes\n");
}

void write_elements2(MshOutput& msh, const std::vector<Batch>& batches) {
  std::size_t total = 0;
  for (const Batch& batch : batches) total += batch.cells.size();
  msh.text(fmt::format("$Elements\n{}\n", total));
  for (const Batch& batch : batches) {
    const int type = *msh_number(batch.block->type);
    if (!msh.is_text()) {
      msh.int32(type);
      msh.int32(static_cast<std::int64_t>(batch.cells.size()));
      msh.int32(2);
    }
    for (std::uint32_t cell : batch.cells) {
      msh.int32(static_cast<std::int64_t>(batch.first_tag + cell));
      if (msh.is_text()) {
        msh.int32(type);
        msh.int32(2);
      }
      msh.int32(batch.physical);
      msh.int32(batch.entity);
      for (VertexId v : (*batch.block)[cell]) msh.int32(static_cast<std::int64_t>(v.index()) + 1);
      msh.end_line();
    }
  }
  msh.end_binary();
  msh.text("$EndElements\n");
}

/// One entity a group and one for the cells without; their boxes are that of the mesh, which Gmsh only displays.
void write_entities(MshOutput& msh, const Mesh& mesh, const std::vector<Batch>& batches) {
  std::array<std::int32_t, 4> num_entities{};
  for (const Group& group : mesh.groups) ++num_entities[static_cast<std::size_t>(group.dimension)];
  for (const Batch& batch : batches) {
    const auto d = static_cast<std::size_t>(dimension(batch.block->type));
    num_entities[d] = std::max(num_entities[d], batch.entity);
  }
  const Box box = mesh.bounding_box();
  msh.text("$Entities\n");
  for (std::int32_t n : num_entities) msh.int64(n);
  msh.end_line();
  for (std::size_t d = 0; d < 4; ++d)
    for (std::int32_t entity = 1; entity <= num_entities[d]; ++entity) {
      msh.int32(entity);
      write_point(msh, box.low);
      if (d > 0) write_point(msh, box.high);
      msh.int64(mesh.groups.empty() ? 0 : 1);
      if (!mesh.groups.empty()) msh.int32(entity);
      if (d > 0) msh.int64(0);
      msh.end_line();
    }
  msh.end_binary();
  msh.text("$EndEntities\n");
}

void write_nodes4(MshOutput& msh, const Mesh& mesh, const std::vector<Batch>& batches) {
  const auto n = static_cast<std::int64_t>(mesh.points.size());
  int d = 0;
  std::int32_t entity = 1;
  for (const Batch& batch : batches) {
    if (dimension(batch.block->type) <= d) continue;
    d = dimension(batch.block->type);
    entity = batch.entity;
  }
  msh.text("$Nodes\n");
  for (std::int64_t value : {std::int64_t{1}, n, std::int64_t{1}, n}) msh.int64(value);
  msh.end_line();
  for (std::int64_t value : {std::int64_t{d}, std::int64_t{entity}, std::int64_t{0}}) msh.int32(value);
  msh.int64(n);
  msh.end_line();
  for (std::int64_t tag = 1; tag <= n; ++tag) {
    msh.int64(tag);
    msh.end_line();
  }
  for (const Point& p : mesh.points) {
    write_point(msh, p);
    msh.end_line();
  }
  msh.end_binary();
  msh.text("$EndNodes\n");
}

void write_elements4(MshOutput& msh, const std::vector<Batch>& batches) {
  std::int64_t total = 0;
  for (const Batch& batch : batches) total += static_cast<std::int64_t>(batch.cells.size());
  msh.text("$Elements\n");
  for (std::int64_t value : {static_cast<std::int64_t>(batches.size()), total, std::int64_t{1}, total})
    msh.int64(value);
  msh.end_line();
  for (const Batch& batch : batches) {
    msh.int32(dimension(batch.block->type));
    msh.int32(batch.entity);
    msh.int32(*msh_number(batch.block->type));
    msh.int64(static_cast<std::int64_t>(batch.cells.size()));
    msh.end_line();
    for (std::uint32_t cell : batch.cells) {
      msh.int64(static_cast<std::int64_t>(batch.first_tag + cell));
      for (VertexId v : (*batch.block)[cell]) msh.int64(static_cast<std::int64_t>(v.index()) + 1);
      msh.end_line();
    }
  }
  msh.end_binary();
  msh.text("$EndElements\n");
}

}  // namespace

void write_msh(const Mesh& mesh, Output& out, const WriteOptions& options, Context& context,
               std::vector<std::string>& notes) {
  context.check_limits();
  const bool is_v2 = options.version == "2.2" || options.version == "2";
  if (!is_v2 && !options.version.empty() && options.version != "4.1" && options.version != "4")
    throw UsageError(fmt::format("MSH version '{}' cannot be written; 4.1 and 2.2 can", options.version));
  note_left_out_fields(mesh, "MSH", notes);
  note_left_out_kinds(mesh, "MSH", notes);
  const std::vector<Batch> batches = make_batches(mesh);
  if (is_v2 && mesh.points.size() > 0x7fffffff) throw InputError("MSH 2.2 holds at most 2^31 - 1 nodes; write 4.1");
  MshOutput msh(out, !options.binary);
  write_head(msh, mesh, is_v2 ? "2.2" : "4.1", notes);
  if (is_v2) {
    write_nodes2(msh, mesh);
    write_elements2(msh, batches);
  } else {
    write_entities(msh, mesh, batches);
    write_nodes4(msh, mesh, batches);
    write_elements4(msh, batches);
  }
}

}  // namespace delfront
