// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "geometry_text/fields.hpp"
#include "io/output.hpp"

namespace delfront {
namespace {

constexpr std::size_t kWidth = 110;  ///< of lines; longer lists stand one item a line

std::string text_of(double value) { return fmt::format("{}", value); }
std::string text_of(int value) { return fmt::format("{}", value); }
std::string text_of(bool value) { return value ? "true" : "false"; }

std::string text_of(const std::string& value) {
  std::string result = "\"";
  for (const char c : value) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      result += fmt::format("\\{}", c);
    else if (code < 0x20 || code == 0x7f)
      result += fmt::format("\\u{:04X}", code);
    else
      result += c;
  }
  return result + "\"";
}

std::string joined(const std::vector<std::string>& items) {
  std::string line = "[";
  for (const std::string& item : items) line += (line.size() > 1 ? ", " : "") + item;
  line += "]";
  if (line.size() <= kWidth && line.find('\n') == std::string::npos) return line;
  std::string block = "[\n";
  for (const std::string& item : items) block += "  " + item + ",\n";
  return block + "]";
}

std::string text_of(Point p) { return joined({text_of(p.x), text_of(p.y), text_of(p.z)}); }
std::string text_of(const std::optional<Point>& p) { return text_of(p.value()); }
template <class T>
std::string text_of(const std::array<T, 2>& pair) {
  return joined({text_of(pair[0]), text_of(pair[1])});
}
std::string text_of(const std::optional<std::array<double, 2>>& pair) { return text_of(pair.value()); }
std::string text_of(const TextUse& use);
template <class T>
std::string text_of(const std::vector<T>& items) {
  std::vector<std::string> texts;
  for (const T& item : items) texts.push_back(text_of(item));
  return joined(texts);
}

/// Walks through a table's fields and writes those that are not what they usually are.
class Writer {
 public:
  void type(const std::string& value, std::initializer_list<const char*>) { put("type", text_of(value)); }
  void kind(const std::string& value) { optional("kind", value, {}); }
  template <class T>
  void required(const char* key, const T& value) {
    put(key, text_of(value));
  }
  template <class T>
  void optional(const char* key, const T& value, const T& usual) {
    if (!(value == usual)) put(key, text_of(value));
  }
  std::vector<std::string> lines;

 private:
  void put(const char* key, const std::string& value) { lines.push_back(fmt::format("{} = {}", key, value)); }
};

std::string text_of(const TextUse& use) {
  const std::string edge = text_of((use.is_reversed ? "-" : "") + use.edge);
  Writer writer;
  visit_use(writer, use);
  if (writer.lines.empty()) return edge;
  std::string result = "{edge = " + edge;  // tables within a line have no line breaks of their own but within lists
  for (const std::string& line : writer.lines) result += ", " + line;
  return result + "}";
}

template <class Item, class Visit>
void add_tables(std::string& text, const char* name, const std::vector<Item>& items, const Visit& visit) {
  for (const Item& item : items) {
    Writer writer;
    visit(writer, item);
    text += fmt::format("{}[[{}]]\n", text.empty() ? "" : "\n", name);
    for (const std::string& line : writer.lines) text += line + "\n";
  }
}

}  // namespace

std::string to_text(const GeometryText& geometry) {
  std::string text;
  if (geometry.tolerance > 0) text = fmt::format("tolerance = {}\n", geometry.tolerance);
  add_tables(text, "shape", geometry.shapes, [](auto& v, auto& item) { visit_shape(v, item); });
  add_tables(text, "corner", geometry.corners, [](auto& v, auto& item) { visit_corner(v, item); });
  add_tables(text, "surface", geometry.surfaces, [](auto& v, auto& item) { visit_surface(v, item); });
  add_tables(text, "edge", geometry.edges, [](auto& v, auto& item) { visit_edge(v, item); });
  add_tables(text, "face", geometry.faces, [](auto& v, auto& item) { visit_face(v, item); });
  return text;
}

void write_geometry(const GeometryText& geometry, const std::string& path) {
  Replacement replacement(path);
  Output output(replacement.temporary(), path);
  output.text(to_text(geometry));
  output.close();
  replacement.commit();
}

}  // namespace delfront
