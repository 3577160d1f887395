// SPDX-License-Identifier: Apache-2.0
// Exodus II: element blocks are regions, or patches where their elements are faces of a grid in space; side sets are
// patches, named by their own names, else by their ids. What write_exodus noted says the kind where id and name agree.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/exodus/exodus.hpp"
#include "io/exodus/netcdf.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#ifdef DELFRONT_HAS_HDF5
#include "io/hdf5/hdf5_handle.hpp"
#include "io/hdf5/library_reading.hpp"
#endif

namespace delfront {

namespace {

constexpr std::uint64_t kMostParts = 1000000;  // blocks or sets
constexpr std::size_t kLongestName = 255;      // characters that write_exodus keeps of a name

class ExodusReader {
 public:
  ExodusReader(const NetcdfSource& file, const std::string& path, Context& context)
      : file_(file), path_(path), context_(context) {}

  Mesh read() {
    read_table();
    read_points();
    read_blocks();
    if (mesh_.top_dimension() < 0) throw InputError(fmt::format("{}: the Exodus file has no elements", path_));
    check_finite(mesh_, path_);
    if (!is_flat_) guess_dimension(mesh_);
    read_side_sets();
    set_sides();
    warn_of_table();
    return std::move(mesh_);
  }

 private:
  struct ElementPlace {
    CellType type = CellType::vertex;
    std::uint32_t cell = 0;
  };

  struct Noted {
    NamedNumber line;
    bool is_used = false;
  };

  [[noreturn]] void fail(const std::string& where, const std::string& message) const {
    throw InputError(fmt::format("{}: {}: {}", path_, where, message));
  }

  void read_table() {
    const std::string lines = file_.attribute("", kExodusGroups);
    Cursor text(lines, path_);
    while (!text.at_end()) {
      std::string_view line = text.rest_of_line();
      NamedNumber found;
      constexpr std::string_view kMark = "#delfront ";
      has_table_ = true;
      if (line.starts_with(kMark) && parse_name_line(line.substr(kMark.size()), found))
        table_[{found.dimension, found.number}] = {found, false};
      else if (!trimmed(line).empty())
        ++num_damaged_;
    }
  }

  void read_points() {
    std::vector<std::vector<double>> axes;
    if (file_.has("coord")) {
      const std::vector<double> all = file_.reals("coord");
      const std::vector<std::uint64_t> shape = file_.shape("coord");
      if (shape.size() != 2 || shape[0] < 1 || shape[0] > 3) fail("coord", "it should have one to three rows");
      const auto n = static_cast<std::ptrdiff_t>(shape[1]);
      for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(shape[0]); ++k)
        axes.emplace_back(all.begin() + k * n, all.begin() + (k + 1) * n);
    } else {
      axes = separate_axes();
    }
    if (axes.empty()) fail("coordx", "there are no coordinates: this is no Exodus file, or it is incomplete");
    for (const std::vector<double>& axis : axes)
      if (axis.size() != axes[0].size())
        fail("coordx", fmt::format("{} and {} coordinates of different axes", axes[0].size(), axis.size()));
    if (axes[0].size() >= Id<VertexTag>::kNone) fail("coordx", "more than 2^32 - 1 points are not supported");
    is_flat_ = axes.size() == 2;
    if (is_flat_) mesh_.dimension = 2;
    for (std::size_t i = 0; i < axes[0].size(); ++i) {
      Point p{0, 0, 0};
      for (std::size_t k = 0; k < axes.size(); ++k) p[static_cast<int>(k)] = axes[k][i];
      mesh_.points.push_back(p);
    }
  }

  /// @return none where no axis is there
  std::vector<std::vector<double>> separate_axes() const {
    constexpr std::array<const char*, 3> kNames = {"coordx", "coordy", "coordz"};
    std::size_t num_there = 0;  // up to the last that is there
    for (std::size_t k = 0; k < kNames.size(); ++k)
      if (file_.has(kNames[k])) num_there = k + 1;
    std::vector<std::vector<double>> axes;
    if (num_there == 0) return axes;
    const std::uint64_t said = file_.dimension("num_dim");
    if (said > kNames.size()) fail("num_dim", fmt::format("{} axes cannot be", said));
    const std::size_t n = said > 0 ? static_cast<std::size_t>(said) : num_there;
    for (std::size_t k = 0; k < n; ++k) {
      if (!file_.has(kNames[k])) fail(kNames[k], fmt::format("it is missing, and the grid has {} axes", n));
      axes.push_back(file_.reals(kNames[k]));
    }
    return axes;
  }

  /// @return 0 where there are none
  std::size_t number_of(const char* dimension) const {
    const std::uint64_t n = file_.dimension(dimension);
    if (n > kMostParts) fail(dimension, fmt::format("{} of them cannot be", n));
    return static_cast<std::size_t>(n);
  }

  /// Ids of blocks or sets; 1, 2, … where they are not said.
  std::vector<std::int64_t> ids(const std::string& variable, std::size_t n) const {
    std::vector<std::int64_t> found;
    if (file_.has(variable)) found = file_.integers(variable);
    for (std::size_t i = found.size(); i < n; ++i) found.push_back(static_cast<std::int64_t>(i) + 1);
    return found;
  }

  std::vector<std::string> names(const std::string& variable, std::size_t n) const {
    std::vector<std::string> found(n);
    if (!file_.has(variable)) return found;
    const std::vector<std::uint64_t> shape = file_.shape(variable);
    const std::string all = file_.text(variable);
    if (shape.size() != 2 || shape[0] != n) fail(variable, fmt::format("it should hold {} names", n));
    const auto width = static_cast<std::size_t>(shape[1]);
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view name = std::string_view(all).substr(i * width, width);
      found[i] = std::string(trimmed(name.substr(0, name.find('\0'))));
    }
    return found;
  }

  /// By the first letters, as Exodus's own programs take them.
  CellType type_of(const std::string& where, const std::string& said, std::uint64_t num_corners) const {
    struct Row {
      const char* letters;
      CellType type;
    };
    constexpr Row kRows[] = {{"hex", CellType::hexahedron}, {"tet", CellType::tetrahedron}, {"pyr", CellType::pyramid},
                             {"wed", CellType::prism},      {"tri", CellType::triangle},    {"qua", CellType::quad},
                             {"she", CellType::quad},       {"she", CellType::triangle},    {"bar", CellType::line},
                             {"bea", CellType::line},       {"tru", CellType::line},        {"rod", CellType::line},
                             {"edg", CellType::line},       {"sph", CellType::vertex},      {"cir", CellType::vertex},
                             {"poi", CellType::vertex}};
    for (const Row& row : kRows)
      if (starts_with_ignoring_case(said, row.letters) &&
          num_corners == static_cast<std::uint64_t>(num_vertices(row.type)))
        return row.type;
    fail(where,
         fmt::format("elements '{}' with {} nodes are not read; linear ones are", said.substr(0, 40), num_corners));
  }

  /// @param may_be  names that write_exodus gave to what it noted
  GroupId group(int d, std::int64_t id, const std::string& name, const std::vector<std::string>& may_be) {
    const auto noted = table_.find({d, id});
    const bool is_noted =
        noted != table_.end() && !name.empty() && std::any_of(may_be.begin(), may_be.end(), [&](const auto& candidate) {
          const std::string& full = noted->second.line.name;
          return candidate == full || (candidate.size() >= kLongestName && full.starts_with(candidate));
        });
    if (!is_noted) {
      is_all_noted_ = false;
      return mesh_.add_group(d, name.empty() ? fmt::format("{}_{}", role_name(mesh_, d), id) : name);
    }
    noted->second.is_used = true;
    const GroupId found = mesh_.add_group(d, noted->second.line.name, noted->second.line.kind);
    noted_sides_.emplace_back(found, noted->second.line.two_sided);
    return found;
  }

  /// The blocks of one region are called "air", "air_prism", …; those of none "cells_prism" or "faces_quad"; with "_2"
  /// and so on behind it where that was taken.
  GroupId group_of_block(CellType type, std::int64_t id, const std::string& name) {
    std::vector<std::string> may_be = {name};
    if (const std::size_t end = name.find_last_not_of("0123456789"); end + 1 < name.size() && name[end] == '_')
      may_be.push_back(name.substr(0, end));
    const std::string suffix = fmt::format("_{}", name_of(type));
    for (std::size_t i = may_be.size(); i-- > 0;) {
      if (!may_be[i].ends_with(suffix)) continue;
      may_be.push_back(may_be[i].substr(0, may_be[i].size() - suffix.size()));
      const bool is_of_none = may_be.back() == "cells" || may_be.back() == "faces";
      if (has_table_ && is_of_none && !table_.contains({dimension(type), id})) return GroupId();
    }
    return group(dimension(type), id, name, may_be);
  }

  /// What the table does not say of patches, the cells do.
  void set_sides() {
    if (!is_all_noted_) mark_inner_groups(mesh_);
    for (const auto& [group, two_sided] : noted_sides_) mesh_.groups[group].two_sided = two_sided;
  }

  void warn_of_table() const {
    if (num_damaged_ > 0)
      context_.warn(fmt::format("{}: {} line{} of the attribute {} cannot be read: the kinds they note are left out",
                                path_, num_damaged_, num_damaged_ == 1 ? "" : "s", kExodusGroups));
    const NamedNumber* first = nullptr;
    std::size_t num_unused = 0;
    for (const auto& [key, noted] : table_)
      if (!noted.is_used && num_unused++ == 0) first = &noted.line;
    if (first)
      context_.warn(
          fmt::format("{}: the attribute {} notes {} groups (the first: \"{}\") that no block or side set has by that "
                      "id and name: their kinds are left out",
                      path_, kExodusGroups, num_unused, first->name));
  }

  void read_blocks() {
    const std::size_t n = number_of("num_el_blk");
    const std::vector<std::int64_t> block_ids = ids("eb_prop1", n);
    const std::vector<std::string> block_names = names("eb_names", n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::string variable = fmt::format("connect{}", i + 1);
      if (!file_.has(variable)) continue;  // an empty block
      context_.check_limits();
      const std::vector<std::uint64_t> shape = file_.shape(variable);
      if (shape.size() != 2)
        fail(variable, "elements with any number of nodes (polyhedra, polygons) are not read; save linear cells");
      const CellType type = type_of(variable, file_.attribute(variable, "elem_type"), shape[1]);
      const std::vector<std::int64_t> corners = file_.integers(variable);
      add_block(variable, type, corners, group_of_block(type, block_ids[i], block_names[i]));
    }
  }

  void add_block(const std::string& variable, CellType type, std::span<const std::int64_t> corners, GroupId group) {
    const auto width = static_cast<std::size_t>(num_vertices(type));
    const auto num_points = static_cast<std::int64_t>(mesh_.points.size());
    std::vector<VertexId> vertices(width);
    for (std::size_t i = 0; i + width <= corners.size(); i += width) {
      for (std::size_t k = 0; k < width; ++k) {
        if (corners[i + k] < 1 || corners[i + k] > num_points)
          fail(variable,
               fmt::format("element {} has the node {}, and there are {}", i / width + 1, corners[i + k], num_points));
        vertices[k] = VertexId(static_cast<std::size_t>(corners[i + k] - 1));
      }
      elements_.push_back({type, static_cast<std::uint32_t>(mesh_.num_cells(type))});
      add_cell(mesh_, type, vertices, group);
    }
  }

  void read_side_sets() {
    const std::size_t n = number_of("num_side_sets");
    const std::vector<std::int64_t> set_ids = ids("ss_prop1", n);
    const std::vector<std::string> set_names = names("ss_names", n);
    top_ = mesh_.top_dimension();
    if (n > 0) note_stored_faces();
    for (std::size_t i = 0; i < n; ++i) {
      context_.check_limits();
      const bool has_none = has_table_ && set_names[i] == kExodusNoPatch;
      const GroupId set = has_none ? GroupId() : group(top_ - 1, set_ids[i], set_names[i], {set_names[i]});
      const std::string elements = fmt::format("elem_ss{}", i + 1), sides = fmt::format("side_ss{}", i + 1);
      if (!file_.has(elements) || !file_.has(sides)) continue;  // an empty set
      add_set(elements, file_.integers(elements), file_.integers(sides), set);
    }
    if (num_repeated_ > 0)
      context_.warn(fmt::format("{}: {} faces are in several side sets: each goes to the first", path_, num_repeated_));
  }

  void note_stored_faces() {
    for (const CellBlock& block : mesh_.blocks)
      for (std::size_t cell = 0; dimension(block.type) == top_ - 1 && cell < block.size(); ++cell)
        stored_.try_emplace(facet_key(block[cell]), ElementPlace{block.type, static_cast<std::uint32_t>(cell)});
  }

  void add_set(const std::string& where, const std::vector<std::int64_t>& elements,
               const std::vector<std::int64_t>& sides, GroupId set) {
    if (elements.size() != sides.size())
      fail(where, fmt::format("{} elements and {} sides", elements.size(), sides.size()));
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (elements[i] < 1 || elements[i] > static_cast<std::int64_t>(elements_.size()))
        fail(where, fmt::format("side {} is of element {}, and there are {}", i + 1, elements[i], elements_.size()));
      const ElementPlace element = elements_[static_cast<std::size_t>(elements[i] - 1)];
      const int d = dimension(element.type);
      const std::int64_t num_faces = d == 2 && !is_flat_ ? 2 : 0;  // of a surface in space
      const auto all = exodus_sides(element.type);
      if (sides[i] < 1 || sides[i] > num_faces + static_cast<std::int64_t>(all.size()))
        fail(where, fmt::format("side {} is number {} of a {}", i + 1, sides[i], name_of(element.type)));
      if (sides[i] <= num_faces) {
        if (d == top_ - 1) mesh_.block(element.type).group[element.cell] = set;
      } else if (d == top_) {
        add_side(element, all[static_cast<std::size_t>(sides[i] - 1 - num_faces)], set);
      }
    }
  }

  void add_side(ElementPlace element, const std::array<int, 4>& local, GroupId set) {
    const CellBlock& block = mesh_.block(element.type);
    std::array<VertexId, 4> all;
    std::size_t n = 0;
    for (const int k : local)
      if (k >= 0) all[n++] = block[element.cell][static_cast<std::size_t>(k)];
    const std::span<const VertexId> corners(all.data(), n);
    const CellType type = n == 2 ? CellType::line : n == 3 ? CellType::triangle : CellType::quad;
    const ElementPlace next{type, static_cast<std::uint32_t>(mesh_.num_cells(type))};
    const auto [known, is_new] = stored_.try_emplace(facet_key(corners), next);
    if (is_new) return add_cell(mesh_, type, corners, set);
    GroupId& old = mesh_.block(known->second.type).group[known->second.cell];
    if (known->second.cell >= num_given(known->second.type)) {
      num_repeated_ += old == set ? 0 : 1;
      return;
    }
    old = set;
  }

  /// Cells of that type that the blocks gave; a side set says more of those than their block.
  std::uint32_t num_given(CellType type) {
    if (given_.empty()) {
      given_.assign(kNumCellTypes, 0);
      for (const ElementPlace& element : elements_) ++given_[static_cast<std::size_t>(element.type)];
    }
    return given_[static_cast<std::size_t>(type)];
  }

  const NetcdfSource& file_;
  std::string path_;
  Context& context_;
  Mesh mesh_;
  bool is_flat_ = false;
  int top_ = 3;
  bool has_table_ = false;
  std::map<std::pair<int, std::int64_t>, Noted> table_;
  std::size_t num_damaged_ = 0;                        // lines of the table
  std::vector<std::pair<GroupId, bool>> noted_sides_;  // two-sided or not, as the table has it
  bool is_all_noted_ = true;
  std::vector<ElementPlace> elements_;  // by their number - 1
  std::unordered_map<FacetKey, ElementPlace, FacetKeyHash> stored_;
  std::vector<std::uint32_t> given_;
  std::size_t num_repeated_ = 0;
};

}  // namespace

Mesh read_exodus(std::string_view bytes, const std::string& path, Context& context) {
  if (bytes.starts_with("CDF")) return ExodusReader(*open_netcdf_classic(bytes, path), path, context).read();
#ifdef DELFRONT_HAS_HDF5
  if (bytes.starts_with("\x89HDF")) {
    const Hdf5Turn turn;
    const LibraryReading reading(path, context);
    return ExodusReader(*open_netcdf4(path), path, context).read();
  }
  throw InputError(fmt::format("{}: this is no netCDF file, so it is no Exodus", path));
#else
  throw InputError(
      fmt::format("{}: this is no classic netCDF file, and this build has no HDF5 (Debian: libhdf5-dev) for "
                  "netCDF-4; nccopy -k classic changes the file",
                  path));
#endif
}

}  // namespace delfront
