// SPDX-License-Identifier: Apache-2.0
// CGNS: the unstructured zones of the first base, sections of linear elements. Boundary conditions name their faces by
// number, or by the vertices on them; a face's patch is the condition's family, else its own name, else its section.
// Cells have the region that write_cgns noted, else their zone's family, else the zone where there are several. Equal
// points of different zones become one.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cgns/cgns_file.hpp"
#include "io/cgns/older_version.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/hdf5/library_reading.hpp"

namespace delfront {

namespace {

// The library writes up to 33 characters, for names of families as many for each node on the way to one.
using Name = std::array<char, CG_MAX_GOTO_DEPTH * 33 + 1>;

struct PointHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    std::size_t h = 0;
    for (const double x : p) h = h * 1000003 ^ std::hash<double>()(x + 0.0);
    return h;
  }
};

/// A cell of a zone by its number there.
struct Element {
  cgsize_t number = 0;
  CellType type = CellType::vertex;
  std::array<VertexId, 8> corners{};
  std::uint32_t section = 0;
  GroupId group;
};

class CgnsReader {
 public:
  CgnsReader(CgnsFile& file, std::string path, std::uint64_t file_size, Context& context)
      : file_(file), path_(std::move(path)), file_size_(file_size), context_(context) {}

  Mesh read() {
    int num_bases = 0, num_zones = 0, cell_dimension = 3, space = 3;
    Name name{};
    file_.check(cg_nbases(fn(), &num_bases), "the number of bases");
    if (num_bases < 1) throw InputError(fmt::format("{}: the CGNS file has no base", path_));
    if (num_bases > 1) context_.warn(fmt::format("{}: of its {} bases the first is read", path_, num_bases));
    file_.check(cg_base_read(fn(), kBase, name.data(), &cell_dimension, &space), "the base");
    if (cell_dimension < 1 || cell_dimension > 3 || space < 1 || space > 3)
      throw InputError(fmt::format("{}: base of dimension {} in space of dimension {}", path_, cell_dimension, space));
    mesh_.dimension = 3;
    base_name_ = name.data();
    cell_dimension_ = cell_dimension;
    space_ = space;
    file_.check(cg_nzones(fn(), kBase, &num_zones), "the number of zones");
    read_families();
    for (int zone = 1; zone <= num_zones; ++zone) read_zone(zone, num_zones);
    if (mesh_.top_dimension() < 0) throw InputError(fmt::format("{}: the CGNS file has no elements", path_));
    if (num_shared_ > 0)
      context_.warn(
          fmt::format("{}: {} faces are in several conditions; they get the last one's patch", path_, num_shared_));
    check_finite(mesh_, path_);
    set_plane(space);
    mark_inner_groups(mesh_);
    return std::move(mesh_);
  }

 private:
  static constexpr int kBase = 1;
  int fn() const { return file_.number(); }
  [[noreturn]] void fail(const std::string& where, const std::string& message) const {
    throw InputError(fmt::format("{}: {}: {}", path_, where, message));
  }

  void set_plane(int space) {
    if (cell_dimension_ != 2) return;
    if (space == 2) mesh_.dimension = 2;
    guess_dimension(mesh_);
  }

  /// @return the text of a descriptor of this name where cg_goto stands; "" where there is none
  std::string descriptor(const char* wanted) const {
    int n = 0;
    if (cg_ndescriptors(&n) != CG_OK) return "";
    for (int i = 1; i <= n; ++i) {
      Name name{};
      char* text = nullptr;
      if (cg_descriptor_read(i, name.data(), &text) != CG_OK) continue;
      const std::string found(text ? text : "");
      cg_free(text);
      if (std::string_view(name.data()) == wanted) return found;
    }
    return "";
  }

  /// Kinds of families, by their condition or by what write_cgns noted.
  void read_families() {
    int n = 0;
    file_.check(cg_nfamilies(fn(), kBase, &n), "the number of families");
    for (int family = 1; family <= n; ++family) {
      Name name{}, condition_name{};
      int num_conditions = 0, num_geometries = 0;
      file_.check(cg_family_read(fn(), kBase, family, name.data(), &num_conditions, &num_geometries), "a family");
      BCType_t condition = BCTypeNull;
      if (num_conditions > 0)
        file_.check(cg_fambc_read(fn(), kBase, family, 1, condition_name.data(), &condition),
                    "the condition of a family");
      std::string kind = kind_from_cgns(condition);
      if (cg_goto(fn(), kBase, "Family_t", family, "end") == CG_OK)
        if (const std::string noted = descriptor(kKindMark); !noted.empty()) kind = noted;
      kind_of_family_[name.data()] = kind;
      Name node{}, outer{};
      int num_outer = 0;
      if (cg_nfamily_names(fn(), kBase, family, &num_outer) == CG_OK && num_outer > 0 &&
          cg_family_name_read(fn(), kBase, family, 1, node.data(), outer.data()) == CG_OK)
        outer_family_[name.data()] = outer.data();
    }
  }

  void read_zone(int zone, int num_zones) {
    Name name{};
    ZoneType_t type = ZoneTypeNull;
    std::array<cgsize_t, 9> sizes{};
    file_.check(cg_zone_type(fn(), kBase, zone, &type), "a zone");
    if (type != Unstructured)
      throw InputError(
          fmt::format("{}: zone {} is structured, which is not read; export an unstructured grid", path_, zone));
    file_.check(cg_zone_read(fn(), kBase, zone, name.data(), sizes.data()), "a zone");
    zone_name_ = name.data();
    const std::string where = fmt::format("zone {}", zone_name_);
    // Even compressed, a number takes more than a thousandth of its bytes in the file.
    if (sizes[0] < 0 || static_cast<std::uint64_t>(sizes[0]) > 1000 * file_size_ ||
        mesh_.points.size() + static_cast<std::uint64_t>(sizes[0]) >= Id<VertexTag>::kNone)
      fail(where, fmt::format("{} points in a file of {} bytes; it is damaged", sizes[0], file_size_));
    context_.check_limits();
    const std::vector<VertexId> vertices = read_points(zone, static_cast<std::size_t>(sizes[0]), num_zones > 1);
    elements_.clear();
    section_names_.clear();
    region_of_section_.clear();
    std::string region = num_zones > 1 ? zone_name_ : "";
    if (cg_goto(fn(), kBase, "Zone_t", zone, "end") == CG_OK) {
      Name family{};
      if (cg_famname_read(family.data()) == CG_OK) region = family.data();
    }
    read_sections(zone, vertices);
    sort_elements();
    read_conditions(zone, vertices);
    add_cells(region);
  }

  std::vector<VertexId> read_points(int zone, std::size_t n, bool welds) {
    std::vector<Point> points(n);
    int num_coordinates = 0;
    file_.check(cg_ncoords(fn(), kBase, zone, &num_coordinates), "the number of coordinates");
    std::vector<double> values(n);
    std::array<bool, 3> is_there{};
    for (int c = 1; c <= num_coordinates; ++c) {
      Name name{};
      DataType_t type = DataTypeNull;
      file_.check(cg_coord_info(fn(), kBase, zone, c, &type, name.data()), "a coordinate");
      const std::string_view known(name.data());
      const int axis = known == "CoordinateX" ? 0 : known == "CoordinateY" ? 1 : known == "CoordinateZ" ? 2 : -1;
      if (axis < 0) fail("zone " + zone_name_, fmt::format("coordinates '{}' are not read; export x, y, z", known));
      is_there[static_cast<std::size_t>(axis)] = true;
      const cgsize_t low = 1, high = static_cast<cgsize_t>(n);
      if (n == 0) continue;
      file_.check(cg_coord_read(fn(), kBase, zone, name.data(), RealDouble, &low, &high, values.data()),
                  "the coordinates");
      for (std::size_t i = 0; i < n; ++i) points[i][axis] = values[i];
    }
    for (int axis = 0; axis < (cell_dimension_ == 2 ? 2 : space_) && n > 0; ++axis)
      if (!is_there[static_cast<std::size_t>(axis)])
        fail("zone " + zone_name_, fmt::format("it has no Coordinate{}; the file is damaged", "XYZ"[axis]));
    std::vector<VertexId> vertices;
    const auto first_of_zone = mesh_.points.size();
    for (const Point& p : points) {
      if (welds)
        if (const auto found = welded_.find({p.x, p.y, p.z});
            found != welded_.end() && found->second.index() < first_of_zone) {
          vertices.push_back(found->second);
          continue;
        }
      vertices.push_back(mesh_.points.next_id());
      if (welds) welded_.try_emplace({p.x, p.y, p.z}, vertices.back());
      mesh_.points.push_back(p);
    }
    return vertices;
  }

  void read_sections(int zone, const std::vector<VertexId>& vertices) {
    int n = 0;
    file_.check(cg_nsections(fn(), kBase, zone, &n), "the number of sections");
    for (int section = 1; section <= n; ++section) {
      Name name{};
      ElementType_t type = ElementTypeNull;
      cgsize_t first = 0, last = 0, size = 0;
      int num_boundary = 0, has_parents = 0;
      file_.check(
          cg_section_read(fn(), kBase, zone, section, name.data(), &type, &first, &last, &num_boundary, &has_parents),
          "a section");
      const std::string where = fmt::format("zone {}, section {}", zone_name_, name.data());
      section_names_.emplace_back(name.data());
      region_of_section_.push_back("");
      if (cg_goto(fn(), kBase, "Zone_t", zone, "Elements_t", section, "end") == CG_OK)
        region_of_section_.back() = descriptor(kRegionMark);
      if (type != MIXED && !type_from_cgns(type))
        fail(where, fmt::format("elements of type {} are not read; export linear ones, no polyhedra",
                                cg_ElementTypeName(type)));
      file_.check(cg_ElementDataSize(fn(), kBase, zone, section, &size), where);
      if (first < 1 || last < first - 1 || size < 0 || static_cast<std::uint64_t>(size) > 1000 * file_size_)
        fail(where, fmt::format("elements {} to {} with {} numbers; the file is damaged", first, last, size));
      context_.check_limits();
      std::vector<cgsize_t> numbers(static_cast<std::size_t>(size));
      if (size > 0 && type != MIXED)
        file_.check(cg_elements_read(fn(), kBase, zone, section, numbers.data(), nullptr), where);
      else if (size > 0)
        file_.check(read_mixed(zone, section, name.data(), numbers), where);
      take_elements(where, type, first, last, numbers, vertices);
    }
  }

  /// Since 3.4 the library has a call of its own for them, with the offsets of the elements, which tell nothing more.
  int read_mixed(int zone, int section, const std::string& section_name, std::vector<cgsize_t>& numbers) const {
#if CGNS_VERSION >= 3400
    const std::uint64_t n = file_.num_values({base_name_, zone_name_, section_name, "ElementStartOffset"});
    std::vector<cgsize_t> offsets(std::max<std::size_t>(n, numbers.size() + 1));
    return cg_poly_elements_read(fn(), kBase, zone, section, numbers.data(), offsets.data(), nullptr);
#else
    return cg_elements_read(fn(), kBase, zone, section, numbers.data(), nullptr);
#endif
  }

  void take_elements(const std::string& where, ElementType_t section_type, cgsize_t first, cgsize_t last,
                     const std::vector<cgsize_t>& numbers, const std::vector<VertexId>& vertices) {
    std::size_t at = 0;
    for (cgsize_t element = first; element <= last; ++element) {
      ElementType_t type = section_type;
      if (type == MIXED) {
        if (at >= numbers.size()) fail(where, "it ends within its elements; the file is damaged");
        const cgsize_t number = numbers[at++];
        type = number > 0 && number < NofValidElementTypes ? static_cast<ElementType_t>(number) : ElementTypeNull;
      }
      const auto cell = type_from_cgns(type);
      if (!cell)
        fail(where, fmt::format("element {} is of type {}, which is not read; export linear ones, no polyhedra",
                                element, cg_ElementTypeName(type)));
      if (dimension(*cell) > cell_dimension_)
        fail(where,
             fmt::format("element {} is a {} in a base of dimension {}", element, name_of(*cell), cell_dimension_));
      const auto num = static_cast<std::size_t>(num_vertices(*cell));
      if (numbers.size() - at < num) fail(where, "it ends within its elements; the file is damaged");
      Element added;
      added.number = element;
      added.type = *cell;
      added.section = static_cast<std::uint32_t>(section_names_.size() - 1);
      for (std::size_t k = 0; k < num; ++k) {
        const cgsize_t v = numbers[at++];
        if (v < 1 || static_cast<std::size_t>(v) > vertices.size())
          fail(where, fmt::format("element {} has the vertex {}, and the zone has {}", element, v, vertices.size()));
        added.corners[k] = vertices[static_cast<std::size_t>(v - 1)];
      }
      elements_.push_back(added);
    }
    if (at != numbers.size())
      fail(where, fmt::format("{} numbers are left when its elements end; the file is damaged", numbers.size() - at));
  }

  /// By number; sections need not stand in that order.
  void sort_elements() {
    const auto is_before = [](const Element& a, const Element& b) { return a.number < b.number; };
    if (!std::is_sorted(elements_.begin(), elements_.end(), is_before))
      std::sort(elements_.begin(), elements_.end(), is_before);
    const auto twice = std::adjacent_find(elements_.begin(), elements_.end(),
                                          [](const Element& a, const Element& b) { return a.number == b.number; });
    if (twice != elements_.end()) fail("zone " + zone_name_, fmt::format("element {} is there twice", twice->number));
  }

  Element* find_element(cgsize_t number) {
    const auto found = std::lower_bound(elements_.begin(), elements_.end(), number,
                                        [](const Element& a, cgsize_t wanted) { return a.number < wanted; });
    return found != elements_.end() && found->number == number ? &*found : nullptr;
  }

  GroupId patch(const std::string& name, const std::string& kind) {
    return mesh_.add_group(cell_dimension_ - 1, name, kind);
  }

  void read_conditions(int zone, const std::vector<VertexId>& vertices) {
    int n = 0;
    file_.check(cg_nbocos(fn(), kBase, zone, &n), "the number of conditions");
    for (int number = 1; number <= n; ++number) {
      Name name{};
      BCType_t condition = BCTypeNull;
      PointSetType_t set = PointSetTypeNull;
      DataType_t normal_type = DataTypeNull;
      GridLocation_t location = Vertex;
      cgsize_t num_points = 0, num_normals = 0;
      int normal_index[3] = {0, 0, 0}, num_data = 0;
      file_.check(cg_boco_info(fn(), kBase, zone, number, name.data(), &condition, &set, &num_points, normal_index,
                               &num_normals, &normal_type, &num_data),
                  "a condition");
      file_.check(cg_boco_gridlocation_read(fn(), kBase, zone, number, &location), "the location of a condition");
      if (num_points < 0 || static_cast<std::uint64_t>(num_points) > 1000 * file_size_)
        fail(fmt::format("condition {}", name.data()), fmt::format("{} numbers; the file is damaged", num_points));
      std::uint64_t num_stored = 0;  // the library reads lists of elements as lists of points
      for (const char* const list : {"PointList", "PointRange", "ElementList", "ElementRange"})
        num_stored += file_.num_values({base_name_, zone_name_, "ZoneBC_t", name.data(), list});
      if (num_stored != static_cast<std::uint64_t>(num_points))
        fail(fmt::format("condition {}", name.data()),
             fmt::format("{} numbers where there should be {}; the file is damaged", num_stored, num_points));
      std::vector<cgsize_t> numbers(static_cast<std::size_t>(num_points));
      if (num_points > 0) file_.check(cg_boco_read(fn(), kBase, zone, number, numbers.data(), nullptr), "a condition");
      std::string group = name.data(), kind = kind_from_cgns(condition);
      if (cg_goto(fn(), kBase, "Zone_t", zone, "ZoneBC_t", 1, "BC_t", number, "end") == CG_OK) {
        Name family{};
        if (cg_famname_read(family.data()) == CG_OK) {
          group = family.data();
          const auto known = kind_of_family_.find(group);
          if (kind.empty() && known != kind_of_family_.end()) kind = known->second;
          if (const auto outer = outer_family_.find(group); outer != outer_family_.end()) group = outer->second;
        }
      }
      const bool is_range = set == PointRange || set == ElementRange;
      const bool on_vertices = location == Vertex && (set == PointRange || set == PointList);
      if (is_range && numbers.size() != 2)
        fail(fmt::format("condition {}", name.data()), fmt::format("a range of {} numbers", numbers.size()));
      const std::size_t num_taken = on_vertices ? take_vertices(numbers, is_range, vertices, patch(group, kind))
                                                : take_elements_of(numbers, is_range, group, kind);
      const std::size_t num_named = is_range || on_vertices ? std::min<std::size_t>(num_taken, 1) : numbers.size();
      if (num_taken == 0 || num_taken < num_named)
        context_.warn(fmt::format("{}: condition {}: {} of what it lists are faces or cells of the file", path_,
                                  name.data(), num_taken == 0 ? "none" : fmt::format("only {}", num_taken)));
    }
  }

  /// Faces become the patch; cells, which some programs give conditions too, the region of that name.
  /// @return how many
  std::size_t take_elements_of(const std::vector<cgsize_t>& numbers, bool is_range, const std::string& name,
                               const std::string& kind) {
    GroupId face_group, cell_group;
    std::size_t num_taken = 0;
    const auto take = [&](Element& element) {
      const int d = dimension(element.type);
      if (d < cell_dimension_ - 1) return;
      GroupId& group = d == cell_dimension_ ? cell_group : face_group;
      if (!group.is_valid()) group = d == cell_dimension_ ? mesh_.add_group(d, name) : patch(name, kind);
      num_shared_ += element.group.is_valid() && element.group != group;
      element.group = group;
      ++num_taken;
    };
    if (!is_range) {
      for (const cgsize_t number : numbers)
        if (Element* element = find_element(number)) take(*element);
    } else {
      for (Element& element : elements_)
        if (element.number >= numbers[0] && element.number <= numbers[1]) take(element);
    }
    return num_taken;
  }

  /// Faces with all corners among the vertices of the condition. @return how many
  std::size_t take_vertices(const std::vector<cgsize_t>& numbers, bool is_range, const std::vector<VertexId>& vertices,
                            GroupId group) {
    std::vector<bool> is_on(mesh_.points.size(), false);
    const auto take = [&](cgsize_t number) {
      if (number >= 1 && static_cast<std::size_t>(number) <= vertices.size())
        is_on[vertices[static_cast<std::size_t>(number - 1)].index()] = true;
    };
    if (!is_range)
      std::for_each(numbers.begin(), numbers.end(), take);
    else
      for (cgsize_t v = std::max<cgsize_t>(numbers[0], 1);
           v <= numbers[1] && static_cast<std::size_t>(v) <= vertices.size(); ++v)
        take(v);
    std::size_t num_taken = 0;
    for (Element& element : elements_) {
      if (dimension(element.type) != cell_dimension_ - 1 || element.group.is_valid()) continue;
      bool all = true;
      for (int k = 0; k < num_vertices(element.type); ++k)
        all = all && is_on[element.corners[static_cast<std::size_t>(k)].index()];
      if (!all) continue;
      element.group = group;
      ++num_taken;
    }
    return num_taken;
  }

  void add_cells(const std::string& zone_region) {
    const bool has_marks = std::any_of(region_of_section_.begin(), region_of_section_.end(),
                                       [](const std::string& s) { return !s.empty(); });
    // Each section's cells of the top dimension, and its faces, without a condition.
    std::vector<std::array<GroupId, 2>> group_of_section(section_names_.size());
    std::vector<std::array<bool, 2>> is_known(section_names_.size());
    for (const Element& element : elements_) {
      GroupId group = element.group;
      const int d = dimension(element.type);
      if (!group.is_valid() && d >= cell_dimension_ - 1) {
        const std::size_t is_face = d < cell_dimension_ ? 1 : 0;
        if (!is_known[element.section][is_face])
          group_of_section[element.section][is_face] = section_group(element.section, d, has_marks, zone_region);
        is_known[element.section][is_face] = true;
        group = group_of_section[element.section][is_face];
      }
      const std::span<const VertexId> corners(element.corners.data(),
                                              static_cast<std::size_t>(num_vertices(element.type)));
      add_cell(mesh_, element.type, corners, group);
    }
  }

  GroupId section_group(std::uint32_t section, int d, bool has_marks, const std::string& zone_region) {
    const std::string& noted = region_of_section_[section];
    if (!noted.empty()) return mesh_.add_group(d, noted, d < cell_dimension_ ? kind_of_family_[noted] : "");
    if (d < cell_dimension_)
      return section_names_[section].starts_with("Faces") ? GroupId() : patch(section_names_[section], "");
    return has_marks || zone_region.empty() ? GroupId() : mesh_.add_group(d, zone_region);
  }

  CgnsFile& file_;
  std::string path_, base_name_, zone_name_;
  std::uint64_t file_size_;
  Context& context_;
  Mesh mesh_;
  int cell_dimension_ = 3, space_ = 3;
  std::size_t num_shared_ = 0;                                        ///< elements that several conditions list
  std::map<std::string, std::string> kind_of_family_, outer_family_;  // Gmsh puts entities into families of families
  std::vector<Element> elements_;                                     // of the zone, by number
  std::vector<std::string> section_names_, region_of_section_;
  std::unordered_map<std::array<double, 3>, VertexId, PointHash> welded_;
};

}  // namespace

Mesh read_cgns(const std::string& path, Context& context) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error) throw InputError(fmt::format("cannot read {}: {}", path, error.message()));
  if (size == 0) throw InputError(fmt::format("{}: the file is empty; export it again", path));
  const Hdf5Turn turn;
  const LibraryReading reading(path, context);
  OlderVersion readable(path, context);
  CgnsFile file(readable.path(), CG_MODE_READ, path);
  readable.remove();
  return CgnsReader(file, path, size, context).read();
}

}  // namespace delfront
