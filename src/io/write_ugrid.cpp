// SPDX-License-Identifier: Apache-2.0
// AFLR's UGRID as text (.ugrid) or binary (.b8.ugrid big endian, .lb8.ugrid little endian), and FUN3D's .mapbc beside
// it with the names and kinds. Surface numbers count the patches from 1. Where there are several regions their numbers
// follow the cells. Faces of inner patches are there once, like others.
#include <fmt/format.h>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/names.hpp"
#include "io/output.hpp"
#include "io/ugrid.hpp"

namespace delfront {

namespace {

enum class Encoding { text, big, little };

constexpr const char* kUnnamed = "unnamed_boundary";

bool has_unnamed(const Mesh& mesh, int wanted) {
  for (const CellBlock& block : mesh.blocks)
    for (std::size_t cell = 0; dimension(block.type) == wanted && cell < block.size(); ++cell)
      if (group_of(block, cell) < 0) return true;
  return false;
}

std::size_t num_groups(const Mesh& mesh, int wanted) {
  std::size_t n = 0;
  for (const Group& group : mesh.groups) n += group.dimension == wanted;
  return n;
}

class UgridWriter {
 public:
  UgridWriter(const Mesh& mesh, Output& out, Encoding encoding, Context& context)
      : mesh_(mesh), out_(out), encoding_(encoding), context_(context), number_(number_groups_by_dimension(mesh)) {
    has_volume_ = mesh.num_cells_of_dimension(3) > 0;
  }

  void write() {
    write_counts();
    for (const Point& p : mesh_.points) {
      for (int k = 0; k < 3; ++k) real(p[k]);
      end_line();
    }
    for (const CellType type : {CellType::triangle, CellType::quad}) write_cells(type);
    for (const CellType type : {CellType::triangle, CellType::quad}) write_numbers(type);
    for (std::size_t i = 2; i < kUgridTypes.size(); ++i) write_cells(kUgridTypes[i]);
    const std::size_t num_regions = num_groups(mesh_, 3);
    if (num_regions == 0 || (num_regions == 1 && !has_unnamed(mesh_, 3))) return;  // the .mapbc names the one there is
    integer(0);
    end_line();
    for (std::size_t i = 2; i < kUgridTypes.size(); ++i) write_numbers(kUgridTypes[i]);
  }

 private:
  void integer(std::int64_t value) {
    if (encoding_ == Encoding::text) {
      out_.integer(value);
      return out_.character(' ');
    }
    const auto small = static_cast<std::int32_t>(value);
    out_.binary(encoding_ == Encoding::big ? Cursor::swapped(small) : small);
  }
  void real(double value) {
    if (encoding_ == Encoding::text) {
      out_.real(value);
      return out_.character(' ');
    }
    out_.binary(encoding_ == Encoding::big ? Cursor::swapped(value) : value);
  }
  void end_line() {
    if (encoding_ == Encoding::text) out_.character('\n');
  }

  void write_counts() {
    integer(static_cast<std::int64_t>(mesh_.points.size()));
    for (const CellType type : kUgridTypes) integer(static_cast<std::int64_t>(mesh_.num_cells(type)));
    end_line();
  }

  void write_cells(CellType type) {
    const CellBlock* block = mesh_.find_block(type);
    if (!block) return;
    context_.check_limits();
    const bool turns = dimension(type) == 2 && has_volume_;
    for (std::size_t cell = 0; cell < block->size(); ++cell) {
      const std::span<const VertexId> v = (*block)[cell];
      for (std::size_t k = 0; k < v.size(); ++k)
        integer(static_cast<std::int64_t>(v[turns ? turned_place(type, k) : ugrid_place(type, k)].index()) + 1);
      end_line();
    }
  }

  void write_numbers(CellType type) {
    const CellBlock* block = mesh_.find_block(type);
    if (!block) return;
    const int d = dimension(type);
    const auto none = static_cast<std::int64_t>(d == 2 ? num_groups(mesh_, 2) + 1 : 0);
    for (std::size_t cell = 0; cell < block->size(); ++cell) {
      const std::int64_t group = group_of(*block, cell);
      integer(group < 0 ? none : number_[static_cast<std::size_t>(group)] + 1);
      end_line();
    }
  }

  const Mesh& mesh_;
  Output& out_;
  Encoding encoding_;
  Context& context_;
  std::vector<std::int32_t> number_;
  bool has_volume_ = false;
};

constexpr const char* kKinds[] = {"wall", "inlet", "outlet", "farfield", "symmetry", "cyclic"};

/// FUN3D's number of a kind; 0 where the kind does not decide it.
int condition_of(const Mesh& mesh, GroupId group) {
  const std::string& kind = mesh.groups[group].kind;
  if (kind == "wall") return 4000;
  if (kind == "farfield") return 5000;
  if (kind == "symmetry") return 6661 + axis_of_group(mesh, group);
  if (kind == "cyclic") return 6100;
  if (kind == "inlet") return 7011;
  if (kind == "outlet") return 7012;
  return 0;
}

void write_ugrid_as(const Mesh& mesh, Output& out, Encoding encoding, Context& context,
                    std::vector<std::string>& notes) {
  refuse_general_cells(mesh, "UGRID");
  const bool is_small = mesh.points.size() <= 0x7fffffff;
  if (encoding != Encoding::text && !is_small)
    throw InputError("binary UGRID of 4-byte numbers holds at most 2^31 - 1 nodes; write text (.ugrid)");
  note_left_out_fields(mesh, "UGRID", notes);
  note_left_out_kinds(mesh, "UGRID", notes, kKinds);
  note_empty_groups(mesh, "UGRID", notes);
  if (const std::size_t n = mesh.num_cells(CellType::line) + mesh.num_cells(CellType::vertex); n > 0)
    notes.push_back(
        fmt::format("UGRID: {} lines and points are left out, with their names; SU2, VTU and MSH keep them", n));
  for (std::size_t i = 0; i < mesh.groups.size(); ++i)
    if (const Group& group = mesh.groups[GroupId(i)]; group.two_sided && group.dimension == 2)
      notes.push_back(
          fmt::format("UGRID: the inner patch \"{}\" is written as a surface like others; some solvers take "
                      "boundary faces only",
                      group.name));
  UgridWriter(mesh, out, encoding, context).write();
}

}  // namespace

void write_ugrid(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                 std::vector<std::string>& notes) {
  write_ugrid_as(mesh, out, Encoding::text, context, notes);
}
void write_ugrid_b8(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                    std::vector<std::string>& notes) {
  write_ugrid_as(mesh, out, Encoding::big, context, notes);
}
void write_ugrid_lb8(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                     std::vector<std::string>& notes) {
  write_ugrid_as(mesh, out, Encoding::little, context, notes);
}

void write_mapbc(const Mesh& mesh, Output& out, std::vector<std::string>& notes) {
  const std::vector<std::string> names = fit_names(mesh, NameRule::word, "UGRID", notes);
  const std::vector<std::int32_t> number = number_groups_by_dimension(mesh);
  const bool is_unnamed = has_unnamed(mesh, 2);
  const std::size_t n = num_groups(mesh, 2);
  out.text(fmt::format("{}\n", n + is_unnamed));
  std::size_t num_open = is_unnamed;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (mesh.groups[GroupId(i)].dimension != 2) continue;
    const int condition = condition_of(mesh, GroupId(i));
    num_open += condition == 0;
    out.text(fmt::format("{} {} {}\n", number[i] + 1, condition, names[i]));
  }
  if (is_unnamed) {
    out.text(fmt::format("{} 0 {}\n", n + 1, kUnnamed));
    notes.push_back(fmt::format("UGRID: faces without a patch are surface {}, {}", n + 1, kUnnamed));
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (mesh.groups[GroupId(i)].dimension == 3) out.text(fmt::format("# volume {} {}\n", number[i] + 1, names[i]));
  if (num_open > 0)
    notes.push_back(
        fmt::format("UGRID: the condition of {} surfaces is 0 in the .mapbc; set FUN3D's numbers there", num_open));
}

}  // namespace delfront
