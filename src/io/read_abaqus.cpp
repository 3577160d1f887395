// SPDX-License-Identifier: Apache-2.0
// Abaqus (and CalculiX) input: *NODE, *ELEMENT, *ELSET, *SURFACE of flat parts. Element sets are regions (patches,
// where their elements are shells), surfaces made of faces of cells are patches (of sides, in the plane). A set named
// by *ELSET goes before the one that *ELEMENT names, since programs name their parts so; of several *ELSETs the first.
// Node sets say nothing that a grid has a place for. Kinds stand in comments of write_abaqus ("**#delfront …").
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/abaqus.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 12;
constexpr std::uint32_t kNone = 0xffffffffu;

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

/// "C3D8R" -> hexahedron; nullopt where the name is no linear element that is known.
std::optional<CellType> cell_type(std::string_view name) {
  const std::string text = upper(name);
  std::string_view rest = text;
  const auto is_line = [&] {
    for (const char* line : {"T2D2", "T3D2", "B21", "B31", "R2D2", "RB2D2", "RB3D2", "DC1D2", "SAX1", "RAX2"})
      if (rest.starts_with(line)) return true;
    return false;
  };
  if (is_line()) return CellType::line;
  struct Family {
    const char* name;
    int dimension;
  };
  constexpr Family kFamilies[] = {{"DC3D", 3}, {"AC3D", 3}, {"FC3D", 3}, {"C3D", 3},  {"F3D", 3},   {"SC", 3},
                                  {"CPS", 2},  {"CPE", 2},  {"CPEG", 2}, {"CAX", 2},  {"CGAX", 2},  {"DC2D", 2},
                                  {"DCAX", 2}, {"AC2D", 2}, {"ACAX", 2}, {"STRI", 2}, {"SFM3D", 2}, {"M3D", 2},
                                  {"R3D", 2},  {"DS", 2},   {"S", 2},    {"F2D", 2}};
  for (const Family& family : kFamilies) {
    if (!rest.starts_with(family.name)) continue;
    const std::string_view number = rest.substr(std::string_view(family.name).size());
    int n = 0;
    const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), n);
    if (error != std::errc()) continue;
    if (family.dimension == 2)
      return n == 3 ? std::optional(CellType::triangle) : n == 4 ? std::optional(CellType::quad) : std::nullopt;
    switch (n) {
      case 4:
        return CellType::tetrahedron;
      case 5:
        return CellType::pyramid;
      case 6:
        return CellType::prism;
      case 8:
        return CellType::hexahedron;
      default:
        return std::nullopt;
    }
  }
  return std::nullopt;
}

struct RawCell {
  CellType type;
  std::int64_t id;
  std::size_t first_vertex;
  std::uint32_t set = kNone;  // of *ELEMENT
  std::uint32_t elset = kNone;
};

/// One line of *SURFACE: an element or a set, and which face.
struct RawFace {
  std::uint32_t surface;
  std::string_view element;
  int face;
  std::size_t position;
};

struct Keyword {
  std::string name;
  std::map<std::string, std::string_view> parameters;
  std::string_view operator[](const char* key) const {
    const auto found = parameters.find(key);
    return found == parameters.end() ? std::string_view() : found->second;
  }
};

class AbaqusReader {
 public:
  AbaqusReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path), context_(context) {}

  Mesh read() {
    for (std::size_t n = 0; next_line(); ++n) {
      if (n % kCheckEvery == 0) context_.check_limits();
      if (!line_.starts_with('*')) {
        take_data();
      } else if (!line_.starts_with("**")) {
        begin_keyword();
      } else if (NamedNumber named; line_.starts_with("**#delfront ") && parse_name_line(line_.substr(12), named)) {
        own_.push_back(named);
      }
    }
    end_keyword();
    if (cells_.empty()) fail("the file has no elements (*ELEMENT)");
    finish();
    return std::move(mesh_);
  }

 private:
  bool next_line() {
    if (cursor_.position() >= cursor_.bytes().size()) return false;
    position_ = cursor_.position();
    line_ = cursor_.rest_of_line();
    return true;
  }
  [[noreturn]] void fail(const std::string& message) const { cursor_.fail_at(position_, message); }

  static Keyword parse_keyword(std::string_view line) {
    Keyword keyword;
    for (bool is_first = true; !line.empty(); is_first = false) {
      const std::size_t comma = std::min(line.find(','), line.size());
      const std::string_view part = line.substr(0, comma);
      const std::size_t equals = part.find('=');
      const std::string key = upper(trimmed(part.substr(0, equals)));
      std::string_view value = equals == std::string_view::npos ? std::string_view() : trimmed(part.substr(equals + 1));
      if (value.size() > 1 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
      if (is_first)
        keyword.name = key;
      else
        keyword.parameters[key] = value;
      line.remove_prefix(std::min(comma + 1, line.size()));
    }
    return keyword;
  }

  void begin_keyword() {
    end_keyword();
    keyword_ = parse_keyword(line_);
    current_ = kNone;
    if (keyword_.name == "*ELEMENT") {
      const auto type = cell_type(keyword_["TYPE"]);
      if (!type)
        fail(fmt::format(
            "elements of type '{}' are not supported; export linear solids or shells (C3D4, C3D8, S3, S4, …)",
            keyword_["TYPE"].substr(0, 40)));
      type_ = *type;
      if (!keyword_["ELSET"].empty()) current_ = set_number(sets_, keyword_["ELSET"]);
    } else if (keyword_.name == "*ELSET") {
      if (keyword_["ELSET"].empty()) fail("*ELSET without a name (ELSET=)");
      current_ = set_number(sets_, keyword_["ELSET"]);
      is_generated_ = keyword_.parameters.contains("GENERATE");
    } else if (keyword_.name == "*SURFACE") {
      const std::string type = upper(keyword_["TYPE"]);
      if (type.empty() || type == "ELEMENT") current_ = set_number(surfaces_, keyword_["NAME"]);
    } else if (keyword_.name == "*NSET") {
      ++num_node_sets_;
    } else if (keyword_.name == "*INCLUDE") {
      fail("*INCLUDE is not followed; put the files together");
    }
  }

  struct NameTable {
    std::vector<std::string> names;
    std::unordered_map<std::string, std::uint32_t> numbers;
  };
  /// Names are the same whatever the case of their letters.
  static std::uint32_t set_number(NameTable& table, std::string_view name) {
    const auto [it, is_new] = table.numbers.try_emplace(upper(name), static_cast<std::uint32_t>(table.names.size()));
    if (is_new) table.names.emplace_back(name);
    return it->second;
  }

  /// The numbers of an element may take several lines.
  void end_keyword() {
    if (keyword_.name == "*ELEMENT" && !numbers_.empty())
      fail(fmt::format("element {} has {} nodes, a {} needs {}", numbers_[0], numbers_.size() - 1, name_of(type_),
                       num_vertices(type_)));
    numbers_.clear();
  }

  void take_data() {
    if (line_.empty()) return;
    if (keyword_.name == "*NODE") return take_node();
    if (keyword_.name == "*ELEMENT") return take_element();
    if (keyword_.name == "*ELSET") return take_elset();
    if (keyword_.name == "*SURFACE" && current_ != kNone) return take_surface();
  }

  std::string_view take_item(std::string_view& rest) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view item = trimmed(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    return item;
  }

  static std::optional<std::int64_t> parse_integer(std::string_view item) {
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(item.data(), item.data() + item.size(), value);
    if (item.empty() || error != std::errc() || stop != item.data() + item.size()) return std::nullopt;
    return value;
  }
  std::int64_t integer(std::string_view item, const char* what) const {
    if (const auto value = parse_integer(item)) return *value;
    fail(fmt::format("'{}' should be a whole number ({})", item.substr(0, 40), what));
  }

  void take_node() {
    std::string_view rest = line_;
    const std::int64_t id = integer(take_item(rest), "number of a node");
    Point p;
    for (int k = 0; k < 3 && !rest.empty(); ++k) {
      const std::string_view item = take_item(rest);
      if (!item.empty() && !parse_number(item, p[k]))
        fail(fmt::format("'{}' should be a number (coordinate of node {})", item.substr(0, 40), id));
    }
    if (!vertex_of_.try_emplace(id, static_cast<std::uint32_t>(mesh_.points.size())).second)
      fail(fmt::format("node {} is there twice; write the parts of an assembly as one flat part", id));
    mesh_.points.push_back(p);
  }

  void take_element() {
    std::string_view rest = line_;
    while (!rest.empty()) {
      const std::string_view item = take_item(rest);
      if (!item.empty()) numbers_.push_back(integer(item, "node of an element"));
    }
    const auto num = static_cast<std::size_t>(num_vertices(type_));
    if (numbers_.size() < num + 1) return;  // goes on in the next line
    if (numbers_.size() > num + 1)
      fail(
          fmt::format("element {} has {} nodes, a {} needs {}", numbers_[0], numbers_.size() - 1, name_of(type_), num));
    if (!cell_of_.try_emplace(numbers_[0], static_cast<std::uint32_t>(cells_.size())).second)
      fail(fmt::format("element {} is there twice; write the parts of an assembly as one flat part", numbers_[0]));
    cells_.push_back({type_, numbers_[0], pool_.size(), current_, kNone});
    pool_.insert(pool_.end(), numbers_.begin() + 1, numbers_.end());
    numbers_.clear();
  }

  void take_elset() {
    std::string_view rest = line_;
    if (is_generated_) {
      const std::int64_t first = integer(take_item(rest), "first element"),
                         last = integer(take_item(rest), "last element");
      const std::int64_t step = rest.empty() ? 1 : integer(take_item(rest), "step");
      if (step < 1 || last < first) fail(fmt::format("elements {} to {} by {}", first, last, step));
      return ranges_.push_back({current_, first, last, step});
    }
    while (!rest.empty()) {
      const std::string_view item = take_item(rest);
      if (item.empty()) continue;
      if (const auto id = parse_integer(item))
        ranges_.push_back({current_, *id, *id, 1});
      else
        nested_.push_back({current_, set_number(sets_, item)});
    }
  }

  void take_surface() {
    std::string_view rest = line_;
    const std::string_view element = take_item(rest), face = take_item(rest);
    if (face.size() < 2 || upper(face.substr(0, 1)) != "S")
      return;  // SPOS, SNEG, END…: of shells, which are patches anyway
    if (const auto number = parse_integer(face.substr(1)))
      faces_.push_back({current_, element, static_cast<int>(std::clamp<std::int64_t>(*number, 0, 99)), position_});
  }

  struct Range {
    std::uint32_t set;
    std::int64_t first, last, step;
  };

  void mark(std::uint32_t cell, std::uint32_t set) {
    if (cells_[cell].elset == kNone) cells_[cell].elset = set;
  }

  /// Calls `take(cell)` for the elements that there are of a range of numbers.
  template <class Take>
  void for_each_cell(const Range& range, const Take& take) {
    if (range.first == range.last) {
      if (const auto found = cell_of_.find(range.first); found != cell_of_.end()) take(found->second);
      return;
    }
    auto at = std::lower_bound(sorted_.begin(), sorted_.end(), range.first,
                               [&](std::uint32_t cell, std::int64_t id) { return cells_[cell].id < id; });
    for (; at != sorted_.end() && cells_[*at].id <= range.last; ++at) {
      if (++num_named_ > 1000 * (cells_.size() + ranges_.size())) fail("the element sets name elements over and over");
      if ((cells_[*at].id - range.first) % range.step == 0) take(*at);
    }
  }

  /// *ELSET names elements by number, or other sets.
  void apply_sets() {
    sorted_.resize(cells_.size());
    for (std::uint32_t i = 0; i < sorted_.size(); ++i) sorted_[i] = i;
    std::sort(sorted_.begin(), sorted_.end(), [&](auto a, auto b) { return cells_[a].id < cells_[b].id; });
    for (const Range& range : ranges_)
      if (upper(sets_.names[range.set]) != "EALL")
        for_each_cell(range, [&](std::uint32_t cell) { mark(cell, range.set); });
    std::map<std::uint32_t, std::uint32_t> outer;  // set -> the first that names it
    for (const auto& [set, inner] : nested_)
      if (upper(sets_.names[set]) != "EALL") outer.try_emplace(inner, set);
    for (RawCell& cell : cells_)
      if (const auto found = outer.find(cell.set); cell.elset == kNone && found != outer.end())
        cell.elset = found->second;
  }

  void set_dimension() {
    int top = 0;
    for (const RawCell& cell : cells_) top = std::max(top, dimension(cell.type));
    const bool is_flat = std::all_of(mesh_.points.begin(), mesh_.points.end(), [](const Point& p) { return p.z == 0; });
    if (top == 2 && is_flat) mesh_.dimension = 2;
  }

  std::array<VertexId, 8> corners_of(const RawCell& cell) const {
    std::array<VertexId, 8> corners;
    for (int k = 0; k < num_vertices(cell.type); ++k) {
      const std::int64_t id = pool_[cell.first_vertex + static_cast<std::size_t>(k)];
      const auto found = vertex_of_.find(id);
      if (found == vertex_of_.end())
        throw InputError(fmt::format("{}: element {} ({}) has the node {}, which the file does not hold",
                                     cursor_.path(), cell.id, name_of(cell.type), id));
      corners[static_cast<std::size_t>(k)] = VertexId(std::size_t{found->second});
    }
    return corners;
  }

  void finish() {
    check_finite(mesh_, cursor_.path());
    set_dimension();
    apply_sets();
    for (const NamedNumber& named : own_)
      mesh_.groups[mesh_.add_group(named.dimension, named.name, named.kind)].two_sided = named.two_sided;
    std::map<std::pair<int, std::uint32_t>, GroupId> groups;
    for (const RawCell& cell : cells_) {
      const std::array<VertexId, 8> corners = corners_of(cell);
      const std::uint32_t set = cell.elset != kNone ? cell.elset : cell.set;
      GroupId group;
      if (set != kNone) {
        const auto [it, is_new] = groups.try_emplace({dimension(cell.type), set});
        if (is_new) it->second = group_named(dimension(cell.type), sets_.names[set]);
        group = it->second;
      }
      add_cell(mesh_, cell.type, std::span(corners).first(static_cast<std::size_t>(num_vertices(cell.type))), group);
    }
    add_surfaces();
    if (own_.empty()) mark_inner_groups(mesh_);
    if (num_node_sets_ > 0 && faces_.empty() && mesh_.num_cells_of_dimension(mesh_.dimension - 1) == 0)
      context_.warn(fmt::format("{}: its {} node sets are not read, and it has no surfaces: the grid has no patches",
                                cursor_.path(), num_node_sets_));
  }

  /// Sets that write_abaqus makes of cells without a group are none.
  GroupId group_named(int d, const std::string& name) {
    if (!own_.empty() && upper(name).starts_with("DELFRONT_UNNAMED")) return GroupId();
    return mesh_.add_group(d, name);
  }

  void add_surfaces() {
    std::vector<std::vector<std::uint32_t>> cells_of_set;
    std::map<std::uint32_t, GroupId> groups;
    std::size_t total = 0;
    for (const RawFace& face : faces_) {
      std::vector<std::uint32_t> cells;
      position_ = face.position;
      if (const auto id = parse_integer(face.element)) {
        const auto found = cell_of_.find(*id);
        if (found == cell_of_.end())
          fail(fmt::format("a surface has the element {}, which the file does not hold", *id));
        cells.push_back(found->second);
      } else {
        if (cells_of_set.empty()) cells_of_set = list_sets();
        const auto found = sets_.numbers.find(upper(face.element));
        if (found == sets_.numbers.end())
          fail(fmt::format("a surface has the set '{}', which the file does not hold", face.element.substr(0, 80)));
        cells = cells_of_set[found->second];
      }
      total += cells.size();  // each line may name a large set again: no more memory than the file is worth
      if (total > 64 * (cells_.size() + faces_.size())) fail("surfaces have more faces than the elements of the file");
      const auto [it, is_new] = groups.try_emplace(face.surface);
      if (is_new) it->second = group_named(mesh_.dimension - 1, surfaces_.names[face.surface]);
      for (const std::uint32_t cell : cells) add_surface_face(cells_[cell], face.face, it->second);
    }
  }

  /// Turned, since the manual's faces look inwards; sides in the plane run with the cell.
  void add_surface_face(const RawCell& cell, int number, GroupId group) {
    const auto faces = abaqus_faces(cell.type);
    if (dimension(cell.type) != mesh_.dimension) return;
    if (number < 1 || number > static_cast<int>(faces.size()))
      fail(fmt::format("face S{} of element {}, a {}", number, cell.id, name_of(cell.type)));
    const std::array<VertexId, 8> corners = corners_of(cell);
    std::vector<VertexId> face;
    for (const int k : faces[static_cast<std::size_t>(number - 1)])
      if (k >= 0) face.push_back(corners[static_cast<std::size_t>(k)]);
    if (face.size() == 2) return add_cell(mesh_, CellType::line, face, group);
    std::reverse(face.begin() + 1, face.end());
    add_face(mesh_, face, group);
  }

  /// The cells that *ELEMENT or *ELSET put into each set.
  std::vector<std::vector<std::uint32_t>> list_sets() {
    std::vector<std::vector<std::uint32_t>> cells(sets_.names.size());
    for (std::uint32_t i = 0; i < cells_.size(); ++i)
      if (cells_[i].set != kNone) cells[cells_[i].set].push_back(i);
    std::size_t total = 0;
    for (const Range& range : ranges_)
      for_each_cell(range, [&](std::uint32_t cell) {
        if (++total > 64 * (cells_.size() + ranges_.size())) fail("the element sets name elements over and over");
        cells[range.set].push_back(cell);
      });
    return cells;
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  std::string_view line_;
  std::size_t position_ = 0;
  Keyword keyword_;
  CellType type_ = CellType::tetrahedron;
  std::uint32_t current_ = kNone;
  bool is_generated_ = false;
  std::vector<std::int64_t> numbers_, pool_;
  std::vector<RawCell> cells_;
  std::vector<RawFace> faces_;
  std::vector<Range> ranges_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> nested_;
  std::vector<NamedNumber> own_;
  std::vector<std::uint32_t> sorted_;  // cells by number
  std::size_t num_named_ = 0, num_node_sets_ = 0;
  NameTable sets_, surfaces_;
  std::unordered_map<std::int64_t, std::uint32_t> vertex_of_, cell_of_;
};

}  // namespace

Mesh read_abaqus(std::string_view bytes, const std::string& path, Context& context) {
  return AbaqusReader(bytes, path, context).read();
}

}  // namespace delfront
