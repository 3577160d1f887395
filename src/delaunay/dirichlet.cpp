// SPDX-License-Identifier: Apache-2.0
// The dual of the Delaunay tetrahedrization: a vertex a tet (one for all tets on one sphere), a face an edge, with a
// vertex for each tet round it. For a box, eight points far away are added, which make all cells bounded and reach
// nowhere into the box; then the cells are cut at its six sides, one after the other.
#include "delfront/dirichlet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "delaunay/circumcentre.hpp"
#include "delaunay/cut_cells.hpp"
#include "delfront/delaunay.hpp"
#include "delfront/errors.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

namespace {

constexpr std::uint32_t kNone = DirichletCells::kNone;
constexpr double kLargest = 0x1p90;     ///< of what is clipped, so that the far points stay below 2^100
constexpr double kFarAway = 8;          ///< sides of the far cube by diagonals of everything; more than 2 is needed
constexpr double kTolerance = 0x1p-44;  ///< of the box's diagonal: vertices this near to its sides lie on them
constexpr double kThinnest = 0x1p-36;   ///< side of a box by its diagonal
constexpr std::size_t kTetsPerCheck = 1 << 16;

bool is_in_range(Point p) {
  return std::fabs(p.x) <= kLargest && std::fabs(p.y) <= kLargest && std::fabs(p.z) <= kLargest;
}

void check_box(std::span<const Point> points, const Box& box) {
  const Point size = box.high - box.low;
  const double least = kThinnest * length(size);
  if (!is_in_range(box.low) || !is_in_range(box.high) || !(size.x > least && size.y > least && size.z > least))
    throw InputError(fmt::format("the box ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) is empty, flat, or over 2^90",
                                 box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z));
  if (points.empty()) throw InputError("no points: there are no cells");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_in_range(points[i]))
      throw InputError(fmt::format("point {} at ({:g}, {:g}, {:g}) is not finite, or over 2^90", i, points[i].x,
                                   points[i].y, points[i].z),
                       {{points[i], {static_cast<std::uint32_t>(i)}}});
}

/// The points and the corners of a cube round them and the box, so far away that no place in the box is nearer to one
/// of these than to a point.
std::vector<Point> with_far_points(std::span<const Point> points, const Box& box) {
  Box all = box;
  for (const Point& p : points) all.add(p);
  const double reach = kFarAway * all.diagonal();
  std::vector<Point> result(points.begin(), points.end());
  for (int corner = 0; corner < 8; ++corner)
    result.push_back(all.centre() + reach * Point{corner & 1 ? 1. : -1., corner & 2 ? 1. : -1., corner & 4 ? 1. : -1.});
  return result;
}

/// Numbers of the dual's vertices by tet: tets that share a face and a sphere share one.
class Centres {
 public:
  Centres(std::span<const Point> points, const Tetrahedrization& tets, std::vector<Point>& vertices, Context& context)
      : points_(points), tets_(tets), number_(tets.tets.size()) {
    std::iota(number_.begin(), number_.end(), 0u);
    for (std::uint32_t t = 0; t < number_.size(); ++t) {
      if (t % kTetsPerCheck == 0) context.check_limits();
      for (std::size_t i = 0; i < 4; ++i) {
        const std::uint32_t other = tets.neighbours[t][i];
        if (other != kNone && other < t && has_in_sphere(other, t)) join(t, other);
      }
    }
    place(vertices);
  }

  std::uint32_t operator[](std::uint32_t t) const { return number_[t]; }

 private:
  /// Whether the corner of `other` that is not in t lies on t's sphere.
  bool has_in_sphere(std::uint32_t t, std::uint32_t other) const {
    const auto& n = tets_.tets[t];
    const auto& m = tets_.tets[other];
    const std::size_t back = static_cast<std::size_t>(
        std::find(tets_.neighbours[other].begin(), tets_.neighbours[other].end(), t) - tets_.neighbours[other].begin());
    return insphere(points_[n[0]], points_[n[1]], points_[n[2]], points_[n[3]], points_[m[back]]) == 0;
  }

  std::uint32_t root(std::uint32_t t) {
    while (number_[t] != t) t = number_[t] = number_[number_[t]];
    return t;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t ra = root(a), rb = root(b);
    number_[std::max(ra, rb)] = std::min(ra, rb);
  }

  /// The centre of the first tet of each set; then numbers of vertices in place of those of tets.
  void place(std::vector<Point>& vertices) {
    std::vector<std::uint32_t> roots(number_.size());
    for (std::uint32_t t = 0; t < roots.size(); ++t) roots[t] = root(t);
    for (std::uint32_t t = 0; t < roots.size(); ++t) {  // a root is the lowest of its set
      if (roots[t] != t) {
        number_[t] = number_[roots[t]];
        continue;
      }
      number_[t] = static_cast<std::uint32_t>(vertices.size());
      const auto& n = tets_.tets[t];
      vertices.push_back(circumcentre(points_[n[0]], points_[n[1]], points_[n[2]], points_[n[3]]));
    }
  }

  std::span<const Point> points_;
  const Tetrahedrization& tets_;
  std::vector<std::uint32_t> number_;  ///< parents while sets are joined, numbers of vertices then
};

/// Walks once round every edge of the tets.
class Faces {
 public:
  Faces(const Tetrahedrization& tets, const Centres& centres, CellFaces& faces)
      : tets_(tets), centres_(centres), faces_(faces), done_(tets.tets.size(), 0) {}

  /// Edges between points from `num_points` on are left out.
  void add_all(std::uint32_t num_points) {
    for (std::uint32_t t = 0; t < done_.size(); ++t)
      for (unsigned e = 0; e < 6; ++e) {
        const std::uint32_t a = tets_.tets[t][kEdgeNodes[e][0]], b = tets_.tets[t][kEdgeNodes[e][1]];
        if (!(done_[t] >> e & 1) && (a < num_points || b < num_points) && walk_round(t, a, b)) add(a, b);
      }
  }

 private:
  static unsigned place(const std::array<std::uint32_t, 4>& n, std::uint32_t v) {
    return n[0] == v ? 0 : n[1] == v ? 1 : n[2] == v ? 2 : 3;
  }

  /// @return false at the hull: the face is unbounded
  bool walk_round(std::uint32_t first, std::uint32_t a, std::uint32_t b) {
    loop_.clear();
    std::uint32_t t = first;
    do {
      const auto& n = tets_.tets[t];
      const unsigned i = place(n, a), j = place(n, b);
      done_[t] |= static_cast<std::uint8_t>(1u << edge_number(i, j));
      const std::uint32_t vertex = centres_[t];
      if (loop_.empty() || loop_.back() != vertex) loop_.push_back(vertex);
      t = tets_.neighbours[t][kOtherNodes[i][j][0]];
      if (t == kNone) return false;
    } while (t != first);
    if (loop_.size() > 1 && loop_.front() == loop_.back()) loop_.pop_back();
    return true;
  }

  static unsigned edge_number(unsigned i, unsigned j) {
    const unsigned low = std::min(i, j), high = std::max(i, j);
    return low == 0 ? high - 1 : low + high;
  }

  /// Faces with less than three vertices are those of edges inside of a set of cospherical points.
  void add(std::uint32_t a, std::uint32_t b) {
    if (loop_.size() > 2) faces_.add(loop_, {a, b});
  }

  const Tetrahedrization& tets_;
  const Centres& centres_;
  CellFaces& faces_;
  std::vector<std::uint8_t> done_;  ///< by tet, a bit an edge
  std::vector<std::uint32_t> loop_;
};

void drop_unused_vertices(CellFaces& faces) {
  std::vector<std::uint32_t> number(faces.vertices.size(), kNone);
  for (const std::uint32_t v : faces.loops) number[v] = 0;
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    faces.vertices[count] = faces.vertices[v];
    number[v] = count++;
  }
  faces.vertices.resize(count);
  for (std::uint32_t& v : faces.loops) v = number[v];
}

/// Faces by cell, and volumes.
void measure_cells(std::span<const Point> points, DirichletCells& result) {
  result.cell_offsets.assign(points.size() + 1, 0);
  result.volumes.assign(points.size(), 0);
  for (const auto& cells : result.face_cells)
    for (const std::uint32_t cell : cells)
      if (cell != kNone) ++result.cell_offsets[cell + 1];
  std::partial_sum(result.cell_offsets.begin(), result.cell_offsets.end(), result.cell_offsets.begin());
  result.cell_faces.resize(result.cell_offsets.back());
  std::vector<std::uint64_t> next(result.cell_offsets.begin(), result.cell_offsets.end() - 1);
  for (std::uint32_t f = 0; f < result.num_faces(); ++f)
    for (std::size_t side = 0; side < 2; ++side) {
      const std::uint32_t cell = result.face_cells[f][side];
      if (cell == kNone) continue;
      result.cell_faces[next[cell]++] = f;
      const std::span<const std::uint32_t> loop = result.face(f);
      const Point first = result.vertices[loop[0]] - points[cell];
      double six_volumes = 0;
      for (std::size_t k = 1; k + 1 < loop.size(); ++k)
        six_volumes +=
            dot(first, cross(result.vertices[loop[k]] - points[cell], result.vertices[loop[k + 1]] - points[cell]));
      result.volumes[cell] += side == 0 ? six_volumes : -six_volumes;
    }
  for (double& volume : result.volumes) volume /= 6;
}

}  // namespace

DirichletCells dirichlet(std::span<const Point> points, Context& context, const std::optional<Box>& box) {
  std::vector<Point> more;
  if (box) {
    check_box(points, *box);
    more = with_far_points(points, *box);
  }
  const std::span<const Point> all = box ? std::span<const Point>(more) : points;
  Tetrahedrization tets = delaunay(all, context);
  const auto num_points = static_cast<std::uint32_t>(points.size());
  CellFaces faces;
  const Centres centres(all, tets, faces.vertices, context);
  Faces(tets, centres, faces).add_all(num_points);
  DirichletCells result;
  result.is_unbounded.assign(num_points, 0);
  result.duplicates = std::move(tets.duplicates);
  if (box) {
    const double tolerance = kTolerance * box->diagonal();
    for (int axis = 0; axis < 3; ++axis) {
      context.check_limits();
      cut_cells(faces, num_points, axis, 1, box->low[axis], tolerance);
      cut_cells(faces, num_points, axis, -1, box->high[axis], tolerance);
    }
  } else {
    for (const auto& triangle : tets.hull)
      for (const std::uint32_t v : triangle) result.is_unbounded[v] = 1;
  }
  drop_unused_vertices(faces);
  result.vertices = std::move(faces.vertices);
  result.face_offsets = std::move(faces.offsets);
  result.face_vertices = std::move(faces.loops);
  result.face_cells = std::move(faces.cells);
  for (const auto& cells : result.face_cells)
    for (const std::uint32_t cell : cells) DELFRONT_CHECK(cell == kNone || cell < num_points);
  measure_cells(points, result);
  for (std::size_t i = 0; i < num_points; ++i)
    if (result.is_unbounded[i]) result.volumes[i] = std::numeric_limits<double>::infinity();
  return result;
}

Mesh mesh_of(const DirichletCells& cells) {
  Mesh mesh;
  std::vector<VertexId> number(cells.vertices.size());
  const auto use = [&](std::uint32_t v) {
    if (!number[v].is_valid()) {
      number[v] = mesh.points.next_id();
      mesh.points.push_back(cells.vertices[v]);
    }
    return number[v];
  };
  CellBlock& block = mesh.block(CellType::polyhedron);
  block.offsets.assign(1, 0);
  Field point{"point", Field::On::cells, CellType::polyhedron, 1, {}}, volume = point;
  volume.name = "volume";
  for (std::uint32_t cell = 0; cell < cells.num_cells(); ++cell) {
    const std::span<const std::uint32_t> faces = cells.faces_of(cell);
    if (cells.is_unbounded[cell] || faces.empty()) continue;
    block.vertices.push_back(VertexId(faces.size()));
    for (const std::uint32_t f : faces) {
      std::vector<std::uint32_t> loop(cells.face(f).begin(), cells.face(f).end());
      if (cells.face_cells[f][0] != cell) std::reverse(loop.begin(), loop.end());
      block.vertices.push_back(VertexId(loop.size()));
      for (const std::uint32_t v : loop) block.vertices.push_back(use(v));
    }
    block.offsets.push_back(block.vertices.size());
    block.group.push_back(GroupId());
    point.values.push_back(cell);
    volume.values.push_back(cells.volumes[cell]);
  }
  mesh.fields = {std::move(point), std::move(volume)};
  return mesh;
}

}  // namespace delfront
