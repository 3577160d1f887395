// SPDX-License-Identifier: Apache-2.0
// Curvature of lines in the plane. At a vertex it is that of the circle through it and its neighbours: exact for points
// on a circle, however far apart. A point read off a drawing beside a short segment makes nonsense of that: a neighbour
// farther away, as far as the other side's, then says less, and the smaller of both is taken. A vertex that turns to
// the other side than both its neighbours is noise too, or a kink between straight sides: there the turn is laid over
// the three of them.
#include "sizing/geometry_plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace delfront {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kFlat = 32 * std::numeric_limits<double>::epsilon();  // of coordinates: no height over a chord
constexpr double kMostTurn = 45 * kPi / 180;                           // on the way to a neighbour farther away

double cross_z(Point a, Point b) { return a.x * b.y - a.y * b.x; }

}  // namespace

bool is_in_the_plane(const Model& model) {
  if (!model.triangles.empty() || model.curves.empty()) return false;
  const double z = model.points.empty() ? 0 : model.points[VertexId(0)].z;
  return std::all_of(model.points.begin(), model.points.end(), [&](Point p) { return p.z == z; });
}

PlaneLines::PlaneLines(const Model& m)
    : model(m), joints_(m.points.size()), cos_corner_(std::cos(m.feature_angle * kPi / 180)) {
  const Box box = m.bounding_box();
  diagonal_ = box.diagonal();
  for (const double x : {box.low.x, box.low.y, box.high.x, box.high.y}) flat_ = std::max(flat_, kFlat * std::abs(x));
  std::vector<std::array<VertexId, 2>> all;
  for (const Curve& curve : m.curves)
    for (std::size_t k = 0; k + 1 < curve.vertices.size(); ++k) {
      const VertexId a = curve.vertices[k], b = curve.vertices[k + 1];
      if (distance(m.points[a], m.points[b]) > 0) all.push_back({a, b});
    }
  const auto sorted_ends = [&](std::uint32_t i) {
    const auto a = all[i][0].index(), b = all[i][1].index();
    return std::pair(std::min(a, b), std::max(a, b));
  };
  std::vector<std::uint32_t> order(all.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return sorted_ends(i) < sorted_ends(j); });
  std::vector<bool> is_again(all.size(), false);
  for (std::size_t k = 1; k < order.size(); ++k)
    is_again[order[k]] = sorted_ends(order[k]) == sorted_ends(order[k - 1]);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (is_again[i]) continue;
    for (const VertexId v : all[i]) {
      Joint& joint = joints_[v.index()];
      if (joint.count < 2) joint.segment[std::size_t(joint.count)] = static_cast<std::uint32_t>(segments.size());
      ++joint.count;
    }
    segments.push_back({all[i], distance(m.points[all[i][0]], m.points[all[i][1]])});
  }
}

bool PlaneLines::share_an_end(std::uint32_t s, std::uint32_t t) const {
  const auto& [a, b] = segments[s].ends;
  const auto& [c, d] = segments[t].ends;
  return a == c || a == d || b == c || b == d;
}

std::optional<PlaneLines::Passage> PlaneLines::smooth_at(VertexId v) const {
  const Joint& joint = joints_[v.index()];
  if (joint.count != 2) return std::nullopt;
  const auto [s, t] = joint.segment;
  const Point p = model.points[v];
  const Point in = p - model.points[other_end(s, v)], out = model.points[other_end(t, v)] - p;
  if (dot(in, out) < cos_corner_ * segments[s].length * segments[t].length) return std::nullopt;
  return Passage{v, s, t};
}

std::optional<PlaneLines::Passage> PlaneLines::next(const Passage& from) const {
  const std::optional<Passage> found = smooth_at(other_end(from.out, from.at));
  return !found || found->in == from.out ? found : reversed(*found);
}

double PlaneLines::through(Point a, Point b, Point c) const {
  const double twice = cross_z(b - a, c - b), across = distance(a, c);
  if (!(std::abs(twice) > flat_ * across)) return 0;
  return 2 * twice / (distance(a, b) * distance(b, c) * across);
}

/// A vertex ahead at least so far along the line, short of what turns too much.
Point PlaneLines::reach_out(const Passage& here, double least) const {
  VertexId v = other_end(here.out, here.at);
  double travelled = segments[here.out].length, turned = 0;
  std::optional<Passage> passage = next(here);
  while (passage && travelled < least) {
    const Point p = model.points[v], ahead = model.points[other_end(passage->out, v)] - p;
    const Point before = p - model.points[other_end(passage->in, v)];
    turned += std::abs(std::atan2(cross_z(before, ahead), dot(before, ahead)));
    if (turned > kMostTurn || passage->out == here.in) break;
    travelled += segments[passage->out].length;
    v = other_end(passage->out, v);
    passage = next(*passage);
  }
  return model.points[v];
}

double PlaneLines::curvature(const Passage& here) const {
  const Point p = model.points[here.at];
  const double next_ones = through(model.points[other_end(here.in, here.at)], p,  //
                                   model.points[other_end(here.out, here.at)]);
  const double reach = 0.5 * std::max(segments[here.in].length, segments[here.out].length);
  const double farther = through(reach_out(reversed(here), reach), p, reach_out(here, reach));
  return std::abs(farther) < std::abs(next_ones) ? farther : next_ones;
}

double PlaneLines::steady_curvature(const Passage& here) const {
  const double own = curvature(here);
  const auto weight = [&](const Passage& p) { return segments[p.in].length + segments[p.out].length; };
  double sum = weight(here) * own, sum_weights = weight(here);
  for (const Passage& way : {here, reversed(here)}) {
    const std::optional<Passage> beside = next(way);
    if (!beside) continue;
    // the way back runs the other way round
    const double there = way.out == here.out ? curvature(*beside) : -curvature(*beside);
    if (there * own > 0) return own;
    sum += weight(*beside) * there;
    sum_weights += weight(*beside);
  }
  return sum / sum_weights;
}

GeometrySources find_plane_curvature_sizes(const Model& model, const CurvatureSizes& wish, Context& context) {
  const PlaneLines lines(model);
  const double largest = std::min(wish.hmax, 2 * lines.diagonal());
  GeometrySources found;
  // what a vertex says reaches as far as its shorter side shows, but for a cell at least
  struct Size {
    double h = std::numeric_limits<double>::infinity(), reach = 0;
  };
  const auto size_at = [&](VertexId v) {
    const auto here = lines.smooth_at(v);
    const double curvature = here ? std::abs(lines.steady_curvature(*here)) : 0;
    const double h = curvature > 0 ? size_on_radius(1 / curvature, wish) : std::numeric_limits<double>::infinity();
    if (!(h < largest)) return Size{};
    return Size{h, std::max({h, wish.hmin,
                             2 * std::min(lines.segments[here->in].length,  //
                                          lines.segments[here->out].length)})};
  };
  std::vector<Size> sizes(model.points.size());
  for (std::size_t v = 0; v < sizes.size(); ++v) {
    if (v % 4096 == 0) context.check_limits();
    sizes[v] = size_at(VertexId(v));
  }
  for (std::uint32_t s = 0; s < lines.segments.size(); ++s) {
    const PlaneLines::Segment& segment = lines.segments[s];
    const std::array<Point, 2> p{lines.start(s), lines.end(s)};
    const std::array<Size, 2> at{sizes[segment.ends[0].index()], sizes[segment.ends[1].index()]};
    const double least = std::min(at[0].h, at[1].h);
    if (std::min(at[0].reach, at[1].reach) >= segment.length) {
      add_source(found, simplex(p[0], p[1]), least, wish.hmin, "curvature");
      continue;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (!(at[i].h < largest)) continue;
      const double part = std::min(1.0, at[i].reach / segment.length);
      const Point to = part < 1 ? p[i] + part * (p[1 - i] - p[i]) : p[1 - i];
      add_source(found, simplex(p[i], to), at[i].h, wish.hmin, "curvature");
    }
  }
  return found;
}

}  // namespace delfront
