// SPDX-License-Identifier: Apache-2.0
// What of a surface has to stay: lines by angle and by name, corners, and the regions between them.
#include "surface/parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "geometry/angles.hpp"

namespace delfront {
namespace {

constexpr double kSliver = 1e-3;    ///< height over longest side: the normal of less says nothing
constexpr double kWeakShare = 0.5;  ///< of the feature angle, for edges that close a gap in a line
constexpr int kLongestGap = 4;      ///< edges

}  // namespace

SurfaceParts::SurfaceParts(const Model& m, const SizeField& size, Context& context) : model(m) {
  find_normals();
  context.check_limits();
  edges = SurfaceEdges(model.triangles, std::vector<bool>(model.triangles.size(), true));
  smooth_slivers();
  find_features();
  drop_short_creases(size);
  find_corners();
  find_lines();
  find_regions();
  find_sides();
}

/// Slivers take the normal of the triangle over their longest edge.
void SurfaceParts::smooth_slivers() {
  const std::vector<Point> own = normal;
  for (std::uint32_t t = 0; t < normal.size(); ++t) {
    std::uint32_t longest = 0;
    double side[3];
    for (std::uint32_t k = 0; k < 3; ++k) {
      side[k] = distance(corner(t, k), corner(t, (k + 1) % 3));
      if (side[k] > side[longest]) longest = k;
    }
    const double twice = length(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
    if (twice >= kSliver * side[longest] * side[longest]) continue;
    const auto half = edges.half_edges(edges.edge_of(3 * t + longest));
    if (half.size() != 2) continue;
    const std::uint32_t other = half[0] / 3 == t ? half[1] : half[0];
    if (start(other) != start(3 * t + longest)) normal[t] = own[other / 3];
  }
}

void SurfaceParts::find_normals() {
  normal.resize(model.triangles.size());
  for (std::size_t t = 0; t < normal.size(); ++t) {
    const Point a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    const double longest = std::max({distance(a, b), distance(b, c), distance(c, a)});
    const Point twice = longest > 0 ? cross((b - a) / longest, (c - a) / longest) : Point{};
    const double size = length(twice);
    if (!(size > 0))
      throw InputError(fmt::format("triangle {} of the surface has no area, at {:g} {:g} {:g}; repair the surface, or "
                                   "keep its triangles (surface.method = \"keep\")",
                                   t, a.x, a.y, a.z),
                       {{a, {static_cast<std::uint32_t>(t)}}});
    normal[t] = twice / size;
  }
}

VertexId SurfaceParts::other_end(std::uint32_t edge, VertexId v) const {
  const auto ends = edges.ends(edge);
  return ends[0] == v ? ends[1] : ends[0];
}

void SurfaceParts::find_features() {
  std::unordered_map<std::uint64_t, std::uint32_t> curve_of;
  for (std::size_t c = 0; c < model.curves.size(); ++c) {
    const auto& v = model.curves[CurveId(c)].vertices;
    for (std::size_t i = 0; i + 1 < v.size(); ++i) {
      const auto [low, high] = std::minmax(v[i].value, v[i + 1].value);
      curve_of.emplace(std::uint64_t(low) << 32 | high, static_cast<std::uint32_t>(c));
    }
  }
  is_feature.assign(edges.size(), true);
  given_curve_.assign(edges.size(), kNoTriangle);
  std::vector<double> turn(edges.size(), 0);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto ends = edges.ends(e);
    const auto curve = curve_of.find(std::uint64_t(ends[0].value) << 32 | ends[1].value);
    if (curve != curve_of.end()) {
      given_curve_[e] = curve->second;
      curve_edges_[curve->first] = static_cast<std::uint32_t>(e);
    }
    const auto half = edges.half_edges(e);
    if (half.size() != 2 || start(half[0]) == start(half[1])) continue;  // open, of many, or orientations disagree
    const std::uint32_t s = half[0] / 3, t = half[1] / 3;
    turn[e] = angle_between(normal[s], normal[t]);
    is_feature[e] = turn[e] > model.feature_angle * kDegree || curve != curve_of.end() ||
                    model.patch_of_triangle[TriangleId(s)] != model.patch_of_triangle[TriangleId(t)];
  }
  close_gaps(turn);
}

std::vector<std::vector<std::uint32_t>> SurfaceParts::features_at_vertices() const {
  std::vector<std::vector<std::uint32_t>> at(model.points.size());
  for (std::uint32_t e = 0; e < edges.size(); ++e)
    if (is_feature[e])
      for (const VertexId v : edges.ends(e)) at[v.index()].push_back(e);
  return at;
}

/// A line that ends goes on over edges that turn a little less, where they lead to a line within a few steps.
void SurfaceParts::close_gaps(const std::vector<double>& turn) {
  const double weak = kWeakShare * model.feature_angle * kDegree;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> weak_at;
  for (std::uint32_t e = 0; e < edges.size(); ++e)
    if (!is_feature[e] && turn[e] > weak)
      for (const VertexId v : edges.ends(e)) weak_at[v.value].push_back(e);
  if (weak_at.empty()) return;
  const auto at = features_at_vertices();
  for (std::uint32_t v = 0; v < at.size(); ++v) {
    if (at[v].size() != 1 || !weak_at.count(v)) continue;
    std::vector<std::uint32_t> path;
    VertexId from = other_end(at[v][0], VertexId(v)), here(v);
    while (path.size() < kLongestGap) {
      std::uint32_t best = kNoTriangle;
      double straightest = 0.5;
      for (const std::uint32_t e : weak_at[here.value]) {
        if (is_feature[e] || std::find(path.begin(), path.end(), e) != path.end()) continue;
        const Point in = model.points[here] - model.points[from];
        const Point out = model.points[other_end(e, here)] - model.points[here];
        const double cosine = dot(in, out) / (length(in) * length(out));
        if (cosine > straightest) straightest = cosine, best = e;
      }
      if (best == kNoTriangle) break;
      path.push_back(best);
      from = here;
      here = other_end(best, here);
      if (at[here.index()].empty()) continue;
      for (const std::uint32_t e : path) is_feature[e] = true;
      break;
    }
  }
}

/// Whether nothing but its angle makes the edge a feature.
bool SurfaceParts::is_by_angle(std::size_t e) const {
  const auto half = edges.half_edges(e);
  return half.size() == 2 && start(half[0]) != start(half[1]) && given_curve_[e] == kNoTriangle &&
         model.patch_of_triangle[TriangleId(half[0] / 3)] == model.patch_of_triangle[TriangleId(half[1] / 3)];
}

/// Creases by angle alone that end freely and are shorter than the wanted size are noise, not features.
void SurfaceParts::drop_short_creases(const SizeField& size) {
  const auto at = features_at_vertices();
  DisjointSets sets(edges.size());
  for (const auto& list : at)
    for (std::size_t i = 1; i < list.size(); ++i) sets.join(list[0], list[i]);
  struct Piece {
    double length = 0;
    bool is_by_angle = true;
    std::size_t free_ends = 0;
    Point at;
  };
  std::unordered_map<std::uint32_t, Piece> pieces;
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    if (!is_feature[e]) continue;
    Piece& piece = pieces[sets.find(e)];
    const auto ends = edges.ends(e);
    piece.at = model.points[ends[0]];
    piece.length += distance(piece.at, model.points[ends[1]]);
    piece.is_by_angle = piece.is_by_angle && is_by_angle(e);
    for (const VertexId v : ends) piece.free_ends += at[v.index()].size() == 1;
  }
  std::unordered_map<std::uint32_t, bool> goes;
  for (const auto& [root, piece] : pieces)
    goes[root] = piece.is_by_angle && piece.free_ends >= 2 && piece.length < size.size(piece.at);
  for (std::uint32_t e = 0; e < edges.size(); ++e)
    if (is_feature[e] && goes[sets.find(e)]) is_feature[e] = false;
}

void SurfaceParts::find_corners() {
  is_corner.assign(model.points.size(), false);
  const auto at = features_at_vertices();
  const double straight = std::cos(model.feature_angle * kDegree);
  for (std::uint32_t v = 0; v < at.size(); ++v) {
    const auto& list = at[v];
    if (list.empty()) continue;
    if (list.size() != 2 || given_curve_[list[0]] != given_curve_[list[1]]) {
      is_corner[v] = true;
      continue;
    }
    const Point p = model.points[VertexId(v)];
    const Point in = p - model.points[other_end(list[0], VertexId(v))];
    const Point out = model.points[other_end(list[1], VertexId(v))] - p;
    is_corner[v] = dot(in, out) < straight * length(in) * length(out);
  }
  for (const VertexId v : model.corners) is_corner[v.index()] = true;
  for (const Curve& curve : model.curves) mark_curve_corners(curve);
}

/// Where a curve ends, meets itself, or leaves the triangles' edges.
void SurfaceParts::mark_curve_corners(const Curve& curve) {
  const auto& v = curve.vertices;
  for (const VertexId end : {v.front(), v.back()})
    if (v.front() != v.back()) is_corner[end.index()] = true;
  for (std::size_t i = 0; i + 1 < v.size(); ++i)
    if (edge_between(v[i], v[i + 1]) == kNoTriangle) is_corner[v[i].index()] = is_corner[v[i + 1].index()] = true;
}

std::uint32_t SurfaceParts::edge_between(VertexId a, VertexId b) const {
  const auto found = curve_edges_.find(std::uint64_t(std::min(a, b).value) << 32 | std::max(a, b).value);
  return found == curve_edges_.end() ? kNoTriangle : found->second;
}

void SurfaceParts::find_lines() {
  line_of_edge.assign(edges.size(), kNoTriangle);
  const auto at = features_at_vertices();
  const auto run = [&](VertexId from, std::uint32_t edge) {
    SurfaceLine line;
    line.vertices.push_back(from);
    VertexId here = from;
    while (true) {
      line_of_edge[edge] = static_cast<std::uint32_t>(lines.size());
      line.edges.push_back(edge);
      here = other_end(edge, here);
      line.vertices.push_back(here);
      if (is_corner[here.index()] || here == from) break;
      edge = at[here.index()][0] == edge ? at[here.index()][1] : at[here.index()][0];
    }
    line.is_loop = !is_corner[here.index()];
    lines.push_back(std::move(line));
  };
  for (std::uint32_t v = 0; v < at.size(); ++v)
    if (is_corner[v])
      for (const std::uint32_t e : at[v])
        if (line_of_edge[e] == kNoTriangle) run(VertexId(v), e);
  for (std::uint32_t e = 0; e < edges.size(); ++e)
    if (is_feature[e] && line_of_edge[e] == kNoTriangle) run(edges.ends(e)[0], e);
}

void SurfaceParts::find_regions() {
  const std::size_t n = model.triangles.size();
  DisjointSets sets(n);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (is_feature[e]) continue;
    const auto half = edges.half_edges(e);
    sets.join(half[0] / 3, half[1] / 3);
  }
  std::uint32_t count = 0;
  region_of_triangle = sets.number(count);
  regions.resize(count);
  for (std::uint32_t t = 0; t < n; ++t) {
    SurfaceRegion& region = regions[region_of_triangle[t]];
    region.patch = model.patch_of_triangle[TriangleId(t)];
    region.triangles.push_back(t);
  }
}

void SurfaceParts::find_sides() {
  for (std::uint32_t l = 0; l < lines.size(); ++l) {
    const SurfaceLine& line = lines[l];
    // by region and direction: triangles along the line
    std::vector<std::pair<std::uint32_t, RegionSide>> sides;
    for (std::size_t i = 0; i < line.edges.size(); ++i) {
      for (const std::uint32_t h : edges.half_edges(line.edges[i])) {
        const std::uint32_t r = region_of_triangle[h / 3];
        const bool is_backward = start(h) != line.vertices[i];
        auto side = std::find_if(sides.begin(), sides.end(), [&](const auto& s) {
          return s.first == r && s.second.is_backward == is_backward && s.second.triangles.size() <= i;
        });
        if (side == sides.end()) {
          if (i > 0) regions[r].is_simple = false;
          sides.push_back({r, {l, is_backward, {}}});
          side = sides.end() - 1;
        }
        side->second.triangles.push_back(h / 3);
      }
    }
    for (auto& [r, side] : sides) {
      for (const RegionSide& other : regions[r].sides)
        if (other.line == l && other.is_backward == side.is_backward) regions[r].is_simple = false;
      if (side.triangles.size() != line.edges.size()) regions[r].is_simple = false;
      regions[r].sides.push_back(std::move(side));
    }
  }
}

}  // namespace delfront
