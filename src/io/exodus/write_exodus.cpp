// SPDX-License-Identifier: Apache-2.0
// Exodus II in netCDF's classic format, which all of its readers take: an element block a region and type of cell, a
// side set a patch. Kinds, two-sided patches, and which blocks are one region stand in an attribute of the file.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/exodus/exodus.hpp"
#include "io/exodus/netcdf.hpp"
#include "io/face_owners.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/names.hpp"

namespace delfront {

namespace {

constexpr std::size_t kLeastName = 33, kMostName = 256;  // characters, with the zero at the end
constexpr float kVersion = 7.05F;                        // of the layout

class ExodusWriter {
 public:
  ExodusWriter(const Mesh& mesh, Output& out, Context& context, std::vector<std::string>& notes)
      : mesh_(mesh), file_(out), context_(context), notes_(notes), top_(mesh.top_dimension()), owners_(mesh, true) {
    names_ = fit_names(mesh, NameRule::line, "Exodus", notes, {top_ - 1, top_});
  }

  void write() {
    make_blocks();
    make_sets();
    const std::size_t name_size = size_of_names();
    add_head(name_size);
    add_points(name_size);
    add_blocks(name_size);
    add_sets(name_size);
    file_.write();
  }

 private:
  using Type = NetcdfWriter::Type;

  /// Cells of one block and one region.
  struct Block {
    std::string name;
    const CellBlock* cells;
    std::int64_t group;
    std::vector<std::uint32_t> members;
  };
  struct SideSet {
    std::string name;
    std::int64_t group;
    std::vector<FaceOwners::Owner> sides;
  };

  void make_blocks() {
    std::vector<std::vector<Block>> of_group(mesh_.groups.size() + 1);  // the last for cells without one
    for (const CellBlock& cells : mesh_.blocks)
      for (std::size_t cell = 0; dimension(cells.type) == top_ && cell < cells.size(); ++cell) {
        const std::int64_t group = group_of(cells, cell);
        auto& blocks = of_group[group >= 0 ? static_cast<std::size_t>(group) : mesh_.groups.size()];
        if (blocks.empty() || blocks.back().cells != &cells) blocks.push_back({"", &cells, group, {}});
        blocks.back().members.push_back(static_cast<std::uint32_t>(cell));
      }
    for (std::vector<Block>& blocks : of_group)
      for (Block& block : blocks) {
        const std::string own = block.group >= 0          ? names_[static_cast<std::size_t>(block.group)]
                                : top_ == mesh_.dimension ? "cells"
                                                          : "faces";
        const bool is_first = &block == &blocks.front() && block.group >= 0;
        block.name = unique_name(is_first ? own : fmt::format("{}_{}", own, name_of(block.cells->type)));
        offer_sides(block);
        blocks_.push_back(std::move(block));
      }
    if (next_element_ > std::numeric_limits<std::int32_t>::max())
      throw InputError("Exodus: more than 2^31 - 1 elements are not written; write VTU");
  }

  std::string unique_name(const std::string& wanted) {
    std::string name = wanted;
    for (int number = 2; !block_names_.insert(name).second; ++number) name = fmt::format("{}_{}", wanted, number);
    return name;
  }

  void offer_sides(const Block& block) {
    context_.check_limits();
    for (const std::uint32_t cell : block.members)
      owners_.offer(next_element_++, (*block.cells)[cell], exodus_sides(block.cells->type));
  }

  void make_sets() {
    if (top_ != mesh_.dimension) return;
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (mesh_.groups[GroupId(i)].dimension == top_ - 1)
        sets_.push_back({names_[i], static_cast<std::int64_t>(i), {}});
    sets_.push_back({kExodusNoPatch, -1, {}});
    std::vector<SideSet*> set_of(names_.size() + 1, &sets_.back());
    for (SideSet& set : sets_)
      if (set.group >= 0) set_of[static_cast<std::size_t>(set.group)] = &set;
    std::size_t num_loose = 0;
    for (const CellBlock& faces : mesh_.blocks)
      for (std::size_t face = 0; dimension(faces.type) == top_ - 1 && face < faces.size(); ++face) {
        const FaceOwners::Owner* owner = owners_.find(faces[face]);
        const std::int64_t group = group_of(faces, face);
        if (owner)
          set_of[group >= 0 ? static_cast<std::size_t>(group) : names_.size()]->sides.push_back(*owner);
        else
          ++num_loose;
      }
    if (num_loose > 0) notes_.push_back(fmt::format("Exodus: {} faces that bound no cell are left out", num_loose));
    if (sets_.back().sides.empty()) return sets_.pop_back();
    notes_.push_back(fmt::format("Exodus: {} faces without a patch are in the side set {}", sets_.back().sides.size(),
                                 kExodusNoPatch));
  }

  std::size_t size_of_names() const {
    std::size_t size = kLeastName;
    for (const Block& block : blocks_) size = std::max(size, block.name.size() + 1);
    for (const SideSet& set : sets_) size = std::max(size, set.name.size() + 1);
    return std::min(size, kMostName);
  }

  /// Blocks and sets are numbered from 1, as their ids.
  std::string table() const {
    std::string lines;
    for (std::size_t i = 0; i < blocks_.size(); ++i) append_line(lines, blocks_[i].group, i + 1);
    for (std::size_t i = 0; i < sets_.size(); ++i) append_line(lines, sets_[i].group, i + 1);
    return lines;
  }
  void append_line(std::string& lines, std::int64_t group, std::size_t id) const {
    if (group < 0) return;
    const auto i = static_cast<std::size_t>(group);
    lines += name_line(mesh_.groups[GroupId(i)], static_cast<std::int64_t>(id), names_[i]) + "\n";
  }

  void add_head(std::size_t name_size) {
    file_.add_attribute("api_version", kVersion);
    file_.add_attribute("version", kVersion);
    file_.add_attribute("floating_point_word_size", 8);
    file_.add_attribute("file_size", 1);
    file_.add_attribute("maximum_name_length", static_cast<std::int32_t>(name_size - 1));
    file_.add_attribute("title", std::string("grid"));
    if (const std::string lines = table(); !lines.empty()) file_.add_attribute(kExodusGroups, lines);
    file_.add_dimension("len_string", kLeastName);
    file_.add_dimension("len_line", 81);
    file_.add_dimension("four", 4);
    name_dimension_ = file_.add_dimension("len_name", name_size);
    const std::size_t steps = file_.add_dimension("time_step", 0);
    file_.add_variable("time_whole", Type::real, {steps}, nullptr);
  }

  void add_points(std::size_t name_size) {
    const std::size_t num_axes = file_.add_dimension("num_dim", static_cast<std::uint64_t>(mesh_.dimension));
    const std::size_t num_points = file_.add_dimension("num_nodes", mesh_.points.size());
    const char* const axes[] = {"x", "y", "z"};
    file_.add_variable("coor_names", Type::text, {num_axes, name_dimension_}, [=, this, &axes](NetcdfWriter& file) {
      for (int k = 0; k < mesh_.dimension; ++k)
        file.put_text(std::string_view("xyz").substr(static_cast<std::size_t>(k), 1), name_size);
    });
    for (int k = 0; k < mesh_.dimension; ++k)
      file_.add_variable(fmt::format("coord{}", axes[k]), Type::real, {num_points}, [this, k](NetcdfWriter& file) {
        context_.check_limits();
        for (const Point& p : mesh_.points) file.put(p[k]);
      });
  }

  /// Ids 1, 2, …, whether there is anything in each, and names.
  template <class Item>
  void add_list(const std::string& prefix, std::size_t number, std::size_t name_size, const std::vector<Item>& items) {
    file_.add_variable(prefix + "_status", Type::integer, {number}, [&items](NetcdfWriter& file) {
      for (const Item& item : items) file.put(is_there(item) ? 1 : 0);
    });
    file_.add_variable(prefix + "_prop1", Type::integer, {number},
                       [&items](NetcdfWriter& file) {
                         for (std::size_t i = 0; i < items.size(); ++i) file.put(static_cast<std::int32_t>(i + 1));
                       },
                       {"name", "ID"});
    file_.add_variable(prefix + "_names", Type::text, {number, name_dimension_},
                       [&items, name_size](NetcdfWriter& file) {
                         for (const Item& item : items)
                           file.put_text(std::string_view(item.name).substr(0, name_size - 1), name_size);
                       });
  }
  static bool is_there(const Block& block) { return !block.members.empty(); }
  static bool is_there(const SideSet& set) { return !set.sides.empty(); }

  const char* type_name(CellType type) const {
    const bool is_flat = mesh_.dimension == 2;
    switch (type) {
      case CellType::line:
        return "BAR2";
      case CellType::triangle:
        return "TRI3";
      case CellType::quad:
        return is_flat ? "QUAD4" : "SHELL4";
      case CellType::tetrahedron:
        return "TETRA";  // for meshio; others go by the first three letters
      case CellType::pyramid:
        return "PYRAMID";
      case CellType::prism:
        return "WEDGE";
      default:
        return "HEX8";
    }
  }

  void add_blocks(std::size_t name_size) {
    file_.add_dimension("num_elem", static_cast<std::uint64_t>(next_element_ - 1));
    add_list("eb", file_.add_dimension("num_el_blk", blocks_.size()), name_size, blocks_);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const Block& block = blocks_[i];
      const std::size_t num = file_.add_dimension(fmt::format("num_el_in_blk{}", i + 1), block.members.size());
      const std::size_t width = file_.add_dimension(fmt::format("num_nod_per_el{}", i + 1),
                                                    static_cast<std::uint64_t>(num_vertices(block.cells->type)));
      file_.add_variable(fmt::format("connect{}", i + 1), Type::integer, {num, width},
                         [this, &block](NetcdfWriter& file) {
                           context_.check_limits();
                           for (const std::uint32_t cell : block.members)
                             for (const VertexId v : (*block.cells)[cell])
                               file.put(static_cast<std::int32_t>(v.index() + 1));
                         },
                         {"elem_type", type_name(block.cells->type)});
    }
  }

  void add_sets(std::size_t name_size) {
    if (sets_.empty()) return;
    add_list("ss", file_.add_dimension("num_side_sets", sets_.size()), name_size, sets_);
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      const SideSet& set = sets_[i];
      if (set.sides.empty()) continue;
      const std::size_t num = file_.add_dimension(fmt::format("num_side_ss{}", i + 1), set.sides.size());
      file_.add_variable(fmt::format("elem_ss{}", i + 1), Type::integer, {num}, [&set](NetcdfWriter& file) {
        for (const FaceOwners::Owner& side : set.sides) file.put(static_cast<std::int32_t>(side.element));
      });
      file_.add_variable(fmt::format("side_ss{}", i + 1), Type::integer, {num}, [&set](NetcdfWriter& file) {
        for (const FaceOwners::Owner& side : set.sides) file.put(static_cast<std::int32_t>(side.face));
      });
    }
  }

  const Mesh& mesh_;
  NetcdfWriter file_;
  Context& context_;
  std::vector<std::string>& notes_;
  int top_;
  FaceOwners owners_;
  std::vector<std::string> names_;
  std::set<std::string> block_names_;
  std::vector<Block> blocks_;
  std::vector<SideSet> sets_;
  std::int64_t next_element_ = 1;
  std::size_t name_dimension_ = 0;
};

}  // namespace

void write_exodus(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                  std::vector<std::string>& notes) {
  refuse_general_cells(mesh, "Exodus");
  if (mesh.top_dimension() < 1) throw InputError("Exodus: a mesh of points alone cannot be written");
  if (mesh.points.size() > std::size_t(std::numeric_limits<std::int32_t>::max()))
    throw InputError("Exodus: more than 2^31 - 1 points are not written; write VTU");
  note_left_out_fields(mesh, "Exodus", notes);
  note_left_out_curves(mesh, "Exodus", notes);
  note_empty_groups(mesh, "Exodus", notes, true);
  ExodusWriter(mesh, out, context, notes).write();
}

}  // namespace delfront
