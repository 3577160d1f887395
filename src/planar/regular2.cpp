// SPDX-License-Identifier: Apache-2.0
// In space, points of a plane and one apex off it have the tets (triangle, apex) for regular tetrahedrization, one for
// each triangle of the regular triangulation in the plane: the apex is in all tets, since the others are flat without
// it, and whether a point of the plane is hidden is decided by the points of the plane alone.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "delfront/delaunay.hpp"
#include "delfront/errors.hpp"
#include "delfront/planar_points.hpp"

namespace delfront {

namespace {

constexpr double kLargest = 0x1p90;
constexpr std::uint32_t kNone = Triangulation2::kNone;

/// The points at z = 0, and the apex above the middle of them.
std::vector<Point> with_apex(std::span<const Point2> points) {
  if (points.size() < 3)
    throw InputError(fmt::format("{} points: a triangulation needs at least three", points.size()));
  std::vector<Point> result;
  result.reserve(points.size() + 1);
  Box box;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point p{points[i].x, points[i].y, 0};
    if (!(std::fabs(p.x) <= kLargest && std::fabs(p.y) <= kLargest))
      throw InputError(fmt::format("point {} at ({:g}, {:g}) is not finite, or over 2^90", i, p.x, p.y),
                       {{p, {static_cast<std::uint32_t>(i)}}});
    box.add(p);
    result.push_back(p);
  }
  const double height = box.longest_side();
  if (height == 0) throw InputError("all points are at one place");
  result.push_back(box.centre() + Point{0, 0, height});
  return result;
}

/// The faces opposite the apex, from above; neighbours over their sides.
void take_triangles(const Tetrahedrization& tets, std::uint32_t apex, Triangulation2& result) {
  static constexpr std::size_t kFace[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};  // seen from the node
  for (std::size_t t = 0; t < tets.tets.size(); ++t) {
    const auto& n = tets.tets[t];
    const auto at = static_cast<std::size_t>(std::find(n.begin(), n.end(), apex) - n.begin());
    DELFRONT_CHECK(at < 4);
    const std::size_t* face = kFace[at];
    result.triangles.push_back({n[face[0]], n[face[1]], n[face[2]]});
    const auto& m = tets.neighbours[t];
    result.neighbours.push_back({m[face[0]], m[face[1]], m[face[2]]});
  }
}

/// The sides without a neighbour, one after the other.
void take_hull(std::size_t num_points, Triangulation2& result) {
  std::vector<std::uint32_t> next(num_points, kNone);
  std::uint32_t first = kNone;
  for (std::size_t t = 0; t < result.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      if (result.neighbours[t][i] == kNone) {
        first = result.triangles[t][(i + 1) % 3];
        next[first] = result.triangles[t][(i + 2) % 3];
      }
  std::uint32_t v = first;
  do {
    result.hull.push_back(v);
    v = next[v];
  } while (v != first);
}

}  // namespace

RegularTriangulation2 regular2(std::span<const Point2> points, std::span<const double> weights, Context& context) {
  const std::vector<Point> in_space = with_apex(points);
  if (weights.size() != points.size())
    throw InputError(fmt::format("{} weights for {} points: give one a point", weights.size(), points.size()));
  std::vector<double> all_weights(weights.begin(), weights.end());
  all_weights.push_back(0);
  Tetrahedrization tets;
  try {
    tets = regular(in_space, all_weights, context);
  } catch (const InputError& error) {
    // With the apex off the plane, no volume means that the points span no plane.
    if (std::string_view(error.what()).find("plane") == std::string_view::npos) throw;
    throw InputError("all points lie on one line: there is nothing to triangulate");
  }
  RegularTriangulation2 result;
  take_triangles(tets, static_cast<std::uint32_t>(points.size()), result.triangulation);
  take_hull(points.size(), result.triangulation);
  result.triangulation.duplicates = std::move(tets.duplicates);
  result.hidden = std::move(tets.hidden);
  return result;
}

}  // namespace delfront
