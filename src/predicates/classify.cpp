// SPDX-License-Identifier: Apache-2.0
// How two triangles meet, by exact signs only. I is their intersection (a convex set), S the convex hull of the corners
// they share by id. The answer:
//   none      I is empty or I = S
//   overlaps  I has area (and for three shared corners)
//   crosses   the relative interiors meet, without common area
//   touches   anything else
// Two facts do most of the work: S is always part of I, so where I is a single point a shared corner settles `none`;
// and two triangles in different planes that share an edge have I = that edge.
// Interval test on the common line of two planes after Guigue & Devillers (2003); the cases of contact are our own.
#include <array>
#include <utility>

#include "predicates/classify_planar.hpp"

namespace delfront {
namespace {

using detail::PlaneTriangle;
using detail::project;

/// @brief A triangle with the corners it shares marked.
struct Corners {
  Point at[3];
  bool shared[3] = {false, false, false};
  int num_shared = 0;  ///< different ids, so the same number for both triangles

  int first_shared() const { return shared[0] ? 0 : shared[1] ? 1 : 2; }
  bool is_shared_point(const Point& p) const {
    return (shared[0] && at[0] == p) || (shared[1] && at[1] == p) || (shared[2] && at[2] == p);
  }
};

Crossing report(Crossing crossing, Point place, Point* where) {
  if (where != nullptr) *where = place;
  return crossing;
}

bool boxes_disjoint(const Point p[3], const Point q[3]) {
  for (int k = 0; k < 3; ++k) {
    if (std::max({p[0][k], p[1][k], p[2][k]}) < std::min({q[0][k], q[1][k], q[2][k]})) return true;
    if (std::min({p[0][k], p[1][k], p[2][k]}) > std::max({q[0][k], q[1][k], q[2][k]})) return true;
  }
  return false;
}

PlaneTriangle view(const Point (&t)[3], int axis) {
  PlaneTriangle flat = {project(t[0], axis), project(t[1], axis), project(t[2], axis)};
  if (turn(flat[0], flat[1], flat[2]) < 0) std::swap(flat[1], flat[2]);
  return flat;
}

/// @brief A place in the common part of two triangles in one plane, by clipping in floating point (Sutherland &
/// Hodgman).
Point place_in_plane(const Point (&p)[3], const Point (&q)[3]) {
  const Point normal = cross(q[1] - q[0], q[2] - q[0]);
  std::array<Point, 9> polygon = {p[0], p[1], p[2]}, kept;
  int size = 3;
  for (int e = 0; e < 3; ++e) {
    const Point inward = cross(normal, q[(e + 1) % 3] - q[e]);
    int num_kept = 0;
    for (int i = 0; i < size; ++i) {
      const Point &a = polygon[i], &b = polygon[(i + 1) % size];
      const double da = dot(inward, a - q[e]), db = dot(inward, b - q[e]);
      if (da >= 0) kept[num_kept++] = a;
      if ((da >= 0) != (db >= 0) && num_kept < 9) kept[num_kept++] = a + (da / (da - db)) * (b - a);
    }
    if (num_kept == 0) break;
    polygon = kept;
    size = num_kept;
  }
  Point sum;
  for (int i = 0; i < size; ++i) sum = sum + polygon[i];
  return (1.0 / size) * sum;
}

/// @brief As above, for a segment.
Point place_of_segment(const Point& a, const Point& b, const Point (&q)[3]) { return place_in_plane({a, b, b}, q); }

// ---- both proper, in one plane -------------------------------------------------------------------------------------

Crossing classify_coplanar(const Corners& p, const Corners& q, int axis, Point* where) {
  const PlaneTriangle p2 = view(p.at, axis), q2 = view(q.at, axis);
  if (!interiors_disjoint(p2, q2)) return report(Crossing::overlaps, place_in_plane(p.at, q.at), where);
  if (p.num_shared == 2) return Crossing::none;  // the apexes are on opposite sides of the common edge
  // A line separates the triangles, so I is part of an edge of each: a corner of one of them is an end of I.
  for (int i = 0; i < 3; ++i)
    if (!p.shared[i] && contains(q2, project(p.at[i], axis))) return report(Crossing::touches, p.at[i], where);
  for (int i = 0; i < 3; ++i)
    if (!q.shared[i] && contains(p2, project(q.at[i], axis))) return report(Crossing::touches, q.at[i], where);
  return Crossing::none;
}

// ---- both proper, planes differ ------------------------------------------------------------------------------------

/// @brief p has only a corner or an edge in the plane of q, and nothing beyond the plane on one side.
Crossing classify_contact(const Corners& p, const int (&side)[3], const Corners& q, Point* where) {
  const int axis = detail::view_axis(q.at[0], q.at[1], q.at[2]);
  const PlaneTriangle q2 = view(q.at, axis);
  int in_plane[3], count = 0;
  for (int i = 0; i < 3; ++i)
    if (side[i] == 0) in_plane[count++] = i;
  const Point &a = p.at[in_plane[0]], &b = p.at[in_plane[count - 1]];
  if (p.num_shared == 0) {
    const bool meets =
        count == 1 ? contains(q2, project(a, axis)) : segment_meets(q2, project(a, axis), project(b, axis));
    if (!meets) return Crossing::none;
    if (count == 1 || contains(q2, project(a, axis))) return report(Crossing::touches, a, where);
    return report(Crossing::touches, contains(q2, project(b, axis)) ? b : place_of_segment(a, b, q.at), where);
  }
  if (count == 1) return Crossing::none;  // I is the shared corner
  const Point& end = p.shared[in_plane[0]] ? b : a;
  const Point& corner = p.shared[in_plane[0]] ? a : b;
  int i = 0;
  while (i < 2 && !(q2[i].xy[0] == project(corner, axis).xy[0] && q2[i].xy[1] == project(corner, axis).xy[1])) ++i;
  if (!is_in_cone(q2, i, project(end, axis))) return Crossing::none;
  return report(Crossing::touches, place_of_segment(corner, end, q.at), where);
}

/// @brief Where the edge a-b meets the plane of q, approximately.
Point edge_meets_plane(const Point& a, const Point& b, const Point (&q)[3]) {
  const Point normal = cross(q[1] - q[0], q[2] - q[0]);
  const double da = dot(normal, a - q[0]), db = dot(normal, b - q[0]);
  const double t = da == db ? 0.5 : std::clamp(da / (da - db), 0.0, 1.0);
  return a + t * (b - a);
}

/// @brief Middle of the common part of the two intervals on the common line.
Point middle_of_overlap(const Point (&p)[3], const Point (&q)[3]) {
  std::array<Point, 4> ends = {edge_meets_plane(p[0], p[1], q), edge_meets_plane(p[0], p[2], q),
                               edge_meets_plane(q[0], q[1], p), edge_meets_plane(q[0], q[2], p)};
  const Point d = distance(ends[0], ends[1]) > distance(ends[2], ends[3]) ? ends[1] - ends[0] : ends[3] - ends[2];
  std::sort(ends.begin(), ends.end(), [&](const Point& a, const Point& b) { return dot(a, d) < dot(b, d); });
  return 0.5 * (ends[1] + ends[2]);
}

/// @brief Rotate so that corner 0 is alone on its side.
void put_alone_first(Point (&t)[3], int (&side)[3]) {
  int i = 0;
  while (side[i] == 0 || side[(i + 1) % 3] == side[i] || side[(i + 2) % 3] == side[i]) ++i;
  std::rotate(t, t + i, t + 3);
  std::rotate(side, side + i, side + 3);
}

/// @brief Each triangle has corners strictly on both sides of the other's plane: compare intervals on the common line.
Crossing classify_intervals(const Corners& p_in, int (&p_side)[3], const Corners& q_in, int (&q_side)[3],
                            Point* where) {
  Point p[3], q[3];
  std::copy(p_in.at, p_in.at + 3, p);
  std::copy(q_in.at, q_in.at + 3, q);
  put_alone_first(p, p_side);
  put_alone_first(q, q_side);
  // Turn each triangle so that the other's corner 0 is above it. Then, with i, j where p's edges 01, 02 and k, l where
  // q's edges 01, 02 meet the line, the intervals are [j, i] and [k, l] in one and the same direction.
  if (p_side[0] < 0) std::swap(q[1], q[2]);
  if (q_side[0] < 0) std::swap(p[1], p[2]);
  const int ki = -orient3d(p[0], p[1], q[0], q[1]);  // sign of i - k
  if (ki < 0) return Crossing::none;
  const int jl = orient3d(p[0], p[2], q[0], q[2]);  // sign of l - j
  if (jl < 0) return Crossing::none;
  if (ki > 0 && jl > 0) return report(Crossing::crosses, middle_of_overlap(p, q), where);
  if (p_in.num_shared > 0) return Crossing::none;  // one point, hence the shared corner
  return report(Crossing::touches, edge_meets_plane(p[0], ki == 0 ? p[1] : p[2], q), where);
}

// ---- flat triangles ------------------------------------------------------------------------------------------------

/// @brief Ends of a flat triangle, which is a segment or a point: the least and the greatest corner.
std::pair<Point, Point> ends_of(const Corners& t) {
  const auto less = [](const Point& a, const Point& b) { return compare_xyz(a, b) < 0; };
  return {std::min({t.at[0], t.at[1], t.at[2]}, less), std::max({t.at[0], t.at[1], t.at[2]}, less)};
}

Crossing classify_flat_in_plane(const Corners& s, const Point& a, const Point& b, const Corners& q, int axis,
                                Point* where) {
  const PlaneTriangle q2 = view(q.at, axis);
  if (s.num_shared >= 2) return Crossing::none;  // in line with an edge of q: I is that edge
  if (s.num_shared == 0) {
    if (!segment_meets(q2, project(a, axis), project(b, axis))) return Crossing::none;
    const bool has_a = contains(q2, project(a, axis)), has_b = contains(q2, project(b, axis));
    return report(Crossing::touches, has_a ? a : has_b ? b : place_of_segment(a, b, q.at), where);
  }
  const Point corner = s.at[s.first_shared()];
  const auto corner2 = project(corner, axis);
  int i = 0;
  while (i < 2 && !(q2[i].xy[0] == corner2.xy[0] && q2[i].xy[1] == corner2.xy[1])) ++i;
  for (const Point& end : {a, b})
    if (end != corner && is_in_cone(q2, i, project(end, axis)))
      return report(Crossing::touches, place_of_segment(corner, end, q.at), where);
  return Crossing::none;
}

/// @brief Segment (the flat triangle s) against a proper triangle q.
Crossing classify_flat(const Corners& s, const Corners& q, int axis, Point* where) {
  const auto [a, b] = ends_of(s);
  const int side_a = orient3d(q.at[0], q.at[1], q.at[2], a), side_b = orient3d(q.at[0], q.at[1], q.at[2], b);
  if (side_a == 0 && side_b == 0) return classify_flat_in_plane(s, a, b, q, axis, where);
  if (side_a == side_b || s.num_shared > 0) return Crossing::none;  // none, or one point, hence the shared corner
  if (side_a == 0 || side_b == 0) {
    const Point& end = side_a == 0 ? a : b;
    return contains(view(q.at, axis), project(end, axis)) ? report(Crossing::touches, end, where) : Crossing::none;
  }
  int low = 1, high = -1;
  for (int i = 0; i < 3; ++i) {
    const int turn = orient3d(a, b, q.at[i], q.at[(i + 1) % 3]);
    low = std::min(low, turn);
    high = std::max(high, turn);
  }
  if (low < 0 && high > 0) return Crossing::none;
  return report(low == high ? Crossing::crosses : Crossing::touches, edge_meets_plane(a, b, q.at), where);
}

/// @brief Two flat triangles in one line: intervals in the order of coordinates.
Crossing classify_in_line(const Corners& s, const Corners& t, Point* where) {
  const auto [s_low, s_high] = ends_of(s);
  const auto [t_low, t_high] = ends_of(t);
  const Point low = compare_xyz(s_low, t_low) < 0 ? t_low : s_low;
  const Point high = compare_xyz(s_high, t_high) < 0 ? s_high : t_high;
  if (compare_xyz(low, high) > 0) return Crossing::none;
  if (s.is_shared_point(low) && s.is_shared_point(high)) return Crossing::none;
  return report(Crossing::touches, 0.5 * (low + high), where);
}

Crossing classify_both_flat(const Corners& s, const Corners& t, Point* where) {
  const auto [a, b] = ends_of(s);
  const auto [c, d] = ends_of(t);
  if (orient3d(a, b, c, d) != 0) return Crossing::none;
  int axis = detail::view_axis(a, b, c);
  if (axis < 0) axis = detail::view_axis(a, b, d);
  if (axis < 0) axis = detail::view_axis(a, c, d);
  if (axis < 0) axis = detail::view_axis(b, c, d);
  if (axis < 0) return classify_in_line(s, t, where);
  if (s.num_shared > 0) return Crossing::none;
  if (!segments_meet(project(a, axis), project(b, axis), project(c, axis), project(d, axis))) return Crossing::none;
  const Point normal = cross(b - a, d - c);
  const double size = squared_length(normal);
  const double along = size > 0 ? dot(cross(c - a, d - c), normal) / size : 0.5;
  return report(Crossing::touches, a + std::clamp(along, 0.0, 1.0) * (b - a), where);
}

// ---- the cases -----------------------------------------------------------------------------------------------------

/// @brief All corners of one triangle in the plane of the other: in one plane, or one of them is flat.
Crossing classify_degenerate(const Corners& p, const Corners& q, Point* where) {
  const int p_axis = detail::view_axis(p.at[0], p.at[1], p.at[2]);
  const int q_axis = detail::view_axis(q.at[0], q.at[1], q.at[2]);
  if (p_axis >= 0 && q_axis >= 0) return classify_coplanar(p, q, p_axis, where);
  if (p_axis < 0 && q_axis < 0) return classify_both_flat(p, q, where);
  return p_axis < 0 ? classify_flat(p, q, q_axis, where) : classify_flat(q, p, p_axis, where);
}

/// @brief Side of each corner of p to the plane of q; shared ones are in it.
void find_sides(const Corners& p, const Corners& q, int (&side)[3]) {
  for (int i = 0; i < 3; ++i) side[i] = p.shared[i] ? 0 : orient3d(q.at[0], q.at[1], q.at[2], p.at[i]);
}

bool is_strictly_on_one_side(const int (&side)[3]) { return side[0] != 0 && side[0] == side[1] && side[0] == side[2]; }
bool is_on_both_sides(const int (&side)[3]) {
  return std::min({side[0], side[1], side[2]}) < 0 && std::max({side[0], side[1], side[2]}) > 0;
}
bool is_zero(const int (&side)[3]) { return side[0] == 0 && side[1] == 0 && side[2] == 0; }

}  // namespace

Crossing classify_triangles(const Point p_at[3], const unsigned p_id[3], const Point q_at[3], const unsigned q_id[3],
                            Point* where) {
  if (boxes_disjoint(p_at, q_at)) return Crossing::none;
  Corners p, q;
  for (int i = 0; i < 3; ++i) {
    p.at[i] = p_at[i];
    q.at[i] = q_at[i];
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (p_id[i] == q_id[j]) p.shared[i] = q.shared[j] = true;
  for (int i = 0; i < 3; ++i)  // a flat triangle may hold a corner twice
    p.num_shared += p.shared[i] && !(i > 0 && p_id[i] == p_id[0]) && !(i > 1 && p_id[i] == p_id[1]);
  q.num_shared = p.num_shared;
  if (p.num_shared == 3) return report(Crossing::overlaps, (1 / 3.0) * (p.at[0] + p.at[1] + p.at[2]), where);

  int p_side[3], q_side[3];
  find_sides(p, q, p_side);
  if (is_strictly_on_one_side(p_side)) return Crossing::none;
  if (is_zero(p_side)) return classify_degenerate(p, q, where);
  if (p.num_shared == 2) return Crossing::none;  // planes differ, or p is proper and q flat along the common edge
  find_sides(q, p, q_side);
  if (is_strictly_on_one_side(q_side)) return Crossing::none;
  if (is_zero(q_side)) return classify_degenerate(p, q, where);
  if (!is_on_both_sides(p_side)) return classify_contact(p, p_side, q, where);
  if (!is_on_both_sides(q_side)) return classify_contact(q, q_side, p, where);
  return classify_intervals(p, p_side, q, q_side, where);
}

}  // namespace delfront
