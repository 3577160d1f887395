// SPDX-License-Identifier: Apache-2.0
#include "geometry_text/build_edge.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "delfront/errors.hpp"
#include "geometry_text/shapes.hpp"

namespace delfront {
namespace {

constexpr double kDegree = std::numbers::pi / 180, kTurn = 2 * std::numbers::pi;
constexpr double kFullTurn = 1e-9;   ///< radians: a range that misses so much is closed
constexpr double kSameEnds = 1e-12;  ///< of the distance from the origin

double angle_of(Point p, const SpaceFrame& frame, const std::array<double, 2>& radii) {
  const Point d = p - frame.origin;
  return std::atan2(dot(d, frame.y) / radii[1], dot(d, frame.x) / radii[0]);
}

/// From corner to corner the positive way round; the whole turn where they are one or there are none.
BuiltCurve build_round(const TextEdge& edge, const Point* from, const Point* to) {
  const SpaceFrame frame = build_frame(edge.frame);
  const std::array<double, 2> radii =
      edge.type == "circle" ? std::array<double, 2>{edge.radius, edge.radius} : edge.radii;
  if (!(radii[0] > 0) || !(radii[1] > 0)) throw InputError("the radius must be above 0");
  BuiltCurve made;
  made.curve = make_ellipse(frame, radii[0], radii[1]);
  double begin = 0, end = kTurn;
  if (edge.range) {
    begin = kDegree * (*edge.range)[0];
    end = kDegree * (*edge.range)[1];
    if (!(begin < end) || end - begin > kTurn + kFullTurn)
      throw InputError("range goes from an angle to a larger one, by 360 degrees at most");
  } else if (from) {
    begin = angle_of(*from, frame, radii);
    end = angle_of(*to, frame, radii);
    if (from == to || *from == *to) end = begin + kTurn;
    while (end <= begin) end += kTurn;
  }
  made.range = {begin, end};
  made.is_closed = end - begin >= kTurn - kFullTurn;
  return made;
}

NurbsCurveData spline_of(int degree, const std::vector<double>& knots, const std::vector<double>& weights,
                         std::vector<Point> points) {
  NurbsCurveData data{degree, knots, std::move(points), weights};
  if (knots.empty() && degree >= 1 && data.points.size() > std::size_t(degree))
    data.knots = even_knots(data.points.size(), degree);
  return data;
}

BuiltCurve build_spline(const TextEdge& edge) {
  const NurbsCurveData data = edge.type == "nurbs" ? spline_of(edge.degree, edge.knots, edge.weights, edge.points)
                                                   : interpolate_points(edge.points, edge.closed);
  BuiltCurve made;
  made.curve = make_nurbs_curve(data);
  made.range = made.curve->range();
  if (edge.range) {
    const auto [low, high] = made.range;
    made.range = *edge.range;
    if (!(made.range[0] < made.range[1]) || made.range[0] < low || made.range[1] > high)
      throw InputError(fmt::format("range must ascend within that of the knots, {:g} to {:g}", low, high));
  }
  const Point a = made.curve->at(made.range[0]), b = made.curve->at(made.range[1]);
  made.is_closed = distance(a, b) <= kSameEnds * (length(a) + length(b)) ||
                   (made.curve->is_closed() && made.range == made.curve->range());
  return made;
}

std::vector<Point> in_space(const std::vector<std::array<double, 2>>& uv) {
  std::vector<Point> points;
  for (const std::array<double, 2>& p : uv) points.push_back({p[0], p[1], 0});
  return points;
}

template <class T>
std::vector<T> flattened(const std::vector<std::vector<T>>& rows, const char* what) {
  std::vector<T> all;
  for (const std::vector<T>& row : rows) {
    if (row.size() != rows[0].size())
      throw InputError(fmt::format("rows of {} must be equally long: the first has {}, another {}", what,
                                   rows[0].size(), row.size()));
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

SurfacePointer build_nurbs(const TextSurface& text) {
  NurbsSurfaceData data;
  data.degree = text.degree;
  data.points = flattened(text.points, "points");
  data.weights = flattened(text.weights, "weights");
  data.count = {text.points.size(), text.points.empty() ? 0 : text.points[0].size()};
  data.knots = {text.knots_u, text.knots_v};
  for (std::size_t k = 0; k < 2; ++k)
    if (data.knots[k].empty() && data.degree[k] >= 1 && data.count[k] > std::size_t(data.degree[k]))
      data.knots[k] = even_knots(data.count[k], data.degree[k]);
  return make_nurbs_surface(data);
}

}  // namespace

ParameterCurvePointer build_uv_curve(const std::vector<std::array<double, 2>>& uv, std::array<double, 2> range) {
  if (uv.size() < 2) throw InputError("uv takes two places [u, v] or more");
  if (uv.size() == 2) return make_parameter_line({uv[0][0], uv[0][1]}, {uv[1][0], uv[1][1]}, range);
  NurbsCurveData data = interpolate_points(in_space(uv));
  for (double& knot : data.knots) knot = (1 - knot) * range[0] + knot * range[1];
  return make_nurbs_parameter_curve(data);
}

BuiltCurve build_curve(const TextEdge& edge, const Point* from, const Point* to,
                       const std::function<SurfacePointer(const std::string&)>& surface) {
  if (edge.type == "circle" || edge.type == "ellipse") return build_round(edge, from, to);
  if (edge.type == "nurbs" || edge.type == "interpolated") return build_spline(edge);
  BuiltCurve made;
  if (edge.type == "on") {
    made.surface = surface(edge.surface);
    made.on_surface = build_uv_curve(edge.uv, made.range);
    const Point a = made.surface->at(made.on_surface->at(0)), b = made.surface->at(made.on_surface->at(1));
    made.is_closed = distance(a, b) <= kSameEnds * (length(a) + length(b));
    made.curve = make_curve_on(made.surface, made.on_surface, made.range, made.is_closed);
    return made;
  }
  if (!from || !to) throw InputError("a line goes from a corner to another: give from and to");
  if (*from == *to) throw InputError("a line needs two ends that differ");
  made.curve = make_line(*from, *to);
  return made;
}

SurfacePointer build_surface(const TextSurface& text) {
  if (text.type == "nurbs") return build_nurbs(text);
  if (text.type == "interpolated")
    return make_nurbs_surface(interpolate_sections(text.sections, text.closed, text.degree_across));
  const SpaceFrame frame = build_frame(text.frame);
  if (text.type == "plane") return make_plane_surface(frame);
  if (text.type == "cone") {
    if (!(text.half_angle > 0 && text.half_angle < 90))
      throw InputError("half_angle is between the axis and the surface: above 0, below 90 degrees");
    return make_cone_surface(frame, kDegree * text.half_angle);
  }
  if (!(text.radius > 0)) throw InputError("radius must be above 0");
  if (text.type == "cylinder") return make_cylinder_surface(frame, text.radius);
  if (text.type == "sphere") return make_sphere_surface(frame, text.radius);
  if (!(text.tube > 0)) throw InputError("tube must be above 0");
  return make_torus_surface(frame, text.radius, text.tube);
}

}  // namespace delfront
