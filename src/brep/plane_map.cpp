// SPDX-License-Identifier: Apache-2.0
#include "brep/plane_map.hpp"

#include <algorithm>
#include <cmath>

namespace delfront {
namespace {

constexpr int kNet = 24;              ///< places each way
constexpr double kLeastCosine = 0.8;  ///< between the surface's normals and the plane's, either way round
constexpr double kWellMapped = 1e-3;  ///< sine between tangents from where normals are looked at
constexpr int kMostSteps = 20, kHalvings = 6;
constexpr double kFound = 1e-12;  ///< of the extent
constexpr double kSteep = 0.3;    ///< cosine under which tangents are taken in the plane

}  // namespace

PlaneMap::PlaneMap(const SmoothSurface& surface, const ParameterBox& box, Point up)
    : surface_(surface), box_(box), up_(up) {
  const Point side = std::abs(up.x) < 0.6 ? Point{1, 0, 0} : Point{0, 1, 0};
  const Point x = cross(side, up);
  x_ = x / length(x);
  y_ = cross(up, x_);
  std::vector<Point> at;
  for (int i = 0; i <= kNet; ++i)
    for (int j = 0; j <= kNet; ++j) {
      const double f = double(i) / kNet, g = double(j) / kNet;
      const Point2 uv = {(1 - f) * box.low.x + f * box.high.x, (1 - g) * box.low.y + g * box.high.y};
      const SurfaceTangents s = surface.tangents(uv);
      const Point n = cross(s.u, s.v);
      const double area = length(n);
      is_flat_ =
          is_flat_ && (area <= kWellMapped * length(s.u) * length(s.v) || std::abs(dot(n, up)) >= kLeastCosine * area);
      at.push_back(s.at);
      if (!(dot(n, up) > 0)) continue;
      net_uv_.push_back(uv);
      net_.push_back({double(at.size() - 1), 0});  // where at has it
    }
  origin_ = at[0];
  double extent = 0;
  for (const Point p : at) extent = std::max({extent, std::abs(dot(p - origin_, x_)), std::abs(dot(p - origin_, y_))});
  if (extent > 0) unit_ = extent;
  for (Point2& place : net_) place = flatten(at[std::size_t(place.x)]);
  is_flat_ = is_flat_ && !net_.empty();
}

Point2 PlaneMap::to_uv(Point2 xy) const {
  const auto squared = [](Point2 a, Point2 b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); };
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < net_.size(); ++i)
    if (squared(net_[i], xy) < squared(net_[nearest], xy)) nearest = i;
  Point2 uv = net_uv_[nearest];
  double best = squared(net_[nearest], xy);
  for (int step = 0; step < kMostSteps && best > kFound * kFound; ++step) {
    const SurfaceTangents s = surface_.tangents(uv);
    const Point2 here = flatten(s.at);
    const double a = dot(s.u, x_), b = dot(s.v, x_), c = dot(s.u, y_), d = dot(s.v, y_), det = a * d - b * c;
    // least squares with a little weight on the step: at a fold the equations have no solution
    const double r = (xy.x - here.x) * unit_, q = (xy.y - here.y) * unit_;
    const double e = a * a + c * c, f = a * b + c * d, g = b * b + d * d;
    const double extra = std::abs(det) > 1e-6 * std::sqrt(e * g) ? 0 : 1e-6 * (e + g);
    const double whole = (e + extra) * (g + extra) - f * f;
    if (!(whole > 0)) break;
    const double p = a * r + c * q, o = b * r + d * q;
    double du = ((g + extra) * p - f * o) / whole, dv = ((e + extra) * o - f * p) / whole;
    bool is_nearer = false;
    for (int k = 0; k < kHalvings && !is_nearer; ++k, du *= 0.5, dv *= 0.5) {
      const Point2 next = {std::clamp(uv.x + du, box_.low.x, box_.high.x),
                           std::clamp(uv.y + dv, box_.low.y, box_.high.y)};
      const double then = squared(to_plane(next), xy);
      is_nearer = then < best;
      if (is_nearer) uv = next, best = then;
    }
    if (!is_nearer) break;
  }
  return uv;
}

PlaneMap::Place PlaneMap::place(Point2 xy) const {
  const Point2 uv = to_uv(xy);
  const SurfaceTangents s = surface_.tangents(uv);
  const Point n = cross(s.u, s.v);
  const double over = dot(n, up_);
  const auto tangent = [&](Point axis) {
    return unit_ * (std::abs(over) > kSteep * length(n) ? axis - dot(n, axis) / over * up_ : axis);
  };
  return {uv, s.at, tangent(x_), tangent(y_)};
}

}  // namespace delfront
