// SPDX-License-Identifier: Apache-2.0
// Every triangle of a grid against its surface: the middle of the triangle and of its sides, by the tangent plane at
// the place of the mean parameters (exact to third order where parameters are even), and by the nearest place where
// that says it matters.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.hpp"
#include "brep/sharp_corners.hpp"
#include "brep_sizes/size_parts.hpp"
#include "geometry/angles.hpp"
#include "geometry/surface.hpp"

namespace delfront {
namespace {

constexpr double kSharp = 30 * kDegree;  ///< corners of faces under it have sharp triangles whatever is done
constexpr double kSharpReach = 0.5;      ///< over the angle in radians: sides from such a corner that do not count
constexpr double kLeastAngle = 1e-3;     ///< radians, of it
constexpr double kNearGoal = 0.7;        ///< of the goal: from there deviations are found exactly
constexpr double kAtLeast = 1.5;         ///< times hmin: sides up to that are as small as they may be
constexpr double kLeastShare = 0.5;      ///< one round lowers sizes by no more
constexpr double kMostShare = 0.9;       ///< and by no less
constexpr double kRightLow = 0.7, kRightHigh = 1.4;
constexpr std::size_t kGrain = 1024;
constexpr std::size_t kAngleClasses = 12;

struct Looked {
  double angle = 180, deviation = 0, middle_deviation = 0, area = 0;
  Point deviation_at;
};

class Measurer {
 public:
  Measurer(const Brep& brep, const Model& grid, const BrepGridReport& report, const SizeField& size,
           const BrepGoals& goals, BoundarySizes* lowered, const Context& context)
      : grid_(grid),
        report_(report),
        size_(size),
        goals_(goals),
        lowered_(lowered),
        context_(context),
        pieces_(pieces_of(brep, grid, report)),
        sharp_(find_sharp_corners(brep, kSharp)) {
    for (const BrepEdge& edge : brep.edges)
      if (edge.is_degenerate()) tips_.push_back(brep.corners[edge.corners[0]].at);
  }

  BrepAccuracy run() {
    made_.triangles = grid_.triangles.size();
    made_.points = grid_.points.size();
    made_.angles.assign(kAngleClasses, 0);
    for (const Patch& patch : grid_.patches) made_.patches.push_back({patch.name, 0, 180, 0});
    look_at_triangles();
    look_at_sides();
    std::vector<std::uint32_t>& faces = made_.faces_beyond;
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return std::move(made_);
  }

 private:
  Looked look(const FacePiece& p) const {
    Looked it;
    const Point twice = cross(p.at[1] - p.at[0], p.at[2] - p.at[0]);
    it.area = 0.5 * length(twice);
    it.angle = smallest_angle_deg(p.at[0], p.at[1], p.at[2]);
    const auto take = [&](Point at, Point2 uv) {
      const double away = deviation(*p.surface, at, uv);
      if (away > it.deviation) it.deviation = away, it.deviation_at = at;
      return away;
    };
    it.middle_deviation = take((p.at[0] + p.at[1] + p.at[2]) / 3, p.middle());
    for (std::size_t k = 0; k < 3; ++k) take(0.5 * (p.at[k] + p.at[(k + 1) % 3]), p.middle_of_side(k));
    return it;
  }

  double deviation(const SmoothSurface& surface, Point at, Point2 uv) const {
    const SurfaceTangents s = surface.tangents(uv);
    const Point n = cross(s.u, s.v);
    const double size = length(n), whole = distance(s.at, at);
    const double away = size > 0 ? std::abs(dot(s.at - at, n)) / size : whole;
    if (std::max(away, 0.1 * whole) < kNearGoal * goals_.deviation) return away;
    return std::min(whole, distance(surface.at(surface.closest(at, uv)), at));
  }

  void look_at_triangles() {
    std::vector<Looked> looked(pieces_.size());
    parallel_ranges(context_.threads, pieces_.size(), kGrain, [&](std::size_t first, std::size_t last) {
      context_.check_limits();
      for (std::size_t t = first; t < last; ++t) looked[t] = look(pieces_[t]);
    });
    double area = 0;
    SmallestAngles angles;
    for (std::size_t t = 0; t < looked.size(); ++t) {
      const Looked& it = looked[t];
      const double angle = it.angle;
      BrepAccuracy::Patch& patch = made_.patches[grid_.patch_of_triangle[TriangleId(t)].index()];
      ++patch.triangles;
      patch.min_angle_deg = std::min(patch.min_angle_deg, angle);
      patch.largest_deviation = std::max(patch.largest_deviation, it.deviation);
      angles.add(angle);
      ++made_.angles[std::min(kAngleClasses - 1, std::size_t(angle / 5))];
      made_.mean_deviation += it.area * it.middle_deviation;
      area += it.area;
      judge(pieces_[t], it, angle);
    }
    made_.min_angle_deg = angles.min_deg;
    made_.mean_min_angle_deg = angles.mean_deg();
    if (area > 0) made_.mean_deviation /= area;
  }

  void judge(const FacePiece& p, const Looked& it, double angle) {
    const Point middle = (p.at[0] + p.at[1] + p.at[2]) / 3;
    if (it.deviation > made_.deviation.value)
      made_.deviation.value = it.deviation, made_.deviation.at = it.deviation_at;
    if (it.deviation > goals_.deviation && !is_at_least(p)) {
      ++made_.deviation.num_beyond;
      lower(p, std::sqrt(goals_.deviation / it.deviation));
    }
    if (angle >= made_.angle_deg.value && angle >= goals_.angle_deg) return;
    if (is_near_sharp(p)) return;
    if (angle < made_.angle_deg.value) made_.angle_deg.value = angle, made_.angle_deg.at = middle;
    if (angle < goals_.angle_deg && !is_at_least(p)) {
      ++made_.angle_deg.num_beyond;
      lower(p, kLeastShare);
    }
  }

  bool is_at_least(const FacePiece& p) const { return p.longest_side() <= kAtLeast * goals_.hmin; }

  bool is_near_sharp(const FacePiece& p) const {
    const double h = p.longest_side();
    const auto is_near = [&](Point corner, double reach) {
      return std::any_of(p.at.begin(), p.at.end(), [&](Point q) { return distance(q, corner) <= reach; });
    };
    return std::any_of(sharp_.begin(), sharp_.end(), [&](const SharpCorner& c) {
      return is_near(c.at, h * std::max(1.5, kSharpReach / std::max(c.angle, kLeastAngle)));
    });
  }

  /// At the corners and the middle of a triangle sizes are to be this share of what its sides are, or of what is asked
  /// for.
  void lower(const FacePiece& p, double share) {
    made_.faces_beyond.push_back(p.face);
    if (!lowered_) return;
    share = std::clamp(share, kLeastShare, kMostShare);
    const double side = (distance(p.at[0], p.at[1]) + distance(p.at[1], p.at[2]) + distance(p.at[2], p.at[0])) / 3;
    const std::array<Point, 4> at = {p.at[0], p.at[1], p.at[2], (p.at[0] + p.at[1] + p.at[2]) / 3};
    std::array<double, 4> asked;
    size_.sizes(at, asked);
    for (std::size_t k = 0; k < at.size(); ++k) add_place(at[k], share * std::min(side, asked[k]));
  }
  void add_place(Point at, double h) {
    lowered_->points.push_back(at);
    lowered_->size.push_back(std::max(h, goals_.hmin));
  }

  /// Lengths over sizes, and turns between neighbours on one face.
  void look_at_sides() {
    const SurfaceEdges edges(grid_.triangles, std::vector<bool>(grid_.triangles.size(), true));
    std::vector<Point> middle(edges.size());
    std::vector<double> side(edges.size()), asked(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto [a, b] = edges.ends(e);
      middle[e] = 0.5 * (grid_.points[a] + grid_.points[b]);
      side[e] = distance(grid_.points[a], grid_.points[b]);
    }
    evaluate_sizes(size_, middle, asked, context_);
    std::size_t right = 0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const double ratio = side[e] / asked[e];
      right += ratio >= kRightLow && ratio <= kRightHigh;
      made_.mean_side += ratio / double(edges.size());
      if (edges.half_edges(e).size() == 2) look_at_turn(edges, e, middle[e]);
    }
    made_.share_of_right_sides = edges.size() ? double(right) / double(edges.size()) : 1;
  }

  bool is_at_tip(const FacePiece& p) const {
    return std::any_of(tips_.begin(), tips_.end(),
                       [&](Point tip) { return std::find(p.at.begin(), p.at.end(), tip) != p.at.end(); });
  }

  void look_at_turn(const SurfaceEdges& edges, std::size_t e, Point middle) {
    const auto half = edges.half_edges(e);
    const FacePiece &p = pieces_[half[0] / 3], &q = pieces_[half[1] / 3];
    if (p.face != q.face || is_on_border(edges, e)) return;
    const Point a = cross(p.at[1] - p.at[0], p.at[2] - p.at[0]), b = cross(q.at[1] - q.at[0], q.at[2] - q.at[0]);
    const double turn = angle_between(a, b);
    if (turn <= made_.turn_deg.value * kDegree && turn <= goals_.turn_deg * kDegree) return;
    if (is_at_tip(p) || is_at_tip(q)) return;
    if (turn > made_.turn_deg.value * kDegree) made_.turn_deg.value = turn / kDegree, made_.turn_deg.at = middle;
    if (turn <= goals_.turn_deg * kDegree || is_at_least(p) || is_at_least(q)) return;
    ++made_.turn_deg.num_beyond;
    const double share = std::sin(0.5 * goals_.turn_deg * kDegree) / std::sin(0.5 * turn);
    lower(p, share);
    lower(q, share);
  }

  /// Seams too: neighbours there may meet at a kink.
  bool is_on_border(const SurfaceEdges& edges, std::size_t e) const {
    const auto [a, b] = edges.ends(e);
    return report_.entity[a.index()].dimension < 2 && report_.entity[b.index()].dimension < 2;
  }

  const Model& grid_;
  const BrepGridReport& report_;
  const SizeField& size_;
  const BrepGoals& goals_;
  BoundarySizes* lowered_;
  const Context& context_;
  std::vector<FacePiece> pieces_;
  std::vector<SharpCorner> sharp_;
  std::vector<Point> tips_;
  BrepAccuracy made_;
};

}  // namespace

BrepAccuracy measure_brep_grid(const Brep& brep, const Model& grid, const BrepGridReport& report, const SizeField& size,
                               const BrepGoals& goals, BoundarySizes* lowered, const Context& context) {
  return Measurer(brep, grid, report, size, goals, lowered, context).run();
}

}  // namespace delfront
