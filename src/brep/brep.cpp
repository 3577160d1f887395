// SPDX-License-Identifier: Apache-2.0
// What every smooth surface can do with its derivatives, and what must hold of a Brep.
#include "delfront/brep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr double kFlat = 1e-9;  ///< sine between tangents, relative to their usual lengths: the mapping is degenerate
constexpr int kMostSteps = 30;
constexpr double kLoopTolerance = 1e-7;  ///< of a loop's extent in the parameter plane
constexpr int kSamples = 7;
constexpr double kShare = 1e-9;  ///< of the diagonal: the tolerance where none is given

Point unit(Point p) {
  const double size = length(p);
  return size > 0 ? p / size : p;
}

class Checker {
 public:
  explicit Checker(const Brep& brep) : brep_(brep) {}

  void run() {
    if (brep_.faces.empty()) throw InputError("the geometry has no faces");
    for (std::size_t e = 0; e < brep_.edges.size(); ++e) check_ids(e);
    find_tolerance();
    for (std::size_t e = 0; e < brep_.edges.size(); ++e) check_edge(e);
    for (std::size_t f = 0; f < brep_.faces.size(); ++f) check_face(f);
  }

 private:
  static std::string name_of(const char* what, std::size_t i, const std::string& name) {
    return name.empty() ? fmt::format("{} {}", what, i) : fmt::format("{} {} ('{}')", what, i, name);
  }
  std::string edge_name(std::size_t e) const { return name_of("edge", e, brep_.edges[EdgeId(e)].name); }

  void check_ids(std::size_t e) const {
    const BrepEdge& edge = brep_.edges[EdgeId(e)];
    const bool is_closed = !edge.corners[0].is_valid() && !edge.corners[1].is_valid();
    for (const CornerId c : edge.corners)
      if (!is_closed && c.index() >= brep_.corners.size())
        throw InputError(edge_name(e) + " ends in a corner that does not exist");
    if (!(edge.range[0] < edge.range[1]) || !std::isfinite(edge.range[1] - edge.range[0]))
      throw InputError(edge_name(e) + " has no length: its parameter range is empty or not finite");
    if (edge.is_degenerate() && (is_closed || edge.corners[0] != edge.corners[1]))
      throw InputError(edge_name(e) + " has no curve, but does not begin and end in one corner");
  }

  void find_tolerance() {
    Box box;
    for (const BrepCorner& corner : brep_.corners) box.add(corner.at);
    for (const BrepEdge& edge : brep_.edges)
      for (int i = 0; i <= kSamples && !edge.is_degenerate(); ++i)
        box.add(edge.curve->at(edge.range[0] + (edge.range[1] - edge.range[0]) * i / kSamples));
    tolerance_ = std::max(brep_.tolerance, kShare * box.diagonal());
  }

  void check_edge(std::size_t e) const {
    const BrepEdge& edge = brep_.edges[EdgeId(e)];
    if (edge.is_degenerate()) return;
    const Point ends[2] = {edge.curve->at(edge.range[0]), edge.curve->at(edge.range[1])};
    const bool is_closed = !edge.corners[0].is_valid();
    for (std::size_t k = 0; k < 2; ++k) {
      const Point wanted = is_closed ? ends[0] : brep_.corners[edge.corners[k]].at;
      const double corner = is_closed ? 0 : brep_.corners[edge.corners[k]].tolerance;
      if (!(distance(ends[k], wanted) <= std::max({tolerance_, edge.tolerance, corner})))
        throw InputError(fmt::format("{} ends {:g} away from its corner", edge_name(e), distance(ends[k], wanted)),
                         {{ends[k], {std::uint32_t(e)}}});
    }
  }

  void check_face(std::size_t f) const {
    const BrepFace& face = brep_.faces[FaceId(f)];
    const std::string name = name_of("face", f, face.name);
    if (!face.surface) throw InputError(name + " has no surface");
    if (face.loops.empty()) throw InputError(name + " has no loops: a closed surface is cut along a seam");
    for (const auto& loop : face.loops) {
      if (loop.empty()) throw InputError(name + " has a loop without edges");
      for (const BrepUse& use : loop) check_use(face, name, use);
      check_loop(face, name, loop);
    }
  }

  void check_use(const BrepFace& face, const std::string& name, const BrepUse& use) const {
    if (use.edge.index() >= brep_.edges.size()) throw InputError(name + " uses an edge that does not exist");
    if (!use.curve) throw InputError(name + " has no parameter curve for " + edge_name(use.edge.index()));
    const BrepEdge& edge = brep_.edges[use.edge];
    for (int i = 0; i <= kSamples; ++i) {
      const double t = edge.range[0] + (edge.range[1] - edge.range[0]) * i / kSamples;
      const Point at = edge.is_degenerate() ? brep_.corners[edge.corners[0]].at : edge.curve->at(t);
      const double away = distance(at, face.surface->at(use.curve->at(t)));
      const double allowed = tolerance_of(face, use);
      if (!(away <= 2 * allowed))
        throw InputError(fmt::format("{}: the parameter curve of {} lies {:g} away from the edge (tolerance {:g})",
                                     name, edge_name(use.edge.index()), away, allowed),
                         {{at, {use.edge.value}}});
    }
  }

  Point2 end_of(const BrepUse& use, bool is_first) const {
    return use.curve->at(brep_.edges[use.edge].range[is_first == use.is_reversed ? 1 : 0]);
  }

  double tolerance_of(const BrepFace& face, const BrepUse& use) const {
    const BrepEdge& edge = brep_.edges[use.edge];
    const double corner = edge.is_degenerate() ? brep_.corners[edge.corners[0]].tolerance : 0;
    return std::max({tolerance_, face.tolerance, edge.tolerance, corner});
  }

  /// Two ends in the parameter plane may be apart by what the corner's tolerance is there.
  bool meet_in_space(const BrepFace& face, const BrepUse& last, Point2 a, const BrepUse& next, Point2 b) const {
    double allowed = std::max(tolerance_of(face, last), tolerance_of(face, next));
    for (const BrepUse* use : {&last, &next})
      for (const CornerId c : brep_.edges[use->edge].corners)
        if (c.is_valid()) allowed = std::max(allowed, brep_.corners[c].tolerance);
    const Point at = face.surface->at(a);
    for (const double f : {0.25, 0.5, 0.75, 1.0})
      if (!(distance(at, face.surface->at({a.x + f * (b.x - a.x), a.y + f * (b.y - a.y)})) <= 2 * allowed))
        return false;
    return true;
  }

  void check_loop(const BrepFace& face, const std::string& name, const std::vector<BrepUse>& loop) const {
    Box extent;
    for (const BrepUse& use : loop)
      for (int i = 0; i <= kSamples; ++i) {
        const auto& range = brep_.edges[use.edge].range;
        const Point2 p = use.curve->at(range[0] + (range[1] - range[0]) * i / kSamples);
        extent.add(Point{p.x, p.y, 0});
      }
    const Point size = extent.high - extent.low;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const BrepUse& next = loop[(i + 1) % loop.size()];
      const Point2 a = end_of(loop[i], false), b = end_of(next, true);
      const bool is_apart =
          std::abs(a.x - b.x) > kLoopTolerance * size.x || std::abs(a.y - b.y) > kLoopTolerance * size.y;
      if (is_apart && !meet_in_space(face, loop[i], a, next, b))
        throw InputError(fmt::format("{}: a loop does not close in the parameter plane after {}: ({:g}, {:g}) to "
                                     "({:g}, {:g}); a seam is an edge that is used twice",
                                     name, edge_name(loop[i].edge.index()), a.x, a.y, b.x, b.y),
                         {{face.surface->at(a), {loop[i].edge.value}}});
    }
  }

  const Brep& brep_;
  double tolerance_ = 0;
};

}  // namespace

SurfaceTangents SmoothSurface::tangents(Point2 uv) const {
  const SurfaceDerivatives s = derivatives(uv);
  return {s.at, s.u, s.v};
}

Point SmoothSurface::normal(Point2 uv) const {
  const SurfaceDerivatives s = derivatives(uv);
  const Point n = cross(s.u, s.v);
  const double usual = (length(s.u) + length(s.uv) + length(s.uu)) * (length(s.v) + length(s.uv) + length(s.vv));
  if (length(n) > kFlat * usual) return unit(n);
  // along the degenerate side one tangent vanishes; just inside, it is the mixed derivative's
  const ParameterBox b = box();
  if (length(s.u) <= length(s.v)) {
    const double inside = uv.y - b.low.y <= b.high.y - uv.y ? 1 : -1;
    return unit(inside * cross(s.uv, s.v));
  }
  const double inside = uv.x - b.low.x <= b.high.x - uv.x ? 1 : -1;
  return unit(inside * cross(s.u, s.uv));
}

Point2 SmoothSurface::closest(Point p, Point2 start) const {
  const ParameterBox b = box();
  const auto [period_u, period_v] = period();
  Point2 uv = start;
  SurfaceDerivatives s = derivatives(uv);
  double best = squared_length(s.at - p);
  for (int step = 0; step < kMostSteps; ++step) {
    const Point r = s.at - p;
    const double fu = dot(r, s.u), fv = dot(r, s.v), e = dot(s.u, s.u), f = dot(s.u, s.v), g = dot(s.v, s.v);
    double a = e + dot(r, s.uu), c = f + dot(r, s.uv), d = g + dot(r, s.vv);
    if (!(a * d - c * c > 1e-3 * e * g) || !(a > 0)) a = e, c = f, d = g;  // not convex: Gauss and Newton
    const double det = a * d - c * c;
    if (!(det > 1e-14 * a * d)) break;
    double du = -(d * fu - c * fv) / det, dv = -(a * fv - c * fu) / det;
    bool is_nearer = false;
    for (int halving = 0; halving < 8 && !is_nearer; ++halving, du *= 0.5, dv *= 0.5) {
      Point2 next = {uv.x + du, uv.y + dv};
      if (period_u == 0) next.x = std::clamp(next.x, b.low.x, b.high.x);
      if (period_v == 0) next.y = std::clamp(next.y, b.low.y, b.high.y);
      const SurfaceDerivatives there = derivatives(next);
      const double away = squared_length(there.at - p);
      is_nearer = away < best;
      if (!is_nearer) continue;
      best = away;
      uv = next;
      s = there;
    }
    if (!is_nearer) break;
  }
  return uv;
}

double largest_curvature(const SurfaceDerivatives& s) {
  const Point n = cross(s.u, s.v);
  const double e = dot(s.u, s.u), f = dot(s.u, s.v), g = dot(s.v, s.v), det = e * g - f * f;
  const double area = length(n);
  if (!(det > kFlat * kFlat * (e + g) * (e + g)) || !(area > 0)) return 0;
  const double l = dot(s.uu, n) / area, m = dot(s.uv, n) / area, q = dot(s.vv, n) / area;
  const double mean = (e * q - 2 * f * m + g * l) / (2 * det), gauss = (l * q - m * m) / det;
  return std::abs(mean) + std::sqrt(std::max(mean * mean - gauss, 0.0));
}

void check_brep(const Brep& brep) { Checker(brep).run(); }

}  // namespace delfront
