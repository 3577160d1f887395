// SPDX-License-Identifier: Apache-2.0
// TetGen .poly with its points inside: facets of one or more polygons without holes in them, the facet's marker as its
// patch. Volume holes and region points are said and left out: the regions of a domain are found by us.
#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/poly_points.hpp"

namespace delfront {

namespace {

class PolyReader {
 public:
  PolyReader(std::string_view bytes, const std::string& path, Context& context)
      : cursor_(bytes, path, "#"), context_(context), groups_(mesh_) {}

  Mesh read() {
    read_points();
    const std::size_t num_facets = cursor_.count("number of facets", 2);
    const bool has_markers = !cursor_.at_line_end() && cursor_.integer("marker flag") != 0;
    cursor_.skip_line();
    for (std::size_t i = 0; i < num_facets; ++i) read_facet(has_markers);
    if (mesh_.top_dimension() < 0) throw InputError(fmt::format("{}: the file has no facets", cursor_.path()));
    read_seeds();
    check_finite(mesh_, cursor_.path());
    return std::move(mesh_);
  }

 private:
  void read_points() {
    const std::size_t n = cursor_.count("number of points", 8);
    if (n == 0) cursor_.fail("0 points: they are in a .node file, which is not read; put them into this file");
    if (cursor_.integer("dimension") != 3) cursor_.fail("only 3-D .poly files are read");
    cursor_.skip_line();
    first_index_ = read_poly_points(cursor_, n, 3, mesh_);
  }

  void read_facet(bool has_markers) {
    context_.check_limits();
    const std::size_t num_polygons = cursor_.count("number of polygons", 2);
    if (!cursor_.at_line_end() && cursor_.integer("number of holes") != 0)
      cursor_.fail("facets with holes are not read; split them into polygons");
    std::int64_t marker = 0;
    if (has_markers && !cursor_.at_line_end()) marker = cursor_.integer("marker");
    const GroupId group = groups_.by_marker(2, marker);
    std::vector<std::vector<VertexId>> rings;
    for (std::size_t i = 0; i < num_polygons; ++i) {
      std::vector<VertexId> corners = read_corners();
      if (corners.size() >= 3) {
        rings.push_back(std::move(corners));
      } else if (corners.size() != 2 || !split_by_edge(rings, corners[0], corners[1])) {
        cursor_.fail(
            "a point or an edge inside a facet that does not join two of its corners is not read; split the "
            "facet");
      }
    }
    for (const std::vector<VertexId>& ring : rings) add_face(mesh_, ring, group);
  }

  std::vector<VertexId> read_corners() {
    const std::size_t n = cursor_.count("number of corners", 2);
    const auto last = first_index_ + static_cast<std::int64_t>(mesh_.points.size()) - 1;
    std::vector<VertexId> corners;
    for (std::size_t k = 0; k < n; ++k)
      corners.push_back(
          VertexId(static_cast<std::size_t>(cursor_.integer_in("point", first_index_, last) - first_index_)));
    return corners;
  }

  /// An edge between two corners of a ring makes two rings of it. @return false where no ring has both
  static bool split_by_edge(std::vector<std::vector<VertexId>>& rings, VertexId a, VertexId b) {
    for (std::vector<VertexId>& ring : rings) {
      auto from = std::find(ring.begin(), ring.end(), a), to = std::find(ring.begin(), ring.end(), b);
      if (from == ring.end() || to == ring.end() || from == to) continue;
      if (to < from) std::swap(from, to);
      std::vector<VertexId> inner(from, to + 1), outer(ring.begin(), from + 1);
      outer.insert(outer.end(), to, ring.end());
      if (inner.size() < 3 || outer.size() < 3) return true;  // a side of the ring already
      ring = std::move(inner);
      rings.push_back(std::move(outer));
      return true;
    }
    return false;
  }

  void read_seeds() {
    for (const char* what : {"hole", "region"}) {
      if (cursor_.at_end()) return;
      const std::size_t n = cursor_.count(what, 6);
      cursor_.skip_line();
      for (std::size_t i = 0; i < n && !cursor_.at_end(); ++i) cursor_.skip_line();
      if (n > 0)
        context_.warn(
            fmt::format("{}: {} {} point(s) are not used; give domain.seeds instead", cursor_.path(), n, what));
    }
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  TagGroups groups_;
  std::int64_t first_index_ = 1;
};

}  // namespace

Mesh read_poly(std::string_view bytes, const std::string& path, Context& context) {
  Cursor head(bytes, path, "#");
  if (!head.next().empty() && head.next_on_line() == "2" && head.left() > 0) {
    head.move_to(0);
    if (head.count("number of points", 6) == 0)
      head.fail("0 points: they are in a .node file, which is not read; put them into this file");
    return read_planar_poly(bytes, path, context);
  }
  return PolyReader(bytes, path, context).read();
}

}  // namespace delfront
