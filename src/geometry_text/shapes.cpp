// SPDX-License-Identifier: Apache-2.0
#include "geometry_text/shapes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr double kSquare = 1e-6;  ///< cosine between directions that count as square

void need(bool holds, const char* what) {
  if (!holds) throw InputError(what);
}

/// Faces are named by their side of the box; corners run anticlockwise seen from outside.
Brep make_box(Point low, Point high) {
  struct Side {
    const char* name;
    int corner[4];
  };
  // corner number: 1 for high x, 2 for high y, 4 for high z, added
  constexpr Side kSides[6] = {{"x_low", {0, 4, 6, 2}},  {"x_high", {1, 3, 7, 5}}, {"y_low", {0, 1, 5, 4}},
                              {"y_high", {2, 6, 7, 3}}, {"z_low", {0, 2, 3, 1}},  {"z_high", {4, 5, 7, 6}}};
  Brep brep;
  for (int i = 0; i < 8; ++i)
    brep.corners.push_back({{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}, ""});
  std::map<std::pair<int, int>, EdgeId> edges;
  for (const Side& side : kSides) {
    const auto place = [&](int k) { return brep.corners[CornerId(std::size_t(side.corner[k % 4]))].at; };
    const double wide = distance(place(0), place(1)), tall = distance(place(0), place(3));
    SpaceFrame frame;
    frame.origin = place(0);
    frame.x = (place(1) - place(0)) / wide;
    frame.y = (place(3) - place(0)) / tall;
    frame.z = cross(frame.x, frame.y);
    const Point2 uv[5] = {{0, 0}, {wide, 0}, {wide, tall}, {0, tall}, {0, 0}};
    BrepFace face;
    face.surface = make_plane_surface(frame);
    face.name = side.name;
    face.loops.emplace_back();
    for (int k = 0; k < 4; ++k) {
      const int a = side.corner[k], b = side.corner[(k + 1) % 4];
      const auto [it, is_new] = edges.try_emplace(std::minmax(a, b), EdgeId(brep.edges.size()));
      if (is_new) {
        BrepEdge edge;
        edge.corners = {CornerId(std::size_t(a)), CornerId(std::size_t(b))};
        edge.curve = make_line(place(k), place(k + 1));
        brep.edges.push_back(edge);
      }
      const bool is_reversed = brep.edges[it->second].corners[0] != CornerId(std::size_t(a));
      face.loops[0].push_back(
          {it->second, is_reversed ? make_parameter_line(uv[k + 1], uv[k]) : make_parameter_line(uv[k], uv[k + 1]),
           is_reversed});
    }
    brep.faces.push_back(std::move(face));
  }
  return brep;
}

Brep build_faces(const TextShape& shape) {
  if (shape.type == "box") {
    const Point size = shape.max - shape.min;
    need(size.x > 0 && size.y > 0 && size.z > 0, "max must be above min in x, y and z");
    return make_box(shape.min, shape.max);
  }
  const SpaceFrame frame = build_frame(shape.frame);
  need(shape.radius > 0, "radius must be above 0");
  if (shape.type == "sphere") {
    const SurfacePointer surface = make_sphere_surface(frame, shape.radius);
    return make_rectangle_on(surface, surface->box());
  }
  if (shape.type == "torus") {
    need(shape.tube > 0 && shape.tube < shape.radius, "tube must be above 0 and below radius");
    return make_torus(frame, shape.radius, shape.tube);
  }
  need(shape.height > 0, "height must be above 0");
  return shape.type == "cylinder" ? make_cylinder(frame, shape.radius, shape.height)
                                  : make_cone(frame, std::atan2(shape.radius, shape.height), shape.height);
}

}  // namespace

SpaceFrame build_frame(const TextFrame& text) {
  SpaceFrame frame;
  frame.origin = text.origin;
  need(length(text.axis) > 0, "axis has no length");
  frame.z = text.axis / length(text.axis);
  Point x = text.x.value_or(Point{1, 0, 0});
  need(length(x) > 0, "x has no length");
  x = x / length(x);
  if (text.x) need(std::abs(dot(x, frame.z)) < kSquare, "x must be square to axis");
  if (!text.x && std::abs(dot(x, frame.z)) > 0.9) x = {0, 1, 0};
  x = x - dot(x, frame.z) * frame.z;
  frame.x = x / length(x);
  frame.y = cross(frame.z, frame.x);
  return frame;
}

Brep build_shape(const TextShape& shape) {
  Brep brep = build_faces(shape);
  const std::string name = shape.name.empty() ? shape.type : shape.name;
  for (BrepFace& face : brep.faces) {
    face.name = face.name.empty() ? name : fmt::format("{}_{}", name, face.name);
    face.kind = shape.kind;
    face.is_reversed = face.is_reversed != shape.reversed;
  }
  return brep;
}

void append_brep(Brep& to, Brep from) {
  const std::size_t corners = to.corners.size(), edges = to.edges.size();
  for (BrepCorner& corner : from.corners) to.corners.push_back(std::move(corner));
  for (BrepEdge& edge : from.edges) {
    for (CornerId& corner : edge.corners)
      if (corner.is_valid()) corner = CornerId(corners + corner.index());
    to.edges.push_back(std::move(edge));
  }
  for (BrepFace& face : from.faces) {
    for (std::vector<BrepUse>& loop : face.loops)
      for (BrepUse& use : loop) use.edge = EdgeId(edges + use.edge.index());
    to.faces.push_back(std::move(face));
  }
}

}  // namespace delfront
