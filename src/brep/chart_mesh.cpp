// SPDX-License-Identifier: Apache-2.0
#include "brep/chart_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planar/edit.hpp"

namespace delfront {
namespace {

constexpr double kRegular = 0.995;     ///< mean quality of a star that is left alone
constexpr double kSmoothAngle = 0.41;  ///< squared sine of 40 degrees: worse angles are not made
constexpr double kLeastGain = 1e-3;    ///< of a star's mean quality
constexpr double kRegularHeight = 0.86602540378443865;
constexpr double kGoal = 0.35;      ///< squared sine of 36 degrees: angles below it are lifted
constexpr double kHopeless = 0.25;  ///< of all triangles: so many under that goal are left
constexpr std::size_t kFewTriangles = 5000;
constexpr int kLiftPasses = 4, kLiftSteps = 10;
constexpr double kMargin = 1e-9;      ///< flips back and forth are not flips
constexpr double kFoldCosine = 0.35;  ///< least cosine between triangles that come and those that go
constexpr double kAgree = 0.5;  ///< cosine between triangles and the surface at their corners: less is not made of more
constexpr int kFlipPasses = 6;
constexpr std::size_t kVerticesPerCancelCheck = 1 << 14, kTrianglesPerCancelCheck = 1 << 10;

double squared_sine(Point a, Point b, Point c) {
  const Point u = b - a, v = c - b, w = a - c;
  const double u2 = squared_length(u), v2 = squared_length(v), w2 = squared_length(w);
  const double shortest = std::min({u2, v2, w2});
  const double product = shortest == u2 ? v2 * w2 : shortest == v2 ? u2 * w2 : u2 * v2;
  return product > 0 ? squared_length(cross(u, v)) / product : 0;
}

}  // namespace

ChartMesh::ChartMesh(TriComplex& complex, const Chart& chart, std::vector<Point> at)
    : c_(complex), chart_(chart), first_free_(static_cast<VertexIndex>(at.size())), at_(std::move(at)) {
  const std::size_t n = c_.point.size();
  at_.resize(n);
  x_.resize(n);
  y_.resize(n);
  for (VertexIndex v = 0; v < n; ++v) {
    const Chart::Place place = chart_.place(c_.point[v]);
    if (v >= first_free_) at_[v] = place.at;
    x_[v] = place.x;
    y_[v] = place.y;
  }
  is_calm_.assign(n, false);
  is_changed_.assign(n, 1);
}

void ChartMesh::improve(int passes, const Context& context) {
  for (int k = 0; k < kFlipPasses && flip_all() > 0; ++k) context.check_limits();
  for (int pass = 0; pass < passes; ++pass) {
    std::size_t moved = 0;
    for (VertexIndex v = first_free_; v < c_.point.size(); ++v) {
      if (v % kVerticesPerCancelCheck == 0) context.check_limits();
      if (c_.vertex_tri[v] != kNoTri && !is_calm_[v]) moved += move(v);
    }
    if (moved == 0) break;
    for (int k = 0; k < 2 && flip_all() > 0; ++k) context.check_limits();
  }
  for (int k = 0; k < kFlipPasses && flip_all() > 0; ++k) context.check_limits();
  if (is_hopeless()) return;
  is_calm_.assign(is_calm_.size(), false);
  for (int k = 0; k < kLiftPasses && lift_angles(context) > 0; ++k) flip_all();
}

bool ChartMesh::is_small(TriIndex t) const {
  const Triangle& s = c_.tri[t];
  return squared_sine(at_[s.node[0]], at_[s.node[1]], at_[s.node[2]]) <= kGoal;
}

/// Where needles are everywhere the chart is to blame, and moving each point would take minutes.
bool ChartMesh::is_hopeless() const {
  std::size_t all = 0, small = 0;
  for (TriIndex t = 0; t < c_.tri.size(); ++t) {
    if (!is_inside(t)) continue;
    ++all;
    small += is_small(t);
  }
  return small > kFewTriangles && double(small) > kHopeless * double(all);
}

/// Corners of triangles with an angle under the goal are moved to where the worst angle round them is largest.
std::size_t ChartMesh::lift_angles(const Context& context) {
  std::size_t count = 0;
  for (TriIndex t = 0; t < c_.tri.size(); ++t) {
    if (t % kTrianglesPerCancelCheck == 0) context.check_limits();
    if (!is_inside(t)) continue;
    if (!is_small(t)) continue;
    for (const VertexIndex v : c_.tri[t].node)
      if (v >= first_free_ && !is_calm_[v]) {
        const bool is_better = lift_angle(v);
        is_calm_[v] = !is_better;
        count += is_better;
      }
  }
  return count;
}

bool ChartMesh::lift_angle(VertexIndex v) {
  if (!collect_ring(v)) return false;
  double length2 = 0;
  for (const Point& w : ring_) length2 += squared_length(w - at_[v]) / double(ring_.size());
  bool is_better = false;
  double reach = 0.25 * std::sqrt(length2);  // in space; halved where no direction helps
  for (int k = 0; k < kLiftSteps; ++k) {
    const Point area = cross(x_[v], y_[v]);
    const Star before = measure(at_[v], area / length(area));
    bool is_moved = false;
    for (int d = 0; d < 8 && !is_moved; ++d) {
      const double angle = d * std::numbers::pi / 4, s = reach / std::sqrt(length(area));
      is_moved = try_place(v, {s * std::cos(angle), s * std::sin(angle)}, before, true);
    }
    is_better = is_better || is_moved;
    if (!is_moved) reach *= 0.5;
  }
  return is_better;
}

/// Sides of triangles of which a corner has moved, or got or lost a side, since the last time.
std::size_t ChartMesh::flip_all() {
  const std::vector<std::uint8_t> is_due = is_changed_;
  std::fill(is_changed_.begin(), is_changed_.end(), 0);
  std::size_t count = 0;
  for (TriIndex t = 0; t < c_.tri.size(); ++t) {
    if (!is_inside(t)) continue;
    const VertexIndex* n = c_.tri[t].node;
    if (!is_due[n[0]] && !is_due[n[1]] && !is_due[n[2]]) continue;
    for (unsigned e = 0; e < 3; ++e)
      if (!c_.is_constrained(4 * t + e)) count += flip(4 * t + e);
  }
  return count;
}

/// The least cosine between a triangle and the surface at its corners, but for a pole.
double ChartMesh::agreement(Point area, const std::array<VertexIndex, 3>& corners) const {
  double least = 1;
  for (const VertexIndex v : corners) {
    if (chart_.is_polar() && c_.point[v] == Point2{0, 0}) continue;
    const Point n = cross(x_[v], y_[v]);
    if (n == Point{}) continue;
    least = std::min(least, dot(area, n) / std::sqrt(squared_length(area) * squared_length(n)));
  }
  return least;
}

/// Edge a b of triangles a b c and b a d becomes c d where the sum of the angles at c and d is over 180 degrees.
bool ChartMesh::flip(EdgeRef ref) {
  const EdgeRef other = c_.across(ref);
  if (!is_inside(other >> 2)) return false;
  const VertexIndex a = c_.origin(ref), b = c_.target(ref), c = c_.apex(ref), d = c_.apex(other);
  const Point pa = at_[a], pb = at_[b], pc = at_[c], pd = at_[d];
  const Point u = pa - pc, v = pb - pc, x = pb - pd, y = pa - pd;
  const double cos_c = dot(u, v), cos_d = dot(x, y);
  if (cos_c >= 0 && cos_d >= 0) return false;
  const double sin_c = length(cross(u, v)), sin_d = length(cross(x, y));
  if (sin_c * cos_d + cos_c * sin_d >= -kMargin * (std::abs(sin_c * cos_d) + std::abs(cos_c * sin_d))) return false;
  if (c < first_free_ && d < first_free_ && (a >= first_free_ || b >= first_free_)) return false;
  const Point old_first = cross(pb - pa, pc - pa), old_second = cross(pa - pb, pd - pb), old = old_first + old_second;
  const Point first = cross(pd - pa, pc - pa), second = cross(pb - pd, pc - pd);
  const double size = length(old);
  if (!(dot(first, old) > kFoldCosine * size * length(first)) ||
      !(dot(second, old) > kFoldCosine * size * length(second)))
    return false;
  const double then = std::min(agreement(first, {a, d, c}), agreement(second, {d, b, c}));
  if (!(then > kAgree) &&
      !(then > std::min(agreement(old_first, {a, b, c}), agreement(old_second, {b, a, d})) && then > 0))
    return false;
  if (orient2d(c_.point[a], c_.point[d], c_.point[c]) <= 0 || orient2d(c_.point[d], c_.point[b], c_.point[c]) <= 0)
    return false;
  c_.flip(ref);
  const TriIndex t = ref >> 2, w = other >> 2;
  c_.vertex_tri[a] = c_.vertex_tri[c] = c_.vertex_tri[d] = t;
  c_.vertex_tri[b] = w;
  for (const VertexIndex k : {a, b, c, d}) {
    is_calm_[k] = false;
    is_changed_[k] = 1;
  }
  return true;
}

bool ChartMesh::collect_ring(VertexIndex v) {
  if (!collect_star(c_, v, star_, vertices_)) return false;
  ring_.clear();
  side2_.clear();
  for (const VertexIndex w : vertices_) {
    side2_.push_back(squared_length(at_[w] - (ring_.empty() ? at_[vertices_.back()] : ring_.back())));
    ring_.push_back(at_[w]);
  }
  return true;
}

ChartMesh::Star ChartMesh::measure(Point p, Point normal) const {
  Star star{0, 1};
  Point u = ring_.back() - p;
  double u2 = squared_length(u);
  for (std::size_t i = 0; i < ring_.size(); ++i) {
    const Point v = ring_[i] - p, twice = cross(u, v);
    const double v2 = squared_length(v), side2 = side2_[i], square = squared_length(twice), area2 = std::sqrt(square);
    if (!(dot(twice, normal) > kFoldCosine * area2)) return {-1, 0};
    star.mean += area2 / (u2 + v2 + side2);
    star.worst = std::min(star.worst, square / std::max({u2 * v2, u2 * side2, v2 * side2}));
    u = v;
    u2 = v2;
  }
  star.mean *= 4 * kRegularHeight / double(ring_.size());
  return star;
}

/// To the mean of the places from which the edges round it would be seen as in a regular triangle.
bool ChartMesh::move(VertexIndex v) {
  if (!collect_ring(v)) return false;
  const Point area = cross(x_[v], y_[v]);
  const Point n = area / length(area);
  const Star before = measure(at_[v], n);
  if (before.mean > kRegular) {
    is_calm_[v] = true;
    return false;
  }
  Point sum;
  for (std::size_t i = 0; i < ring_.size(); ++i) {
    const Point a = ring_[i], b = ring_[i + 1 < ring_.size() ? i + 1 : 0];
    sum = sum + 0.5 * (a + b) + kRegularHeight * cross(n, b - a);
  }
  const Point d = sum / double(ring_.size()) - at_[v];
  const double e = dot(x_[v], x_[v]), f = dot(x_[v], y_[v]), g = dot(y_[v], y_[v]), det = e * g - f * f;
  const double dx = dot(d, x_[v]), dy = dot(d, y_[v]);
  const bool is_moved = try_place(v, {(g * dx - f * dy) / det, (e * dy - f * dx) / det}, before);
  is_calm_[v] = !is_moved;
  return is_moved;
}

bool ChartMesh::try_place(VertexIndex v, Point2 step, const Star& before, bool by_worst) {
  const Point2 start = c_.point[v];
  const Point2 to = start + step;
  const Chart::Place place = chart_.place(to);
  const Point area = cross(place.x, place.y);
  const Star after = measure(place.at, area / length(area));
  if (by_worst ? after.worst < before.worst + kLeastGain
               : after.mean < before.mean + kLeastGain || after.worst < std::min(before.worst, kSmoothAngle))
    return false;
  c_.point[v] = to;
  if (!is_positive()) {
    c_.point[v] = start;
    return false;
  }
  at_[v] = place.at;
  x_[v] = place.x;
  y_[v] = place.y;
  is_changed_[v] = 1;
  for (const TriIndex t : star_)
    for (const VertexIndex w : c_.tri[t].node) is_calm_[w] = false;
  return true;
}

bool ChartMesh::is_positive() const {
  for (const TriIndex t : star_) {
    const VertexIndex* n = c_.tri[t].node;
    if (orient2d(c_.point[n[0]], c_.point[n[1]], c_.point[n[2]]) <= 0) return false;
  }
  return true;
}

}  // namespace delfront
