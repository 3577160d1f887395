// SPDX-License-Identifier: Apache-2.0
// The polygon is a ring of corners. Straight corners (exactly, in the projection) leave the ring first and wait on the
// side that passes over them; whichever triangle takes that side is split at them. So every triangle that comes out has
// an area.
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "predicates/predicates.hpp"

namespace delfront {
namespace {

constexpr double kUnknown = -2;  // quality of an ear that is not computed yet
constexpr double kNoEar = -1;

class EarClipper {
 public:
  explicit EarClipper(std::span<const Point> corners);
  std::vector<std::array<int, 3>> run();

 private:
  using Side = std::vector<int>;  // corners that wait on the side from a ring corner to the next

  int turn(int a, int b, int c) const { return sense_ * orient2d(at(a), at(b), at(c)); }
  const double* at(int i) const { return flat_[std::size_t(i)].data(); }
  int& next(int i) { return next_[std::size_t(i)]; }
  int& previous(int i) { return previous_[std::size_t(i)]; }
  Side& side(int i) { return side_[std::size_t(i)]; }

  bool lies_between(int a, int b, int c) const;
  bool is_in_triangle(int p, int a, int b, int c) const;
  double ear_quality(int b);
  void remove_from_ring(int b);
  bool drop_straight_corner();
  int find_ear();
  void emit(int a, int b, int c, Side ab, Side bc, Side ca);

  std::span<const Point> corners_;
  std::vector<std::array<double, 2>> flat_;  // projected
  int sense_ = 1;                            // of turning, in the projection
  int ring_size_, start_ = 0;
  std::vector<int> next_, previous_;
  std::vector<Side> side_;
  std::vector<double> quality_;
  std::vector<std::array<int, 3>> triangles_;
};

/// Sine-like measure of the smallest angle: 4 sqrt(3) area / sum of squared sides, in (0, 1].
double shape(Point a, Point b, Point c) {
  const double sides = squared_length(b - a) + squared_length(c - b) + squared_length(a - c);
  return sides > 0 ? 2 * std::sqrt(3.0) * length(cross(b - a, c - a)) / sides : 0;
}

EarClipper::EarClipper(std::span<const Point> corners) : corners_(corners), ring_size_(int(corners.size())) {
  const std::size_t n = corners.size();
  Point area;
  for (std::size_t i = 1; i + 1 < n; ++i) area = area + cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  const Point size{std::abs(area.x), std::abs(area.y), std::abs(area.z)};
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  sense_ = area[drop] >= 0 ? 1 : -1;
  for (const Point& p : corners) flat_.push_back({p[(drop + 1) % 3], p[(drop + 2) % 3]});
  next_.resize(n);
  previous_.resize(n);
  for (int i = 0; i < ring_size_; ++i) {
    next(i) = (i + 1) % ring_size_;
    previous(i) = (i + ring_size_ - 1) % ring_size_;
  }
  side_.resize(n);
  quality_.assign(n, kUnknown);
}

/// b on the open segment from a to c, for three collinear points.
bool EarClipper::lies_between(int a, int b, int c) const {
  const double *p = at(a), *q = at(b), *r = at(c);
  const int axis = p[0] != r[0] ? 0 : 1;
  return (p[axis] < q[axis] && q[axis] < r[axis]) || (p[axis] > q[axis] && q[axis] > r[axis]);
}

bool EarClipper::is_in_triangle(int p, int a, int b, int c) const {
  const auto& q = flat_[std::size_t(p)];
  for (int corner : {a, b, c})
    if (flat_[std::size_t(corner)] == q) return false;  // the ring comes back to a corner: a bridge to a hole
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

double EarClipper::ear_quality(int b) {
  const int a = previous(b), c = next(b);
  if (turn(a, b, c) <= 0) return kNoEar;
  for (int p = next(c); p != a; p = next(p))
    if (is_in_triangle(p, a, b, c)) return kNoEar;
  return shape(corners_[std::size_t(a)], corners_[std::size_t(b)], corners_[std::size_t(c)]);
}

void EarClipper::remove_from_ring(int b) {
  const int a = previous(b), c = next(b);
  next(a) = c;
  previous(c) = a;
  quality_[std::size_t(a)] = quality_[std::size_t(c)] = kUnknown;
  start_ = a;
  --ring_size_;
}

bool EarClipper::drop_straight_corner() {
  int b = start_;
  for (int i = 0; i < ring_size_; ++i, b = next(b)) {
    const int a = previous(b), c = next(b);
    if (turn(a, b, c) != 0 || !lies_between(a, b, c)) continue;
    side(a).push_back(b);
    side(a).insert(side(a).end(), side(b).begin(), side(b).end());
    remove_from_ring(b);
    return true;
  }
  return false;
}

/// The best ear; where there is none, any corner, so that the work ends.
int EarClipper::find_ear() {
  for (int attempt = 0; attempt < 2; ++attempt) {
    int best = -1, b = start_;
    for (int i = 0; i < ring_size_; ++i, b = next(b)) {
      double& quality = quality_[std::size_t(b)];
      if (quality == kUnknown || attempt == 1) quality = ear_quality(b);
      if (quality > 0 && (best < 0 || quality > quality_[std::size_t(best)])) best = b;
    }
    if (best >= 0) return best;
  }
  return next(start_);
}

void EarClipper::emit(int a, int b, int c, Side ab, Side bc, Side ca) {
  if (ab.empty() && !bc.empty()) return emit(b, c, a, std::move(bc), std::move(ca), {});
  if (ab.empty() && !ca.empty()) return emit(c, a, b, std::move(ca), {}, {});
  if (ab.empty()) {
    triangles_.push_back({a, b, c});
    return;
  }
  // Split at the middle one of the waiting corners, so that the recursion stays shallow.
  const auto half = ab.begin() + std::ptrdiff_t(ab.size() / 2);
  const int middle = *half;
  const Side first(ab.begin(), half), second(half + 1, ab.end());
  emit(a, middle, c, first, {}, std::move(ca));
  emit(middle, b, c, second, std::move(bc), {});
}

std::vector<std::array<int, 3>> EarClipper::run() {
  while (ring_size_ > 3) {
    if (drop_straight_corner()) continue;
    const int b = find_ear(), a = previous(b), c = next(b);
    emit(a, b, c, std::move(side(a)), std::move(side(b)), {});
    side(a).clear();
    side(b).clear();
    remove_from_ring(b);
  }
  const int a = start_, b = next(a), c = next(b);
  emit(a, b, c, std::move(side(a)), std::move(side(b)), std::move(side(c)));
  return std::move(triangles_);
}

}  // namespace

std::vector<std::array<int, 3>> triangulate_polygon(std::span<const Point> corners) {
  return EarClipper(corners).run();
}

}  // namespace delfront
