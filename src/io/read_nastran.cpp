// SPDX-License-Identifier: Apache-2.0
// Nastran bulk data: GRID points and linear elements. A property is a patch or region; its name stands in the comments
// of HyperMesh ($HMNAME), ANSA ($ANSA_NAME, $ANSA_NAME_COMMENT), Femap and Patran, or in those of write_nastran
// ("$#delfront ..."). What else a deck says (materials, loads, …) is passed over.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/nastran_text.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 12;

struct Element {
  std::string_view name;
  CellType type;
};
constexpr Element kElements[] = {
    {"CTRIA3", CellType::triangle},  {"CTRIAR", CellType::triangle}, {"CQUAD4", CellType::quad},
    {"CQUADR", CellType::quad},      {"CSHEAR", CellType::quad},     {"CTETRA", CellType::tetrahedron},
    {"CPYRAM", CellType::pyramid},   {"CPYRA", CellType::pyramid},   {"CPENTA", CellType::prism},
    {"CHEXA", CellType::hexahedron}, {"CROD", CellType::line},       {"CBAR", CellType::line},
    {"CBEAM", CellType::line},       {"CTUBE", CellType::line},      {"PLOTEL", CellType::line}};
constexpr std::string_view kCurved[] = {"CTRIA6", "CQUAD8", "CQUAD9", "CTRIAX6", "CTRAX6"};

struct RawCell {
  CellType type;
  std::int64_t id, property;
  std::size_t first_vertex;
};

/// The text between double quotes.
std::string_view quoted(std::string_view text) {
  const std::size_t begin = text.find('"');
  const std::size_t end = begin == std::string_view::npos ? begin : text.find('"', begin + 1);
  return end == std::string_view::npos ? std::string_view() : text.substr(begin + 1, end - begin - 1);
}

std::int64_t leading_integer(std::string_view text) {
  text = trimmed(text);
  std::int64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Names of properties from the comments of a deck.
class Names {
 public:
  void take(std::string_view comment) {
    constexpr std::string_view kOwn = "$#delfront ", kHyperMesh = "$HMNAME ", kAnsa = "$ANSA_NAME;",
                               kAnsaComment = "$ANSA_NAME_COMMENT;";
    constexpr std::string_view kPatran = "$ Elements and Element Properties for region :", kFemap = "$ Femap ";
    if (awaited_ > 0) {
      set(awaited_, trimmed(comment.substr(1)));
      awaited_ = 0;
    }
    if (comment.starts_with(kOwn)) {
      NamedNumber named;
      if (parse_name_line(comment.substr(kOwn.size()), named)) own_[named.number] = named;
    } else if (comment.starts_with(kHyperMesh)) {
      take_hypermesh(comment.substr(kHyperMesh.size()));
    } else if (comment.starts_with(kAnsaComment)) {
      take_ansa(comment.substr(kAnsaComment.size()));
    } else if (comment.starts_with(kAnsa)) {  // the name stands in the next comment
      const std::string_view rest = comment.substr(kAnsa.size());
      if (const std::size_t type = rest.find(';');
          type != std::string_view::npos && rest.substr(type + 1).starts_with('P'))
        awaited_ = leading_integer(rest);
    } else if (comment.starts_with(kPatran)) {
      of_next_property_ = trimmed(comment.substr(kPatran.size()));
    } else if (comment.starts_with(kFemap)) {
      const std::size_t at = comment.find("Property "), colon = comment.find(" : ");
      if (at != std::string_view::npos && colon != std::string_view::npos && colon > at)
        set(leading_integer(comment.substr(at + 9)), trimmed(comment.substr(colon + 3)));
    }
  }

  void take_property(std::int64_t property) {
    if (!of_next_property_.empty()) set(property, of_next_property_);
    of_next_property_ = {};
  }

  const std::map<std::int64_t, NamedNumber>& own() const { return own_; }
  std::string of(std::int64_t property) const {
    const auto found = names_.find(property);
    return found == names_.end() ? "" : found->second;
  }

 private:
  void set(std::int64_t property, std::string_view name) {
    if (property > 0 && !name.empty()) names_[property] = std::string(name);
  }
  /// "COMP      5"wall" …" or "PROP      5"wall" …"; a property's own name goes before its component's.
  void take_hypermesh(std::string_view text) {
    const bool is_property = text.starts_with("PROP");
    if (!is_property && !text.starts_with("COMP")) return;
    const std::int64_t number = leading_integer(text.substr(4));
    if (is_property) is_property_[number] = true;
    if (is_property || !is_property_.contains(number)) set(number, quoted(text));
  }
  void take_ansa(std::string_view text) {
    const std::size_t type = text.find(';');
    const std::size_t name = type == std::string_view::npos ? type : text.find(';', type + 1);
    if (name == std::string_view::npos || !text.substr(type + 1).starts_with('P')) return;
    const std::string_view rest = text.substr(name + 1);
    set(leading_integer(text), trimmed(rest.substr(0, rest.find(';'))));
  }

  std::map<std::int64_t, std::string> names_;
  std::map<std::int64_t, NamedNumber> own_;
  std::map<std::int64_t, bool> is_property_;
  std::int64_t awaited_ = 0;
  std::string_view of_next_property_;
};

class NastranReader {
 public:
  NastranReader(std::string_view bytes, const std::string& path, Context& context)
      : text_(bytes, path), context_(context) {}

  Mesh read() {
    NastranEntry entry;
    std::vector<std::string_view> comments;
    for (std::size_t n = 0; text_.next(entry, comments); ++n) {
      if (n % kCheckEvery == 0) context_.check_limits();
      for (const std::string_view comment : comments) names_.take(comment);
      comments.clear();
      take(entry);
    }
    for (const std::string_view comment : comments) names_.take(comment);
    if (cells_.empty())
      throw InputError(fmt::format("{}: the bulk data has no elements (CTRIA3, CQUAD4, CTETRA, …)", text_.path()));
    finish();
    return std::move(mesh_);
  }

 private:
  void take(const NastranEntry& entry) {
    if (entry.name == "GRID") return read_point(entry);
    for (const Element& element : kElements)
      if (element.name == entry.name) return read_element(entry, element.type);
    for (const std::string_view curved : kCurved)
      if (curved == entry.name) fail_curved(entry);
    if (entry.name == "INCLUDE") text_.fail(entry, "INCLUDE is not followed; put the files together");
    if (entry.name == "PSHELL" || entry.name == "PSOLID" || entry.name == "PCOMP" || entry.name == "PROD")
      names_.take_property(text_.integer(entry, 0, "number of a property"));
  }

  [[noreturn]] void fail_curved(const NastranEntry& entry) const {
    text_.fail(entry, fmt::format("{} with nodes on its edges is not supported; export linear elements", entry.name));
  }

  void read_point(const NastranEntry& entry) {
    const std::int64_t id = text_.integer(entry, 0, "number of a point");
    if (entry.fields.size() > 1 && !entry.fields[1].empty() && text_.integer(entry, 1, "coordinate system") != 0)
      text_.fail(entry, fmt::format("GRID {} is in the coordinate system {}; export all points in the basic system", id,
                                    entry.fields[1]));
    if (!vertex_of_.try_emplace(id, static_cast<std::uint32_t>(mesh_.points.size())).second)
      text_.fail(entry, fmt::format("GRID {} is there twice; number the points anew", id));
    const double x = text_.real(entry, 2, "x of a point"), y = text_.real(entry, 3, "y of a point");
    mesh_.points.push_back({x, y, text_.real(entry, 4, "z of a point")});
  }

  void read_element(const NastranEntry& entry, CellType type) {
    const std::int64_t id = text_.integer(entry, 0, "number of an element");
    const bool has_property = entry.name != "PLOTEL";
    std::int64_t property = has_property ? id : 0;  // by default its own number
    if (has_property && !entry.fields[1].empty()) property = text_.integer(entry, 1, "property of an element");
    const std::size_t first = has_property ? 2 : 1;
    cells_.push_back({type, id, property, pool_.size()});
    const auto num = static_cast<std::size_t>(num_vertices(type));
    for (std::size_t k = 0; k < num; ++k) pool_.push_back(text_.integer(entry, first + k, "point of an element"));
    if (dimension(type) == 3)
      for (std::size_t k = first + num; k < entry.fields.size(); ++k)
        if (!entry.fields[k].empty() && !entry.fields[k].starts_with('+')) fail_curved(entry);
  }

  void finish() {
    check_finite(mesh_, text_.path());
    int top = 0;
    for (const RawCell& cell : cells_) top = std::max(top, dimension(cell.type));
    const bool is_flat = std::all_of(mesh_.points.begin(), mesh_.points.end(), [](const Point& p) { return p.z == 0; });
    if (top == 2 && is_flat) mesh_.dimension = 2;
    TagGroups groups(mesh_);
    for (const auto& [number, named] : names_.own()) {
      groups.name(named.dimension, number, named.name, named.kind);
      mesh_.groups[groups(named.dimension, number)].two_sided = named.two_sided;
    }
    std::vector<VertexId> corners;
    for (const RawCell& cell : cells_) {
      corners.clear();
      for (int k = 0; k < num_vertices(cell.type); ++k) {
        const std::int64_t id = pool_[cell.first_vertex + static_cast<std::size_t>(k)];
        const auto found = vertex_of_.find(id);
        if (found == vertex_of_.end())
          throw InputError(fmt::format("{}: element {} ({}) has the point {}, which the file does not hold",
                                       text_.path(), cell.id, name_of(cell.type), id));
        corners.push_back(VertexId(std::size_t{found->second}));
      }
      add_cell(mesh_, cell.type, corners, group_of_cell(groups, cell));
    }
    if (names_.own().empty()) mark_inner_groups(mesh_);
  }

  GroupId group_of_cell(TagGroups& groups, const RawCell& cell) {
    const int d = dimension(cell.type);
    if (!names_.own().empty()) {
      const auto found = names_.own().find(cell.property);
      return found != names_.own().end() && found->second.dimension == d ? groups(d, cell.property) : GroupId();
    }
    if (cell.property == 0) return GroupId();
    const std::size_t before = mesh_.groups.size();
    const GroupId group = groups(d, cell.property);
    if (mesh_.groups.size() == before) return group;
    const std::string name = names_.of(cell.property);
    if (!name.empty()) mesh_.groups[group].name = name;
    return group;
  }

  NastranText text_;
  Context& context_;
  Mesh mesh_;
  Names names_;
  std::vector<RawCell> cells_;
  std::vector<std::int64_t> pool_;
  std::unordered_map<std::int64_t, std::uint32_t> vertex_of_;
};

}  // namespace

Mesh read_nastran(std::string_view bytes, const std::string& path, Context& context) {
  return NastranReader(bytes, path, context).read();
}

}  // namespace delfront
