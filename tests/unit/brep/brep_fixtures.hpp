// SPDX-License-Identifier: Apache-2.0
// Shapes with known topology, sizes, and what must hold of their grids.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "delfront/brep_shapes.hpp"
#include "delfront/surface_check.hpp"

namespace delfront::fixtures {

inline constexpr double kPi = std::numbers::pi;
inline FaceId face_0() { return FaceId(std::size_t(0)); }

/// @brief h on the plane x = from, rising evenly to grading * h at x = to; turned and scaled with a shape.
class LinearSize : public SizeField {
 public:
  LinearSize(double h, double grading, SpaceFrame frame, double from, double to)
      : h_(h), grading_(grading), frame_(frame), from_(from), to_(to) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double f = std::clamp((dot(at[i] - frame_.origin, frame_.x) - from_) / (to_ - from_), 0.0, 1.0);
      size[i] = h_ * (1 + (grading_ - 1) * f);
    }
  }
  double lower_bound(const Box&) const override { return h_; }
  double largest() const override { return h_ * grading_; }

 private:
  double h_, grading_;
  SpaceFrame frame_;
  double from_, to_;
};

/// @brief A bicubic patch with two hills and two hollows about 3 by 3 wide, corners between 60 and 120 degrees.
inline std::array<std::array<Point, 4>, 4> wavy_patch(const SpaceFrame& frame = {}, double scale = 1) {
  std::array<std::array<Point, 4>, 4> b;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      b[i][j] = frame.to_space(scale * Point{double(i) + 0.3 * double(j % 2), double(j) - 0.2 * double(i * i) / 3,
                                             (i + j) % 2 ? 0.5 : -0.3});
  return b;
}

struct Shape {
  std::string name;
  Brep brep;
  double h;          ///< for about 1500 triangles
  double low, high;  ///< x that grading runs over
  long euler;
  bool is_closed;
};

/// @brief Every shape in a frame, times a scale.
inline std::vector<Shape> all_shapes(SpaceFrame frame = {}, double scale = 1) {
  const double s = scale;
  const SurfacePointer sphere = make_sphere_surface(frame, s);
  const ParameterBox whole = sphere->box();
  std::vector<Shape> all;
  all.push_back({"sphere", make_rectangle_on(sphere, whole), 0.14 * s, -s, s, 2, true});
  all.push_back({"torus", make_torus(frame, 2 * s, 0.6 * s), 0.27 * s, -2.6 * s, 2.6 * s, 0, true});
  all.push_back({"cylinder", make_cylinder(frame, s, 3 * s), 0.19 * s, -s, s, 2, true});
  all.push_back({"cone", make_cone(frame, kPi / 6, 2 * s), 0.1 * s, -1.2 * s, 1.2 * s, 2, true});
  all.push_back({"bicubic", make_bicubic(wavy_patch(frame, s)), 0.13 * s, 0, 3.3 * s, 1, false});
  // trimmed: half of a sphere between its poles, a cap round a pole, a part without one, with a hole
  all.push_back({"half sphere", make_rectangle_on(sphere, {{0, -kPi / 2}, {kPi, kPi / 2}}), 0.1 * s, -s, s, 1, false});
  all.push_back({"cap", make_rectangle_on(sphere, {{0, 0.4}, {2 * kPi, kPi / 2}}), 0.07 * s, -s, s, 1, false});
  Brep holed = make_bicubic(wavy_patch(frame, s));
  cut_hole(holed, face_0(), {0.5, 0.45}, 0.2, 0.15);
  all.push_back({"holed bicubic", std::move(holed), 0.13 * s, 0, 3.3 * s, 0, false});
  Brep pierced = make_rectangle_on(sphere, whole);
  cut_hole(pierced, face_0(), {2.5, 0.7}, 0.4, 0.3);
  all.push_back({"pierced sphere", std::move(pierced), 0.14 * s, -s, s, 1, false});
  return all;
}

/// @brief The half of a bicubic patch under its diagonal: trimmed by a curve of its own.
inline Brep half_bicubic() {
  const SurfacePointer surface = make_bicubic_surface(wavy_patch());
  const Point2 corner[3] = {{0, 0}, {1, 0}, {1, 1}};
  Brep brep;
  BrepFace face;
  for (std::size_t k = 0; k < 3; ++k) brep.corners.push_back({surface->at(corner[k]), ""});
  face.loops.emplace_back();
  for (std::size_t k = 0; k < 3; ++k) {
    const ParameterCurvePointer line = make_parameter_line(corner[k], corner[(k + 1) % 3]);
    BrepEdge edge;
    edge.curve = make_curve_on(surface, line, {0, 1});
    edge.corners = {CornerId(k), CornerId((k + 1) % 3)};
    brep.edges.push_back(edge);
    face.loops[0].push_back({EdgeId(k), line, false});
  }
  face.surface = surface;
  brep.faces.push_back(std::move(face));
  return brep;
}

/// A solid of plane faces, each a ring of points, anticlockwise from outside; named face_0, face_1, ...
inline Brep make_polyhedron(const std::vector<Point>& points, const std::vector<std::vector<std::size_t>>& faces) {
  Brep brep;
  for (const Point& p : points) brep.corners.push_back({p, ""});
  std::map<std::pair<std::size_t, std::size_t>, EdgeId> edges;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::vector<std::size_t>& ring = faces[f];
    Point normal;
    for (std::size_t k = 0; k < ring.size(); ++k)
      normal = normal + cross(points[ring[k]] - points[ring[0]], points[ring[(k + 1) % ring.size()]] - points[ring[0]]);
    SpaceFrame frame{points[ring[0]]};
    frame.z = normal / length(normal);
    frame.x = (points[ring[1]] - points[ring[0]]) / distance(points[ring[1]], points[ring[0]]);
    frame.y = cross(frame.z, frame.x);
    const auto flat = [&](std::size_t p) {
      return Point2{dot(points[p] - frame.origin, frame.x), dot(points[p] - frame.origin, frame.y)};
    };
    BrepFace face;
    face.surface = make_plane_surface(frame);
    face.name = "face_" + std::to_string(f);
    face.loops.emplace_back();
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const std::size_t a = ring[k], b = ring[(k + 1) % ring.size()];
      const auto [low, high] = std::minmax({a, b});
      const auto [it, is_new] = edges.try_emplace({low, high}, brep.edges.next_id());
      if (is_new)
        brep.edges.push_back({make_line(points[low], points[high]), {0, 1}, {CornerId(low), CornerId(high)}, ""});
      face.loops[0].push_back({it->second, make_parameter_line(flat(low), flat(high)), a > b});
    }
    brep.faces.push_back(std::move(face));
  }
  return brep;
}

/// Over a polygon, anticlockwise from above: bottom, top, then the sides.
inline Brep make_prism(const std::vector<Point2>& polygon, double height) {
  const std::size_t n = polygon.size();
  std::vector<Point> points;
  for (const Point2 p : polygon) points.push_back({p.x, p.y, 0});
  for (const Point2 p : polygon) points.push_back({p.x, p.y, height});
  std::vector<std::vector<std::size_t>> faces(2);
  for (std::size_t k = 0; k < n; ++k) {
    faces[0].push_back(n - 1 - k);
    faces[1].push_back(n + k);
    faces.push_back({k, (k + 1) % n, n + (k + 1) % n, n + k});
  }
  return make_polyhedron(points, faces);
}

struct Gridded {
  Model model;
  BrepGridReport report;
};

inline Gridded grid(const Brep& brep, const SizeField& size, const BrepOptions& options = {}, int threads = 1) {
  Context context;
  context.threads = threads;
  Gridded made;
  made.model = grid_brep(brep, size, options, made.report, context);
  return made;
}

/// @brief V - E + F, and how many edges have one triangle, or more than two.
struct Topology {
  long euler = 0;
  std::size_t open = 0, crowded = 0;
};

inline Topology topology_of(const Model& m) {
  std::vector<std::pair<VertexId, VertexId>> edges;
  for (const auto& t : m.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  Topology topology;
  long distinct = 0;
  for (std::size_t i = 0, n = 0; i < edges.size(); i += n) {
    for (n = 1; i + n < edges.size() && edges[i + n] == edges[i];) ++n;
    ++distinct;
    topology.open += n == 1;
    topology.crowded += n > 2;
  }
  topology.euler = long(m.points.size()) - distinct + long(m.triangles.size());
  return topology;
}

/// @brief The farthest that a vertex lies from its entity, at the entity's parameters.
inline double farthest_from_entity(const Gridded& made, const Brep& brep) {
  double farthest = 0;
  for (std::size_t v = 0; v < made.model.points.size(); ++v) {
    const VertexEntity& e = made.report.entity[v];
    Point at;
    if (e.dimension == 0) at = brep.corners[CornerId(std::size_t(e.id))].at;
    if (e.dimension == 1) at = brep.edges[EdgeId(std::size_t(e.id))].curve->at(e.u);
    if (e.dimension == 2) at = brep.faces[FaceId(std::size_t(e.id))].surface->at({e.u, e.v});
    farthest = std::max(farthest, distance(at, made.model.points[VertexId(v)]));
  }
  return farthest;
}

/// @brief Smallest angle of triangles that have none of these points, degrees.
inline double smallest_angle(const Model& m, const std::set<VertexId>& without = {}) {
  double least = 180;
  for (const auto& t : m.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      if (without.count(t[0]) + without.count(t[1]) + without.count(t[2]) > 0) break;
      const Point a = m.points[t[k]], u = m.points[t[(k + 1) % 3]] - a, w = m.points[t[(k + 2) % 3]] - a;
      least = std::min(least, std::atan2(length(cross(u, w)), dot(u, w)) * 180 / kPi);
    }
  return least;
}

/// @brief Share of edges between 0.6 and 1.5 of the size at their middle.
inline double share_of_right_lengths(const Model& m, const SizeField& size) {
  std::size_t right = 0, all = 0;
  for (const auto& t : m.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point a = m.points[t[k]], b = m.points[t[(k + 1) % 3]];
      const double ratio = distance(a, b) / size.size(0.5 * (a + b));
      ++all;
      right += ratio >= 0.6 && ratio <= 1.5;
    }
  return double(right) / double(all);
}

/// @brief The least cosine between a triangle and its surface at one of its own points.
inline double worst_agreement(const Gridded& made, const Brep& brep) {
  double least = 1;
  for (std::size_t t = 0; t < made.model.triangles.size(); ++t) {
    const auto& v = made.model.triangles[TriangleId(t)];
    const Point a = made.model.points[v[0]], b = made.model.points[v[1]], c = made.model.points[v[2]];
    const Point n = cross(b - a, c - a);
    for (const VertexId p : v) {
      const VertexEntity& e = made.report.entity[p.index()];
      if (e.dimension != 2) continue;
      const BrepFace& face = brep.faces[FaceId(std::size_t(e.id))];
      const Point m = face.surface->normal({e.u, e.v});
      least = std::min(least, (face.is_reversed ? -1 : 1) * dot(n, m) / length(n));
    }
  }
  return least;
}

}  // namespace delfront::fixtures
