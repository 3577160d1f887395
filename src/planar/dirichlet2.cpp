// SPDX-License-Identifier: Apache-2.0
// As dirichlet.cpp in space: a vertex a triangle, one for all triangles on one circle; for a box four points far away
// make all cells bounded, and the cells are cut at its four sides.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "delaunay/circumcentre.hpp"
#include "delfront/errors.hpp"
#include "delfront/planar_points.hpp"
#include "predicates/predicates.hpp"

namespace delfront {

namespace {

constexpr std::uint32_t kNone = DirichletCells2::kNone;
constexpr double kLargest = 0x1p90;     ///< of what is clipped, so that the far points stay below 2^100
constexpr double kFarAway = 8;          ///< half sides of the far square by diagonals of everything; over 2 are needed
constexpr double kTolerance = 0x1p-44;  ///< of the box's diagonal: vertices this near to its sides lie on them
constexpr double kThinnest = 0x1p-36;   ///< side of a box by its diagonal

bool is_in_range(Point2 p) { return std::fabs(p.x) <= kLargest && std::fabs(p.y) <= kLargest; }
double diagonal(const Box2& box) { return std::hypot(box.high.x - box.low.x, box.high.y - box.low.y); }

void check_box(std::span<const Point2> points, const Box2& box) {
  const double least = kThinnest * diagonal(box);
  if (!is_in_range(box.low) || !is_in_range(box.high) || !(box.high.x - box.low.x > least) ||
      !(box.high.y - box.low.y > least))
    throw InputError(fmt::format("the box ({:g}, {:g}) to ({:g}, {:g}) is empty, flat, or over 2^90", box.low.x,
                                 box.low.y, box.high.x, box.high.y));
  if (points.empty()) throw InputError("no points: there are no cells");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_in_range(points[i]))
      throw InputError(fmt::format("point {} at ({:g}, {:g}) is not finite, or over 2^90", i, points[i].x, points[i].y),
                       {{{points[i].x, points[i].y, 0}, {static_cast<std::uint32_t>(i)}}});
}

std::vector<Point2> with_far_points(std::span<const Point2> points, const Box2& box) {
  Box2 all = box;
  for (const Point2& p : points) {
    all.low = {std::min(all.low.x, p.x), std::min(all.low.y, p.y)};
    all.high = {std::max(all.high.x, p.x), std::max(all.high.y, p.y)};
  }
  const double reach = kFarAway * diagonal(all);
  const Point2 centre{0.5 * (all.low.x + all.high.x), 0.5 * (all.low.y + all.high.y)};
  std::vector<Point2> result(points.begin(), points.end());
  for (int corner = 0; corner < 4; ++corner)
    result.push_back({centre.x + (corner & 1 ? reach : -reach), centre.y + (corner & 2 ? reach : -reach)});
  return result;
}

/// By triangle, the number of its circumcentre: neighbours on one circle share it.
std::vector<std::uint32_t> number_centres(std::span<const Point2> points, const Triangulation2& mesh,
                                          std::vector<Point2>& vertices) {
  std::vector<std::uint32_t> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  for (std::uint32_t t = 0; t < parent.size(); ++t)
    for (const std::uint32_t other : mesh.neighbours[t]) {
      if (other == kNone || other > t) continue;
      const auto& back = mesh.neighbours[other];
      const auto at = static_cast<std::size_t>(std::find(back.begin(), back.end(), t) - back.begin());
      const auto& n = mesh.triangles[t];
      if (incircle(&points[n[0]].x, &points[n[1]].x, &points[n[2]].x, &points[mesh.triangles[other][at]].x) != 0)
        continue;
      const std::uint32_t a = root(t), b = root(other);
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::uint32_t> number(parent.size());
  for (std::uint32_t t = 0; t < parent.size(); ++t) {
    const std::uint32_t first = root(t);
    if (first != t) {
      number[t] = number[first];
      continue;
    }
    const auto& n = mesh.triangles[t];
    const Point2 &a = points[n[0]], &b = points[n[1]], &c = points[n[2]];
    const auto centre = circumcentre2({a.x, a.y}, {b.x, b.y}, {c.x, c.y});
    number[t] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back({centre[0], centre[1]});
  }
  return number;
}

/// A cell in the making: its vertices, and the points across the sides that start there.
struct Loop {
  std::vector<std::uint32_t> vertices, across;
  void clear() {
    vertices.clear();
    across.clear();
  }
  void add(std::uint32_t vertex, std::uint32_t point) {
    vertices.push_back(vertex);
    across.push_back(point);
  }
};

/// Anticlockwise round point v, from triangle `first`. @return false at the hull
bool walk_round(const Triangulation2& mesh, const std::vector<std::uint32_t>& centre, std::uint32_t v,
                std::uint32_t first, Loop& loop) {
  loop.clear();
  std::uint32_t t = first;
  do {
    const auto& n = mesh.triangles[t];
    const std::size_t i = n[0] == v ? 0 : n[1] == v ? 1 : 2;
    const std::uint32_t across = n[(i + 2) % 3];
    if (!loop.vertices.empty() && loop.vertices.back() == centre[t])
      loop.across.back() = across;  // the side between had no length
    else
      loop.add(centre[t], across);
    t = mesh.neighbours[t][(i + 1) % 3];
    if (t == kNone) return false;
  } while (t != first);
  if (loop.vertices.size() > 1 && loop.vertices.front() == loop.vertices.back()) {
    loop.vertices.pop_back();
    loop.across.pop_back();
  }
  return true;
}

/// Cuts polygons at one side of the box after the other; cut sides get one new vertex, whichever cell asks.
class Clipper {
 public:
  Clipper(const Box2& box, std::vector<Point2>& vertices)
      : vertices_(vertices),
        tolerance_(kTolerance * diagonal(box)),
        planes_{{0, 1, box.low.x}, {0, -1, box.high.x}, {1, 1, box.low.y}, {1, -1, box.high.y}} {
    for (Point2& p : vertices_)
      for (const Plane& plane : planes_) snap(plane, p);
  }

  void clip(Loop& loop) {
    for (std::size_t i = 0; i < 4 && !loop.vertices.empty(); ++i) cut(i, loop);
  }

 private:
  struct Plane {
    int axis, direction;
    double value;
  };

  static double& along(const Plane& plane, Point2& p) { return plane.axis == 0 ? p.x : p.y; }
  void snap(const Plane& plane, Point2& p) const {
    double& x = along(plane, p);
    if (std::fabs(x - plane.value) <= tolerance_) x = plane.value;
  }
  int side(const Plane& plane, std::uint32_t v) {
    const double height = plane.direction * (along(plane, vertices_[v]) - plane.value);
    return height > 0 ? 1 : height < 0 ? -1 : 0;
  }

  void cut(std::size_t number, Loop& loop) {
    const Plane& plane = planes_[number];
    kept_.clear();
    bool has_above = false;
    const std::size_t n = loop.vertices.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t v = loop.vertices[i], w = loop.vertices[i + 1 < n ? i + 1 : 0];
      const int from = side(plane, v), to = side(plane, w);
      has_above |= from > 0;
      if (from > 0) kept_.add(v, loop.across[i]);
      if (from == 0) kept_.add(v, to > 0 ? loop.across[i] : kNone);
      if (from * to < 0) kept_.add(vertex_between(number, v, w), to > 0 ? loop.across[i] : kNone);
    }
    if (!has_above) kept_.clear();
    std::swap(loop, kept_);
  }

  std::uint32_t vertex_between(std::size_t number, std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto next = static_cast<std::uint32_t>(vertices_.size());
    const auto [found, is_new] = made_[number].insert({std::uint64_t{a} << 32 | b, next});
    if (!is_new) return found->second;
    const Plane& plane = planes_[number];
    Point2 p = vertices_[a], q = vertices_[b];
    const double t = (plane.value - along(plane, p)) / (along(plane, q) - along(plane, p));
    Point2 at{p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
    for (const Plane& other : planes_) snap(other, at);
    along(plane, at) = plane.value;
    vertices_.push_back(at);
    return next;
  }

  std::vector<Point2>& vertices_;
  double tolerance_;
  Plane planes_[4];
  std::unordered_map<std::uint64_t, std::uint32_t> made_[4];
  Loop kept_;
};

double area_of(const DirichletCells2& cells, std::size_t i, Point2 origin) {
  const auto loop = cells.cell(i);
  double twice = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Point2 &p = cells.vertices[loop[k]], &q = cells.vertices[loop[k + 1 < loop.size() ? k + 1 : 0]];
    twice += (p.x - origin.x) * (q.y - origin.y) - (q.x - origin.x) * (p.y - origin.y);
  }
  return twice / 2;
}

void drop_unused_vertices(DirichletCells2& cells) {
  std::vector<std::uint32_t> number(cells.vertices.size(), kNone);
  for (const std::uint32_t v : cells.cell_vertices) number[v] = 0;
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    cells.vertices[count] = cells.vertices[v];
    number[v] = count++;
  }
  cells.vertices.resize(count);
  for (std::uint32_t& v : cells.cell_vertices) v = number[v];
}

}  // namespace

DirichletCells2 dirichlet2(std::span<const Point2> points, Context& context, const std::optional<Box2>& box) {
  std::vector<Point2> more;
  if (box) {
    check_box(points, *box);
    more = with_far_points(points, *box);
  }
  const std::span<const Point2> all = box ? std::span<const Point2>(more) : points;
  Triangulation2 mesh = delaunay2(all, context);
  DirichletCells2 result;
  const std::vector<std::uint32_t> centre = number_centres(all, mesh, result.vertices);
  std::optional<Clipper> clipper;
  if (box) clipper.emplace(*box, result.vertices);
  std::vector<std::uint32_t> triangle_at(all.size(), kNone);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) triangle_at[v] = t;
  result.cell_offsets.assign(1, 0);
  Loop loop;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    const bool is_used = triangle_at[v] != kNone;
    const bool is_closed = is_used && walk_round(mesh, centre, v, triangle_at[v], loop);
    if (!is_closed) loop.clear();
    if (clipper) clipper->clip(loop);
    result.cell_vertices.insert(result.cell_vertices.end(), loop.vertices.begin(), loop.vertices.end());
    result.cell_neighbours.insert(result.cell_neighbours.end(), loop.across.begin(), loop.across.end());
    result.cell_offsets.push_back(result.cell_vertices.size());
    result.is_unbounded.push_back(is_used && !is_closed);
    result.areas.push_back(is_used && !is_closed ? std::numeric_limits<double>::infinity()
                                                 : area_of(result, v, points[v]));
  }
  drop_unused_vertices(result);
  result.duplicates = std::move(mesh.duplicates);
  return result;
}

Mesh mesh_of(const DirichletCells2& cells) {
  Mesh mesh;
  mesh.dimension = 2;
  for (const Point2& p : cells.vertices) mesh.points.push_back({p.x, p.y, 0});
  CellBlock& block = mesh.block(CellType::polygon);
  block.offsets.assign(1, 0);
  Field point{"point", Field::On::cells, CellType::polygon, 1, {}}, area = point;
  area.name = "area";
  for (std::uint32_t i = 0; i < cells.num_cells(); ++i) {
    if (cells.cell(i).empty()) continue;
    for (const std::uint32_t v : cells.cell(i)) block.vertices.push_back(VertexId(v));
    block.offsets.push_back(block.vertices.size());
    block.group.push_back(GroupId());
    point.values.push_back(i);
    area.values.push_back(cells.areas[i]);
  }
  mesh.fields = {std::move(point), std::move(area)};
  return mesh;
}

}  // namespace delfront
