// SPDX-License-Identifier: Apache-2.0
#include "planar/smooth.hpp"

#include <cmath>
#include <numbers>

#include "planar/edit.hpp"

namespace delfront {

namespace {

constexpr double kRegular = 0.995;     ///< mean quality of a star that is left alone
constexpr double kSmoothAngle = 0.41;  ///< squared sine of 40 degrees: worse angles are not made
constexpr double kLeastGain = 1e-3;    ///< of a star's mean quality
constexpr std::size_t kVerticesPerCancelCheck = 1 << 16;
constexpr double kRegularHeight = 0.86602540378443865;

class Smoothing {
 public:
  Smoothing(PlanarGrid& grid, const PlanarSmoothOptions& options, Context& context)
      : c_(grid.complex), options_(options), context_(context) {}

  ImproveReport run() {
    report_.min_dihedral_before_deg = smallest_angle_deg();
    make_all_delaunay();
    is_calm_.assign(c_.point.size(), false);
    for (int pass = 0; pass < options_.passes; ++pass) {
      ++report_.passes;
      const std::size_t before = report_.points_moved;
      for (VertexIndex v = options_.first_free; v < c_.point.size(); ++v) {
        if (v % kVerticesPerCancelCheck == 0) context_.progress("smooth", v, c_.point.size(), "points");
        if (c_.vertex_tri[v] != kNoTri && !is_calm_[v]) move(v);
      }
      if (report_.points_moved == before) break;
      make_all_delaunay();
    }
    report_.min_dihedral_after_deg = smallest_angle_deg();
    return report_;
  }

 private:
  struct Star {
    double mean, worst;  ///< quality; squared sine of the smallest angle
  };

  Point2 at(VertexIndex v) const { return c_.point[v]; }

  double smallest_angle_deg() const {
    double worst = 1;
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      const Triangle& s = c_.tri[t];
      if (!c_.is_dead(t) && !c_.is_ghost(t) && s.region != kOutside)
        worst = std::min(worst, squared_sine(at(s.node[0]), at(s.node[1]), at(s.node[2])));
    }
    return std::asin(std::sqrt(worst)) * 180 / std::numbers::pi;
  }

  void make_all_delaunay() {
    edges_.clear();
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      if (c_.is_dead(t) || c_.is_ghost(t) || c_.tri[t].region == kOutside) continue;
      for (unsigned e = 0; e < 3; ++e)
        if (c_.tri[t].neigh[e] > 4 * t + e) edges_.push_back(4 * t + e);
    }
    report_.edge_swaps += make_delaunay(c_, edges_);
  }

  Star measure(Point2 p) const {
    Star star{0, 1};
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Point2 a = ring_[i], b = ring_[i + 1 < ring_.size() ? i + 1 : 0], u = a - p, v = b - p, w = b - a;
      const double area2 = cross(u, v);
      if (!(area2 > 0)) return {-1, 0};
      star.mean += area2 / (squared_length(u) + squared_length(v) + squared_length(w));
      star.worst = std::min(star.worst, squared_sine(p, a, b));
    }
    star.mean *= 4 * kRegularHeight / static_cast<double>(ring_.size());
    return star;
  }

  void move(VertexIndex v) {
    if (!collect(v)) return;
    const Star before = measure(at(v));
    if (before.mean > kRegular) {
      is_calm_[v] = true;
      return;
    }
    Point2 sum{0, 0};
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Point2 a = ring_[i], b = ring_[i + 1 < ring_.size() ? i + 1 : 0], along = b - a;
      sum = sum + 0.5 * (a + b) + kRegularHeight * Point2{-along.y, along.x};
    }
    const Point2 place = (1.0 / static_cast<double>(ring_.size())) * sum, start = at(v);
    const Star after = measure(place);
    if (after.mean < before.mean + kLeastGain || after.worst < std::min(before.worst, kSmoothAngle)) return;
    c_.point[v] = place;
    if (!is_positive()) {
      c_.point[v] = start;
      return;
    }
    ++report_.points_moved;
    for (const TriIndex t : star_)
      for (const VertexIndex w : c_.tri[t].node) is_calm_[w] = false;
  }

  /// The star of a vertex that may move; false for those on segments.
  bool collect(VertexIndex v) {
    if (!collect_star(c_, v, star_, vertices_)) return false;
    ring_.clear();
    for (const VertexIndex w : vertices_) ring_.push_back(at(w));
    for (const TriIndex t : star_) {
      const Triangle& s = c_.tri[t];
      const unsigned i = s.node[0] == v ? 0 : s.node[1] == v ? 1 : 2;
      if (s.flags >> next_of(i) & 1 || s.region == kOutside) return false;
    }
    return true;
  }

  bool is_positive() const {
    for (const TriIndex t : star_) {
      const VertexIndex* n = c_.tri[t].node;
      if (orient2d(at(n[0]), at(n[1]), at(n[2])) <= 0) return false;
    }
    return true;
  }

  TriComplex& c_;
  PlanarSmoothOptions options_;
  Context& context_;
  ImproveReport report_;
  std::vector<bool> is_calm_;  ///< by vertex: regular, and nothing has moved there since
  std::vector<TriIndex> star_;
  std::vector<VertexIndex> vertices_;
  std::vector<Point2> ring_;
  std::vector<EdgeRef> edges_;
};

}  // namespace

ImproveReport smooth_complex(PlanarGrid& grid, const PlanarSmoothOptions& options, Context& context) {
  const StageTimer timer(context, "smooth");
  return Smoothing(grid, options, context).run();
}

}  // namespace delfront
