// SPDX-License-Identifier: Apache-2.0
// Boxes of lattice cells are halved until they are clear of the boundary and in the plateau of the size field, or one
// cell large, where each point is tried. Boxes are numbered by cells, so the lattice is the same for any cut.
#include "volume/core.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "base/hilbert.hpp"
#include "base/parallel.hpp"
#include "delaunay/territories.hpp"
#include "spatial/bvh.hpp"

namespace delfront {

namespace {

constexpr double kClearance = 1.0;    ///< sizes between the core and boxes round the boundary: room for a regular layer
constexpr double kMinDistance = 0.7;  ///< sizes to points that are there already
constexpr double kJitter = 1e-4;      ///< of a lattice cell
constexpr double kPlateau = 1 - 1e-9;
constexpr double kWorth = 4;  ///< lattice cells along the longest side; in less there is no core
constexpr std::int64_t kMaxCells = std::int64_t{1} << 20;  ///< a side
constexpr int kTaskLevels = 3;                             ///< 8^3 boxes are shared out to threads

/// The side of a lattice cell whose tets have the volume of regular ones of side 1: a^3 / 12 = 1 / (6 sqrt(2)).
const double kCellSide = std::cbrt(std::sqrt(2.0));

struct CellBox {
  std::int64_t i, j, k, side;
};

/// A box of points that is clear of the boundary: inside or outside as a whole. `near`: a vertex of the boundary.
struct Cluster {
  Point centre;
  VertexIndex near;
  std::size_t end;  ///< of the points; the begin is the end of the one before
};

struct Found {
  std::vector<Point> points;
  std::vector<Cluster> clusters;
};

class Core {
 public:
  Core(TetComplex& complex, const SizeField& size, double h, KernelCounts& counts, Context& context)
      : c_(complex), size_(size), h_(h), a_(kCellSide * h), counts_(counts), context_(context) {
    collect_boundary();
  }

  std::size_t fill() {
    const double cells = box_.longest_side() / a_;
    if (!(cells >= kWorth && cells < static_cast<double>(kMaxCells))) return 0;
    const auto side = static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(std::ceil(cells))));
    std::vector<CellBox> tasks = {{0, 0, 0, side}};
    for (int level = 0; level < kTaskLevels && tasks[0].side > 1; ++level) {
      std::vector<CellBox> finer;
      for (const CellBox& box : tasks) for_each_octant(box, [&](const CellBox& octant) { finer.push_back(octant); });
      tasks.swap(finer);
    }
    std::vector<Found> found(tasks.size());
    parallel_for(context_.threads, tasks.size(),
                 [&](std::size_t i) { search(tasks[i], vertex_of_triangle_[0], found[i]); });
    std::vector<Point> points;
    for (const Found& f : found) keep_inside(f, points);
    return insert(points);
  }

 private:
  void collect_boundary() {
    std::vector<Box> triangles;
    for (TetIndex t = 0; t < c_.num_slots(); ++t) {
      if (c_.is_dead(t) || c_.is_ghost(t)) continue;
      for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) {
        if (!c_.is_constrained(ref) || (!c_.is_ghost(c_.neigh[ref] >> 2) && c_.neigh[ref] < ref)) continue;
        const auto n = c_.face_nodes(ref);
        Box box;
        for (const VertexIndex v : n) box.add(c_.point(v));
        box_.add(box);
        triangles.push_back(box);
        vertex_of_triangle_.push_back(n[0]);
      }
    }
    for (const auto& [a, b] : c_.kept_edges.sorted()) {  // in parts, since the box of a slanting edge is large
      const Point from = c_.point(a), to = c_.point(b);
      const double parts = std::clamp(std::ceil(distance(from, to) / h_), 1.0, kMostParts);
      for (double k = 0; k < parts; ++k) {
        Box box;
        box.add(from + (k / parts) * (to - from));
        box.add(from + ((k + 1) / parts) * (to - from));
        triangles.push_back(box);
        vertex_of_triangle_.push_back(a);
      }
    }
    boundary_ = Bvh(triangles);
  }

  template <class Visit>
  static void for_each_octant(const CellBox& b, Visit visit) {
    const std::int64_t s = b.side / 2;
    for (int octant = 0; octant < 8; ++octant)
      visit(CellBox{b.i + (octant & 1) * s, b.j + (octant >> 1 & 1) * s, b.k + (octant >> 2) * s, s});
  }

  Point at(double i, double j, double k) const { return box_.low + Point{a_ * i, a_ * j, a_ * k}; }

  /// A little off the lattice: on it, half of the tests on the way to the full one are ties, which cost exact
  /// arithmetic.
  Point lattice_point(double i, double j, double k) const {
    auto off = [](double x, double y) {
      const double r = 0.7548776662466927 * x + 0.5698402909980532 * y;
      return kJitter * (r - std::floor(r) - 0.5);
    };
    return at(i + off(j, k + 0.3 * i), j + off(k, i + 0.3 * j), k + off(i, j + 0.3 * k));
  }

  /// @return a triangle whose box comes near to this one, or kNoIndex
  std::uint32_t find_near(const Box& box) const {
    const Point reach = kClearance * h_ * Point{1, 1, 1};
    std::uint32_t near = kNoIndex;
    boundary_.for_each_overlap({box.low - reach, box.high + reach}, [&](std::uint32_t t) { near = std::min(near, t); });
    return near;
  }

  /// @param near  a vertex of the boundary in the neighbourhood
  void search(const CellBox& b, VertexIndex near, Found& found) const {
    const auto i = static_cast<double>(b.i), j = static_cast<double>(b.j), k = static_cast<double>(b.k);
    const auto s = static_cast<double>(b.side);
    const Box box{at(i, j, k), at(i + s, j + s, k + s)};
    if (!box.overlaps(box_)) return;
    const std::uint32_t triangle = find_near(box);
    if (triangle == kNoIndex && size_.lower_bound(box) >= kPlateau * h_) {
      add_all(b, found);
      found.clusters.push_back({box.centre(), near, found.points.size()});
      return;
    }
    if (triangle != kNoIndex) near = vertex_of_triangle_[triangle];
    if (b.side > 1) {
      for_each_octant(b, [&](const CellBox& octant) { search(octant, near, found); });
    } else {
      try_point(lattice_point(i, j, k), near, found);
      try_point(lattice_point(i + 0.5, j + 0.5, k + 0.5), near, found);
    }
  }

  void add_all(const CellBox& b, Found& found) const {
    for (std::int64_t k = b.k; k < b.k + b.side; ++k)
      for (std::int64_t j = b.j; j < b.j + b.side; ++j)
        for (std::int64_t i = b.i; i < b.i + b.side; ++i) {
          const auto x = static_cast<double>(i), y = static_cast<double>(j), z = static_cast<double>(k);
          found.points.push_back(lattice_point(x, y, z));
          found.points.push_back(lattice_point(x + 0.5, y + 0.5, z + 0.5));
        }
  }

  void try_point(const Point& p, VertexIndex near, Found& found) const {
    if (find_near({p, p}) != kNoIndex || size_.size(p) < kPlateau * h_) return;
    found.points.push_back(p);
    found.clusters.push_back({p, near, found.points.size()});
  }

  /// Clusters whose centre lies in a tet that is kept.
  void keep_inside(const Found& found, std::vector<Point>& points) {
    std::size_t begin = 0;
    for (const Cluster& cluster : found.clusters) {
      const VertexIndex v = c_.add_vertex(cluster.centre, h_);
      const TetIndex t = kernel_.locate(v, c_.vertex_tet[cluster.near], kMaxSteps);
      c_.remove_last_vertex();
      if (t != kNoIndex && !c_.is_ghost(t))
        points.insert(points.end(), found.points.begin() + static_cast<std::ptrdiff_t>(begin),
                      found.points.begin() + static_cast<std::ptrdiff_t>(cluster.end));
      begin = cluster.end;
    }
  }

  std::size_t insert(const std::vector<Point>& points) {
    std::vector<VertexIndex> vertices;
    for (const std::uint32_t i : hilbert_order(points, context_.threads))
      vertices.push_back(c_.add_vertex(points[i], h_));
    TetIndex start = 0;
    while (start < c_.num_slots() && (c_.is_dead(start) || c_.is_ghost(start))) ++start;
    insert_batch(c_, vertices, {.min_distance = kMinDistance * h_, .constrained = true}, start, counts_, context_);
    std::vector<VertexIndex> refused;
    for (const VertexIndex v : vertices)
      if (c_.vertex_tet[v] == kNoIndex) refused.push_back(v);
    c_.give_vertices(refused);
    return vertices.size() - refused.size();
  }

  static constexpr std::uint64_t kMaxSteps = 1000;
  static constexpr double kMostParts = 1e4;  ///< of a kept edge

  TetComplex& c_;
  const SizeField& size_;
  const double h_, a_;
  KernelCounts& counts_;
  Context& context_;
  DelaunayKernel kernel_{c_};
  Bvh boundary_;
  std::vector<VertexIndex> vertex_of_triangle_;
  Box box_;
};

}  // namespace

std::size_t fill_core(TetComplex& complex, const SizeField& size, KernelCounts& counts, Context& context) {
  const double h = size.largest();
  return std::isfinite(h) ? Core(complex, size, h, counts, context).fill() : 0;
}

}  // namespace delfront
