// SPDX-License-Identifier: Apache-2.0
#pragma once
// First layer of the predicates: semi-static filters, inline so that the Delaunay kernel calls nothing on the usual
// path. Included by predicates.hpp only.
//
// Notation of the error bounds: u = 2^-53 is the unit roundoff; X, Y, Z the largest |computed difference| on each axis,
// so that every computed entry is (exact entry)(1 + d) with |d| <= u, and at most X. All bounds below count terms of
// order u; one more u pays for the terms of order u^2 and for rounding in the bound itself.
// Underflow: with |coordinate| <= 2^100 a product that underflows is wrong by at most 2^-1075, which the factors that
// follow make at most 2^-970 (orient3d) and 2^-764 (insphere); the kTiny constants pay for that, so that there is no
// smallest allowed difference.
#include "predicates/predicates.hpp"

namespace delfront {
namespace detail {

inline constexpr double kRoundoff = 0x1p-53;
// Products of two differences: 2u (entries) + u (product) of XY each, their difference (at most 2XY) one u more: 8u XY.
inline constexpr double kOrient2dBound = 9 * kRoundoff;
// 2x2 minors 8u YZ as above, at most 2YZ. Times an entry: 8u + 2u (entry) + 2u (product) = 12u, at most 2XYZ. Sum of
// three: 36u + 4u + 6u = 46u XYZ.
inline constexpr double kOrient3dBound = 47 * kRoundoff;
// Lift: squares 3u each, two sums: 5u L with L the largest lift. Minor (8u XY, at most 2XY) times lift: 8u + 10u + 2u =
// 20u, at most 2XYL. Sum of three: 60u + 4u + 6u = 70u XYL.
inline constexpr double kIncircleBound = 71 * kRoundoff;
// 3x3 minors 46u XYZ, at most 6XYZ. Times a lift (5u L): 46u + 30u + 6u = 82u, at most 6XYZL. Sum of four in pairs:
// 328u + 2 * 12u + 24u = 376u XYZL.
inline constexpr double kInsphereBound = 378 * kRoundoff;
inline constexpr double kTinyPlane = 0x1p-660;  ///< orient2d 2^-1073, incircle 2^-868 needed
inline constexpr double kTinyOrient3d = 0x1p-960;
inline constexpr double kTinyInsphere = 0x1p-760;

// Exact layers, out of line. Not marked cold: that would have them compiled for size, and degenerate input is common.
[[gnu::noinline]] int orient2d_exact(const double* a, const double* b, const double* c);
[[gnu::noinline]] int orient3d_exact(const Point& a, const Point& b, const Point& c, const Point& d);
[[gnu::noinline]] int incircle_exact(const double* a, const double* b, const double* c, const double* d);
[[gnu::noinline]] int insphere_exact(const Point& a, const Point& b, const Point& c, const Point& d, const Point& e);
[[gnu::noinline]] int insphere_tie(const Point& a, const Point& b, const Point& c, const Point& d, const Point& e);
[[gnu::noinline]] int orient3d_segment(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c,
                                       const ExactPoint& d);
[[gnu::noinline]] int insphere_segment(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c,
                                       const ExactPoint& d, const ExactPoint& e);
[[gnu::noinline]] int insphere_tie(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d,
                                   const ExactPoint& e);
[[gnu::noinline]] int compare_segment(const ExactPoint& a, const ExactPoint& b);

inline double max3(double a, double b, double c) {
  return std::max(std::max(std::fabs(a), std::fabs(b)), std::fabs(c));
}

/// @brief A determinant in plain arithmetic with the extents its error bound needs.
struct Evaluation {
  double det, x, y, z, lift = 0;
};

/// @brief Plain det[b - a, c - a, d - a], by differences to d.
inline Evaluation evaluate_orient3d(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double ax = a.x - d.x, ay = a.y - d.y, az = a.z - d.z;
  const double bx = b.x - d.x, by = b.y - d.y, bz = b.z - d.z;
  const double cx = c.x - d.x, cy = c.y - d.y, cz = c.z - d.z;
  const double det = az * (by * cx - bx * cy) + bz * (cy * ax - cx * ay) + cz * (ay * bx - ax * by);
  return {det, max3(ax, bx, cx), max3(ay, by, cy), max3(az, bz, cz)};
}

/// @brief Plain in-sphere determinant (> 0 inside), by differences to e.
inline Evaluation evaluate_insphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& e) {
  const double ax = a.x - e.x, ay = a.y - e.y, az = a.z - e.z;
  const double bx = b.x - e.x, by = b.y - e.y, bz = b.z - e.z;
  const double cx = c.x - e.x, cy = c.y - e.y, cz = c.z - e.z;
  const double dx = d.x - e.x, dy = d.y - e.y, dz = d.z - e.z;
  const double ab = ax * by - bx * ay, bc = bx * cy - cx * by, cd = cx * dy - dx * cy;
  const double da = dx * ay - ax * dy, ac = ax * cy - cx * ay, bd = bx * dy - dx * by;
  const double abc = az * bc - bz * ac + cz * ab, bcd = bz * cd - cz * bd + dz * bc;
  const double cda = cz * da + dz * ac + az * cd, dab = dz * ab + az * bd + bz * da;
  const double a2 = ax * ax + ay * ay + az * az, b2 = bx * bx + by * by + bz * bz;
  const double c2 = cx * cx + cy * cy + cz * cz, d2 = dx * dx + dy * dy + dz * dz;
  const double det = (a2 * bcd - b2 * cda) + (c2 * dab - d2 * abc);
  return {det, std::max(max3(ax, bx, cx), std::fabs(dx)), std::max(max3(ay, by, cy), std::fabs(dy)),
          std::max(max3(az, bz, cz), std::fabs(dz)), std::max(std::max(a2, b2), std::max(c2, d2))};
}

}  // namespace detail

inline int orient2d(const double* a, const double* b, const double* c) {
  const double ax = a[0] - c[0], ay = a[1] - c[1], bx = b[0] - c[0], by = b[1] - c[1];
  const double det = ax * by - bx * ay;
  const double extent = std::max(std::fabs(ax), std::fabs(bx)) * std::max(std::fabs(ay), std::fabs(by));
  const double bound = detail::kOrient2dBound * extent + detail::kTinyPlane;
  if (std::fabs(det) > bound) [[likely]]
    return det > 0 ? 1 : -1;
  return detail::orient2d_exact(a, b, c);
}

inline int orient3d(Point a, Point b, Point c, Point d) {
  const detail::Evaluation v = detail::evaluate_orient3d(a, b, c, d);
  const double bound = detail::kOrient3dBound * v.x * v.y * v.z + detail::kTinyOrient3d;
  if (std::fabs(v.det) > bound) [[likely]]
    return v.det > 0 ? 1 : -1;
  return detail::orient3d_exact(a, b, c, d);
}

inline int incircle(const double* a, const double* b, const double* c, const double* d) {
  const double ax = a[0] - d[0], ay = a[1] - d[1], bx = b[0] - d[0], by = b[1] - d[1];
  const double cx = c[0] - d[0], cy = c[1] - d[1];
  const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const double det = a2 * (bx * cy - cx * by) + b2 * (cx * ay - ax * cy) + c2 * (ax * by - bx * ay);
  const double extent = detail::max3(ax, bx, cx) * detail::max3(ay, by, cy) * detail::max3(a2, b2, c2);
  if (std::fabs(det) > detail::kIncircleBound * extent + detail::kTinyPlane) [[likely]]
    return det > 0 ? 1 : -1;
  return detail::incircle_exact(a, b, c, d);
}

inline int insphere(Point a, Point b, Point c, Point d, Point e) {
  const detail::Evaluation v = detail::evaluate_insphere(a, b, c, d, e);
  const double bound = detail::kInsphereBound * v.x * v.y * v.z * v.lift + detail::kTinyInsphere;
  if (std::fabs(v.det) > bound) [[likely]]
    return v.det > 0 ? 1 : -1;
  return detail::insphere_exact(a, b, c, d, e);
}

inline int insphere_perturbed(Point a, Point b, Point c, Point d, Point e) {
  const int sign = insphere(a, b, c, d, e);
  if (sign != 0) [[likely]]
    return sign;
  return detail::insphere_tie(a, b, c, d, e);
}

inline int compare_xyz(Point a, Point b) {
  if (a.x != b.x) return a.x < b.x ? -1 : 1;
  if (a.y != b.y) return a.y < b.y ? -1 : 1;
  if (a.z != b.z) return a.z < b.z ? -1 : 1;
  return 0;
}

inline int orient3d(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d) {
  if (a.is_explicit() && b.is_explicit() && c.is_explicit() && d.is_explicit()) [[likely]]
    return orient3d(a.approx, b.approx, c.approx, d.approx);
  return detail::orient3d_segment(a, b, c, d);
}

inline int insphere(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d,
                    const ExactPoint& e) {
  if (a.is_explicit() && b.is_explicit() && c.is_explicit() && d.is_explicit() && e.is_explicit()) [[likely]]
    return insphere(a.approx, b.approx, c.approx, d.approx, e.approx);
  return detail::insphere_segment(a, b, c, d, e);
}

inline int insphere_perturbed(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d,
                              const ExactPoint& e) {
  const int sign = insphere(a, b, c, d, e);
  if (sign != 0) [[likely]]
    return sign;
  return detail::insphere_tie(a, b, c, d, e);
}

inline int compare_xyz(const ExactPoint& a, const ExactPoint& b) {
  if (a.is_explicit() && b.is_explicit()) [[likely]]
    return compare_xyz(a.approx, b.approx);
  return detail::compare_segment(a, b);
}

}  // namespace delfront
