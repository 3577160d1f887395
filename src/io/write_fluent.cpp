// SPDX-License-Identifier: Apache-2.0
// Ansys Fluent mesh, text: points, cells by region, and every face with its two cells, by zone. A face's nodes turn so
// that its normal points into its first cell; a side in the plane has its first cell on the right. Patches of kind
// "wall" inside the grid stay walls, of which Fluent makes two; other inner patches are interior zones of their own.
// Names, kinds and which patches are two-sided stand in comments as well, since zones without a kind are written as
// walls.
#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/fluent.hpp"
#include "io/formats.hpp"
#include "io/grid_facets.hpp"
#include "io/grid_parts.hpp"
#include "io/names.hpp"
#include "io/output.hpp"

namespace delfront {

namespace {

/// Faces of one zone: those of a group, those inside without one, those outside without one.
struct Zone {
  std::string name;
  int type = kFluentInterior;
  std::vector<std::uint32_t> facets;
};

class FluentWriter {
 public:
  FluentWriter(const Mesh& mesh, Output& out, Context& context, std::vector<std::string>& notes)
      : mesh_(mesh), out_(out), context_(context), notes_(notes), facets_(build_facets(mesh, context)) {
    names_ = fit_names(mesh, NameRule::foam_word, "Fluent", notes, {mesh.dimension - 1, mesh.dimension});
    if (facets_.num_loose > 0)
      notes.push_back(fmt::format("Fluent: {} faces that bound no cell are left out", facets_.num_loose));
  }

  void write() {
    out_.text(fmt::format("(0 \"grid of delfront\")\n(2 {})\n", mesh_.dimension));
    write_points();
    write_cells();
    write_faces();
  }

 private:
  void hex(std::uint64_t value) { out_.text(fmt::format("{:x}", value)); }

  /// What the reader of our own files finds again.
  void write_own(const Group& group, std::size_t zone, const std::string& name) {
    out_.text(fmt::format("(0 \"{}\")\n", name_line(group, static_cast<std::int64_t>(zone), name)));
  }

  void write_points() {
    const std::size_t n = mesh_.points.size();
    out_.text(fmt::format("(10 (0 1 {0:x} 0 {1}))\n(10 (1 1 {0:x} 1 {1})(\n", n, mesh_.dimension));
    for (const Point& p : mesh_.points) {
      for (int k = 0; k < mesh_.dimension; ++k) {
        out_.real(p[k]);
        out_.character(k + 1 == mesh_.dimension ? '\n' : ' ');
      }
    }
    out_.text("))\n");
    context_.check_limits();
  }

  /// Cells by region in the order of groups, those without a region last; number_[cell] counts from 1.
  void write_cells() {
    std::vector<std::vector<std::uint32_t>> cells(mesh_.groups.size() + 1);
    std::vector<CellType> type_of;
    for (const CellBlock& block : mesh_.blocks)
      for (std::size_t cell = 0; dimension(block.type) == mesh_.dimension && cell < block.size(); ++cell) {
        const std::int64_t group = group_of(block, cell);
        cells[group < 0 ? mesh_.groups.size() : static_cast<std::size_t>(group)].push_back(
            static_cast<std::uint32_t>(type_of.size()));
        type_of.push_back(block.type);
      }
    number_.assign(type_of.size(), 0);
    out_.text(fmt::format("(12 (0 1 {:x} 0 0))\n", type_of.size()));
    std::uint32_t next = 1;
    for (std::size_t group = 0; group < cells.size(); ++group) {
      if (cells[group].empty()) continue;
      const std::size_t zone = next_zone_++;
      out_.text(fmt::format("(12 ({:x} {:x} {:x} 1 0)(\n", zone, next, next + cells[group].size() - 1));
      for (const std::uint32_t cell : cells[group]) {
        number_[cell] = next++;
        out_.text(fmt::format("{}\n", fluent_number(type_of[cell])));
      }
      out_.text("))\n");
      const bool is_named = group < mesh_.groups.size();
      const std::string name = is_named ? names_[group] : std::string("unnamed_region");
      out_.text(fmt::format("(45 ({} fluid {})())\n", zone, name));
      if (is_named) write_own(mesh_.groups[GroupId(group)], zone, name);
    }
    context_.check_limits();
  }

  int zone_type(const Group& group) const {
    if (group.two_sided && group.kind != "wall") return kFluentInterior;
    if (group.kind == "inlet") return 10;
    if (group.kind == "interface" || group.kind == "cyclic") return 3;
    for (const FluentZone& zone : kFluentZones)
      if (!group.kind.empty() && group.kind == zone.kind) return zone.number;
    return 3;
  }

  std::vector<Zone> make_zones() {
    const std::size_t num_groups = mesh_.groups.size();
    std::vector<Zone> zones(num_groups + 2);
    for (std::size_t i = 0; i < num_groups; ++i) zones[i] = {names_[i], zone_type(mesh_.groups[GroupId(i)]), {}};
    zones[num_groups] = {"interior", kFluentInterior, {}};
    zones[num_groups + 1] = {"unnamed_boundary", 3, {}};
    for (std::uint32_t i = 0; i < facets_.all.size(); ++i) {
      const Facet& facet = facets_.all[i];
      const std::size_t slot = facet.group >= 0 ? static_cast<std::size_t>(facet.group)
                                                : num_groups + (facet.second == Facet::kNone ? 1 : 0);
      zones[slot].facets.push_back(i);
    }
    if (const std::size_t n = zones.back().facets.size(); n > 0)
      notes_.push_back(fmt::format("Fluent: {} boundary faces without a patch are in the zone unnamed_boundary", n));
    return zones;
  }

  void write_faces() {
    const std::vector<Zone> zones = make_zones();
    out_.text(fmt::format("(13 (0 1 {:x} 0 0))\n", facets_.all.size()));
    std::size_t next = 1;
    for (std::size_t i = 0; i < zones.size(); ++i) {
      const Zone& zone = zones[i];
      const bool is_group = i < mesh_.groups.size();
      if (zone.facets.empty()) continue;
      context_.check_limits();
      const std::size_t id = next_zone_++;
      const int shape = mesh_.dimension == 2 ? 2 : 0;
      out_.text(
          fmt::format("(13 ({:x} {:x} {:x} {:x} {})(\n", id, next, next + zone.facets.size() - 1, zone.type, shape));
      for (const std::uint32_t f : zone.facets) write_face(facets_.all[f]);
      out_.text("))\n");
      next += zone.facets.size();
      out_.text(fmt::format("(45 ({} {} {})())\n", id, type_name(zone.type), zone.name));
      if (is_group) write_own(mesh_.groups[GroupId(i)], id, zone.name);
    }
  }

  static const char* type_name(int number) {
    for (const FluentZone& zone : kFluentZones)
      if (zone.number == number) return zone.type;
    return "wall";
  }

  void write_face(const Facet& facet) {
    const auto ring = facet.ring();
    if (mesh_.dimension == 3) out_.text(ring.size() == 3 ? "3 " : "4 ");
    for (std::size_t k = ring.size(); k-- > 0;) {
      hex(ring[k].index() + 1);
      out_.character(' ');
    }
    hex(number_[facet.first]);
    out_.character(' ');
    hex(facet.second == Facet::kNone ? 0 : number_[facet.second]);
    out_.character('\n');
  }

  const Mesh& mesh_;
  Output& out_;
  Context& context_;
  std::vector<std::string>& notes_;
  Facets facets_;
  std::vector<std::string> names_;
  std::vector<std::uint32_t> number_;
  std::size_t next_zone_ = 2;
};

}  // namespace

void write_fluent(const Mesh& mesh, Output& out, const WriteOptions&, Context& context,
                  std::vector<std::string>& notes) {
  refuse_general_cells(mesh, "Fluent");
  if (mesh.num_cells_of_dimension(mesh.dimension) == 0)
    throw InputError(
        fmt::format("Fluent needs a grid of cells of dimension {}, and this mesh has none; surfaces go to stl, "
                    "obj, ply or vtp",
                    mesh.dimension));
  note_left_out_fields(mesh, "Fluent", notes);
  note_left_out_curves(mesh, "Fluent", notes);
  note_empty_groups(mesh, "Fluent", notes);
  FluentWriter(mesh, out, context, notes).write();
}

}  // namespace delfront
