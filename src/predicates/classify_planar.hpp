// SPDX-License-Identifier: Apache-2.0
#pragma once
// Plane geometry for classify_triangles: points that are known to lie in one plane, seen along an axis.
#include <array>

#include "predicates/predicates.hpp"

namespace delfront::detail {

/// @brief A point seen along an axis.
struct PlanePoint {
  double xy[2];
};

/// @brief View along `axis`; keeps no orientation (the callers compare signs among themselves).
inline PlanePoint project(const Point& p, int axis) { return {{p[axis == 0 ? 1 : 0], p[axis == 2 ? 1 : 2]}}; }

inline int turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) { return orient2d(a.xy, b.xy, c.xy); }

/// @brief A triangle that is not flat in the view, anticlockwise there.
using PlaneTriangle = std::array<PlanePoint, 3>;

/// @brief Closed triangle against point.
bool contains(const PlaneTriangle& t, const PlanePoint& p);

/// @brief Do the closed segments ab and cd have a point in common? Segments may be points.
bool segments_meet(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d);

/// @brief Do the closed segment and the closed triangle have a point in common?
bool segment_meets(const PlaneTriangle& t, const PlanePoint& a, const PlanePoint& b);

/// @brief Is p in the closed cone of the triangle at its corner i? True for p = that corner.
bool is_in_cone(const PlaneTriangle& t, int i, const PlanePoint& p);

/// @brief Are the interiors disjoint? (Some edge line has the other triangle wholly on its outer side or on itself.)
bool interiors_disjoint(const PlaneTriangle& p, const PlaneTriangle& q);

/// @brief An axis along which the three points are not in line, or -1 where they are in line in space.
int view_axis(const Point& a, const Point& b, const Point& c);

}  // namespace delfront::detail
