// SPDX-License-Identifier: Apache-2.0
// Distances to shapes (3.1 to 3.9).
//
// Triangles: the nearest place is the foot of the perpendicular where that lies inside (by the contravariant basis),
// else on an edge. Distances are measured to a place on the shape and the least is taken, so that an error of its
// parameters counts by its square only; triangles flatter than 1e-8 are taken for their edges, within rounding the
// same.
#include "sizing/source_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fmt/format.h"
#include "sizing/facet_surface.hpp"

namespace delfront {
namespace {

constexpr double kFlat = 1e-8;

double largest_component(Point v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

double inverse_squared_length(Point v) {
  const double squared = squared_length(v);
  return squared > 0 ? 1 / squared : 0;
}

/// Squared distance of `from` from the segment 0 to `along` (3.1 to 3.4).
double squared_to_segment(Point from, Point along, double inverse) {
  const double xi = std::min(1.0, std::max(0.0, dot(from, along) * inverse));
  return squared_length(from - xi * along);
}

double cos_degrees(double angle) {
  const double turn = std::fmod(std::abs(angle), 360.0);
  if (turn == 90 || turn == 270) return 0;
  if (turn == 0) return 1;
  if (turn == 180) return -1;
  return std::cos(turn * (std::numbers::pi / 180));
}

void fail(const char* what, double value, const char* allowed) {
  throw UsageError(fmt::format("{} = {}: {}", what, value, allowed));
}

void check_point(const char* what, Point p) {
  if (!is_finite(p)) throw UsageError(fmt::format("{} = [{}, {}, {}]: all three must be numbers", what, p.x, p.y, p.z));
}

void check_radius(const char* what, double radius) {
  if (!(radius >= 0 && std::isfinite(radius))) fail(what, radius, "a radius must be a number >= 0");
}

struct CheckShape {
  void operator()(const Simplex& s) const {
    if (s.num_corners < 1 || s.num_corners > 3)
      fail("number of corners", s.num_corners, "a source has 1 (point), 2 (line) or 3 (triangle)");
    for (int i = 0; i < s.num_corners; ++i) check_point("at", s.corner[static_cast<std::size_t>(i)]);
  }
  void operator()(const AlignedBox& b) const {
    check_point("min", b.box.low);
    check_point("max", b.box.high);
    for (int k = 0; k < 3; ++k)
      if (!(b.box.low[k] <= b.box.high[k]))
        throw UsageError(
            fmt::format("box: min {} > max {} along {}; exchange them", b.box.low[k], b.box.high[k], "xyz"[k]));
  }
  void operator()(const SolidSphere& b) const {
    check_point("centre", b.centre);
    check_radius("radius", b.radius);
  }
  void operator()(const Frustum& f) const {
    check_point("from", f.from);
    check_point("to", f.to);
    check_radius("radius_from", f.radius_from);
    check_radius("radius_to", f.radius_to);
    if (f.from == f.to)
      throw UsageError(
          fmt::format("cylinder or cone with from = to = [{}, {}, {}]: it has no axis; move one end "
                      "or take a sphere",
                      f.from.x, f.from.y, f.from.z));
  }
  void operator()(const FacetShape& f) const {
    if (!f.surface) throw UsageError("surface: there is no surface; give a facet file");
  }
};

}  // namespace

void check_shape(const SourceShape& shape) { std::visit(CheckShape{}, shape); }

Point Motion::turned(double time, Point v) const {
  const double size = length(axis);
  const double angle = degrees_rate * time;
  if (!(size > 0) || angle == 0) return v;
  const Point n = axis / size;
  const double c = cos_degrees(angle), s = cos_degrees(angle - 90);
  return c * v + s * cross(n, v) + ((1 - c) * dot(n, v)) * n;
}

Point Motion::at(double time, Point p) const {
  const Point moved = time * velocity;
  if (squared_length(axis) == 0 || degrees_rate * time == 0) return p + moved;
  return centre + turned(time, p - centre) + moved;
}

PlacedShape::PlacedShape(const SourceShape& shape, const Motion& motion, double time) {
  if (const auto* simplex = std::get_if<Simplex>(&shape)) {
    place_simplex(*simplex, motion, time);
    return;
  }
  const Point axes[3] = {motion.turned(time, {1, 0, 0}), motion.turned(time, {0, 1, 0}),
                         motion.turned(time, {0, 0, 1})};
  if (const auto* box = std::get_if<AlignedBox>(&shape)) {
    kind_ = Kind::box;
    at_ = motion.at(time, box->box.centre());
    const Point half = 0.5 * (box->box.high - box->box.low);
    a_ = half.x, b_ = half.y, c_ = half.z;
    u_ = axes[0], v_ = axes[1], w_ = axes[2];
    for (int i = 0; i < 8; ++i)
      box_.add(at_ + ((i & 1) ? a_ : -a_) * u_ + ((i & 2) ? b_ : -b_) * v_ + ((i & 4) ? c_ : -c_) * w_);
    if (axes[0] == Point{1, 0, 0} && axes[1] == Point{0, 1, 0})  // without rounding
      box_ = {motion.at(time, box->box.low), motion.at(time, box->box.high)};
    g_ = box_.low, h_ = box_.high;
  } else if (const auto* ball = std::get_if<SolidSphere>(&shape)) {
    kind_ = Kind::ball;
    at_ = motion.at(time, ball->centre);
    a_ = ball->radius;
    const Point r{a_, a_, a_};
    box_ = {at_ - r, at_ + r};
  } else if (const auto* frustum = std::get_if<Frustum>(&shape)) {
    kind_ = Kind::frustum;
    at_ = motion.at(time, frustum->from);
    const Point to = motion.at(time, frustum->to);
    c_ = delfront::distance(at_, to);
    u_ = (to - at_) / c_;
    a_ = frustum->radius_from, b_ = frustum->radius_to;
    for (int k = 0; k < 3; ++k) {  // a disc of radius r reaches r sqrt(1 - u_k^2) along axis k
      const double side = std::sqrt(std::max(0.0, 1 - u_[k] * u_[k])) * (1 + 1e-12) + 1e-12;
      box_.low[k] = std::min(at_[k] - side * a_, to[k] - side * b_);
      box_.high[k] = std::max(at_[k] + side * a_, to[k] + side * b_);
    }
  } else {
    kind_ = Kind::facets;
    facets_ = std::get<FacetShape>(shape).surface;
    const Box& own = facets_->box();
    at_ = motion.at(time, own.centre());
    g_ = own.centre();
    u_ = axes[0], v_ = axes[1], w_ = axes[2];
    for (int i = 0; i < 8; ++i)
      box_.add(motion.at(time, {(i & 1) ? own.high.x : own.low.x, (i & 2) ? own.high.y : own.low.y,
                                (i & 4) ? own.high.z : own.low.z}));
    a_ = axes[0] == Point{1, 0, 0} && axes[1] == Point{0, 1, 0} && at_ == g_ ? 1 : 0;  // not moved
  }
}

void PlacedShape::place_simplex(const Simplex& simplex, const Motion& motion, double time) {
  const int n = simplex.num_corners;
  Point p[3];
  for (int i = 0; i < n; ++i) box_.add(p[i] = motion.at(time, simplex.corner[static_cast<std::size_t>(i)]));
  at_ = p[0];
  kind_ = n == 1 || (p[1] == p[0] && (n == 2 || p[2] == p[0])) ? Kind::point : n == 2 ? Kind::segment : Kind::triangle;
  if (kind_ == Kind::point) return;
  u_ = p[1] - p[0];
  a_ = inverse_squared_length(u_);
  if (n == 2) return;
  v_ = p[2] - p[0];
  w_ = p[2] - p[1];
  b_ = inverse_squared_length(v_);
  c_ = inverse_squared_length(w_);
  // Contravariant basis (3.7) of the edges in units of the largest, so that no product vanishes.
  const double unit = std::max({largest_component(u_), largest_component(v_), largest_component(w_)});
  const Point u = u_ / unit, v = v_ / unit, normal = cross(u, v);
  const double squared = squared_length(normal);
  if (!(squared > kFlat * kFlat)) return;  // g_ = h_ = 0
  g_ = cross(v, normal) / squared / unit;
  h_ = cross(normal, u) / squared / unit;
}

double PlacedShape::distance_to_triangle(Point q) const {
  double best = squared_to_segment(q, u_, a_);
  const double xi = dot(q, g_), eta = dot(q, h_);
  if (xi > 0 && eta > 0 && xi + eta < 1) {
    const double foot = squared_length(q - xi * u_ - eta * v_);  // (3.9)
    return std::sqrt(std::min(best, foot));
  }
  best = std::min(best, squared_to_segment(q, v_, b_));
  best = std::min(best, squared_to_segment(q - u_, w_, c_));
  return std::sqrt(best);
}

double PlacedShape::distance_to_box(Point p) const {
  Point away;
  if (u_.x == 1 && v_.y == 1 && w_.z == 1) {
    for (int k = 0; k < 3; ++k) away[k] = std::max({g_[k] - p[k], 0.0, p[k] - h_[k]});
  } else {
    const Point q = p - at_;
    away = {std::max(0.0, std::abs(dot(q, u_)) - a_), std::max(0.0, std::abs(dot(q, v_)) - b_),
            std::max(0.0, std::abs(dot(q, w_)) - c_)};
  }
  return length(away);
}

/// In the half plane of the axis: the trapezium (0, 0), (a, 0), (b, c), (0, c).
double PlacedShape::distance_to_frustum(Point q) const {
  const double z = dot(q, u_);
  const double rho = length(q - z * u_);
  const double side_r = b_ - a_;
  const bool is_beside = side_r * z - c_ * (rho - a_) < 0;  // outside of the cone's mantle
  if (z >= 0 && z <= c_ && !is_beside) return 0;
  double best = std::hypot(std::max(0.0, rho - a_), z);
  best = std::min(best, std::hypot(std::max(0.0, rho - b_), z - c_));
  const double t = std::clamp((side_r * (rho - a_) + c_ * z) / (side_r * side_r + c_ * c_), 0.0, 1.0);
  return std::min(best, std::hypot(rho - a_ - t * side_r, z - t * c_));
}

int PlacedShape::corners(Point corner[3]) const {
  corner[0] = at_;
  corner[1] = at_ + u_;
  corner[2] = at_ + v_;
  return kind_ == Kind::point ? 1 : kind_ == Kind::segment ? 2 : kind_ == Kind::triangle ? 3 : 0;
}

double PlacedShape::distance(Point p) const {
  switch (kind_) {
    case Kind::point:
      return length(p - at_);
    case Kind::segment:
      return std::sqrt(squared_to_segment(p - at_, u_, a_));
    case Kind::triangle:
      return distance_to_triangle(p - at_);
    case Kind::box:
      return distance_to_box(p);
    case Kind::ball:
      return std::max(0.0, length(p - at_) - a_);
    case Kind::frustum:
      return distance_to_frustum(p - at_);
    case Kind::facets:
      break;
  }
  if (a_ == 1) return facets_->distance(p);
  const Point q = p - at_;
  return facets_->distance(g_ + Point{dot(q, u_), dot(q, v_), dot(q, w_)});
}

double distance_to(const SourceShape& shape, Point at) {
  check_shape(shape);
  return PlacedShape(shape).distance(at);
}

}  // namespace delfront
