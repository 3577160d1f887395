// SPDX-License-Identifier: Apache-2.0
// CGNS (HDF5): one base, one unstructured zone. Cells are sections by region and type, faces sections by patch and
// type; a patch is a boundary condition on its faces with a family of its name. Faces of inner patches are sections
// without a condition. Which region a section's cells have stands in a descriptor of it, kinds that CGNS does not know
// in one of the family.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cgns/cgns_file.hpp"
#include "io/cgns/same_bytes.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/names.hpp"
#include "io/output.hpp"

namespace delfront {

namespace {

constexpr std::size_t kLongestName = 32;

/// Cells of one block and one group.
struct Section {
  std::string name;
  const CellBlock* block;
  std::int64_t group;
  std::vector<std::uint32_t> cells;
};

class CgnsWriter {
 public:
  CgnsWriter(const Mesh& mesh, CgnsFile& file, Context& context, std::vector<std::string>& notes)
      : mesh_(mesh), file_(file), context_(context), notes_(notes), top_(mesh.top_dimension()) {
    names_ = fit_names(mesh, NameRule::cgns, "CGNS", notes);
  }

  void write() {
    const int space = mesh_.dimension;
    file_.check(cg_base_write(file_.number(), "Base", top_, space, &base_), "the base");
    // A grid here has no unit that is known.
    file_.check(cg_goto(file_.number(), base_, "end"), "the base");
    file_.check(cg_dataclass_write(NormalizedByUnknownDimensional), "the data class");
    const cgsize_t sizes[3] = {static_cast<cgsize_t>(mesh_.points.size()),
                               static_cast<cgsize_t>(mesh_.num_cells_of_dimension(top_)), 0};
    write_families();
    file_.check(cg_zone_write(file_.number(), base_, "Zone", sizes, Unstructured, &zone_), "the zone");
    write_points();
    for (int d = top_; d >= std::max(1, top_ - 1); --d) write_sections(d);
  }

 private:
  void write_points() {
    const char* const names[] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
    std::vector<double> values(mesh_.points.size());
    for (int k = 0; k < mesh_.dimension; ++k) {
      context_.check_limits();
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = mesh_.points[VertexId(i)][k];
      int coordinate = 0;
      file_.check(cg_coord_write(file_.number(), base_, zone_, RealDouble, names[k], values.data(), &coordinate),
                  "the coordinates");
      constexpr double kIsLength[5] = {0, 1, 0, 0, 0};
      file_.check(
          cg_goto(file_.number(), base_, "Zone_t", zone_, "GridCoordinates_t", 1, "DataArray_t", coordinate, "end"),
          "the coordinates");
      file_.check(cg_exponents_write(RealDouble, kIsLength), "the coordinates");
    }
  }

  /// One a patch; a patch and a region of the same name must not share it.
  void write_families() {
    std::set<std::string> taken;
    families_.resize(names_.size());
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const Group& group = mesh_.groups[GroupId(i)];
      if (group.dimension != top_ - 1) continue;
      families_[i] = names_[i];
      int family = 0, condition = 0;
      file_.check(cg_family_write(file_.number(), base_, names_[i].c_str(), &family), "a family");
      const BCType_t type = cgns_condition(group.kind);
      if (!group.two_sided)
        file_.check(cg_fambc_write(file_.number(), base_, family, "FamBC", type, &condition),
                    "the condition of a family");
      if (group.kind.empty() || (type != BCTypeUserDefined && !group.two_sided)) continue;
      file_.check(cg_goto(file_.number(), base_, "Family_t", family, "end"), "a family");
      file_.check(cg_descriptor_write(kKindMark, group.kind.c_str()), "the kind of a family");
    }
  }

  std::vector<Section> make_sections(int d) const {
    std::vector<Section> sections;
    for (std::size_t slot = 0; slot <= mesh_.groups.size(); ++slot) {
      const std::int64_t group = slot < mesh_.groups.size() ? static_cast<std::int64_t>(slot) : -1;
      if (group >= 0 && mesh_.groups[GroupId(slot)].dimension != d) continue;
      for (const CellBlock& block : mesh_.blocks) {
        if (dimension(block.type) != d || block.size() == 0) continue;
        Section section{"", &block, group, {}};
        for (std::size_t cell = 0; cell < block.size(); ++cell)
          if (group_of(block, cell) == group) section.cells.push_back(static_cast<std::uint32_t>(cell));
        if (!section.cells.empty()) sections.push_back(std::move(section));
      }
    }
    return sections;
  }

  /// The group's name, with the type where the group has several; unique and short enough.
  void name_sections(std::vector<Section>& sections, int d) {
    for (std::size_t i = 0; i < sections.size(); ++i) {
      const bool is_one = (i == 0 || sections[i - 1].group != sections[i].group) &&
                          (i + 1 == sections.size() || sections[i + 1].group != sections[i].group);
      const std::string own = sections[i].group >= 0 ? names_[static_cast<std::size_t>(sections[i].group)]
                              : d == top_            ? "Cells"
                                                     : "Faces";
      const std::string suffix = is_one ? "" : fmt::format("_{}", name_of(sections[i].block->type));
      std::string name = own.substr(0, kLongestName - suffix.size()) + suffix;
      for (int number = 2; !section_names_.insert(name).second; ++number) {
        const std::string more = fmt::format("{}_{}", suffix, number);
        name = own.substr(0, kLongestName - more.size()) + more;
      }
      sections[i].name = name;
    }
  }

  void write_sections(int d) {
    std::vector<Section> sections = make_sections(d);
    name_sections(sections, d);
    for (std::size_t i = 0; i < sections.size();) {
      const cgsize_t first = next_element_;
      const std::int64_t group = sections[i].group;
      for (; i < sections.size() && sections[i].group == group; ++i) write_section(sections[i], d);
      if (d == top_ - 1) write_condition(group, first, next_element_ - 1);
    }
  }

  void write_section(const Section& section, int d) {
    context_.check_limits();
    std::vector<cgsize_t> vertices;
    vertices.reserve(section.cells.size() * static_cast<std::size_t>(num_vertices(section.block->type)));
    for (const std::uint32_t cell : section.cells)
      for (const VertexId v : (*section.block)[cell]) vertices.push_back(static_cast<cgsize_t>(v.index() + 1));
    const cgsize_t last = next_element_ + static_cast<cgsize_t>(section.cells.size()) - 1;
    int number = 0;
    file_.check(cg_section_write(file_.number(), base_, zone_, section.name.c_str(), *cgns_type(section.block->type),
                                 next_element_, last, 0, vertices.data(), &number),
                "the section " + section.name);
    next_element_ = last + 1;
    const bool is_inner = d < top_ && section.group >= 0 && mesh_.groups[GroupId(std::size_t(section.group))].two_sided;
    if (section.group < 0 || (d < top_ && !is_inner)) return;
    file_.check(cg_goto(file_.number(), base_, "Zone_t", zone_, "Elements_t", number, "end"), "a section");
    file_.check(cg_descriptor_write(kRegionMark, names_[static_cast<std::size_t>(section.group)].c_str()),
                "the region of a section");
  }

  /// Faces without a patch have no condition; neither have those inside.
  void write_condition(std::int64_t group, cgsize_t first, cgsize_t last) {
    if (group < 0 || mesh_.groups[GroupId(std::size_t(group))].two_sided || top_ != mesh_.dimension) return;
    const auto i = static_cast<std::size_t>(group);
    const cgsize_t range[2] = {first, last};
    int number = 0;
    file_.check(
        cg_boco_write(file_.number(), base_, zone_, names_[i].c_str(), FamilySpecified, PointRange, 2, range, &number),
        "the condition of " + names_[i]);
    file_.check(cg_boco_gridlocation_write(file_.number(), base_, zone_, number, top_ == 3 ? FaceCenter : EdgeCenter),
                "the condition of " + names_[i]);
    file_.check(cg_goto(file_.number(), base_, "Zone_t", zone_, "ZoneBC_t", 1, "BC_t", number, "end"), "a condition");
    file_.check(cg_famname_write(families_[i].c_str()), "the family of " + names_[i]);
  }

  const Mesh& mesh_;
  CgnsFile& file_;
  Context& context_;
  std::vector<std::string>& notes_;
  int top_, base_ = 0, zone_ = 0;
  cgsize_t next_element_ = 1;
  std::vector<std::string> names_, families_;
  std::set<std::string> section_names_;
};

}  // namespace

void write_cgns(const Mesh& mesh, const std::string& path, const std::string& shown_path, const WriteOptions&,
                Context& context, std::vector<std::string>& notes) {
  refuse_general_cells(mesh, "CGNS");
  std::uint64_t num_cells = 0;
  for (const CellBlock& block : mesh.blocks) num_cells += block.size();
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<cgsize_t>::max());
  if (mesh.points.size() > kMost || num_cells > kMost)
    throw InputError(fmt::format("this CGNS library counts to {}, and the grid has {} points and {} cells; write vtu",
                                 kMost, mesh.points.size(), num_cells));
  if (mesh.top_dimension() < 1) throw InputError("CGNS: a mesh of points alone cannot be written");
  note_left_out_fields(mesh, "CGNS", notes);
  if (mesh.top_dimension() == 3) note_left_out_curves(mesh, "CGNS", notes);
  note_empty_groups(mesh, "CGNS", notes);
  const Hdf5Turn turn;
  const Replacement draft(path);  // never committed
  CgnsFile file(draft.temporary(), CG_MODE_WRITE, shown_path);
  CgnsWriter(mesh, file, context, notes).write();
  file.close();
  write_same_bytes(draft.temporary(), path, shown_path);
}

}  // namespace delfront
