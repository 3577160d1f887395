// SPDX-License-Identifier: Apache-2.0
// Holes have bodies round them, as far as boxes tell.
#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"
#include "delfront/geometry_text.hpp"

namespace delfront {
namespace {

constexpr int kBoxSamples = 16;  ///< each way over a face

/// By samples of its faces, over the boxes of their borders.
Box box_of(const Brep& brep) {
  Box box;
  for (const BrepFace& face : brep.faces) {
    Box uv;
    for (const auto& loop : face.loops)
      for (const BrepUse& use : loop) {
        const auto& range = brep.edges[use.edge].range;
        for (int i = 0; i <= kBoxSamples; ++i) {
          const Point2 p = use.curve->at(range[0] + (range[1] - range[0]) * i / kBoxSamples);
          uv.add(Point{p.x, p.y, 0});
          box.add(face.surface->at(p));
        }
      }
    for (int i = 0; i <= kBoxSamples; ++i)
      for (int j = 0; j <= kBoxSamples; ++j)
        box.add(face.surface->at({uv.low.x + (uv.high.x - uv.low.x) * i / kBoxSamples,
                                  uv.low.y + (uv.high.y - uv.low.y) * j / kBoxSamples}));
  }
  return box;
}

bool holds(const Box& outer, const Box& inner) {
  return inner.low.x >= outer.low.x && inner.low.y >= outer.low.y && inner.low.z >= outer.low.z &&
         inner.high.x <= outer.high.x && inner.high.y <= outer.high.y && inner.high.z <= outer.high.z;
}

/// Of the faces that are in no shape; empty: there are none.
Box box_of_faces(const GeometryText& geometry, const std::string& file) {
  if (geometry.faces.empty()) return {};
  GeometryText faces = geometry;
  faces.shapes.clear();
  return box_of(build_brep(faces, file));
}

Box box_of_shape(const TextShape& shape, const std::string& file) {
  GeometryText alone;
  alone.shapes = {shape};
  return box_of(build_brep(alone, file));
}

}  // namespace

void check_holes(const GeometryText& geometry, const std::string& file) {
  const auto& shapes = geometry.shapes;
  if (std::none_of(shapes.begin(), shapes.end(), [](const TextShape& shape) { return shape.reversed; })) return;
  std::vector<Box> bodies;
  if (const Box faces = box_of_faces(geometry, file); !faces.is_empty()) bodies.push_back(faces);
  for (const TextShape& shape : shapes)
    if (!shape.reversed) bodies.push_back(box_of_shape(shape, file));
  for (const TextShape& shape : shapes) {
    if (!shape.reversed) continue;
    const Box hole = box_of_shape(shape, file);
    if (std::any_of(bodies.begin(), bodies.end(), [&](const Box& body) { return holds(body, hole); })) continue;
    throw InputError(
        fmt::format("{}:{}: shape{}: it is reversed, a hole, but lies in no body; leave out reversed, or put a body "
                    "round it",
                    file, shape.line.number, shape.name.empty() ? "" : " '" + shape.name + "'"));
  }
}

}  // namespace delfront
