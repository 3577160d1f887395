// SPDX-License-Identifier: Apache-2.0
#define TOML_ENABLE_FORMATTERS 0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>

#include "base/nearest_name.hpp"
#include "base/toml_letters.hpp"
#include "delfront/errors.hpp"
#include "geometry/boundary_kinds.hpp"
#include "geometry_text/fields.hpp"
#include "io/source.hpp"

namespace delfront {
namespace {

int line_of(const toml::node& node) { return int(node.source().begin.line); }

/// One table of the file: walks through its fields, complains with file and line.
class Reader {
 public:
  Reader(const toml::table& table, std::string file, std::string what)
      : table_(table), file_(std::move(file)), what_(std::move(what)) {}

  void type(std::string& value, std::initializer_list<const char*> allowed) {
    required("type", value);
    check_word("type", value, std::vector<std::string>(allowed.begin(), allowed.end()));
  }
  void kind(std::string& value) {
    optional("kind", value, {});
    if (!value.empty()) check_word("kind", value, boundary_kinds());
  }
  template <class T>
  void required(const char* key, T& value) {
    const toml::node* node = get(key);
    if (!node) fail_missing(key);
    read(*node, key, value);
  }
  template <class T>
  void optional(const char* key, T& value, const T&) {
    if (const toml::node* node = get(key)) read(*node, key, value);
  }
  /// @brief After all fields: what is left nobody asked for.
  void finish() const {
    for (const auto& [key, node] : table_)
      if (std::find(known_.begin(), known_.end(), key.str()) == known_.end())
        fail(node, fmt::format("there is no key '{}' here; keys are {}{}", std::string(key.str()),
                               fmt::join(known_, ", "), meant(std::string(key.str()), known_)));
  }
  const toml::node* get(const char* key) {
    known_.push_back(key);
    return table_.get(key);
  }
  [[noreturn]] void fail(const toml::node& node, const std::string& why) const {
    const toml::node* name = table_.get("name");
    const std::string called = name && name->is_string() ? fmt::format(" '{}'", name->as_string()->get()) : "";
    throw InputError(fmt::format("{}:{}: {}{}: {}", file_, line_of(node), what_, called, why));
  }

 private:
  void check_word(const char* key, const std::string& value, const std::vector<std::string>& words) const {
    if (std::find(words.begin(), words.end(), value) != words.end()) return;
    fail(*table_.get(key), fmt::format("there is no {} '{}'; {}s are {}{}", key, value, key, fmt::join(words, ", "),
                                       meant(value, words)));
  }
  static std::string meant(const std::string& wrong, const std::vector<std::string>& known) {
    const std::string near = nearest_name(wrong, known);
    return near.empty() ? "" : fmt::format(" (did you mean {}?)", near);
  }
  /// Misspelt, most likely, where there is something like it.
  [[noreturn]] void fail_missing(const std::string& key) const {
    for (const auto& [other, node] : table_)
      if (std::find(known_.begin(), known_.end(), other.str()) == known_.end() &&
          !meant(std::string(other.str()), {key}).empty())
        fail(node, fmt::format("there is no key '{}'; did you mean {}?", std::string(other.str()), key));
    fail(table_, fmt::format("{} is missing", key));
  }
  [[noreturn]] void wants(const toml::node& node, const char* key, const char* wanted) const {
    fail(node, fmt::format("{} takes {}", key, wanted));
  }

  void read(const toml::node& node, const char* key, std::string& value) const {
    if (!node.is_string()) wants(node, key, "a text");
    value = node.as_string()->get();
  }
  void read(const toml::node& node, const char* key, bool& value) const {
    if (!node.is_boolean()) wants(node, key, "true or false");
    value = node.as_boolean()->get();
  }
  void read(const toml::node& node, const char* key, double& value) const {
    if (node.is_integer())
      value = double(node.as_integer()->get());
    else if (node.is_floating_point())
      value = node.as_floating_point()->get();
    else
      wants(node, key, "numbers");
    if (!std::isfinite(value)) wants(node, key, "numbers that are finite");
    if (value == 0) value = 0;  // no negative one
  }
  void read(const toml::node& node, const char* key, int& value) const {
    constexpr std::int64_t kMost = 1000000;
    if (!node.is_integer() || std::abs(node.as_integer()->get()) > kMost) wants(node, key, "whole numbers");
    value = int(node.as_integer()->get());
  }
  const toml::array& list(const toml::node& node, const char* key, std::size_t count, const char* wanted) const {
    const toml::array* array = node.as_array();
    if (!array || (count > 0 && array->size() != count)) wants(node, key, wanted);
    return *array;
  }
  void read(const toml::node& node, const char* key, Point& value) const {
    const toml::array& items = list(node, key, 3, "places and directions of three numbers, [x, y, z]");
    for (std::size_t k = 0; k < 3; ++k) read(items[k], key, value[int(k)]);
  }
  template <class T>
  void read(const toml::node& node, const char* key, std::array<T, 2>& value) const {
    const toml::array& items = list(node, key, 2, "pairs of numbers, [u, v]");
    for (std::size_t k = 0; k < 2; ++k) read(items[k], key, value[k]);
  }
  template <class T>
  void read(const toml::node& node, const char* key, std::optional<T>& value) const {
    value.emplace();
    read(node, key, *value);
  }
  template <class T>
  void read(const toml::node& node, const char* key, std::vector<T>& value) const {
    for (const toml::node& item : list(node, key, 0, "a list, [ … ]")) {
      value.emplace_back();
      read(item, key, value.back());
    }
  }
  void read(const toml::node& node, const char*, TextUse& use) const {
    use.line.number = line_of(node);
    std::string edge;
    if (const toml::table* table = node.as_table()) {
      Reader reader(*table, file_, what_ + ": an edge of a loop");
      reader.required("edge", edge);
      visit_use(reader, use);
      reader.finish();
    } else if (node.is_string()) {
      edge = node.as_string()->get();
    } else {
      wants(node, "loops", "lists of edges: [[\"a\", \"-b\"]], or {edge = \"a\", uv = [[0, 0], [1, 0]]}");
    }
    use.is_reversed = !edge.empty() && edge[0] == '-';
    use.edge = edge.substr(use.is_reversed ? 1 : 0);
  }

  const toml::table& table_;
  std::string file_, what_;
  std::vector<std::string> known_;
};

template <class Item, class Visit>
void read_tables(Reader& root, const std::string& file, const char* key, std::vector<Item>& items, const Visit& visit) {
  const toml::node* node = root.get(key);
  if (!node) return;
  const toml::array* tables = node->as_array();
  if (!tables) root.fail(*node, fmt::format("{0} is a list of tables: write [[{0}]]", key));
  for (const toml::node& item : *tables) {
    if (!item.is_table()) root.fail(item, fmt::format("{0} is a list of tables: write [[{0}]]", key));
    Reader reader(*item.as_table(), file, key);
    items.emplace_back();
    items.back().line.number = line_of(item);
    visit(reader, items.back());
    reader.finish();
  }
}

}  // namespace

bool is_geometry_file(const std::string& path) {
  const std::string suffix = kGeometrySuffix;
  return path.size() > suffix.size() && path.compare(path.size() - suffix.size(), suffix.size(), suffix) == 0;
}

GeometryText parse_geometry(const std::string& text, const std::string& file) {
  if (const int line = find_stray_letter(text); line > 0)
    throw InputError(fmt::format("{}:{}: not valid TOML: a letter outside of ASCII; put quotes round it", file, line));
  toml::table table;
  try {
    table = toml::parse(text);
  } catch (const toml::parse_error& e) {
    throw InputError(
        fmt::format("{}:{}: not valid TOML: {}", file, e.source().begin.line, std::string(e.description())));
  }
  GeometryText geometry;
  Reader root(table, file, "the file");
  root.optional("tolerance", geometry.tolerance, 0.0);
  if (geometry.tolerance < 0) root.fail(*table.get("tolerance"), "tolerance is a length, 0 or more");
  read_tables(root, file, "shape", geometry.shapes, [](auto& v, auto& item) { visit_shape(v, item); });
  read_tables(root, file, "corner", geometry.corners, [](auto& v, auto& item) { visit_corner(v, item); });
  read_tables(root, file, "surface", geometry.surfaces, [](auto& v, auto& item) { visit_surface(v, item); });
  read_tables(root, file, "edge", geometry.edges, [](auto& v, auto& item) { visit_edge(v, item); });
  read_tables(root, file, "face", geometry.faces, [](auto& v, auto& item) { visit_face(v, item); });
  root.finish();
  return geometry;
}

GeometryText read_geometry(const std::string& path) {
  const FileBytes bytes(path);
  return parse_geometry(std::string(bytes.view()), path);
}

}  // namespace delfront
