// SPDX-License-Identifier: Apache-2.0
// Passes over the triangles below the goal. Each tries, until something raises the smallest angle of what it touches:
// moving a corner, inserting a point in its cavity, taking a corner away. What changed is looked at again, and the
// edges around it are made Delaunay by flips, which never lower the smallest angle either.
#include "planar/improve.hpp"

#include <cmath>
#include <numbers>

#include "planar/edit.hpp"
#include "planar/kernel.hpp"

namespace delfront {

namespace {

constexpr double kGain = 1.0001;  ///< of the squared sine: smaller gains are none
constexpr double kNearest = 0.4;  ///< of the size: no point is put nearer to another
constexpr std::size_t kLargestStar = 24;
constexpr std::size_t kTrianglesPerCancelCheck = 4096;
constexpr int kSearchSteps = 6;

double angle_deg(double squared_sine_of_it) {
  return std::asin(std::min(1.0, std::sqrt(squared_sine_of_it))) * 180 / std::numbers::pi;
}

class Improvement {
 public:
  Improvement(PlanarGrid& grid, const PlanarImproveOptions& options, Context& context)
      : c_(grid.complex), options_(options), context_(context), kernel_(c_), replacer_(c_) {
    const double sine = std::sin(options.min_angle * std::numbers::pi / 180);
    goal_ = sine * sine;
  }

  ImproveReport run() {
    c_.index_vertices();
    kernel_.last_tri = 0;
    std::vector<TriIndex> bad = all_bad(report_.min_dihedral_before_deg);
    std::erase_if(bad, [&](TriIndex t) { return is_at_sharp_corner(t); });
    for (int pass = 0; pass < options_.max_passes && !bad.empty(); ++pass) {
      touched_.clear();
      std::size_t done = 0;
      for (std::size_t i = 0; i < bad.size(); ++i) {
        if (i % kTrianglesPerCancelCheck == 0) context_.progress("improve", i, bad.size(), "cells");
        if (is_bad(bad[i])) done += work_on(bad[i]);
      }
      ++report_.passes;
      if (done == 0) break;
      bad.insert(bad.end(), touched_.begin(), touched_.end());
      std::sort(bad.begin(), bad.end());
      bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
      std::erase_if(bad, [&](TriIndex t) { return !is_bad(t); });
    }
    bad = all_bad(report_.min_dihedral_after_deg);
    report_.below_goal = bad.size();
    for (const TriIndex t : bad) report_.below_goal_forced += is_at_sharp_corner(t) || has_given_corners(t);
    return report_;
  }

 private:
  Point2 at(VertexIndex v) const { return c_.point[v]; }
  bool is_inside(TriIndex t) const { return !c_.is_dead(t) && !c_.is_ghost(t) && c_.tri[t].region != kOutside; }
  double quality(TriIndex t) const {
    const Triangle& s = c_.tri[t];
    return squared_sine(at(s.node[0]), at(s.node[1]), at(s.node[2]));
  }
  bool is_bad(TriIndex t) const { return is_inside(t) && quality(t) < goal_ && !is_at_sharp_corner(t); }

  /// Whether its small angle lies between two constrained edges.
  bool is_at_sharp_corner(TriIndex t) const {
    const Triangle& s = c_.tri[t];
    for (unsigned e = 0; e < 3; ++e) {
      if (!(s.flags >> next_of(e) & 1) || !(s.flags >> previous_of(e) & 1)) continue;
      const Point2 u = at(s.node[next_of(e)]) - at(s.node[e]), v = at(s.node[previous_of(e)]) - at(s.node[e]);
      const double area2 = cross(u, v);
      if (dot(u, v) > 0 && area2 * area2 < goal_ * squared_length(u) * squared_length(v)) return true;
    }
    return false;
  }

  bool has_given_corners(TriIndex t) const {
    const VertexIndex* n = c_.tri[t].node;
    return n[0] < options_.first_free && n[1] < options_.first_free && n[2] < options_.first_free;
  }

  std::vector<TriIndex> all_bad(double& worst_deg) const {
    std::vector<TriIndex> bad;
    double worst = 1;
    for (TriIndex t = 0; t < c_.tri.size(); ++t) {
      if (!is_inside(t)) continue;
      const double q = quality(t);
      worst = std::min(worst, q);
      if (q < goal_) bad.push_back(t);
    }
    worst_deg = angle_deg(worst);
    return bad;
  }

  bool work_on(TriIndex t) {
    const Triangle s = c_.tri[t];
    for (const VertexIndex v : s.node)
      if (move(v)) return true;
    if (insert(t)) return true;
    for (const VertexIndex v : s.node)
      if (remove(v)) return true;
    return false;
  }

  /// The star of a vertex that may move or go; false for all others.
  bool collect_free_star(VertexIndex v) {
    if (v < options_.first_free || !collect_star(c_, v, star_, ring_)) return false;
    for (const TriIndex t : star_) {
      const Triangle& s = c_.tri[t];
      const unsigned i = s.node[0] == v ? 0 : s.node[1] == v ? 1 : 2;
      if (s.flags >> next_of(i) & 1 || s.region == kOutside) return false;
    }
    return true;
  }

  double star_quality(Point2 p) const {
    double worst = 1;
    for (std::size_t i = 0; i < ring_.size() && worst > 0; ++i)
      worst = std::min(worst, squared_sine(p, at(ring_[i]), at(ring_[i + 1 < ring_.size() ? i + 1 : 0])));
    return worst;
  }

  /// Towards the mean of the ring, then by a pattern search with steps that shrink.
  bool move(VertexIndex v) {
    if (!collect_free_star(v)) return false;
    const Point2 start = at(v);
    const double before = star_quality(start);
    Point2 best = start, mean{0, 0};
    double best_quality = before;
    const auto try_at = [&](Point2 p) {
      const double q = star_quality(p);
      if (q <= best_quality) return false;
      best = p;
      best_quality = q;
      return true;
    };
    for (const VertexIndex w : ring_) mean = mean + at(w);
    mean = (1.0 / static_cast<double>(ring_.size())) * mean;
    try_at(mean);
    double step = 0.25 * std::sqrt(squared_length(at(ring_[0]) - start));
    for (int i = 0; i < kSearchSteps; ++i) {
      const Point2 centre = best;
      bool found = false;
      for (const Point2 d : {Point2{1, 0}, Point2{0, 1}, Point2{-1, 0}, Point2{0, -1}})
        found |= try_at(centre + step * d);
      if (!found) step *= 0.5;
    }
    if (best_quality < kGain * before) return false;
    c_.point[v] = best;
    if (!is_star_positive()) {
      c_.point[v] = start;
      return false;
    }
    ++report_.points_moved;
    settle();
    return true;
  }

  bool is_star_positive() const {
    for (const TriIndex t : star_) {
      const Triangle& s = c_.tri[t];
      if (orient2d(at(s.node[0]), at(s.node[1]), at(s.node[2])) <= 0) return false;
    }
    return true;
  }

  /// Make the edges of star_ Delaunay again, and look at them in the next pass.
  void settle() {
    edges_.clear();
    for (const TriIndex t : star_)
      for (unsigned e = 0; e < 3; ++e) {
        edges_.push_back(4 * t + e);
        touched_.push_back(c_.tri[t].neigh[e] >> 2);
      }
    touched_.insert(touched_.end(), star_.begin(), star_.end());
    report_.edge_swaps += make_delaunay(c_, edges_);
  }

  /// The best of a few places in the triangle's neighbourhood, where that leaves better triangles than it destroys.
  bool insert(TriIndex t) {
    const Triangle s = c_.tri[t];
    const Point2 a = at(s.node[0]), b = at(s.node[1]), d = at(s.node[2]);
    const Point2 centre = a + c_.to_circumcentre(s), centroid = (1.0 / 3) * (a + b + d);
    Point2 best{};
    double best_gain = kGain;
    for (const double share : {1.0, 0.75, 0.5, 0.25, 0.0}) {
      const Point2 p = centroid + share * (centre - centroid);
      const double gain = gain_at(p, t);
      if (gain <= best_gain) continue;
      best_gain = gain;
      best = p;
    }
    if (best_gain <= kGain) return false;
    gain_at(best, t);  // the cavity again
    const auto v = static_cast<VertexIndex>(c_.point.size());
    c_.point.push_back(best);
    c_.h.push_back((c_.h[s.node[0]] + c_.h[s.node[1]] + c_.h[s.node[2]]) / 3);
    kernel_.fill_cavity(v);
    star_ = kernel_.made();
    c_.vertex_tri.push_back(star_[0]);
    for (const TriIndex made : star_)
      for (const VertexIndex w : c_.tri[made].node) c_.vertex_tri[w] = made;
    ++report_.points_added;
    settle();
    return true;
  }

  /// Worst quality after an insertion at p over that before; 0 where it cannot be, or would leave t. Leaves
  /// the cavity in the kernel.
  double gain_at(Point2 p, TriIndex t) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return 0;
    const TriIndex holder = kernel_.locate(p, t);
    if (c_.tri[holder].region != c_.tri[t].region || c_.is_ghost(holder)) return 0;
    kernel_.grow_cavity(holder, p);
    double before = 1, after = 1;
    bool holds_it = false;
    for (const TriIndex u : kernel_.cavity()) {
      before = std::min(before, quality(u));
      holds_it |= u == t;
    }
    if (!holds_it) return 0;
    for (const PlanarKernel::CavityEdge& edge : kernel_.edges()) {
      if (edge.a == kInfinity || edge.b == kInfinity) return 0;
      const double nearest = kNearest * c_.h[edge.a];
      if (squared_length(at(edge.a) - p) < nearest * nearest) return 0;
      if (orient2d(at(edge.a), at(edge.b), p) <= 0) return 0;
      after = std::min(after, squared_sine(at(edge.a), at(edge.b), p));
    }
    return before > 0 ? after / before : after * 1e300;
  }

  /// Take a vertex away and fill its star with Delaunay ears.
  bool remove(VertexIndex v) {
    if (!collect_free_star(v) || ring_.size() > kLargestStar) return false;
    const double before = star_quality(at(v));
    corners_.clear();
    polygon_ = ring_;
    while (polygon_.size() > 3) {
      const std::size_t ear = find_ear();
      if (ear == polygon_.size()) return false;
      cut(ear);
    }
    cut(1);
    for (const Corners& t : corners_)
      if (squared_sine(at(t[0]), at(t[1]), at(t[2])) < kGain * before || orient2d(at(t[0]), at(t[1]), at(t[2])) <= 0)
        return false;
    replacer_.replace(star_, corners_);
    c_.vertex_tri[v] = kNoTri;
    star_.resize(corners_.size());
    ++report_.points_removed;
    settle();
    return true;
  }

  Corners corner_at(std::size_t i) const {
    const std::size_t n = polygon_.size();
    return {polygon_[(i + n - 1) % n], polygon_[i], polygon_[(i + 1) % n]};
  }
  void cut(std::size_t ear) {
    corners_.push_back(corner_at(ear));
    polygon_.erase(polygon_.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  std::size_t find_ear() const {
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const Corners t = corner_at(i);
      if (orient2d(at(t[0]), at(t[1]), at(t[2])) <= 0) continue;
      bool is_empty = true;
      for (const VertexIndex w : polygon_)
        is_empty =
            is_empty && (w == t[0] || w == t[1] || w == t[2] || incircle(at(t[0]), at(t[1]), at(t[2]), at(w)) <= 0);
      if (is_empty) return i;
    }
    return polygon_.size();
  }

  TriComplex& c_;
  PlanarImproveOptions options_;
  Context& context_;
  PlanarKernel kernel_;
  Replacer replacer_;
  ImproveReport report_;
  double goal_ = 0;
  std::vector<TriIndex> star_, touched_;
  std::vector<VertexIndex> ring_, polygon_;
  std::vector<EdgeRef> edges_;
  std::vector<Corners> corners_;
};

}  // namespace

ImproveReport improve_complex(PlanarGrid& grid, const PlanarImproveOptions& options, Context& context) {
  const StageTimer timer(context, "improve");
  return Improvement(grid, options, context).run();
}

}  // namespace delfront
