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

double volume_of(const Box& box) {
  const Point side = box.high - box.low;
  return side.x * side.y * side.z;
}

Box box_of_shape(const TextShape& shape, const std::string& file) {
  GeometryText alone;
  alone.shapes = {shape};
  return box_of(build_brep(alone, file));
}

struct Part {
  Box box;
  bool is_hole = false;
};

/// Shapes each, the other faces together.
void add_parts(const GeometryText& geometry, const std::string& file, std::vector<Part>& parts) {
  for (const TextShape& shape : geometry.shapes) parts.push_back({box_of_shape(shape, file), shape.reversed});
  if (geometry.faces.empty()) return;
  GeometryText faces = geometry;
  faces.shapes.clear();
  parts.push_back({box_of(build_brep(faces, file)), false});
}

/// Whether the innermost part round it is a body.
bool is_in_body(const Box& hole, const std::vector<Part>& parts, std::size_t own) {
  const Part* innermost = nullptr;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (i != own && holds(parts[i].box, hole) && (!innermost || volume_of(parts[i].box) < volume_of(innermost->box)))
      innermost = &parts[i];
  return innermost && !innermost->is_hole;
}

}  // namespace

bool has_holes(const GeometryText& geometry) {
  return std::any_of(geometry.shapes.begin(), geometry.shapes.end(), [](const auto& shape) { return shape.reversed; });
}

void check_holes(const std::vector<NamedGeometry>& files, const std::vector<Box>& bodies) {
  std::vector<Part> parts;
  for (const Box& body : bodies) parts.push_back({body, false});
  std::size_t own = parts.size();
  for (const auto& [geometry, file] : files) add_parts(geometry, file, parts);
  for (const auto& [geometry, file] : files) {
    for (const TextShape& shape : geometry.shapes) {
      const std::size_t number = own++;
      if (!shape.reversed || is_in_body(parts[number].box, parts, number)) continue;
      throw InputError(
          fmt::format("{}:{}: shape{}: it is reversed, a hole, but lies in no body, or not whole; leave out reversed, "
                      "or put a body round it",
                      file, shape.line.number, shape.name.empty() ? "" : " '" + shape.name + "'"));
    }
    own += !geometry.faces.empty();
  }
}

}  // namespace delfront
