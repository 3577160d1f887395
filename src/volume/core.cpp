// SPDX-License-Identifier: Apache-2.0
// Boxes of lattice cells are halved, a level at a time, until they are clear of the boundary and in the plateau of the
// size field, or one cell large, where each point is tried. Boxes are numbered by cells, so the lattice is the same for
// any cut.
#include "volume/core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "base/hilbert.hpp"
#include "base/parallel.hpp"
#include "delaunay/territories.hpp"
#include "delfront/errors.hpp"
#include "spatial/bvh.hpp"

namespace delfront {

namespace {

constexpr double kClearance = 1.0;    ///< sizes between the core and boxes round the boundary: room for a regular layer
constexpr double kMinDistance = 0.7;  ///< sizes to points that are there already
constexpr double kJitter = 1e-4;      ///< of a lattice cell
constexpr double kPlateau = 1 - 1e-9;
constexpr double kWorth = 4;  ///< lattice cells along the longest side; in less there is no core
constexpr std::int64_t kMaxCells = std::int64_t{1} << 20;  ///< a side
constexpr std::size_t kCellsPerPoint = 6;                  ///< tets that a lattice point stands for
constexpr std::size_t kGrain = 1 << 8;                     ///< boxes that a thread takes at a time

/// The side of a lattice cell whose tets have the volume of regular ones of side 1: a^3 / 12 = 1 / (6 sqrt(2)).
const double kCellSide = std::cbrt(std::sqrt(2.0));

/// A cube of lattice cells. `near`: a vertex of the boundary in the neighbourhood.
struct CellBox {
  std::int64_t i, j, k, side;
  VertexIndex near;
};

/// A lattice point by itself, where its cell is not clear of the boundary.
struct Single {
  Point at;
  VertexIndex near;
};

struct Found {
  std::vector<CellBox> clear;  ///< of the boundary: inside or outside as a whole
  std::vector<CellBox> finer;  ///< to be looked at
  std::vector<Single> singles;
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
    std::vector<CellBox> boxes = {{0, 0, 0, side, vertex_of_triangle_[0]}};
    std::vector<Point> points;
    while (!boxes.empty()) {  // large ones first, so that too many points are told early
      context_.check_limits();
      std::vector<Found> found((boxes.size() + kGrain - 1) / kGrain);
      parallel_ranges(context_.threads, boxes.size(), kGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) look_at(boxes[i], found[first / kGrain]);
      });
      boxes.clear();
      for (const Found& f : found) {
        keep_inside(f, points);
        boxes.insert(boxes.end(), f.finer.begin(), f.finer.end());
      }
    }
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

  static void halve(const CellBox& b, VertexIndex near, std::vector<CellBox>& finer) {
    const std::int64_t s = b.side / 2;
    for (int octant = 0; octant < 8; ++octant)
      finer.push_back({b.i + (octant & 1) * s, b.j + (octant >> 1 & 1) * s, b.k + (octant >> 2) * s, s, near});
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

  void look_at(const CellBox& b, Found& found) const {
    const auto i = static_cast<double>(b.i), j = static_cast<double>(b.j), k = static_cast<double>(b.k);
    const auto s = static_cast<double>(b.side);
    const Box box{at(i, j, k), at(i + s, j + s, k + s)};
    if (!box.overlaps(box_)) return;
    const std::uint32_t triangle = find_near(box);
    if (triangle == kNoIndex && size_.lower_bound(box) >= kPlateau * h_) {
      found.clear.push_back(b);
      return;
    }
    const VertexIndex near = triangle == kNoIndex ? b.near : vertex_of_triangle_[triangle];
    if (b.side > 1) {
      halve(b, near, found.finer);
    } else {
      try_point(lattice_point(i, j, k), near, found);
      try_point(lattice_point(i + 0.5, j + 0.5, k + 0.5), near, found);
    }
  }

  void try_point(const Point& p, VertexIndex near, Found& found) const {
    if (find_near({p, p}) != kNoIndex || size_.size(p) < kPlateau * h_) return;
    found.singles.push_back({p, near});
  }

  /// Whether a place lies in a tet that is kept.
  bool is_inside(const Point& p, VertexIndex near) {
    const VertexIndex v = c_.add_vertex(p, h_);
    const TetIndex t = kernel_.locate(v, c_.vertex_tet[near], kMaxSteps);
    c_.remove_last_vertex();
    return t != kNoIndex && !c_.is_ghost(t);
  }

  void keep_inside(const Found& found, std::vector<Point>& points) {
    for (const CellBox& b : found.clear) {
      const double half = static_cast<double>(b.side) / 2;
      const Point centre =
          at(static_cast<double>(b.i) + half, static_cast<double>(b.j) + half, static_cast<double>(b.k) + half);
      if (is_inside(centre, b.near)) add_all(b, points);
    }
    for (const auto& [p, near] : found.singles)
      if (is_inside(p, near)) points.push_back(p);
  }

  void add_all(const CellBox& b, std::vector<Point>& points) const {
    // Before they are made, so that a size far too small ends in a message, not in a lack of memory.
    const auto side = static_cast<std::size_t>(b.side);
    check_num_cells(kCellsPerPoint * (points.size() + 2 * side * side * side));
    for (std::int64_t k = b.k; k < b.k + b.side; ++k)
      for (std::int64_t j = b.j; j < b.j + b.side; ++j)
        for (std::int64_t i = b.i; i < b.i + b.side; ++i) {
          const auto x = static_cast<double>(i), y = static_cast<double>(j), z = static_cast<double>(k);
          points.push_back(lattice_point(x, y, z));
          points.push_back(lattice_point(x + 0.5, y + 0.5, z + 0.5));
        }
  }

  void check_num_cells(std::size_t cells) const {
    if (context_.max_cells > 0 && cells > context_.max_cells)
      throw LimitError(
          fmt::format("stopped: cells of size {:g} are at least {} in number, over the limit of {}; ask for "
                      "larger sizes (--hmax, --growth) or allow more cells (--max-cells)",
                      h_, cells, context_.max_cells));
    if (cells > TetComplex::kMaxSlots)
      throw LimitError(fmt::format("stopped: cells of size {:g} would be more than {} in number; ask for larger ones",
                                   h_, TetComplex::kMaxSlots));
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
