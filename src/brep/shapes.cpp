// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "delfront/brep_shapes.hpp"
#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kSameSide = 1e-12;  ///< of a period: a rectangle as wide as that is closed

EdgeId add_edge(Brep& brep, const SurfacePointer& surface, Point2 from, Point2 to, std::array<CornerId, 2> ends,
                bool is_degenerate) {
  BrepEdge edge;
  edge.corners = ends;
  if (!is_degenerate) edge.curve = make_curve_on(surface, make_parameter_line(from, to), {0, 1}, ends[0] == ends[1]);
  brep.edges.push_back(edge);
  return EdgeId(brep.edges.size() - 1);
}

/// Corners of a rectangle, anticlockwise from the low one: which of them are one.
std::array<std::size_t, 4> find_same_corners(bool closes_u, bool closes_v, const DegenerateSides& at) {
  std::array<std::size_t, 4> same = {0, 1, 2, 3};
  const auto join = [&](std::size_t a, std::size_t b) {
    const std::size_t from = std::max(same[a], same[b]), to = std::min(same[a], same[b]);
    for (std::size_t& s : same)
      if (s == from) s = to;
  };
  if (closes_u || at.v_low) join(0, 1);
  if (closes_u || at.v_high) join(3, 2);
  if (closes_v || at.u_low) join(0, 3);
  if (closes_v || at.u_high) join(1, 2);
  return same;
}

/// The disk inside a circle edge, in a plane whose axes are those of the circle.
void add_disk(Brep& brep, const SpaceFrame& frame, double radius, EdgeId circle, bool is_reversed, const char* name) {
  BrepFace face;
  face.surface = make_plane_surface(frame);
  face.is_reversed = is_reversed;
  face.name = name;
  // the circle's edge runs once round in t from 0 to 1
  class Circle : public ParameterCurve {
   public:
    explicit Circle(double r) : r_(r) {}
    ParameterCurveDerivatives derivatives(double t) const override {
      const double c = r_ * std::cos(kTurn * t), s = r_ * std::sin(kTurn * t);
      return {{c, s}, {-kTurn * s, kTurn * c}, {-kTurn * kTurn * c, -kTurn * kTurn * s}};
    }

   private:
    double r_;
  };
  face.loops = {{BrepUse{circle, std::make_shared<Circle>(radius), false}}};
  brep.faces.push_back(std::move(face));
}

SpaceFrame lifted(SpaceFrame frame, double height) {
  frame.origin = frame.to_space({0, 0, height});
  return frame;
}

}  // namespace

Brep make_rectangle_on(SurfacePointer surface, ParameterBox rectangle) {
  const auto [low, high] = rectangle;
  const auto [period_u, period_v] = surface->period();
  const double wide = high.x - low.x, tall = high.y - low.y;
  if (!(wide > 0) || !(tall > 0) || (period_u > 0 && wide > period_u * (1 + kSameSide)) ||
      (period_v > 0 && tall > period_v * (1 + kSameSide)))
    throw InputError("the rectangle in the parameter plane has no area, or is wider than a period");
  const bool closes_u = period_u > 0 && wide > period_u * (1 - kSameSide);
  const bool closes_v = period_v > 0 && tall > period_v * (1 - kSameSide);
  DegenerateSides at = surface->degenerate_sides();
  const ParameterBox box = surface->box();
  at.u_low = at.u_low && low.x <= box.low.x;
  at.u_high = at.u_high && high.x >= box.high.x;
  at.v_low = at.v_low && low.y <= box.low.y;
  at.v_high = at.v_high && high.y >= box.high.y;
  const Point2 place[4] = {low, {high.x, low.y}, high, {low.x, high.y}};
  Brep brep;
  std::array<CornerId, 4> corner;
  const std::array<std::size_t, 4> same = find_same_corners(closes_u, closes_v, at);
  for (std::size_t k = 0; k < 4; ++k) {
    corner[k] = same[k] < k ? corner[same[k]] : CornerId(brep.corners.size());
    if (same[k] == k) brep.corners.push_back({surface->at(place[k]), ""});
  }
  const auto edge = [&](std::size_t a, std::size_t b, bool is_degenerate) {
    return add_edge(brep, surface, place[a], place[b], {corner[a], corner[b]}, is_degenerate);
  };
  const EdgeId bottom = edge(0, 1, at.v_low);
  const EdgeId right = edge(1, 2, at.u_high);
  const EdgeId top = closes_v ? bottom : edge(3, 2, at.v_high);
  const EdgeId left = closes_u ? right : edge(0, 3, at.u_low);
  BrepFace face;
  face.surface = std::move(surface);
  face.loops = {{BrepUse{bottom, make_parameter_line(place[0], place[1]), false},
                 BrepUse{right, make_parameter_line(place[1], place[2]), false},
                 BrepUse{top, make_parameter_line(place[3], place[2]), true},
                 BrepUse{left, make_parameter_line(place[0], place[3]), true}}};
  brep.faces.push_back(std::move(face));
  return brep;
}

void cut_hole(Brep& brep, FaceId id, Point2 centre, double a, double b) {
  BrepFace& face = brep.faces[id];
  const ParameterCurvePointer curve = make_parameter_ellipse(centre, a, b);
  BrepEdge edge;
  edge.range = {0, kTurn};
  edge.curve = make_curve_on(face.surface, curve, edge.range, true);
  brep.edges.push_back(std::move(edge));
  face.loops.push_back({BrepUse{EdgeId(brep.edges.size() - 1), curve, true}});
}

Brep make_sphere(Point centre, double radius) {
  SpaceFrame frame;
  frame.origin = centre;
  const SurfacePointer surface = make_sphere_surface(frame, radius);
  return make_rectangle_on(surface, surface->box());
}

Brep make_torus(const SpaceFrame& frame, double radius, double tube) {
  const SurfacePointer surface = make_torus_surface(frame, radius, tube);
  return make_rectangle_on(surface, surface->box());
}

Brep make_cylinder(const SpaceFrame& frame, double radius, double height) {
  Brep brep = make_rectangle_on(make_cylinder_surface(frame, radius), {{0, 0}, {kTurn, height}});
  brep.faces[FaceId(std::size_t(0))].name = "side";
  const auto& loop = brep.faces[FaceId(std::size_t(0))].loops[0];
  const EdgeId bottom = loop[0].edge, top = loop[2].edge;
  add_disk(brep, frame, radius, bottom, true, "bottom");
  add_disk(brep, lifted(frame, height), radius, top, false, "top");
  return brep;
}

Brep make_cone(const SpaceFrame& frame, double half_angle, double height) {
  const double slant = height / std::cos(half_angle);
  Brep brep = make_rectangle_on(make_cone_surface(frame, half_angle), {{0, 0}, {kTurn, slant}});
  BrepFace& side = brep.faces[FaceId(std::size_t(0))];
  side.name = "side";
  brep.corners[brep.edges[side.loops[0][0].edge].corners[0]].name = "tip";
  add_disk(brep, lifted(frame, height), slant * std::sin(half_angle), side.loops[0][2].edge, false, "base");
  return brep;
}

Brep make_bicubic(const std::array<std::array<Point, 4>, 4>& control) {
  const SurfacePointer surface = make_bicubic_surface(control);
  return make_rectangle_on(surface, surface->box());
}

}  // namespace delfront
