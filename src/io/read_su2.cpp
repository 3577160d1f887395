// SPDX-License-Identifier: Apache-2.0
// SU2 native grids, 2-D and 3-D: cells by VTK number, markers as groups of the dimension below. One zone.
#include <fmt/format.h>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 16;

class Su2Reader {
 public:
  Su2Reader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path, "%"), context_(context) {}

  Mesh read() {
    while (!cursor_.at_end()) take_line();
    if (mesh_.top_dimension() < 0)
      throw InputError(fmt::format("{}: the SU2 file has no elements (NELEM)", cursor_.path()));
    check_indices();
    check_finite(mesh_, cursor_.path());
    return std::move(mesh_);
  }

 private:
  /// "NPOIN= 8", "NPOIN=8" or "NPOIN = 8": the key, with the cursor behind '='.
  std::string_view take_key() {
    cursor_.at_end();  // to the first character
    const std::size_t begin = cursor_.position();
    const std::string_view rest = cursor_.bytes().substr(begin);
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::size_t equals = rest.substr(0, end).find('=');
    if (equals == std::string_view::npos) {
      const std::string_view token = cursor_.next();
      cursor_.fail(fmt::format("'{}' where a keyword such as NPOIN= should stand", token.substr(0, 40)));
    }
    cursor_.move_to(begin + equals + 1);
    return trimmed(rest.substr(0, equals));
  }

  void take_line() {
    const std::string_view key = take_key();
    if (key == "NDIME") {
      mesh_.dimension = static_cast<int>(cursor_.integer_in("NDIME", 2, 3));
    } else if (key == "NELEM") {
      read_elements(cursor_.count("NELEM", 4), GroupId(), mesh_.dimension);
    } else if (key == "NPOIN") {
      read_points();
    } else if (key == "MARKER_TAG") {
      marker_ = mesh_.add_group(mesh_.dimension - 1, std::string(cursor_.rest_of_line()));
    } else if (key == "MARKER_ELEMS") {
      read_elements(cursor_.count("MARKER_ELEMS", 4), marker_, mesh_.dimension - 1);
    } else if (key == "NZONE") {
      if (cursor_.integer("NZONE") > 1) cursor_.fail("files with several zones are not read; split them first");
    } else {
      cursor_.rest_of_line();  // NMARK, SEND_TO, NCHUNK, …
    }
  }

  void read_points() {
    const std::size_t n = cursor_.count("NPOIN", static_cast<std::size_t>(2 * mesh_.dimension));
    cursor_.skip_line();  // older files give a second number
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      Point p;
      for (int k = 0; k < mesh_.dimension; ++k) p[k] = cursor_.number("coordinate of a point");
      cursor_.skip_line();  // its index
      mesh_.points.push_back(p);
    }
  }

  void read_elements(std::size_t n, GroupId group, int wanted) {
    cursor_.skip_line();
    std::vector<VertexId> corners;
    for (std::size_t i = 0; i < n; ++i) {
      if (i % kCheckEvery == 0) context_.check_limits();
      const std::int64_t number = cursor_.integer("type of an element");
      const std::optional<CellType> type =
          number > 0 && number < 42 && number != 7 ? type_from_vtk(static_cast<int>(number)) : std::nullopt;
      if (!type || dimension(*type) != wanted) {
        if (type == CellType::vertex) {  // SEND_RECEIVE markers of partitioned files
          cursor_.skip_line();
          continue;
        }
        cursor_.fail(fmt::format("element type {} cannot stand here (dimension {})", number, wanted));
      }
      corners.resize(static_cast<std::size_t>(num_vertices(*type)));
      for (VertexId& v : corners)
        v = VertexId(static_cast<std::size_t>(cursor_.integer_in("vertex of an element", 0, Id<VertexTag>::kNone - 1)));
      cursor_.skip_line();  // its index
      add_cell(mesh_, *type, corners, group);
    }
  }

  /// At the end, since elements mostly stand before the points.
  void check_indices() const {
    for (const CellBlock& block : mesh_.blocks)
      for (std::size_t i = 0; i < block.vertices.size(); ++i)
        if (block.vertices[i].index() >= mesh_.points.size())
          throw InputError(fmt::format("{}: {} {} has the vertex {}, but the file has {} points (counted from 0)",
                                       cursor_.path(), name_of(block.type),
                                       i / static_cast<std::size_t>(num_vertices(block.type)),
                                       block.vertices[i].index(), mesh_.points.size()));
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  GroupId marker_;
};

}  // namespace

Mesh read_su2(std::string_view bytes, const std::string& path, Context& context) {
  return Su2Reader(bytes, path, context).read();
}

}  // namespace delfront
