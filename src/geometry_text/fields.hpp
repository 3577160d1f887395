// SPDX-License-Identifier: Apache-2.0
// What each table of a geometry file holds, said once: reading and writing both walk through it.
#pragma once
#include "delfront/geometry_text.hpp"

namespace delfront {

/// A visitor has type(value, allowed), kind(value), required(key, value) and optional(key, value, usual).

template <class Visitor, class Frame>
void visit_frame(Visitor& v, Frame& frame) {
  const TextFrame usual;
  v.optional("origin", frame.origin, usual.origin);
  v.optional("axis", frame.axis, usual.axis);
  v.optional("x", frame.x, usual.x);
}

template <class Visitor, class Corner>
void visit_corner(Visitor& v, Corner& corner) {
  v.required("name", corner.name);
  v.required("at", corner.at);
}

template <class Visitor, class Edge>
void visit_edge(Visitor& v, Edge& edge) {
  const TextEdge usual;
  v.required("name", edge.name);
  v.type(edge.type, {"line", "circle", "ellipse", "nurbs", "interpolated", "on"});
  v.optional("from", edge.from, usual.from);
  v.optional("to", edge.to, usual.to);
  if (edge.type == "circle" || edge.type == "ellipse") {
    visit_frame(v, edge.frame);
    edge.type == "circle" ? v.required("radius", edge.radius) : v.required("radii", edge.radii);
    v.optional("range", edge.range, usual.range);
  } else if (edge.type == "nurbs") {
    v.optional("degree", edge.degree, usual.degree);
    v.optional("knots", edge.knots, usual.knots);
    v.required("points", edge.points);
    v.optional("weights", edge.weights, usual.weights);
    v.optional("range", edge.range, usual.range);
  } else if (edge.type == "interpolated") {
    v.optional("closed", edge.closed, usual.closed);
    v.required("points", edge.points);
  } else if (edge.type == "on") {
    v.required("surface", edge.surface);
    v.required("uv", edge.uv);
  }
}

template <class Visitor, class Surface>
void visit_surface(Visitor& v, Surface& surface) {
  const TextSurface usual;
  v.required("name", surface.name);
  v.type(surface.type, {"plane", "cylinder", "cone", "sphere", "torus", "nurbs", "interpolated"});
  if (surface.type == "nurbs") {
    v.required("degree", surface.degree);
    v.optional("knots_u", surface.knots_u, usual.knots_u);
    v.optional("knots_v", surface.knots_v, usual.knots_v);
    v.required("points", surface.points);
    v.optional("weights", surface.weights, usual.weights);
  } else if (surface.type == "interpolated") {
    v.optional("closed", surface.closed, usual.closed);
    v.optional("degree_across", surface.degree_across, usual.degree_across);
    v.required("sections", surface.sections);
  } else if (!surface.type.empty()) {
    visit_frame(v, surface.frame);
    if (surface.type == "cylinder" || surface.type == "sphere" || surface.type == "torus")
      v.required("radius", surface.radius);
    if (surface.type == "torus") v.required("tube", surface.tube);
    if (surface.type == "cone") v.required("half_angle", surface.half_angle);
  }
}

/// A use that is more than its edge's name.
template <class Visitor, class Use>
void visit_use(Visitor& v, Use& use) {
  const TextUse usual;
  v.optional("uv", use.uv, usual.uv);
  v.optional("degree", use.degree, usual.degree);
  v.optional("knots", use.knots, usual.knots);
  v.optional("points", use.points, usual.points);
  v.optional("weights", use.weights, usual.weights);
}

template <class Visitor, class Face>
void visit_face(Visitor& v, Face& face) {
  const TextFace usual;
  v.optional("name", face.name, usual.name);
  v.kind(face.kind);
  v.required("surface", face.surface);
  v.optional("reversed", face.reversed, usual.reversed);
  v.optional("loops", face.loops, usual.loops);
}

template <class Visitor, class Shape>
void visit_shape(Visitor& v, Shape& shape) {
  const TextShape usual;
  v.type(shape.type, {"sphere", "box", "cylinder", "cone", "torus"});
  v.optional("name", shape.name, usual.name);
  v.kind(shape.kind);
  if (shape.type == "box") {
    v.required("min", shape.min);
    v.required("max", shape.max);
  } else if (!shape.type.empty()) {
    visit_frame(v, shape.frame);
    v.required("radius", shape.radius);
    if (shape.type == "torus") v.required("tube", shape.tube);
    if (shape.type == "cylinder" || shape.type == "cone") v.required("height", shape.height);
  }
  v.optional("reversed", shape.reversed, usual.reversed);
}

}  // namespace delfront
