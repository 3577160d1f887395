// SPDX-License-Identifier: Apache-2.0
#include "brep/face_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/angles.hpp"
#include "surface/linked_triangles.hpp"

namespace delfront {
namespace {

constexpr double kGoal = 0.345;  ///< squared sine of 36 degrees
constexpr int kRounds = 4, kSweeps = 4, kMoves = 8, kDirections = 8;
constexpr std::size_t kMostLifts = 1000, kTrianglesPerLift = 20;  ///< searches a face: that many and one for so many
constexpr double kLeastGain = 1e-3;                               ///< of a squared sine
constexpr double kFoldCosine = 0.35;  ///< least cosine between triangles that come and those that go
constexpr double kAgree = 0.3;        ///< least cosine between triangles and the surface at their corners
constexpr double kFirstReach = 0.25;  ///< of the mean side: a step of lifting at first
constexpr double kLeastSlope = 1e-6;  ///< squared sine between tangents from where steps go by them
constexpr double kMostLonger = 1.3;   ///< sides that a collapse makes, of the longest there
constexpr std::uint32_t kNone = LinkedTriangles::kNone;

/// The triangles round small angles, linked; those at their rim are only looked at.
class SmallAngles {
 public:
  SmallAngles(const SmoothSurface& surface, const std::vector<std::uint64_t>& kept_sides, FaceGrid& grid)
      : surface_(surface), box_(surface.box()), period_(surface.period()), kept_(kept_sides), grid_(grid) {}

  void run() {
    lifts_left_ = kMostLifts + grid_.triangles.size() / kTrianglesPerLift;
    for (int round = 0; round < kRounds && select(); ++round) {
      links_.link(std::move(triangles_), grid_.points.size());
      is_calm_.assign(grid_.points.size(), false);
      std::size_t done = 0;
      for (int sweep = 0; sweep < kSweeps; ++sweep) {
        const std::size_t count = work();
        done += count;
        if (count == 0) break;
      }
      for (std::uint32_t t = 0; t < given_.size(); ++t) grid_.triangles[given_[t]] = links_.triangle(t);
      if (is_collapsed_) drop_collapsed();
      if (done == 0) return;
    }
  }

 private:
  Point at(std::uint32_t p) const { return grid_.points[p].at; }
  double sine(const std::array<std::uint32_t, 3>& t) const {
    return smallest_squared_sine(at(t[0]), at(t[1]), at(t[2]));
  }

  void drop_collapsed() {
    is_collapsed_ = false;
    std::erase_if(grid_.triangles, [](const auto& t) { return t[0] == kNone; });
    std::vector<std::uint32_t> number(grid_.points.size(), kNone);
    for (const auto& t : grid_.triangles)
      for (const std::uint32_t p : t) number[p] = 0;
    std::uint32_t count = 0;
    for (std::uint32_t p = 0; p < number.size(); ++p) {
      if (number[p] == kNone && grid_.points[p].vertex == kNoVertex) continue;
      grid_.points[count] = grid_.points[p];
      number[p] = count++;
    }
    grid_.points.resize(count);
    for (auto& t : grid_.triangles)
      for (std::uint32_t& p : t) p = number[p];
  }

  /// Two rings of triangles round those with small angles. @return whether there are any
  bool select() {
    std::vector<std::uint8_t>& mark = mark_;
    mark.assign(grid_.points.size(), 0);
    bool is_any = false;
    for (const auto& t : grid_.triangles) {
      if (sine(t) > kGoal) continue;
      is_any = true;
      for (const std::uint32_t p : t) mark[p] = 1;
    }
    if (!is_any) return false;
    for (std::uint8_t ring = 1; ring <= 2; ++ring)
      for (const auto& t : grid_.triangles) {
        const auto is_in = [&](std::uint32_t p) { return mark[p] > 0 && mark[p] <= ring; };
        if (!is_in(t[0]) && !is_in(t[1]) && !is_in(t[2])) continue;
        for (const std::uint32_t p : t)
          if (mark[p] == 0) mark[p] = std::uint8_t(ring + 1);
      }
    triangles_.clear();
    given_.clear();
    for (std::size_t i = 0; i < grid_.triangles.size(); ++i) {
      const auto& t = grid_.triangles[i];
      if (mark[t[0]] == 0 || mark[t[1]] == 0 || mark[t[2]] == 0) continue;
      triangles_.push_back(t);
      given_.push_back(i);
    }
    return true;
  }

  bool is_small(std::uint32_t t) const { return !links_.is_gone(t) && sine(links_.triangle(t)) <= kGoal; }

  /// Whether a triangle faces as the surface does at its corners, but for poles.
  bool agrees(const std::array<std::uint32_t, 3>& t) const {
    const Point area = cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]));
    for (const std::uint32_t p : t) {
      const FacePoint& point = grid_.points[p];
      if (!point.is_pole && !(dot(area, normal_at(point.uv)) > kAgree * length(area))) return false;
    }
    return true;
  }

  std::size_t work() {
    std::size_t done = 0;
    const auto n = static_cast<std::uint32_t>(links_.num_triangles());
    for (std::uint32_t t = 0; t < n; ++t)
      for (std::uint32_t k = 0; k < 3 && is_small(t); ++k) done += flip(3 * t + k);
    for (std::uint32_t t = 0; t < n; ++t)
      for (std::size_t k = 0; k < 3 && is_small(t); ++k) done += lift(links_.triangle(t)[k]);
    for (std::uint32_t t = 0; t < n; ++t)
      for (std::uint32_t k = 0; k < 6 && is_small(t); ++k) {
        const std::uint32_t a = links_.triangle(t)[k % 3], b = links_.triangle(t)[(k + 1) % 3];
        done += k < 3 ? collapse(a, b) : collapse(b, a);
      }
    return done;
  }

  /// Point p goes to its neighbour q where that lifts the smallest angle round p, and no side gets much longer.
  bool collapse(std::uint32_t p, std::uint32_t q) {
    if (grid_.points[p].vertex != kNoVertex || mark_[p] > 2 || mark_[q] > 2 || !links_.ring(p, ring_) ||
        ring_.points.size() < 4)
      return false;
    const std::size_t n = ring_.points.size();
    const auto found = std::find(ring_.points.begin(), ring_.points.end(), q);
    if (found == ring_.points.end()) return false;
    const auto i = std::size_t(found - ring_.points.begin());
    links_.fan(q, fan_);
    double before_worst = 1, after_worst = 1, longest = 0;
    for (std::size_t k = 0; k < n; ++k) longest = std::max(longest, distance(at(p), at(ring_.points[k])));
    const Point normal = surface_.normal(grid_.points[p].uv);
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t a = ring_.points[k], b = ring_.points[(k + 1) % n];
      before_worst = std::min(before_worst, sine({p, a, b}));
      if (k == i || (k + 1) % n == i) continue;
      const Point area = cross(at(a) - at(q), at(b) - at(q));
      if (!(dot(area, normal) > kFoldCosine * length(area))) return false;
      after_worst = std::min(after_worst, sine({q, a, b}));
      if (!agrees({q, a, b})) return false;
    }
    if (after_worst < before_worst + kLeastGain) return false;
    for (std::size_t k = 0; k < n; ++k) {
      if (k == i) continue;
      const bool is_beside = (k + 1) % n == i || (i + 1) % n == k;
      if (!is_beside && std::find(fan_.points.begin(), fan_.points.end(), ring_.points[k]) != fan_.points.end())
        return false;
      if (distance(at(q), at(ring_.points[k])) > kMostLonger * longest) return false;
    }
    links_.collapse(p, q);
    disturb_ring(q);
    return is_collapsed_ = true;
  }

  bool is_kept(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t p = grid_.points[a].vertex, q = grid_.points[b].vertex;
    if (p == kNoVertex || q == kNoVertex) return false;
    const auto [low, high] = std::minmax(p, q);
    return std::binary_search(kept_.begin(), kept_.end(), std::uint64_t(low) << 32 | high);
  }

  /// Side a b of triangles a b c and b a d becomes c d where that lifts the smallest angle.
  bool flip(std::uint32_t side) {
    const std::uint32_t other = links_.other(side);
    if (other == kNone) return false;
    const std::uint32_t a = links_.point(side), b = links_.point(links_.next(side));
    const std::uint32_t c = links_.point(links_.before(side)), d = links_.point(links_.before(other));
    if (c == d || is_kept(a, b)) return false;
    if (grid_.points[c].vertex != kNoVertex && grid_.points[d].vertex != kNoVertex) return false;
    const double now = std::min(sine({a, b, c}), sine({b, a, d})), then = std::min(sine({a, d, c}), sine({d, b, c}));
    if (then < now + kLeastGain) return false;
    const Point old = cross(at(b) - at(a), at(c) - at(a)) + cross(at(a) - at(b), at(d) - at(b));
    const Point first = cross(at(d) - at(a), at(c) - at(a)), second = cross(at(b) - at(d), at(c) - at(d));
    if (!(dot(first, old) > kFoldCosine * length(old) * length(first)) ||
        !(dot(second, old) > kFoldCosine * length(old) * length(second)))
      return false;
    if (!agrees({a, d, c}) || !agrees({d, b, c})) return false;
    const std::uint32_t free = grid_.points[c].vertex == kNoVertex ? c : d;
    if (!links_.ring(free, ring_)) return false;
    const std::vector<std::uint32_t>& round = ring_.points;
    if (std::find(round.begin(), round.end(), free == c ? d : c) != round.end()) return false;
    links_.flip(side);
    for (const std::uint32_t point : {a, b, c, d}) is_calm_[point] = false;
    return true;
  }

  double worst_of_ring(Point place, Point normal) const {
    double worst = 1;  // with normals of the ring's points: those at poles are nothing
    for (std::size_t i = 0; i < ring_.points.size(); ++i) {
      const Point a = at(ring_.points[i]), b = at(ring_.points[(i + 1) % ring_.points.size()]),
                  n = cross(a - place, b - place);
      const double least = kAgree * length(n);
      if (!(dot(n, normal) > least)) return 0;
      for (const Point there : {ring_normal_[i], ring_normal_[(i + 1) % ring_.points.size()]})
        if (!(dot(n, there) > least) && there != Point{}) return 0;
      worst = std::min(worst, smallest_squared_sine(place, a, b));
    }
    return worst;
  }

  Point normal_of(const SurfaceTangents& s, Point2 uv) const {
    const Point n = cross(s.u, s.v);
    const double area2 = squared_length(n);
    return area2 > kLeastSlope * squared_length(s.u) * squared_length(s.v) ? n / std::sqrt(area2) : surface_.normal(uv);
  }
  Point normal_at(Point2 uv) const { return normal_of(surface_.tangents(uv), uv); }

  /// The same of angles alone.
  double worst_angle_round(Point place) const {
    double worst = 1;
    for (std::size_t i = 0; i < ring_.points.size(); ++i)
      worst = std::min(
          worst, smallest_squared_sine(place, at(ring_.points[i]), at(ring_.points[(i + 1) % ring_.points.size()])));
    return worst;
  }

  /// Where a small step from a place in its tangent plane leads, by the mapping's slope; by search where it has none.
  Point2 stepped(const SurfaceTangents& from, Point2 uv, Point step) const {
    const double e = dot(from.u, from.u), f = dot(from.u, from.v), g = dot(from.v, from.v), det = e * g - f * f;
    if (!(det > kLeastSlope * e * g)) return surface_.closest(from.at + step, uv);
    const double du = dot(step, from.u), dv = dot(step, from.v);
    const Point2 to = {uv.x + (g * du - f * dv) / det, uv.y + (e * dv - f * du) / det};
    return {period_[0] > 0 ? to.x : std::clamp(to.x, box_.low.x, box_.high.x),
            period_[1] > 0 ? to.y : std::clamp(to.y, box_.low.y, box_.high.y)};
  }

  /// The point goes where the worst angle round it is largest, as far as steps along the surface find that. A point for
  /// which that found nothing is not tried again until something round it has changed.
  bool lift(std::uint32_t p) {
    FacePoint& moved = grid_.points[p];
    if (moved.vertex != kNoVertex || is_calm_[p] || !links_.ring(p, ring_)) return false;
    if (lifts_left_ == 0) return false;
    --lifts_left_;
    double side = 0;
    for (const std::uint32_t q : ring_.points) side += distance(at(q), moved.at) / double(ring_.points.size());
    SurfaceTangents here = surface_.tangents(moved.uv);
    here.at = moved.at;
    Point normal = normal_of(here, moved.uv);
    ring_normal_.clear();
    for (const std::uint32_t q : ring_.points) {
      const FacePoint& point = grid_.points[q];
      ring_normal_.push_back(point.is_pole ? Point{} : normal_at(point.uv));
    }
    double worst = worst_of_ring(moved.at, normal), share = kFirstReach;
    bool is_better = false;
    for (int k = 0; k < kMoves; ++k) {
      bool is_moved = false;
      const Point u = at(ring_.points[0]) - moved.at, x = u - dot(u, normal) * normal, e = x / length(x),
                  f = cross(normal, e);
      for (int d = 0; d < kDirections && !is_moved; ++d) {
        const double angle = d * 2 * std::numbers::pi / kDirections;
        const Point step = share * side * (std::cos(angle) * e + std::sin(angle) * f);
        // the surface is not far from its tangent plane: what does not come near there is not looked at
        if (worst_angle_round(moved.at + step) < worst - share * share) continue;
        const Point2 uv = stepped(here, moved.uv, step);
        const SurfaceTangents there = surface_.tangents(uv);
        const Point n = normal_of(there, uv);
        const double then = worst_of_ring(there.at, n);
        if (then < worst + kLeastGain) continue;
        moved.at = there.at;
        moved.uv = uv;
        here = there;
        normal = n;
        worst = then;
        is_moved = is_better = true;
      }
      if (!is_moved) share *= 0.5;
    }
    if (is_better) disturb_ring(p);
    is_calm_[p] = true;
    return is_better;
  }

  /// Round a point something has changed: what its ring_ holds is to be looked at again.
  void disturb_ring(std::uint32_t p) {
    is_calm_[p] = false;
    for (const std::uint32_t q : ring_.points) is_calm_[q] = false;
  }

  const SmoothSurface& surface_;
  ParameterBox box_;
  std::array<double, 2> period_;
  const std::vector<std::uint64_t>& kept_;
  std::size_t lifts_left_ = 0;
  FaceGrid& grid_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::size_t> given_;  ///< by triangle: the grid's
  LinkedTriangles links_;
  std::vector<std::uint8_t> mark_;  ///< by point: 1 to 3, outwards from small angles; 3 is the rim
  std::vector<bool> is_calm_;       ///< by point: nothing round it has changed since it could not be lifted
  bool is_collapsed_ = false;
  TriangleRing ring_, fan_;
  std::vector<Point> ring_normal_;
};

}  // namespace

std::vector<std::uint64_t> kept_sides_of(const FaceGrid& border) {
  std::vector<std::uint64_t> sides;
  for (const auto& loop : border.loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t a = border.points[loop[i]].vertex, b = border.points[loop[(i + 1) % loop.size()]].vertex;
      sides.push_back(std::uint64_t(std::min(a, b)) << 32 | std::max(a, b));
    }
  std::sort(sides.begin(), sides.end());
  return sides;
}

void lift_small_angles(const SmoothSurface& surface, const std::vector<std::uint64_t>& kept_sides, FaceGrid& grid) {
  if (grid.gave_up.empty()) SmallAngles(surface, kept_sides, grid).run();
}

}  // namespace delfront
