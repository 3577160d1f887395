// SPDX-License-Identifier: Apache-2.0
// Validity is decided by signs of orient2d and by shared ends, never by lengths: two convex sets in the plane are
// disjoint just where a side of one of them has the other strictly behind it.
#include "planar/front_neighbours.hpp"

#include <algorithm>

namespace delfront {

namespace {

constexpr double kRoundoffOfFrame = 1e-14;  ///< of the largest coordinate a frame makes: more than six roundings

/// From the end c of a triangle's two sides to w: not into the triangle (e, c, g) nor along its sides. (e -> c -> g is
/// anticlockwise.)
bool leads_inside(Point2 e, Point2 c, Point2 g, Point2 w) { return orient2d(e, c, w) >= 0 && orient2d(c, g, w) >= 0; }

}  // namespace

void FrontNeighbours::gather(const SideGrid& grid, const FrontSide& side, const FrontFrame& frame, double reach) {
  own_ = side;
  length_ = frame.length;
  sides_.clear();
  candidates_.clear();
  const double half = std::max(reach, 0.5 * frame.length);
  const Point2 right = frame.from_frame({half, 0}) - frame.middle,
               up = frame.from_frame({0, 0.5 * half}) - frame.middle;
  const Point2 extent = {std::fabs(right.x) + std::fabs(up.x), std::fabs(right.y) + std::fabs(up.y)};
  const Point2 middle = frame.middle + up;
  // the middle is rounded as well: by a part of its own size, not of the extent
  const Point2 size = {extent.x + std::fabs(middle.x), extent.y + std::fabs(middle.y)};
  const double low_y = kRoundoffOfFrame * (std::fabs(frame.yx) * size.x + std::fabs(frame.yy) * size.y) * 4;
  const double reach2 = reach * reach;
  grid.for_each_near(middle - extent, middle + extent, [&](const FrontSide& s) {
    const Point2 at_a = frame.to_frame(s.a), at_b = frame.to_frame(s.b);
    if (std::max(at_a.y, at_b.y) < -low_y || s.id == own_.id) return;
    sides_.push_back({s.a, s.b, at_a, at_b, s.from, s.to});
    // Every point of the front is where a side begins.
    if (at_a.y > low_y && squared_length(at_a) <= reach2)
      candidates_.push_back({at_a, front_quality(frame.length, at_a), s.from});
  });
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return a.quality != b.quality ? a.quality > b.quality : a.v < b.v;
  });
}

bool FrontNeighbours::meets(const Side& s, Point2 p, VertexIndex apex) const {
  const VertexIndex a = own_.from, b = own_.to;
  const bool from_is_own = s.from == a || s.from == b || s.from == apex;
  const bool to_is_own = s.to == a || s.to == b || s.to == apex;
  if (from_is_own && to_is_own) return false;  // a side of the triangle, or the apex itself
  if (from_is_own || to_is_own) {
    const VertexIndex shared = from_is_own ? s.from : s.to;
    const Point2 w = from_is_own ? s.b : s.a;
    if (shared == a) return leads_inside(p, own_.a, own_.b, w);
    if (shared == b) return leads_inside(own_.a, own_.b, p, w);
    return leads_inside(own_.b, p, own_.a, w);
  }
  const int a_ab = orient2d(own_.a, own_.b, s.a), b_ab = orient2d(own_.a, own_.b, s.b);
  if (a_ab < 0 && b_ab < 0) return false;
  const int a_bp = orient2d(own_.b, p, s.a), b_bp = orient2d(own_.b, p, s.b);
  if (a_bp < 0 && b_bp < 0) return false;
  const int a_pa = orient2d(p, own_.a, s.a), b_pa = orient2d(p, own_.a, s.b);
  if (a_pa < 0 && b_pa < 0) return false;
  if ((a_ab >= 0 && a_bp >= 0 && a_pa >= 0) || (b_ab >= 0 && b_bp >= 0 && b_pa >= 0)) return true;
  const int side_of_a = orient2d(s.a, s.b, own_.a);
  return side_of_a == 0 || orient2d(s.a, s.b, own_.b) != side_of_a || orient2d(s.a, s.b, p) != side_of_a;
}

bool FrontNeighbours::is_free(Point2 p, VertexIndex apex) const {
  if (orient2d(own_.a, own_.b, p) <= 0) return false;
  for (const Side& s : sides_)
    if (meets(s, p, apex)) return false;
  return true;
}

bool FrontNeighbours::passes_near(const Candidate& apex, double distance) const {
  const double squared = distance * distance;
  const Point2 ends[2] = {{-0.5 * length_, 0}, {0.5 * length_, 0}};
  bool is_new[2] = {true, true};
  for (const Side& s : sides_) {
    is_new[0] = is_new[0] && !(s.from == apex.v && s.to == own_.from);
    is_new[1] = is_new[1] && !(s.from == own_.to && s.to == apex.v);
  }
  for (unsigned k = 0; k < 2; ++k) {
    if (!is_new[k]) continue;
    const Point2 along = apex.at - ends[k];
    const double l2 = squared_length(along);
    for (const Side& s : sides_) {
      const Point2 to = s.at_a - ends[k];
      const double projection = dot(to, along);
      if (projection <= 0 || projection >= l2 || s.from == apex.v || s.from == own_.from || s.from == own_.to) continue;
      const double area = cross(along, to);
      if (area * area < squared * l2) return true;
    }
  }
  return false;
}

bool FrontNeighbours::is_near(Point2 at, double to_points, double to_sides) const {
  const double points2 = to_points * to_points, sides2 = to_sides * to_sides;
  for (const Side& s : sides_) {
    const Point2 to = at - s.at_a;
    const double to_a2 = squared_length(to);
    if (to_a2 < points2) return true;  // every point of the front is where a side begins
    const Point2 along = s.at_b - s.at_a;
    const double l2 = squared_length(along), projection = dot(to, along);
    if (projection <= 0 || projection >= l2) continue;
    if (to_a2 * l2 - projection * projection < sides2 * l2) return true;
  }
  return false;
}

}  // namespace delfront
