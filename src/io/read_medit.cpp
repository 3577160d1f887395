// SPDX-License-Identifier: Apache-2.0
// Medit (.mesh, ASCII), as MMG, TetGen and libMeshb write it. References become groups named by the comments that
// write_medit leaves ("#delfront <dimension> <reference> <sides> <kind or -> <name>"), else "patch_<ref>",
// "region_<ref>". Corners and required vertices become
// vertex cells. Keywords that say nothing about the mesh here (ridges, normals, …) are skipped.
#include <fmt/format.h>

#include <charconv>
#include <set>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

struct Keyword {
  std::string_view name;
  CellType type;
};
constexpr Keyword kKeywords[] = {{"Edges", CellType::line},          {"Triangles", CellType::triangle},
                                 {"Quadrilaterals", CellType::quad}, {"Tetrahedra", CellType::tetrahedron},
                                 {"Pyramids", CellType::pyramid},    {"Prisms", CellType::prism},
                                 {"Pentahedra", CellType::prism},    {"Hexahedra", CellType::hexahedron},
                                 {"Hexaedra", CellType::hexahedron}};

class MeditReader {
 public:
  MeditReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path, "#"), context_(context), groups_(mesh_) {}

  Mesh read() {
    read_names();
    if (cursor_.next() != "MeshVersionFormatted") cursor_.fail("a Medit file begins with MeshVersionFormatted");
    cursor_.integer("version");
    for (std::string_view word = cursor_.next(); !word.empty() && word != "End"; word = cursor_.next()) take(word);
    if (mesh_.top_dimension() < 0) throw InputError(fmt::format("{}: the Medit file has no cells", cursor_.path()));
    check_indices();
    check_finite(mesh_, cursor_.path());
    return std::move(mesh_);
  }

 private:
  void take(std::string_view word) {
    if (word == "Dimension") {
      dimension_ = static_cast<int>(cursor_.integer_in("dimension", 2, 3));
      mesh_.dimension = dimension_;
    } else if (word == "Vertices") {
      read_vertices();
    } else if (word == "Corners" || word == "RequiredVertices") {
      read_points();
    } else if (const Keyword* keyword = find(word)) {
      read_cells(keyword->type);
    } else {
      skip_keyword(word);
    }
  }

  static const Keyword* find(std::string_view word) {
    for (const Keyword& keyword : kKeywords)
      if (keyword.name == word) return &keyword;
    return nullptr;
  }

  /// Numbers up to the next word.
  void skip_keyword(std::string_view word) {
    const auto is_word = [](std::string_view text) {
      return !text.empty() && ((text[0] >= 'A' && text[0] <= 'Z') || (text[0] >= 'a' && text[0] <= 'z'));
    };
    if (!is_word(word)) cursor_.fail(fmt::format("'{}' where a keyword should stand", word.substr(0, 40)));
    for (;;) {
      const std::size_t before = cursor_.position();
      const std::string_view token = cursor_.next();
      double ignored = 0;
      if (token.empty() || (is_word(token) && !parse_number(token, ignored))) return cursor_.move_to(before);
    }
  }

  void read_vertices() {
    const std::size_t n = cursor_.count("number of vertices", static_cast<std::size_t>(2 * dimension_));
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      Point p;
      for (int k = 0; k < dimension_; ++k) p[k] = cursor_.number("coordinate of a vertex");
      cursor_.integer("reference of a vertex");
      mesh_.points.push_back(p);
    }
  }

  void read_cells(CellType type) {
    const auto num_corners = static_cast<std::size_t>(num_vertices(type));
    const std::size_t n = cursor_.count("number of cells", 2 * num_corners + 2);
    std::vector<VertexId> corners(num_corners);
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      for (VertexId& v : corners)
        v = VertexId(static_cast<std::size_t>(cursor_.integer_in("vertex of a cell", 1, Id<VertexTag>::kNone) - 1));
      const std::int64_t reference = cursor_.integer("reference of a cell");
      add_cell(mesh_, type, corners, reference != 0 ? groups_(dimension(type), reference) : GroupId());
    }
  }

  /// A vertex may be both a corner and required.
  void read_points() {
    const std::size_t n = cursor_.count("number of vertices", 2);
    for (std::size_t i = 0; i < n; ++i) {
      const VertexId v(static_cast<std::size_t>(cursor_.integer_in("vertex", 1, Id<VertexTag>::kNone) - 1));
      if (is_point_.insert(v).second) add_cell(mesh_, CellType::vertex, {&v, 1}, GroupId());
    }
  }

  /// At the end, since cells may stand before the vertices.
  void check_indices() const {
    for (const CellBlock& block : mesh_.blocks)
      for (std::size_t i = 0; i < block.vertices.size(); ++i)
        if (block.vertices[i].index() >= mesh_.points.size())
          throw InputError(fmt::format("{}: {} {} has the vertex {}, but the file has {} vertices (counted from 1)",
                                       cursor_.path(), name_of(block.type),
                                       i / static_cast<std::size_t>(num_vertices(block.type)) + 1,
                                       block.vertices[i].index() + 1, mesh_.points.size()));
  }

  void read_names() {
    constexpr std::string_view kMark = "#delfront ";
    for (std::size_t at = cursor_.bytes().find(kMark); at != std::string_view::npos;
         at = cursor_.bytes().find(kMark, at + 1)) {
      Cursor line(cursor_.bytes(), cursor_.path());
      line.move_to(at + kMark.size());
      const std::string_view dimension = line.next_on_line(), tag = line.next_on_line();
      const std::string_view sides = line.next_on_line(), kind = line.next_on_line();
      int d = -1;
      std::int64_t reference = 0;
      std::from_chars(dimension.data(), dimension.data() + dimension.size(), d);
      std::from_chars(tag.data(), tag.data() + tag.size(), reference);
      const std::string name(line.rest_of_line());
      if (d < 0 || d > 3 || reference <= 0 || name.empty()) continue;
      groups_.name(d, reference, name, kind == "-" ? "" : std::string(kind));
      mesh_.groups[groups_(d, reference)].two_sided = sides == "2";
    }
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  TagGroups groups_;
  int dimension_ = 3;
  std::set<VertexId> is_point_;
};

}  // namespace

Mesh read_medit(std::string_view bytes, const std::string& path, Context& context) {
  return MeditReader(bytes, path, context).read();
}

}  // namespace delfront
