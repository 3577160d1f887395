// SPDX-License-Identifier: Apache-2.0
#include "support/plc_fixtures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "delfront/grid_check.hpp"
#include "delfront/surface_check.hpp"
#include "support/support.hpp"
#include "support/tet_fixtures.hpp"
#include "volume/front.hpp"
#include "volume/to_mesh.hpp"

namespace delfront::fixtures {

void Facets::add(const Facets& other, Point shift, double scale) {
  const std::size_t offset = points.size();
  for (const Point& p : other.points) points.push_back(scale * p + shift);
  for (std::vector<std::size_t> face : other.faces) {
    for (std::size_t& v : face) v += offset;
    faces.push_back(std::move(face));
  }
}

std::size_t Facets::add_point(Point p) {
  points.push_back(p);
  return points.size() - 1;
}

void Facets::turn() {
  for (auto& face : faces) std::reverse(face.begin(), face.end());
}

double Facets::volume() const {
  double sum = 0;
  const Point origin = points.at(0);
  for (const auto& face : faces)
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      sum += dot(points[face[0]] - origin, cross(points[face[k]] - origin, points[face[k + 1]] - origin)) / 6;
  return sum;
}

Facets sphere_facets(int levels) {
  const Mesh mesh = sphere_surface(levels);
  Facets sphere;
  sphere.points.assign(mesh.points.begin(), mesh.points.end());
  const CellBlock& triangles = *mesh.find_block(CellType::triangle);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    sphere.faces.push_back({triangles[t][0].index(), triangles[t][1].index(), triangles[t][2].index()});
  return sphere;
}

Facets box_facets(Point low, Point high) {
  Facets box;
  for (int i = 0; i < 8; ++i)
    box.points.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  box.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  return box;
}

Facets gridded_cube(int n) {
  Facets cube;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          std::vector<std::size_t> face;
          for (const auto& [a, b] : {std::pair{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}) {
            Point p;
            p[axis] = side / double(n);
            p[(axis + 1) % 3] = a / double(n);
            p[(axis + 2) % 3] = b / double(n);
            face.push_back(cube.add_point(p));
          }
          if (side == 0) std::reverse(face.begin(), face.end());
          cube.faces.push_back(face);
        }
  return cube;
}

Facets fan_box(int n) {
  Facets box;
  box.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}};
  const std::size_t first = box.points.size();
  for (int i = 0; i <= n; ++i) box.points.push_back({1, double(i) / n, 1});
  const std::size_t last = first + static_cast<std::size_t>(n);
  box.faces = {{0, 3, 2, 1}, {0, 4, 5, 3}, {0, 1, first, 4}, {3, 5, last, 2}, {4, last, 5}};
  std::vector<std::size_t> side = {2};
  for (std::size_t i = first; i < last; ++i) box.faces.push_back({4, i, i + 1});
  for (std::size_t i = last + 1; i-- > first;) side.push_back(i);
  side.push_back(1);
  box.faces.push_back(side);
  return box;
}

Facets tetrahedron_facets(Point a, Point b, Point c, Point d) {
  return {{a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

Facets schoenhardt(double degrees, double height) {
  Facets prism;
  for (int top = 0; top < 2; ++top)
    for (int k = 0; k < 3; ++k) {
      const double angle = (120.0 * k + top * degrees) * std::numbers::pi / 180;
      prism.points.push_back({std::cos(angle), std::sin(angle), top * height});
    }
  prism.faces = {{0, 2, 1}, {3, 4, 5}};
  for (std::size_t k = 0; k < 3; ++k) {  // the longer diagonal, k below to k + 1 above: it bends inwards
    const std::size_t next = (k + 1) % 3;
    prism.faces.push_back({k, next, 3 + next});
    prism.faces.push_back({k, 3 + next, 3 + k});
  }
  return prism;
}

Facets chazelle(int n, double gap) {
  Facets body;
  const double side = n + 1, low = -1, high = side * side + 1, half = 0.05;
  auto vertex = [&](double x, double y, double z) {
    body.points.push_back({x, y, z});
    return body.points.size() - 1;
  };
  // chain[0][e]: along x at y = 0 and y = side, from below; chain[1][e]: along y at x = 0 and x = side, from above.
  std::vector<std::size_t> chain[2][2];
  for (int from_above = 0; from_above < 2; ++from_above)
    for (int end = 0; end < 2; ++end) {
      const double across = end * side, base = from_above ? high : low;
      auto add = [&](double along, double z) {
        chain[from_above][end].push_back(from_above ? vertex(across, along, z) : vertex(along, across, z));
      };
      add(0, base);
      for (int i = 1; i <= n; ++i) {
        add(i - half, base);
        add(i, i * across + (from_above ? gap : 0));
        add(i + half, base);
      }
      add(side, base);
    }
  auto strips = [&](const std::vector<std::size_t>& p, const std::vector<std::size_t>& q, bool turned) {
    for (std::size_t i = 0; i + 1 < p.size(); ++i)
      for (std::vector<std::size_t> f : {std::vector{p[i], q[i], q[i + 1]}, std::vector{p[i], q[i + 1], p[i + 1]}}) {
        if (turned) std::reverse(f.begin(), f.end());
        body.faces.push_back(f);
      }
  };
  strips(chain[0][0], chain[0][1], false);  // the bottom, normal down
  strips(chain[1][0], chain[1][1], false);  // the top, normal up
  auto joined = [](std::vector<std::size_t> one, const std::vector<std::size_t>& other) {
    one.insert(one.end(), other.begin(), other.end());
    return one;
  };
  auto reversed = [](std::vector<std::size_t> face) {
    std::reverse(face.begin(), face.end());
    return face;
  };
  const auto &left = chain[1][0], &right = chain[1][1], &front = chain[0][0], &back = chain[0][1];
  body.faces.push_back(joined(front, {right.front(), left.front()}));          // y = 0
  body.faces.push_back(reversed(joined(back, {right.back(), left.back()})));   // y = side
  body.faces.push_back(joined(left, {back.front(), front.front()}));           // x = 0
  body.faces.push_back(reversed(joined(right, {back.back(), front.back()})));  // x = side
  return body;
}

Model to_model(const Facets& facets) {
  Mesh mesh;
  for (const Point& p : facets.points) mesh.points.push_back(p);
  CellBlock& block = mesh.block(CellType::polygon);
  block.offsets.assign(1, 0);
  for (const auto& face : facets.faces) {
    for (const std::size_t v : face) block.vertices.push_back(VertexId(v));
    block.offsets.push_back(block.vertices.size());
  }
  for (const auto& curve : facets.curves)
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
      CellBlock& lines = mesh.block(CellType::line);
      lines.vertices.insert(lines.vertices.end(), {VertexId(curve[i]), VertexId(curve[i + 1])});
      lines.group.push_back(mesh.add_group(1, "wire"));
    }
  for (const std::size_t v : facets.corners) {
    CellBlock& corners = mesh.block(CellType::vertex);
    corners.vertices.push_back(VertexId(v));
    corners.group.push_back(mesh.add_group(0, "probe"));
  }
  Context context;
  return build_model({{std::move(mesh), "body"}}, context);
}

namespace {

using Face = std::array<VertexIndex, 3>;

void expect_valid_surface(const Model& model) {
  Context context;
  const SurfaceReport surface = check_surface(model, context);
  EXPECT_TRUE(surface.can_bound_volume) << "the test's own surface is not valid";
  for (const Finding& f : surface.findings) EXPECT_NE(f.severity, Severity::error) << f.message;
}

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// The constrained faces are the model's triangles, one to one; parts of triangles only where `split` names some.
void expect_same_boundary(const Model& model, const BoundaryGrid& grid, bool all_triangles) {
  std::set<Face> split, whole;
  for (const SplitTriangle& s : grid.split) {
    const auto& c = model.triangles[s.triangle];
    split.insert(sorted({c[0].value, c[1].value, c[2].value}));
  }
  for (const auto& c : model.triangles)
    if (const Face face = sorted({c[0].value, c[1].value, c[2].value}); !split.contains(face)) whole.insert(face);
  std::size_t found = 0, parts = 0;
  for (const Face& face : constrained_faces(grid.complex)) ++(whole.contains(face) ? found : parts);
  EXPECT_EQ(parts > 0, !split.empty()) << parts << " faces that are no triangles of the surface";
  if (all_triangles) {
    EXPECT_EQ(found, whole.size()) << "triangles of the surface are not there";
  }
  EXPECT_GT(found + parts, 0u);
}

/// Curves are chains of edges from vertex to vertex, nearly straight, with no points between but those reported.
void expect_curves(const Model& model, const BoundaryGrid& grid, const RecoveryReport& report) {
  ASSERT_EQ(grid.curve_pieces.size(), model.curves.size());
  const TetComplex& c = grid.complex;
  std::vector<TetIndex> scratch;
  std::set<VertexIndex> left;
  for (const Place& place : report.left) left.insert(place.ids.begin(), place.ids.end());
  std::size_t edges = 0, split = 0, points = 0;
  for (std::size_t i = 0; i < model.curves.size(); ++i) {
    const std::vector<VertexId>& vertices = model.curves[CurveId(i)].vertices;
    std::size_t step = 0;
    bool is_split = false;
    for (const auto& [a, b] : grid.curve_pieces[i]) {
      EXPECT_NE(c.find_edge(a, b, scratch), kNoIndex) << "an edge of a curve is not there";
      EXPECT_TRUE(c.on_boundary[a] && c.on_boundary[b]);
      if (a < model.points.size()) {
        while (step + 1 < vertices.size() && vertices[step].value != a) ++step;
        EXPECT_EQ(vertices[step].value, a) << "a curve jumps";
      }
      const Point from = model.points[vertices[step]], to = model.points[vertices[step + 1]];
      EXPECT_LE(length(cross(c.point(b) - from, to - from)), 1e-14 * squared_length(to - from) + 1e-15 * length(from));
      if (b >= model.points.size()) {
        EXPECT_TRUE(left.contains(b)) << "a point on a curve is not reported";
        is_split = true;
        ++points;
        continue;
      }
      EXPECT_EQ(b, vertices[step + 1].value);
      ++edges;
      split += is_split ? 1 : 0;
      is_split = false;
    }
  }
  EXPECT_EQ(report.curve_edges, edges);
  EXPECT_EQ(report.curve_edges_split, split);
  EXPECT_LE(report.curve_points_left, points);
  for (const VertexId v : model.corners)
    if (c.vertex_tet[v.value] != kNoIndex) {
      EXPECT_EQ(c.point(v.value), model.points[v]);
      EXPECT_EQ(c.on_boundary[v.value], 1);
    }
}

}  // namespace

constexpr std::size_t kMostForFront = 600;  ///< triangles of a model

Recovered expect_recovered(const Model& model, double volume, const DomainOptions& domain) {
  expect_valid_surface(model);
  Recovered result;
  Context context;
  std::vector<bool> is_far_field;
  for (const Patch& patch : model.patches) is_far_field.push_back(patch.kind == "farfield");
  result.grid = tetrahedralize_boundary(model, domain, is_far_field, result.report, context);
  EXPECT_EQ(result.grid.complex.find_defect(), "");
  EXPECT_TRUE(result.grid.complex.segment_points.empty());
  EXPECT_EQ(result.report.left.size(), result.report.steiner_left + result.report.curve_points_left);
  EXPECT_LE(result.report.steiner_moved + result.report.left.size(), result.report.steiner_points);
  EXPECT_EQ(result.grid.split.empty(), result.report.steiner_left == 0);
  expect_same_boundary(model, result.grid, domain.keep.empty() && domain.keep_points.empty());
  expect_curves(model, result.grid, result.report);
  result.volume = total_volume(result.grid.complex);
  const Box box = model.bounding_box();
  const Point size = box.high - box.low;
  // Sums of tets run from one corner each: they round with the model's size and its distance from the origin.
  const double largest = std::max(length(box.low), length(box.high));
  const double tolerance = 1e-11 * std::max(size.x * size.y * size.z, 1e-30) +
                           1e-14 * largest * (size.x * size.y + size.y * size.z + size.z * size.x);
  if (!std::isnan(volume)) EXPECT_NEAR(result.volume, volume, tolerance);
  result.mesh = to_mesh(result.grid, model);
  for (const Finding& f : check(result.mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
  if (model.triangles.size() <= kMostForFront) {
    const auto r = expect_filled_by_front(model, result.grid, domain);
    EXPECT_NEAR(total_volume(r.grid.complex), result.volume, tolerance);
  }
  return result;
}

FilledByFront expect_filled_by_front(const Model& model, const BoundaryGrid& empty, const DomainOptions& domain,
                                     int threads) {
  FilledByFront result{empty, {}};
  Context context;
  context.threads = threads;
  BoundarySizes sizes;
  for (const TetVertex& v : empty.complex.vertex)
    if (v.h > 0) sizes.points.push_back(v.point()), sizes.size.push_back(v.h);
  const auto field = build_boundary_size_field(sizes, context);
  result.report = fill_by_front(result.grid, *field, context);
  EXPECT_EQ(result.grid.complex.find_defect(), "");
  std::vector<TetIndex> scratch;
  for (const auto& pieces : result.grid.curve_pieces)
    for (const auto& [a, b] : pieces)
      EXPECT_NE(result.grid.complex.find_edge(a, b, scratch), kNoIndex) << "an edge of a curve is not there";
  expect_same_boundary(model, result.grid, domain.keep.empty() && domain.keep_points.empty());
  for (const Finding& f : check(to_mesh(result.grid, model))) EXPECT_NE(f.severity, Severity::error) << f.message;
  return result;
}

Recovered expect_recovered(const Facets& facets, double volume, const DomainOptions& domain) {
  return expect_recovered(to_model(facets), volume, domain);
}

}  // namespace delfront::fixtures
