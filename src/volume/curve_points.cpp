// SPDX-License-Identifier: Apache-2.0
#include "volume/curve_points.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "volume/edge_flips.hpp"
#include "volume/link.hpp"
#include "volume/visible_point.hpp"

namespace delfront {

namespace {

constexpr std::size_t kMostFills = 60;  ///< a way to switch an edge takes a few where there is one

class CurvePointRemoval {
 public:
  CurvePointRemoval(TetComplex& complex, VertexIndex s, VertexIndex p, VertexIndex q)
      : c_(complex), s_(s), p_(p), q_(q) {}

  bool run(bool may_add_points) {
    return find_link(c_, s_, star_, link_) && (pull_into(p_) || pull_into(q_) || move_aside(may_add_points));
  }

 private:
  bool pull_into(VertexIndex u) {
    std::vector<std::array<VertexIndex, 4>> made;
    for (const LinkFace& f : link_) {
      if (has(f, u)) continue;
      if (c_.orient(f[0], f[1], f[2], u) <= 0) return false;
      made.push_back({f[0], f[1], f[2], u});
    }
    free_point();
    std::vector<TetIndex> new_tets;
    c_.replace(star_, made, new_tets);
    c_.kept_edges.insert(p_, q_);
    return true;
  }

  void free_point() {
    c_.segment_points.erase(s_);
    c_.on_boundary[s_] = 0;
    c_.kept_edges.erase(p_, s_);
    c_.kept_edges.erase(s_, q_);
  }

  /// To one side of the edge, where that is met by little but the tets around s then.
  bool move_aside(bool may_add_points) {
    std::vector<Wall> walls;
    double reach = 0;
    for (const LinkFace& f : link_) {
      walls.push_back({c_.exact(f[0]), c_.exact(f[1]), c_.exact(f[2])});
      reach = std::max(reach, distance(c_.point(s_), c_.point(f[0])));
    }
    const Point along = c_.point(q_) - c_.point(p_);
    int least = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (std::abs(along[axis]) < std::abs(along[least])) least = axis;
    Point axis;
    axis[least] = 1;
    const Point u = cross(along, axis), v = cross(along, u) / length(along);
    const std::vector<bool> everywhere(may_add_points ? c_.num_vertices() : 0, true);
    const TetComplex before = c_;  // what a failed search has switched is put back
    for (const Point& direction : {u, v, -1 * u, -1 * v}) {
      const auto place = find_visible_point(walls, c_.point(s_), {direction}, reach);
      if (!place) continue;
      free_point();
      c_.vertex[s_] = {place->x, place->y, place->z, c_.vertex[s_].h};
      if (EdgeFlips(c_, c_.kept_edges).recover(p_, q_, everywhere, kMostFills)) {
        c_.kept_edges.insert(p_, q_);
        return true;
      }
      c_ = before;
    }
    return false;
  }

  TetComplex& c_;
  const VertexIndex s_, p_, q_;
  std::vector<TetIndex> star_;
  std::vector<LinkFace> link_;  ///< opposite s, normals towards it
};

void warn_of_outside(const Model& model, const std::vector<std::size_t>& outside, Context& context) {
  for (std::size_t i = 0; i < outside.size(); ++i) {
    if (outside[i] == 0) continue;
    const Curve& curve = model.curves[CurveId(i)];
    const Point at = model.points[curve.vertices[0]];
    context.warn(
        fmt::format("curve '{}' from ({:g}, {:g}, {:g}): {} of its {} edges lie outside of what is gridded "
                    "and are left out",
                    curve.name, at.x, at.y, at.z, outside[i], curve.vertices.size() - 1));
  }
}

void count_points(const TetComplex& complex, const Model& model, const Segments& segments, RecoveryReport& report,
                  Context& context) {
  std::size_t outside = 0;
  Point first;
  for (const VertexId v : model.corners) {
    const bool is_alone = segments.vertex_offset[v.index()] == segments.vertex_offset[v.index() + 1];
    if (complex.vertex_tet[v.value] != kNoIndex) {
      report.embedded_points += is_alone ? 1 : 0;
      continue;
    }
    if (outside++ == 0) first = model.points[v];
  }
  if (outside > 0)
    context.warn(
        fmt::format("{} embedded points lie outside of what is gridded and are left out, the first at "
                    "({:g}, {:g}, {:g})",
                    outside, first.x, first.y, first.z));
}

}  // namespace

void keep_curve_edges(TetComplex& complex, const Segments& segments) {
  std::vector<VertexIndex> along;
  std::vector<TetIndex> scratch;
  for (auto e = static_cast<std::uint32_t>(segments.num_surface_edges); e < segments.ends.size(); ++e) {
    segments.vertices_along(e, false, along);
    for (std::size_t i = 0; i + 1 < along.size(); ++i) {
      if (complex.vertex_tet[along[i]] == kNoIndex) continue;
      if (complex.find_edge(along[i], along[i + 1], scratch) == kNoIndex) continue;
      complex.kept_edges.insert(along[i], along[i + 1]);
      for (const VertexIndex v : {along[i], along[i + 1]}) complex.on_boundary[v] = 1;
    }
  }
}

bool remove_curve_point(TetComplex& complex, VertexIndex s, VertexIndex p, VertexIndex q, bool may_add_points) {
  return CurvePointRemoval(complex, s, p, q).run(may_add_points);
}

std::vector<std::vector<CurvePiece>> find_curve_pieces(const TetComplex& complex, const Model& model,
                                                       const Segments& segments, RecoveryReport& report,
                                                       Context& context) {
  std::vector<std::vector<CurvePiece>> pieces(model.curves.size());
  std::vector<std::size_t> outside(model.curves.size(), 0);
  std::vector<VertexIndex> along;
  std::vector<TetIndex> scratch;
  for (std::size_t i = 0; i < model.curves.size(); ++i)
    for (std::size_t step = 0; step < segments.of_curve[i].size(); ++step) {
      const std::uint32_t e = segments.of_curve[i][step];
      segments.vertices_along(e, segments.ends[e][0] != model.curves[CurveId(i)].vertices[step].value, along);
      const bool is_there =
          complex.vertex_tet[along[0]] != kNoIndex && complex.find_edge(along[0], along[1], scratch) != kNoIndex;
      if (!is_there) {
        ++outside[i];
        continue;
      }
      for (std::size_t k = 0; k + 1 < along.size(); ++k) {
        DELFRONT_CHECK(complex.find_edge(along[k], along[k + 1], scratch) != kNoIndex);
        pieces[i].push_back({along[k], along[k + 1]});
      }
      ++report.curve_edges;
      report.curve_edges_inside += e >= segments.num_surface_edges ? 1 : 0;
      report.curve_edges_split += along.size() > 2 ? 1 : 0;
    }
  warn_of_outside(model, outside, context);
  count_points(complex, model, segments, report, context);
  return pieces;
}

}  // namespace delfront
