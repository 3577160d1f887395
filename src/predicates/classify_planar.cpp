// SPDX-License-Identifier: Apache-2.0
#include "predicates/classify_planar.hpp"

namespace delfront::detail {

bool contains(const PlaneTriangle& t, const PlanePoint& p) {
  return turn(t[0], t[1], p) >= 0 && turn(t[1], t[2], p) >= 0 && turn(t[2], t[0], p) >= 0;
}

namespace {

/// @brief For p on the line ab: is it on the closed segment?
bool is_between(const PlanePoint& a, const PlanePoint& b, const PlanePoint& p) {
  for (int k = 0; k < 2; ++k)
    if (p.xy[k] < std::min(a.xy[k], b.xy[k]) || p.xy[k] > std::max(a.xy[k], b.xy[k])) return false;
  return true;
}

}  // namespace

bool segments_meet(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  const int ab_c = turn(a, b, c), ab_d = turn(a, b, d), cd_a = turn(c, d, a), cd_b = turn(c, d, b);
  if (ab_c * ab_d < 0 && cd_a * cd_b < 0) return true;
  return (ab_c == 0 && is_between(a, b, c)) || (ab_d == 0 && is_between(a, b, d)) ||
         (cd_a == 0 && is_between(c, d, a)) || (cd_b == 0 && is_between(c, d, b));
}

bool segment_meets(const PlaneTriangle& t, const PlanePoint& a, const PlanePoint& b) {
  if (contains(t, a) || contains(t, b)) return true;
  for (int i = 0; i < 3; ++i)
    if (segments_meet(t[i], t[(i + 1) % 3], a, b)) return true;
  return false;
}

bool is_in_cone(const PlaneTriangle& t, int i, const PlanePoint& p) {
  return turn(t[i], t[(i + 1) % 3], p) >= 0 && turn(t[(i + 2) % 3], t[i], p) >= 0;
}

bool interiors_disjoint(const PlaneTriangle& p, const PlaneTriangle& q) {
  const auto separates = [](const PlaneTriangle& t, const PlaneTriangle& other) {
    for (int i = 0; i < 3; ++i) {
      const PlanePoint &a = t[i], &b = t[(i + 1) % 3];
      if (turn(a, b, other[0]) <= 0 && turn(a, b, other[1]) <= 0 && turn(a, b, other[2]) <= 0) return true;
    }
    return false;
  };
  return separates(p, q) || separates(q, p);
}

int view_axis(const Point& a, const Point& b, const Point& c) {
  const Point n = cross(b - a, c - a);
  const double size[3] = {std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)};
  const int likely = size[0] > size[1] ? (size[0] > size[2] ? 0 : 2) : (size[1] > size[2] ? 1 : 2);
  for (int i = 0; i < 3; ++i) {
    const int axis = (likely + i) % 3;
    if (turn(project(a, axis), project(b, axis), project(c, axis)) != 0) return axis;
  }
  return -1;
}

}  // namespace delfront::detail
