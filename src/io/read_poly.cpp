// SPDX-License-Identifier: Apache-2.0
// TetGen .poly with its points inside, the facet's marker as its patch. A facet whose edges and points inside do more
// than cut its polygons from corner to corner, or that has holes, comes out as triangles that have all of them; its
// inner edges stay as lines. A facet without a polygon of three corners is an edge or a point in the volume. Volume
// holes and region points are said and left out: the regions of a domain are found by us.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "delfront/errors.hpp"
#include "delfront/facet.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/poly_points.hpp"

namespace delfront {

namespace {

constexpr double kFlatness = 1e-6;  ///< of a facet's extent

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
    const std::size_t begin = cursor_.position();
    const std::size_t num_holes = cursor_.at_line_end() ? 0 : cursor_.count("number of holes", 8);
    const std::int64_t marker = has_markers && !cursor_.at_line_end() ? cursor_.integer("marker") : 0;
    std::vector<std::vector<VertexId>> rings, inside;
    for (std::size_t i = 0; i < num_polygons; ++i) {
      std::vector<VertexId> corners = read_corners();
      (corners.size() >= 3 ? rings : inside).push_back(std::move(corners));
    }
    std::vector<Point> holes(num_holes);
    for (Point& hole : holes) {
      cursor_.integer("number of a hole");
      for (int k = 0; k < 3; ++k) hole[k] = cursor_.number("coordinate of a hole");
      if (!is_in_range(hole)) cursor_.fail("a hole is at no place: its coordinates are not finite, or too large");
    }
    ++num_facets_read_;
    if (rings.empty()) return add_embedded(inside, marker);
    const GroupId group = groups_.by_marker(2, marker);
    if (holes.empty()) {
      std::vector<std::vector<VertexId>> parts = rings;
      const bool is_cut = std::all_of(inside.begin(), inside.end(), [&](const std::vector<VertexId>& corners) {
        return corners.size() == 2 && split_by_edge(parts, corners[0], corners[1]);
      });
      if (is_cut) {
        for (const std::vector<VertexId>& part : parts) add_face(mesh_, part, group);
        return;
      }
    }
    add_triangles(rings, inside, holes, group, marker, begin);
  }

  /// Edges and points that lie in no facet.
  void add_embedded(const std::vector<std::vector<VertexId>>& pieces, std::int64_t marker) {
    for (const std::vector<VertexId>& piece : pieces) {
      const bool is_edge = piece.size() == 2;
      add_cell(mesh_, is_edge ? CellType::line : CellType::vertex, piece,
               marker != 0 ? groups_(is_edge ? 1 : 0, marker) : GroupId());
    }
  }

  void add_triangles(const std::vector<std::vector<VertexId>>& rings, const std::vector<std::vector<VertexId>>& inside,
                     const std::vector<Point>& holes, GroupId group, std::int64_t marker, std::size_t begin) {
    FacetOutline facet;
    facet.holes = holes;
    std::map<VertexId, std::uint32_t> local;
    std::vector<VertexId> global;
    const auto number = [&](VertexId v) {
      const auto [at, is_new] = local.try_emplace(v, static_cast<std::uint32_t>(global.size()));
      if (is_new) {
        global.push_back(v);
        facet.points.push_back(mesh_.points[v]);
      }
      return at->second;
    };
    for (const std::vector<VertexId>& ring : rings) {
      Point area;
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const VertexId next = ring[(k + 1) % ring.size()];
        facet.edges.push_back({number(ring[k]), number(next)});
        area = area + cross(mesh_.points[ring[k]] - mesh_.points[ring[0]], mesh_.points[next] - mesh_.points[ring[0]]);
      }
      if (squared_length(area) > squared_length(facet.normal)) facet.normal = area;  // the outer ring tells the side
    }
    const std::size_t num_ring_edges = facet.edges.size();
    for (const std::vector<VertexId>& piece : inside) {
      const std::uint32_t a = number(piece[0]), b = number(piece.back());
      if (piece.size() == 2) facet.edges.push_back({a, b});
    }
    if (!std::all_of(facet.points.begin(), facet.points.end(), is_in_range)) {  // said when all is read
      for (const std::vector<VertexId>& ring : rings) add_face(mesh_, ring, group);
      return;
    }
    warn_of_bulge(facet);
    const FacetTriangles made = triangulate_or_fail(facet, global, begin);
    for (const auto& [a, b, c] : made.triangles) add_face(mesh_, std::array{global[a], global[b], global[c]}, group);
    for (const FacetTriangles::Piece& piece : made.pieces)
      if (piece.edge >= num_ring_edges)
        add_cell(mesh_, CellType::line, std::array{global[piece.a], global[piece.b]},
                 marker != 0 ? groups_(1, marker) : GroupId());
  }

  /// The triangles go through the points as they are.
  void warn_of_bulge(const FacetOutline& facet) {
    const double area = length(facet.normal);
    double extent = 0, bulge = 0;
    for (const Point& p : facet.points) {
      extent = std::max(extent, length(p - facet.points[0]));
      if (area > 0) bulge = std::max(bulge, std::abs(dot(p - facet.points[0], facet.normal)) / area);
    }
    if (bulge > kFlatness * extent)
      context_.warn(
          fmt::format("{}: facet {} is not flat: its points are up to {:.3g} off the plane of the others; the "
                      "surface bends there",
                      cursor_.path(), num_facets_read_, bulge));
  }

  /// What the predicates hold.
  static bool is_in_range(const Point& p) {
    constexpr double kLargest = 0x1p100;
    return std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest;
  }

  FacetTriangles triangulate_or_fail(const FacetOutline& facet, const std::vector<VertexId>& global,
                                     std::size_t begin) {
    try {
      return triangulate_facet(facet, context_);
    } catch (const InputError& e) {
      std::string numbers;
      for (const VertexId v : global)
        numbers += fmt::format(" {}", static_cast<std::int64_t>(v.index()) + first_index_);
      cursor_.fail_at(begin,
                      fmt::format("facet {} cannot be triangulated: {} (counted from 0 in the points of the facet, "
                                  "which are{})",
                                  num_facets_read_, e.what(), numbers));
    }
  }

  std::vector<VertexId> read_corners() {
    const std::size_t n = cursor_.count("number of corners", 2);
    if (n == 0) cursor_.fail("a polygon without corners");
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
        context_.warn(fmt::format(
            "{}: {} {} point(s) are not used; name the regions to be gridded by points in them (--keep X,Y,Z)",
            cursor_.path(), n, what));
    }
  }

  Cursor cursor_;
  Context& context_;
  Mesh mesh_;
  TagGroups groups_;
  std::int64_t first_index_ = 1;
  std::size_t num_facets_read_ = 0;
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
