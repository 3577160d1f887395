// SPDX-License-Identifier: Apache-2.0
// Gmsh MSH 2.x and 4.1, ASCII and binary. Physical groups become groups by (dimension, tag); where a dimension has no
// physical groups at all, its entities do. Cells are put in the order of their tags, which is how write_msh keeps the
// order of a mesh although the format sorts cells by entity.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/grid_parts.hpp"
#include "io/msh_types.hpp"
#include "io/node_means.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

/// A cell as read: vertices in a pool, tags still the file's.
struct RawCell {
  std::int64_t tag;
  std::size_t first_vertex;
  std::int32_t physical, entity;
  CellType type;
};

class MshReader {
 public:
  MshReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path), context_(context) {}

  Mesh read() {
    read_format();
    for (std::string_view word = cursor_.next(); !word.empty(); word = cursor_.next()) {
      if (!word.starts_with('$'))
        cursor_.fail(fmt::format("'{}' where a section ($Name) should begin", word.substr(0, 40)));
      read_section(std::string(word.substr(1)));
    }
    if (cells_.empty()) throw InputError(fmt::format("{}: the MSH file has no elements", cursor_.path()));
    finish();
    return std::move(mesh_);
  }

 private:
  void read_format() {
    if (cursor_.next() != "$MeshFormat") cursor_.fail("an MSH file begins with $MeshFormat");
    const double version = cursor_.number("version");
    is_text_ = cursor_.integer("file type") == 0;
    const std::int64_t data_size = cursor_.integer("data size");
    is_v4_ = version >= 4.1 && version < 5;
    if (!is_v4_ && !(version >= 2 && version < 3))
      cursor_.fail(fmt::format("MSH {} is not read; save it as MSH 4.1 or 2.2 (gmsh -format msh41)", version));
    if (data_size != 8) cursor_.fail(fmt::format("data size {} is not 8", data_size));
    cursor_.skip_line();
    if (!is_text_) {
      const auto one = cursor_.binary<std::int32_t>("the byte order mark");
      cursor_.swap_bytes = one != 1;
      if (one != 1 && Cursor::swapped(one) != 1)
        cursor_.fail_in_binary("the byte order mark is not 1; the file is damaged");
    }
    end_section("MeshFormat");
  }

  void read_section(const std::string& name) {
    if (name == "PhysicalNames") {
      read_physical_names();
    } else if (name == "Entities" && is_v4_) {
      cursor_.skip_line();
      read_entities();
    } else if (name == "Nodes") {
      cursor_.skip_line();
      is_v4_ ? read_nodes4() : read_nodes2();
    } else if (name == "Elements") {
      cursor_.skip_line();
      is_v4_ ? read_elements4() : read_elements2();
    } else if (name == "NodeData" || name == "ElementNodeData") {
      read_data(name == "NodeData");
    } else {
      skip_section(name);
      return;
    }
    end_section(name);
  }

  /// Values as read: each entry is a node with one value, or an element with one a corner; tags are the file's.
  struct Data {
    std::string name;
    double time = 0;
    int components = 1;
    bool is_on_nodes = true;
    std::vector<std::int64_t> tags;
    std::vector<std::uint32_t> corners;
    std::vector<double> values;
  };

  /// $NodeData and $ElementNodeData: string, real and integer tags as text, then the entries.
  void read_data(bool is_on_nodes) {
    Data data;
    data.is_on_nodes = is_on_nodes;
    const std::size_t num_names = cursor_.count("number of string tags", 2);
    cursor_.skip_line();
    for (std::size_t i = 0; i < num_names; ++i) {
      std::string_view name = cursor_.rest_of_line();
      if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
      if (i == 0) data.name = name;
    }
    const std::size_t num_reals = cursor_.count("number of real tags", 2);
    for (std::size_t i = 0; i < num_reals; ++i) {
      const double value = cursor_.number("real tag");
      if (i == 0) data.time = value;
    }
    const std::size_t num_integers = cursor_.count("number of integer tags", 2);
    if (num_integers < 3) cursor_.fail("a view has at least three integer tags: time step, components, entries");
    std::size_t num_entries = 0;
    for (std::size_t i = 0; i < num_integers; ++i) {
      if (i == 1)
        data.components = static_cast<int>(cursor_.integer_in("number of components", 1, 9));
      else if (i == 2)
        num_entries = cursor_.count("number of entries", 2 * static_cast<std::size_t>(data.components));
      else
        cursor_.integer("integer tag");
    }
    cursor_.skip_line();
    read_entries(num_entries, data);
    take_data(std::move(data));
  }

  void read_entries(std::size_t num_entries, Data& data) {
    for (std::size_t i = 0; i < num_entries; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      data.tags.push_back(int32("tag of a value"));
      std::size_t num_values = static_cast<std::size_t>(data.components);
      if (!data.is_on_nodes) {
        const std::size_t corners = cursor_.checked_count(int32("number of corners"), "number of corners", 2);
        data.corners.push_back(static_cast<std::uint32_t>(corners));
        num_values *= corners;
      }
      for (std::size_t k = 0; k < num_values; ++k) data.values.push_back(real("value"));
    }
  }

  /// Of several time steps the last.
  void take_data(Data&& data) {
    for (Data& known : data_) {
      if (known.name != data.name || known.is_on_nodes != data.is_on_nodes) continue;
      context_.warn(
          fmt::format("{}: '{}' comes several times; the one with the latest time is kept", cursor_.path(), data.name));
      if (data.time >= known.time) known = std::move(data);
      return;
    }
    data_.push_back(std::move(data));
  }

  void end_section(const std::string& name) {
    const std::string_view word = cursor_.next();
    if (word != "$End" + name)
      cursor_.fail(fmt::format("$End{} should stand here{}", name, word.empty() ? "; the file is truncated" : ""));
  }

  void skip_section(const std::string& name) {
    const std::string end = "$End" + name;
    const std::size_t found = cursor_.bytes().find(end, cursor_.position());
    if (found == std::string_view::npos) cursor_.fail(fmt::format("{} is missing; the file is truncated", end));
    cursor_.move_to(found + end.size());
  }

  // Numbers of either encoding.
  std::int64_t int32(const char* what) {
    constexpr std::int64_t kHigh = std::numeric_limits<std::int32_t>::max();
    return is_text_ ? cursor_.integer_in(what, -kHigh, kHigh) : cursor_.binary<std::int32_t>(what);
  }
  std::int64_t int64(const char* what) { return is_text_ ? cursor_.integer(what) : cursor_.binary<std::int64_t>(what); }
  double real(const char* what) { return is_text_ ? cursor_.number(what) : cursor_.binary<double>(what); }
  std::size_t count64(const char* what, std::size_t text_bytes, std::size_t binary_bytes) {
    return cursor_.checked_count(int64(what), what, is_text_ ? text_bytes : binary_bytes);
  }
  int dimension_of_entity() {
    const std::int64_t d = int32("dimension of an entity");
    if (d < 0 || d > 3) fail_here(fmt::format("dimension {} is none of 0 to 3", d));
    return static_cast<int>(d);
  }
  [[noreturn]] void fail_here(const std::string& message) const {
    if (is_text_) cursor_.fail(message);
    cursor_.fail_in_binary(message);
  }

  void read_physical_names() {
    const std::size_t n = cursor_.count("number of physical names", 6);
    for (std::size_t i = 0; i < n; ++i) {
      const auto d = static_cast<int>(cursor_.integer_in("dimension of a physical group", 0, 3));
      const std::int64_t tag = cursor_.integer("tag of a physical group");
      std::string_view name = cursor_.rest_of_line();
      if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
      names_[static_cast<std::size_t>(d)][tag] = name;
    }
  }

  void read_entities() {
    std::array<std::size_t, 4> counts;
    for (std::size_t& n : counts) n = count64("number of entities", 2, 8);
    for (std::size_t d = 0; d < 4; ++d)
      for (std::size_t i = 0; i < counts[d]; ++i) {
        const std::int64_t tag = int32("tag of an entity");
        for (int k = 0; k < (d == 0 ? 3 : 6); ++k) real("box of an entity");
        const std::size_t num_physical = count64("number of physical tags", 2, 4);
        for (std::size_t k = 0; k < num_physical; ++k) {
          const std::int64_t physical = std::abs(int32("physical tag"));
          if (k == 0) physical_of_entity_[d][tag] = static_cast<std::int32_t>(physical);
          if (k == 1) warn_of_second_group();
        }
        const std::size_t num_bounding = d == 0 ? 0 : count64("number of bounding entities", 2, 4);
        for (std::size_t k = 0; k < num_bounding; ++k) int32("bounding entity");
      }
  }

  void warn_of_second_group() {
    if (has_warned_) return;
    has_warned_ = true;
    context_.warn(fmt::format("{}: some entities are in several physical groups; the first is kept", cursor_.path()));
  }

  void add_node(std::int64_t tag, Point p) {
    if (mesh_.points.size() + 1 >= Id<VertexTag>::kNone) fail_here("more than 2^32 - 1 nodes are not supported");
    is_dense_ = is_dense_ && tag == static_cast<std::int64_t>(mesh_.points.size()) + 1;
    node_tags_.push_back(tag);
    mesh_.points.push_back(p);
  }

  void read_nodes2() {
    const std::size_t n = cursor_.count("number of nodes", is_text_ ? 8 : 28);
    cursor_.skip_line();
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      const std::int64_t tag = int32("tag of a node");
      const double x = real("x of a node"), y = real("y of a node");
      add_node(tag, {x, y, real("z of a node")});
    }
  }

  void read_nodes4() {
    const std::size_t num_blocks = count64("number of node blocks", 8, 20);
    count64("number of nodes", 6, 24);
    int64("least node tag");
    int64("greatest node tag");
    std::vector<std::int64_t> tags;
    for (std::size_t block = 0; block < num_blocks; ++block) {
      const int d = dimension_of_entity();
      int32("entity of a node block");
      const int num_parameters = int32("parametric flag") == 0 ? 0 : d;
      const std::size_t n = count64("number of nodes in a block", 8, 32);
      context_.check_limits();
      tags.clear();
      for (std::size_t i = 0; i < n; ++i) tags.push_back(int64("tag of a node"));
      for (std::size_t i = 0; i < n; ++i) {
        const double x = real("x of a node"), y = real("y of a node");
        add_node(tags[i], {x, y, real("z of a node")});
        for (int k = 0; k < num_parameters; ++k) real("parameter of a node");
      }
    }
  }

  CellType cell_type(std::int64_t number) const {
    if (const auto type = type_from_msh(number)) return *type;
    fail_here(fmt::format("element type {} is not supported; save linear elements (gmsh -order 1)", number));
  }

  void add_raw_cell(std::int64_t tag, std::int64_t physical, std::int64_t entity, CellType type) {
    if (cells_.size() % kCheckEvery == 0) context_.check_limits();
    cells_.push_back({tag, pool_.size(), static_cast<std::int32_t>(physical), static_cast<std::int32_t>(entity), type});
  }

  void read_elements2() {
    const std::size_t n = cursor_.count("number of elements", is_text_ ? 8 : 8);
    cursor_.skip_line();
    std::size_t done = 0;
    while (done < n) {
      std::int64_t tag = 0, number = 0, in_block = 1, num_tags = 0;
      if (is_text_) {
        tag = cursor_.integer("number of an element");
        number = cursor_.integer("type of an element");
        num_tags = cursor_.integer("number of tags");
      } else {
        number = int32("type of an element");
        in_block = int32("number of elements in a block");
        num_tags = int32("number of tags");
      }
      if (in_block < 1 || in_block > static_cast<std::int64_t>(n - done))
        fail_here(fmt::format("a block of {} elements among {}", in_block, n));
      cursor_.checked_count(num_tags, "number of tags", is_text_ ? 2 : 4);
      const CellType type = cell_type(number);
      for (std::int64_t i = 0; i < in_block; ++i) {
        if (!is_text_) tag = int32("number of an element");
        read_element2(tag, type, num_tags);
      }
      done += static_cast<std::size_t>(in_block);
    }
  }

  void read_element2(std::int64_t tag, CellType type, std::int64_t num_tags) {
    std::int64_t physical = 0, entity = 0;
    for (std::int64_t k = 0; k < num_tags; ++k) {
      const std::int64_t value = int32("tag of an element");
      if (k == 0) physical = value;
      if (k == 1) entity = value;
    }
    add_raw_cell(tag, std::abs(physical), entity, type);
    for (int k = 0; k < num_vertices(type); ++k) pool_.push_back(int32("vertex of an element"));
  }

  void read_elements4() {
    const std::size_t num_blocks = count64("number of element blocks", 8, 20);
    count64("number of elements", 4, 16);
    int64("least element tag");
    int64("greatest element tag");
    for (std::size_t block = 0; block < num_blocks; ++block) {
      const int d = dimension_of_entity();
      const std::int64_t entity = int32("entity of an element block");
      const CellType type = cell_type(int32("type of an element"));
      if (dimension(type) != d) fail_here(fmt::format("an entity of dimension {} holds a {}", d, name_of(type)));
      const auto corners = static_cast<std::size_t>(num_vertices(type));
      const std::size_t n = count64("number of elements in a block", 2 * (corners + 1), 8 * (corners + 1));
      const auto found = physical_of_entity_[static_cast<std::size_t>(d)].find(entity);
      const std::int64_t physical = found == physical_of_entity_[static_cast<std::size_t>(d)].end() ? 0 : found->second;
      for (std::size_t i = 0; i < n; ++i) {
        add_raw_cell(int64("tag of an element"), physical, entity, type);
        for (std::size_t k = 0; k < corners; ++k) pool_.push_back(int64("vertex of an element"));
      }
    }
  }

  /// From the file's node tags to positions; dense tags 1 … n need no table.
  std::optional<VertexId> find_vertex(std::int64_t tag) const {
    if (is_dense_) {
      if (tag >= 1 && tag <= static_cast<std::int64_t>(mesh_.points.size()))
        return VertexId(static_cast<std::size_t>(tag - 1));
    } else if (const auto found = vertex_of_tag_.find(tag); found != vertex_of_tag_.end()) {
      return VertexId(static_cast<std::size_t>(found->second));
    }
    return std::nullopt;
  }

  VertexId vertex(std::int64_t tag, const RawCell& cell) const {
    if (const std::optional<VertexId> found = find_vertex(tag)) return *found;
    throw InputError(fmt::format("{}: element {} ({}) has the node {}, which the file does not hold", cursor_.path(),
                                 cell.tag, name_of(cell.type), tag));
  }

  void finish() {
    check_finite(mesh_, cursor_.path());
    if (!is_dense_)
      for (std::size_t i = 0; i < node_tags_.size(); ++i)
        vertex_of_tag_.emplace(node_tags_[i], static_cast<std::uint32_t>(i));
    const auto by_tag = [](const RawCell& a, const RawCell& b) { return a.tag < b.tag; };
    if (!std::is_sorted(cells_.begin(), cells_.end(), by_tag)) std::stable_sort(cells_.begin(), cells_.end(), by_tag);
    std::array<bool, 4> has_physical{};
    for (const RawCell& cell : cells_)
      has_physical[static_cast<std::size_t>(dimension(cell.type))] |= cell.physical != 0;
    set_dimension();
    TagGroups groups(mesh_);
    for (std::size_t d = 4; d-- > 0;)
      for (const auto& [tag, name] : names_[d]) groups.name(static_cast<int>(d), tag, name);
    std::vector<VertexId> corners;
    for (const RawCell& cell : cells_) {
      const int d = dimension(cell.type);
      corners.clear();
      for (int k = 0; k < num_vertices(cell.type); ++k)
        corners.push_back(vertex(pool_[cell.first_vertex + static_cast<std::size_t>(k)], cell));
      const std::int64_t tag = has_physical[static_cast<std::size_t>(d)] ? cell.physical : cell.entity;
      add_cell(mesh_, cell.type, corners, tag != 0 && !is_no_group(d, tag) ? groups(d, tag) : GroupId());
    }
    mark_inner_groups(mesh_);
    set_fields();
  }

  /// write_msh puts cells without a group behind the named ones of their dimension.
  bool is_no_group(int d, std::int64_t tag) const {
    const auto& names = names_[static_cast<std::size_t>(d)];
    const bool has_names = std::any_of(names_.begin(), names_.end(), [](const auto& some) { return !some.empty(); });
    return has_names && tag == static_cast<std::int64_t>(names.size()) + 1 && !names.contains(tag);
  }

  void set_fields() {
    std::size_t total = 0;
    for (const Data& data : data_) {
      total += mesh_.points.size() * static_cast<std::size_t>(data.components);
      if (total > cursor_.bytes().size())
        throw InputError(fmt::format("{}: too few nodes have values of '{}' ({} entries for {} nodes)", cursor_.path(),
                                     data.name, data.tags.size(), mesh_.points.size()));
      NodeMeans means(mesh_.points.size(), data.components);
      if (data.is_on_nodes)
        add_node_values(data, means);
      else
        add_corner_values(data, means);
      if (means.differ())
        context_.warn(fmt::format("{}: the cells of '{}' differ at the nodes they share; the mean is taken",
                                  cursor_.path(), data.name));
      mesh_.fields.push_back(means.take(data.name));
    }
  }

  void add_node_values(const Data& data, NodeMeans& means) const {
    for (std::size_t i = 0; i < data.tags.size(); ++i) {
      const std::optional<VertexId> node = find_vertex(data.tags[i]);
      if (!node)
        throw InputError(fmt::format("{}: '{}' has a value for node {}, which the file does not hold", cursor_.path(),
                                     data.name, data.tags[i]));
      means.add(node->index(), data.values.data() + i * static_cast<std::size_t>(data.components));
    }
  }

  /// cells_ is sorted by tag here.
  void add_corner_values(const Data& data, NodeMeans& means) const {
    std::size_t at = 0;
    for (std::size_t i = 0; i < data.tags.size(); ++i) {
      const auto cell = std::lower_bound(cells_.begin(), cells_.end(), data.tags[i],
                                         [](const RawCell& c, std::int64_t tag) { return c.tag < tag; });
      const std::string what =
          fmt::format("{}: '{}' has values for element {}", cursor_.path(), data.name, data.tags[i]);
      if (cell == cells_.end() || cell->tag != data.tags[i]) throw InputError(what + ", which the file does not hold");
      if (data.corners[i] != static_cast<std::uint32_t>(num_vertices(cell->type)))
        throw InputError(fmt::format("{} with {} corners, but it is a {}", what, data.corners[i], name_of(cell->type)));
      for (std::size_t k = 0; k < data.corners[i]; ++k, at += static_cast<std::size_t>(data.components))
        means.add(vertex(pool_[cell->first_vertex + k], *cell).index(), data.values.data() + at);
    }
  }

  /// Before the groups are named, since "patch" and "region" depend on it.
  void set_dimension() {
    int top = 0;
    for (const RawCell& cell : cells_) top = std::max(top, dimension(cell.type));
    const bool is_flat = std::all_of(mesh_.points.begin(), mesh_.points.end(), [](const Point& p) { return p.z == 0; });
    if (top == 2 && is_flat) mesh_.dimension = 2;
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  bool is_text_ = true, is_v4_ = false, is_dense_ = true, has_warned_ = false;
  std::array<std::map<std::int64_t, std::string>, 4> names_;
  std::array<std::unordered_map<std::int64_t, std::int32_t>, 4> physical_of_entity_;
  std::vector<std::int64_t> node_tags_, pool_;
  std::unordered_map<std::int64_t, std::uint32_t> vertex_of_tag_;
  std::vector<RawCell> cells_;
  std::vector<Data> data_;
};

}  // namespace

Mesh read_msh(std::string_view bytes, const std::string& path, Context& context) {
  return MshReader(bytes, path, context).read();
}

}  // namespace delfront
