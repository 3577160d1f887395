// SPDX-License-Identifier: Apache-2.0
// Abaqus and CalculiX input. Regions are element sets; patches are surfaces made of faces of cells, and node sets of
// the same name. Grids without volume cells are shells. Kinds and two-sided patches are said in comments.
#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "io/abaqus.hpp"
#include "io/cells.hpp"
#include "io/face_owners.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/names.hpp"
#include "io/output.hpp"

namespace delfront {

namespace {

constexpr std::size_t kItemsOfLine = 16;

class AbaqusWriter {
 public:
  AbaqusWriter(const Mesh& mesh, Output& out, Context& context, std::vector<std::string>& notes)
      : mesh_(mesh),
        out_(out),
        context_(context),
        notes_(notes),
        top_(mesh.top_dimension()),
        owners_(mesh, false) {  // the manual's faces look inwards
    names_ = fit_names(mesh, NameRule::any_case, "Abaqus", notes, {mesh.dimension - 1, mesh.dimension});
  }

  void write() {
    out_.text("*HEADING\n");
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const Group& group = mesh_.groups[GroupId(i)];
      if (group.dimension == top_ || group.dimension == top_ - 1)
        out_.text(fmt::format("**{}\n", name_line(group, static_cast<std::int64_t>(i) + 1, names_[i])));
    }
    write_nodes();
    write_elements();
    write_sets();
    find_faces();
    write_surfaces();
    if (num_loose_ > 0) notes_.push_back(fmt::format("Abaqus: {} faces that bound no cell are left out", num_loose_));
  }

 private:
  const char* type_name(CellType type) const {
    switch (type) {
      case CellType::line:
        return "T3D2";
      case CellType::triangle:
        return mesh_.dimension == 2 ? "CPS3" : "S3";
      case CellType::quad:
        return mesh_.dimension == 2 ? "CPS4" : "S4";
      case CellType::tetrahedron:
        return "C3D4";
      case CellType::pyramid:
        return "C3D5";
      case CellType::prism:
        return "C3D6";
      default:
        return "C3D8";
    }
  }

  template <class Function>
  void for_each_block(int d, Function&& take) const {
    std::int64_t first = 1;
    for (const CellBlock& block : mesh_.blocks) {
      if (dimension(block.type) != d) continue;
      take(block, first);
      first += static_cast<std::int64_t>(block.size());
    }
  }

  void write_nodes() {
    out_.text("*NODE\n");
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      if (i % 65536 == 0) context_.check_limits();
      out_.integer(static_cast<std::int64_t>(i) + 1);
      for (int k = 0; k < mesh_.dimension; ++k) {
        out_.text(", ");
        out_.real(mesh_.points[VertexId(i)][k]);
      }
      out_.character('\n');
    }
  }

  void write_elements() {
    for_each_block(top_, [&](const CellBlock& block, std::int64_t first) {
      if (block.size() == 0) return;
      context_.check_limits();
      out_.text(fmt::format("*ELEMENT, TYPE={}\n", type_name(block.type)));
      for (std::size_t cell = 0; cell < block.size(); ++cell) {
        out_.integer(first + static_cast<std::int64_t>(cell));
        for (const VertexId v : block[cell]) {
          out_.text(", ");
          out_.integer(static_cast<std::int64_t>(v.index()) + 1);
        }
        out_.character('\n');
      }
    });
  }

  /// Runs of numbers: groups mostly are.
  void write_sets() {
    struct Run {
      std::int64_t first, last;
    };
    std::vector<std::vector<Run>> of_group(names_.size());
    for_each_block(top_, [&](const CellBlock& block, std::int64_t first) {
      for (std::size_t cell = 0; cell < block.size(); ++cell) {
        const std::int64_t group = group_of(block, cell), number = first + static_cast<std::int64_t>(cell);
        if (group < 0) continue;
        auto& runs = of_group[static_cast<std::size_t>(group)];
        if (runs.empty() || runs.back().last + 1 < number) runs.push_back({number, number});
        runs.back().last = number;
      }
    });
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (mesh_.groups[GroupId(i)].dimension != top_) continue;
      out_.text(fmt::format("*ELSET, ELSET={}, GENERATE\n", names_[i]));
      for (const Run& run : of_group[i]) out_.text(fmt::format("{}, {}, 1\n", run.first, run.last));
    }
  }

  void find_faces() {
    if (owners_.is_empty()) return;
    for_each_block(top_, [&](const CellBlock& block, std::int64_t first) {
      for (std::size_t cell = 0; cell < block.size(); ++cell)
        owners_.offer(first + static_cast<std::int64_t>(cell), block[cell], abaqus_faces(block.type));
    });
  }

  using Face = std::pair<const CellBlock*, std::size_t>;

  void write_surfaces() {
    std::vector<std::vector<Face>> of_group(names_.size() + 1);  // the last for faces without one
    for (const CellBlock& block : mesh_.blocks)
      for (std::size_t cell = 0; dimension(block.type) == top_ - 1 && cell < block.size(); ++cell) {
        const std::int64_t group = group_of(block, cell);
        of_group[group < 0 ? names_.size() : static_cast<std::size_t>(group)].emplace_back(&block, cell);
      }
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (mesh_.groups[GroupId(i)].dimension == top_ - 1) write_surface(of_group[i], names_[i], true);
    write_surface(of_group.back(), "DELFRONT_UNNAMED", false);
  }

  void write_surface(const std::vector<Face>& stored, const std::string& name, bool is_patch) {
    std::vector<FaceOwners::Owner> faces;
    std::vector<std::int64_t> nodes;
    for (const auto& [block, cell] : stored) {
      const FaceOwners::Owner* owner = owners_.find((*block)[cell]);
      if (!owner) {
        ++num_loose_;
        continue;
      }
      faces.push_back(*owner);
      for (const VertexId v : (*block)[cell]) nodes.push_back(static_cast<std::int64_t>(v.index()) + 1);
    }
    if (faces.empty() && (!is_patch || top_ != mesh_.dimension)) return;
    if (!is_patch)
      notes_.push_back(fmt::format("Abaqus: {} faces without a patch are in the surface {}", faces.size(), name));
    out_.text(fmt::format("*SURFACE, NAME={}, TYPE=ELEMENT\n", name));
    for (const FaceOwners::Owner& face : faces) out_.text(fmt::format("{}, S{}\n", face.element, face.face));
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    if (nodes.empty()) return;
    out_.text(fmt::format("*NSET, NSET={}\n", name));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      out_.integer(nodes[i]);
      out_.text(i + 1 == nodes.size() || (i + 1) % kItemsOfLine == 0 ? "\n" : ", ");
    }
  }

  const Mesh& mesh_;
  Output& out_;
  Context& context_;
  std::vector<std::string>& notes_;
  int top_;
  std::vector<std::string> names_;
  FaceOwners owners_;
  std::size_t num_loose_ = 0;
};

}  // namespace

void write_abaqus(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                  std::vector<std::string>& notes) {
  refuse_general_cells(mesh, "Abaqus");
  note_left_out_fields(mesh, "Abaqus", notes);
  note_left_out_curves(mesh, "Abaqus", notes);
  AbaqusWriter(mesh, out, context, notes).write();
}

}  // namespace delfront
