// SPDX-License-Identifier: Apache-2.0
// What embedded curves and points must not do: have no length, meet facets or each other outside of common vertices.
// All decided by signs of exact determinants. A point in the plane of others is looked at along an axis along which
// their triangle keeps an area, which keeps all incidences.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/surface_findings.hpp"
#include "predicates/predicates.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

int turn(Point a, Point b, Point c, int drop) {
  const int i = (drop + 1) % 3, j = (drop + 2) % 3;
  const double p[2] = {a[i], a[j]}, q[2] = {b[i], b[j]}, r[2] = {c[i], c[j]};
  return orient2d(p, q, r);
}

/// An axis along which the three points do not look collinear; -1 where they are.
int axis_for(Point a, Point b, Point c) {
  for (int drop = 0; drop < 3; ++drop)
    if (turn(a, b, c, drop) != 0) return drop;
  return -1;
}

/// p, collinear with a and b, on the closed segment.
bool is_between(Point a, Point b, Point p) {
  for (int k = 0; k < 3; ++k)
    if (p[k] < std::min(a[k], b[k]) || p[k] > std::max(a[k], b[k])) return false;
  return true;
}

bool is_on_segment(Point a, Point b, Point p) { return is_between(a, b, p) && axis_for(a, b, p) < 0; }

/// Closed segments that lie in one plane, seen along an axis that keeps it a plane.
bool meet_in_plane(Point a, Point b, Point c, Point d, int drop) {
  const int c_side = turn(a, b, c, drop), d_side = turn(a, b, d, drop);
  const int a_side = turn(c, d, a, drop), b_side = turn(c, d, b, drop);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && is_between(a, b, c)) || (d_side == 0 && is_between(a, b, d)) ||
         (a_side == 0 && is_between(c, d, a)) || (b_side == 0 && is_between(c, d, b));
}

bool is_in_triangle(const Point* t, Point p, int drop) {
  const int sense = turn(t[0], t[1], t[2], drop);
  for (int k = 0; k < 3; ++k)
    if (turn(t[k], t[(k + 1) % 3], p, drop) * sense < 0) return false;
  return true;
}

struct Ends {
  VertexId a, b;
};

class CurveChecks {
 public:
  CurveChecks(const Surface& surface, std::vector<Finding>& findings) : surface_(surface), findings_(findings) {
    for (const Curve& curve : surface.model.curves)
      for (std::size_t i = 0; i + 1 < curve.vertices.size(); ++i)
        edges_.push_back({curve.vertices[i], curve.vertices[i + 1]});
  }

  void run(Context& context) {
    std::vector<Box> triangles(surface_.num_triangles());
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (surface_.is_sound(t)) triangles[t] = surface_.box(t);
    const Bvh facets(triangles);
    std::vector<Box> boxes(edges_.size());
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      if (e % 4096 == 0) context.progress("check", e, edges_.size(), "edges of curves");
      boxes[e] = look_at_edge(e, facets);
    }
    const Bvh curves(boxes);
    curves.for_each_pair([&](std::uint32_t e, std::uint32_t f) {
      if (edges_meet(edges_[e], edges_[f])) add(crossing_, middle(edges_[e]), {e, f});
    });
    look_at_points(facets, curves);
    report();
  }

 private:
  Point at(VertexId v) const { return surface_.points[v]; }
  Point middle(const Ends& e) const { return 0.5 * (surface_.model.points[e.a] + surface_.model.points[e.b]); }

  static void add(Finding& finding, Point where, std::vector<std::uint32_t> ids) {
    ++finding.count;
    add_place(finding, where, std::move(ids));
  }

  Box look_at_edge(std::uint32_t e, const Bvh& facets) {
    const Ends edge = edges_[e];
    if (edge.a == edge.b) {
      add(flat_, middle(edge), {e});
      return {};
    }
    Box box;
    box.add(at(edge.a));
    box.add(at(edge.b));
    facets.for_each_overlap(box, [&](std::uint32_t t) {
      if (meets_facet(edge, t)) add(piercing_, middle(edge), {e, face_id(surface_, t)});
    });
    return box;
  }

  /// Other than in a common vertex, or as one of its sides.
  bool meets_facet(const Ends& edge, std::uint32_t t) const {
    const auto& corner = surface_.corners(t);
    const Point p[3] = {surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2)};
    int shared = 0;
    std::size_t common = 0;
    bool is_a = true;
    for (std::size_t k = 0; k < 3; ++k)
      for (const VertexId v : {edge.a, edge.b})
        if (corner[k] == v) {
          ++shared;
          common = k;
          is_a = v == edge.a;
        }
    if (shared == 2) return false;
    const Point a = at(edge.a), b = at(edge.b);
    const int a_side = orient3d(p[0], p[1], p[2], a), b_side = orient3d(p[0], p[1], p[2], b);
    const int drop = axis_for(p[0], p[1], p[2]);
    if (shared == 1) {
      if ((is_a ? b_side : a_side) != 0) return false;
      const Point far = is_a ? b : a, o = p[common], q = p[(common + 1) % 3], r = p[(common + 2) % 3];
      const int sense = turn(o, q, r, drop);
      return turn(o, q, far, drop) * sense >= 0 && turn(o, far, r, drop) * sense >= 0;
    }
    if (a_side * b_side > 0) return false;
    if (a_side == 0 && b_side == 0) {
      if (is_in_triangle(p, a, drop) || is_in_triangle(p, b, drop)) return true;
      for (int k = 0; k < 3; ++k)
        if (meet_in_plane(a, b, p[k], p[(k + 1) % 3], drop)) return true;
      return false;
    }
    const int s[3] = {orient3d(a, b, p[0], p[1]), orient3d(a, b, p[1], p[2]), orient3d(a, b, p[2], p[0])};
    return std::min({s[0], s[1], s[2]}) >= 0 || std::max({s[0], s[1], s[2]}) <= 0;
  }

  bool edges_meet(const Ends& e, const Ends& f) const {
    if (e.a == e.b || f.a == f.b) return false;
    if (e.a == f.a || e.a == f.b || e.b == f.a || e.b == f.b) {
      const VertexId common = e.a == f.a || e.a == f.b ? e.a : e.b;
      const Point o = at(common), p = at(e.a == common ? e.b : e.a), q = at(f.a == common ? f.b : f.a);
      return axis_for(o, p, q) < 0 && dot_sign(o, p, q) > 0;
    }
    const Point a = at(e.a), b = at(e.b), c = at(f.a), d = at(f.b);
    if (orient3d(a, b, c, d) != 0) return false;
    const int drop = axis_for(a, b, c) >= 0 ? axis_for(a, b, c) : axis_for(a, b, d);
    if (drop >= 0) return meet_in_plane(a, b, c, d, drop);
    return is_between(a, b, c) || is_between(a, b, d) || is_between(c, d, a);
  }

  /// Points that stand alone: on a facet or on a curve?
  void look_at_points(const Bvh& facets, const Bvh& curves) {
    std::set<VertexId> ends;
    for (const Ends& e : edges_) ends.insert({e.a, e.b});
    for (const VertexId v : surface_.model.corners) {
      const Point p = at(v);
      bool is_vertex = ends.contains(v), is_on_facet = false;
      std::uint32_t facet = 0;
      facets.for_each_overlap({p, p}, [&](std::uint32_t t) {
        const auto& corner = surface_.corners(t);
        is_vertex = is_vertex || std::find(corner.begin(), corner.end(), v) != corner.end();
        const Point c[3] = {surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2)};
        if (orient3d(c[0], c[1], c[2], p) != 0 || !is_in_triangle(c, p, axis_for(c[0], c[1], c[2]))) return;
        facet = is_on_facet ? std::min(facet, t) : t;
        is_on_facet = true;
      });
      if (is_vertex) continue;
      if (is_on_facet) add(on_facet_, surface_.model.points[v], {v.value, face_id(surface_, facet)});
      curves.for_each_overlap({p, p}, [&](std::uint32_t e) {
        if (is_on_segment(at(edges_[e].a), at(edges_[e].b), p)) add(on_curve_, surface_.model.points[v], {v.value, e});
      });
    }
  }

  void report() {
    const std::pair<Finding*, const char*> all[] = {
        {&flat_, "edges of curves have no length"},
        {&piercing_, "times an edge of a curve meets a facet outside of common vertices"},
        {&crossing_, "pairs of edges of curves meet outside of common vertices"},
        {&on_facet_, "embedded points lie on a facet without being its vertex"},
        {&on_curve_, "embedded points lie on an edge of a curve without being its end"}};
    for (const auto& [finding, what] : all) {
      if (finding->count == 0) continue;
      const Place& first = finding->places[0];
      finding->message = fmt::format("{} {}, the first at {}, ids {}", finding->count, what, text_of(first.at),
                                     fmt::join(first.ids, " and "));
      findings_.push_back(std::move(*finding));
    }
  }

  const Surface& surface_;
  std::vector<Finding>& findings_;
  std::vector<Ends> edges_;
  Finding flat_{"degenerate_curves", Severity::error, 0, "", "drop them", {}};
  Finding piercing_{"curves_through_facets",
                    Severity::error,
                    0,
                    "",
                    "make the place where they meet a vertex of both, or end the curve before",
                    {}};
  Finding crossing_{"crossing_curves", Severity::error, 0, "", "make the place where they meet a vertex of both", {}};
  Finding on_facet_{"points_on_facets", Severity::error, 0, "", "make the point a vertex of the facet, or drop it", {}};
  Finding on_curve_{"points_on_curves", Severity::error, 0, "", "split the edge there, or drop the point", {}};
};

}  // namespace

void find_curve_defects(const Surface& surface, std::vector<Finding>& findings, Context& context) {
  if (surface.model.curves.empty() && surface.model.corners.empty()) return;
  CurveChecks(surface, findings).run(context);
}

}  // namespace delfront
