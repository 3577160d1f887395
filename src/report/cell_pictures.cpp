// SPDX-License-Identifier: Apache-2.0
// Orthographic projection. A cell of the volume is seen nearly along the edge with its smallest dihedral angle, so that
// the angle is seen as it is, tilted so far that the edge is no point and the two facets are no lines; a cell of a
// surface along its normal. Neighbours are the cells with a whole facet in common: as many vertices as a facet has at
// least. Only cells near the picked ones are looked at closely: those with that many vertices of picked cells.
#include "report/cell_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "mesh/cell_geometry.hpp"
#include "mesh/facet_table.hpp"

namespace delfront {

namespace {

constexpr double kWidth = 180, kHeight = 126;
constexpr double kCellShare = 0.78;                  ///< of the width or height, for the cell
constexpr double kTowardsEdge = 0.4, kAside = 0.13;  ///< tangents of the tilts off the sharpest edge
constexpr double kTiny = 1e-300;

/// A direction; some direction where the vector has none.
Point unit(Point v) {
  const double size = length(v);
  return size > kTiny ? v / size : Point{0, 0, 1};
}

Point any_normal_to(Point v) {
  const Point axis = std::abs(v.x) < 0.6 ? Point{1, 0, 0} : Point{0, 1, 0};
  return unit(cross(v, axis));
}

/// Where things are on the paper.
struct View {
  Point right{1, 0, 0}, up{0, 1, 0}, ahead{0, 0, 1}, centre;
  double scale = 1;

  /// @param ahead  towards the reader
  void look(Point towards_reader, Point upwards) {
    ahead = unit(towards_reader);
    const Point rest = upwards - dot(upwards, ahead) * ahead;
    up = length(rest) > 1e-9 * length(upwards) ? unit(rest) : any_normal_to(ahead);
    right = cross(up, ahead);
  }
  std::array<double, 2> operator()(Point p) const {
    const Point d = p - centre;
    return {0.5 * kWidth + scale * dot(d, right), 0.5 * kHeight - scale * dot(d, up)};
  }
};

/// A cell with what is needed to draw it.
struct Drawn {
  const CellShape& shape;
  std::vector<Point> at;

  std::vector<Point> facet(int f) const {
    std::vector<Point> corners;
    const LocalFacet& local = shape.facets[f];
    for (int i = 0; i < local.num_vertices; ++i) corners.push_back(at[local.vertices[i]]);
    return corners;
  }
};

class CellArtist {
 public:
  explicit CellArtist(const Mesh& mesh)
      : mesh_(mesh), dimension_(mesh.top_dimension()), cells_(mesh, dimension_), sides_(mesh, dimension_ - 1) {}

  std::vector<CellPicture> draw(const std::vector<std::vector<std::uint32_t>>& picks);

 private:
  void mark(const std::vector<std::vector<std::uint32_t>>& picks);
  std::vector<std::uint32_t> find_near(const CellRange& range) const;
  bool shares_facet(std::span<const VertexId> a, std::span<const VertexId> b) const;
  Drawn drawn(std::size_t cell) const;
  std::vector<std::string> touched(const std::vector<std::uint32_t>& pick) const;
  std::string picture(const std::vector<std::uint32_t>& pick) const;

  const Mesh& mesh_;
  int dimension_;
  CellRange cells_, sides_;
  std::vector<bool> is_marked_;  ///< by point: of a picked cell
  std::vector<std::uint32_t> near_cells_, near_sides_;
};

void CellArtist::mark(const std::vector<std::vector<std::uint32_t>>& picks) {
  is_marked_.assign(mesh_.points.size(), false);
  for (const auto& pick : picks)
    for (const std::uint32_t cell : pick)
      if (cell < cells_.size() && shape_of(cells_.part_of(cell).block->type).num_facets > 0)
        for (const VertexId v : cells_[cell]) is_marked_[v.index()] = true;
}

/// Cells that may share a facet with a picked one, or be one.
std::vector<std::uint32_t> CellArtist::find_near(const CellRange& range) const {
  std::vector<std::uint32_t> near;
  for (const CellRange::Part& part : range.parts())
    for (std::size_t i = 0; i < part.block->size(); ++i) {
      int count = 0;
      for (const VertexId v : (*part.block)[i]) count += v.index() < is_marked_.size() && is_marked_[v.index()];
      if (count >= dimension_) near.push_back(static_cast<std::uint32_t>(part.first + i));
    }
  return near;
}

bool CellArtist::shares_facet(std::span<const VertexId> a, std::span<const VertexId> b) const {
  const auto common = std::count_if(a.begin(), a.end(), [&](VertexId v) { return std::count(b.begin(), b.end(), v); });
  return common >= dimension_;
}

Drawn CellArtist::drawn(std::size_t cell) const {
  Drawn result{shape_of(cells_.part_of(cell).block->type), {}};
  for (const VertexId v : cells_[cell]) result.at.push_back(mesh_.points[v]);
  return result;
}

std::vector<std::string> CellArtist::touched(const std::vector<std::uint32_t>& pick) const {
  std::set<std::string> names;
  for (const std::uint32_t side : near_sides_) {
    const CellRange::Part& part = sides_.part_of(side);
    const GroupId group = part.block->group.empty() ? GroupId() : part.block->group[side - part.first];
    const auto is_of = [&](std::uint32_t cell) {
      const auto vertices = cells_[cell];
      return std::all_of(sides_[side].begin(), sides_[side].end(),
                         [&](VertexId v) { return std::find(vertices.begin(), vertices.end(), v) != vertices.end(); });
    };
    if (group.is_valid() && std::any_of(pick.begin(), pick.end(), is_of)) names.insert(mesh_.groups[group].name);
  }
  return {names.begin(), names.end()};
}

struct SharpEdge {
  int edge = -1;
  Point outwards;  ///< away from the cell, between its two facets
};

/// The edge with the smallest angle between its facets.
SharpEdge sharpest_edge(const Drawn& cell) {
  SharpEdge sharp;
  double largest = -2;
  for (int e = 0; e < cell.shape.num_edges; ++e) {
    const auto& facets = cell.shape.facets_of_edge[e];
    const Point a = unit(facet_geometry(cell.facet(facets[0])).area);
    const Point b = unit(facet_geometry(cell.facet(facets[1])).area);
    const double turn = -dot(a, b);  // 1: the two lie on each other
    if (turn <= largest) continue;
    largest = turn;
    sharp = {e, a + b};
  }
  return sharp;
}

View view_of(const Drawn& cell, int dimension, int& marked_edge) {
  View view;
  marked_edge = -1;
  if (dimension == 2) {
    view.look(facet_geometry(cell.at).area, {0, 1, 0});
  } else if (const SharpEdge sharp = sharpest_edge(cell); sharp.edge >= 0) {
    marked_edge = sharp.edge;
    const auto& ends = cell.shape.edges[sharp.edge];
    const Point along = unit(cell.at[ends[1]] - cell.at[ends[0]]);
    const Point side = cross(along, unit(sharp.outwards));
    view.look(along + kTowardsEdge * unit(sharp.outwards) + kAside * unit(side), side);
  }
  return view;
}

/// The picked cells fill the middle.
void fit(const std::vector<Drawn>& cells, View& view) {
  Box box;
  for (const Drawn& cell : cells)
    for (const Point p : cell.at) box.add(Point{dot(p, view.right), dot(p, view.up), dot(p, view.ahead)});
  const Point middle = box.centre();
  view.centre = middle.x * view.right + middle.y * view.up + middle.z * view.ahead;
  const double extent = std::max((box.high.x - box.low.x) / kWidth, (box.high.y - box.low.y) / kHeight);
  view.scale = extent > kTiny ? kCellShare / extent : 1;
}

std::string points_text(const std::vector<Point>& points, const View& view) {
  std::string text;
  for (const Point p : points) {
    const auto at = view(p);
    text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", at[0], at[1]);
  }
  return text;
}

std::string line_svg(Point a, Point b, const char* kind, const View& view) {
  const auto from = view(a), to = view(b);
  return fmt::format(R"(<line class="{}" x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}"/>)", kind, from[0], from[1],
                     to[0], to[1]);
}

std::string outline(const Drawn& cell, const char* kind, const View& view) {
  std::string svg;
  for (int e = 0; e < cell.shape.num_edges; ++e)
    svg += line_svg(cell.at[cell.shape.edges[e][0]], cell.at[cell.shape.edges[e][1]], kind, view);
  return svg;
}

/// Facets that look at the reader are filled; edges between two that look away are dashed.
std::string solid(const Drawn& cell, int dimension, const char* fill, int marked_edge, const View& view) {
  if (dimension == 2)
    return fmt::format(R"(<polygon class="{}" points="{}"/>)", fill, points_text(cell.at, view)) +
           outline(cell, "edge", view);
  std::string svg;
  std::array<bool, 6> is_seen{};
  for (int f = 0; f < cell.shape.num_facets; ++f) {
    const std::vector<Point> corners = cell.facet(f);
    is_seen[f] = dot(facet_geometry(corners).area, view.ahead) > 0;
    if (is_seen[f]) svg += fmt::format(R"(<polygon class="{}" points="{}"/>)", fill, points_text(corners, view));
  }
  for (const bool seen : {false, true})  // what is in front is drawn last
    for (int e = 0; e < cell.shape.num_edges; ++e) {
      const auto& facets = cell.shape.facets_of_edge[e];
      if ((is_seen[facets[0]] || is_seen[facets[1]]) != seen) continue;
      const char* kind = e == marked_edge ? "sharp" : seen ? "edge" : "edge hidden";
      svg += line_svg(cell.at[cell.shape.edges[e][0]], cell.at[cell.shape.edges[e][1]], kind, view);
    }
  return svg;
}

std::string CellArtist::picture(const std::vector<std::uint32_t>& pick) const {
  std::vector<Drawn> cells;
  for (const std::uint32_t cell : pick) {
    if (cell >= cells_.size()) return "";
    cells.push_back(drawn(cell));
    if (cells.back().shape.num_facets == 0) return "";
  }
  if (cells.empty()) return "";
  int marked_edge = -1;
  View view = view_of(cells[0], dimension_, marked_edge);
  fit(cells, view);
  std::string svg = fmt::format(R"(<svg class="cell" viewBox="0 0 {} {}" role="img">)", kWidth, kHeight);
  for (const std::uint32_t near : near_cells_) {
    const auto is_neighbour = [&](std::uint32_t cell) { return shares_facet(cells_[near], cells_[cell]); };
    if (std::count(pick.begin(), pick.end(), near) || std::none_of(pick.begin(), pick.end(), is_neighbour)) continue;
    svg += outline(drawn(near), "near", view);
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
    svg += solid(cells[i], dimension_, i == 0 ? "fill" : "fill second", i == 0 ? marked_edge : -1, view);
  return svg + "</svg>";
}

std::vector<CellPicture> CellArtist::draw(const std::vector<std::vector<std::uint32_t>>& picks) {
  std::vector<CellPicture> pictures(picks.size());
  if (dimension_ < 2) return pictures;
  mark(picks);
  near_cells_ = find_near(cells_);
  near_sides_ = find_near(sides_);
  for (std::size_t i = 0; i < picks.size(); ++i) {
    pictures[i].svg = picture(picks[i]);
    if (!pictures[i].svg.empty()) pictures[i].touches = touched(picks[i]);
  }
  return pictures;
}

}  // namespace

std::vector<CellPicture> draw_cells(const Mesh& mesh, const std::vector<std::vector<std::uint32_t>>& picks) {
  return CellArtist(mesh).draw(picks);
}

}  // namespace delfront
