// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/point.hpp"

namespace delfront {

/// @brief Error of ExactPoint::approx on an axis, relative to the larger |coordinate| of the segment's ends: half a
/// unit in the last place for the last rounding, as much again for everything of second order (and underflow aside).
inline constexpr double kSegmentPointError = 0x1p-52;

/// @brief A point given exactly: itself, or a + t (b - a) on a segment, evaluated without rounding.
///
/// `approx` is the coordinates for an explicit point; for a segment point it is the nearest double (each coordinate
/// within kSegmentPointError * max(|a|, |b|) of the exact value), used by filters only.
struct ExactPoint {
  Point approx;
  Point a, b;     ///< segment points only
  double t = -1;  ///< in (0, 1) for a segment point, negative for an explicit one

  static ExactPoint explicit_point(Point p) { return {p, {}, {}, -1}; }
  /// @brief a + t (b - a); the end itself, explicit, where t <= 0 or t >= 1.
  static ExactPoint on_segment(Point a, Point b, double t);
  bool is_explicit() const { return t < 0; }
};

// Every predicate returns the exact sign (-1, 0, +1) of its determinant: an inline semi-static filter first, then exact
// integers of the least width that holds the differences (one 64-bit limb in nearly every degenerate case in practice).
// Coordinates must be finite and |x| <= 2^100; there is no smallest allowed difference. The filter is at its best where
// the largest coordinate is about 1 (the caller scales the model by a power of two).

/// @brief Sign of det[b - a, c - a] in the plane (x, y): +1 where a, b, c turn anticlockwise.
int orient2d(const double* a, const double* b, const double* c);

/// @brief Sign of det[b - a, c - a, d - a]: +1 where the tetrahedron (a, b, c, d) is positive.
int orient3d(Point a, Point b, Point c, Point d);
int orient3d(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d);

/// @brief +1 where d lies inside the circle through a, b, c (anticlockwise), 0 on it.
int incircle(const double* a, const double* b, const double* c, const double* d);

/// @brief +1 where e lies inside the sphere through the positive tetrahedron (a, b, c, d), 0 on it.
int insphere(Point a, Point b, Point c, Point d, Point e);
int insphere(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d, const ExactPoint& e);

/// @brief As insphere, never 0 for five distinct points that are not all coplanar: cospherical points are decided by a
/// symbolic perturbation of the lifted coordinate, ordered by the points' coordinates (Devillers & Teillaud 2011).
int insphere_perturbed(Point a, Point b, Point c, Point d, Point e);
int insphere_perturbed(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d,
                       const ExactPoint& e);

/// @brief Lexicographic order of exact coordinates: -1, 0, +1.
int compare_xyz(Point a, Point b);
int compare_xyz(const ExactPoint& a, const ExactPoint& b);

/// @brief Sign of (b - a) . (c - a) exactly: > 0 for an acute angle at a.
int dot_sign(Point a, Point b, Point c);

/// @brief How two triangles meet, decided exactly, shared corners by id.
enum class Crossing : unsigned char {
  none,      ///< disjoint, or they share just the corners/edge they have in common
  touches,   ///< a point or segment in common that is not a common corner or edge (vertex on face, T-junction …)
  crosses,   ///< they properly cross
  overlaps,  ///< coplanar with common area
};

/// @brief Triangles p and q with vertex ids: `shared` corners are those whose ids are equal.
/// @param[out] where  a place in the intersection (approximate), when not none
Crossing classify_triangles(const Point p[3], const unsigned p_id[3], const Point q[3], const unsigned q_id[3],
                            Point* where);

}  // namespace delfront

#include "predicates/predicates_inline.hpp"
