// SPDX-License-Identifier: Apache-2.0
// Predicates on points given as a + t (b - a): filter on the approximate coordinates, then exact integers.
#include "predicates/load_exact.hpp"

namespace delfront {

ExactPoint ExactPoint::on_segment(Point a, Point b, double t) {
  if (!(t > 0)) return explicit_point(a);
  if (!(t < 1)) return explicit_point(b);
  ExactPoint p{{}, a, b, t};
  for (int k = 0; k < 3; ++k) {
    // Compensated: d + dt is b - a, product + product_tail is t d, s + e is a + product, each exactly.
    const double d = b[k] - a[k], av = b[k] - d, bv = d + av, dt = (b[k] - bv) + (av - a[k]);
    const double product = t * d, product_tail = std::fma(t, d, -product);
    const double s = a[k] + product, v = s - a[k], e = (a[k] - (s - v)) + (product - v);
    p.approx[k] = s + (e + (product_tail + t * dt));
  }
  return p;
}

namespace detail {
namespace {

/// @brief Twice the largest error of an approximate coordinate on one axis: what a difference may be off by.
/// A segment point's approximation is off by at most kSegmentPointError times its larger end, plus underflow.
template <std::size_t N>
Point difference_errors(const ExactPoint* const (&points)[N]) {
  Point error;
  for (const ExactPoint* p : points) {
    if (p->is_explicit()) continue;
    for (int k = 0; k < 3; ++k) error[k] = std::max({error[k], std::fabs(p->a[k]), std::fabs(p->b[k])});
  }
  return (2 * kSegmentPointError) * error + Point{0x1p-1070, 0x1p-1070, 0x1p-1070};
}

}  // namespace

// With X' = X + error_x and so on, every product in the determinant of exact entries differs from that of approximate
// ones by at most X'Y'Z' - XYZ, and there are 6; rounding is at most 46u X'Y'Z' as in the filter for explicit points.
// The subtraction X'Y'Z' - XYZ itself is off by 5u X'Y'Z', 6 times: 30u. Sum: 76u, taken as 80u.
int orient3d_segment(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d) {
  const ExactPoint* const p[4] = {&a, &b, &c, &d};
  const Evaluation v = evaluate_orient3d(a.approx, b.approx, c.approx, d.approx);
  const Point error = difference_errors(p);
  const double wide = (v.x + error.x) * (v.y + error.y) * (v.z + error.z);
  const double bound = 6 * (wide - v.x * v.y * v.z) + 80 * kRoundoff * wide + kTinyOrient3d;
  if (std::fabs(v.det) > bound) return v.det > 0 ? 1 : -1;
  return -exact_sign<3, 3>(p, [](const auto& rows) { return det3_sign(rows); });
}

// As above with 24 products of three entries and a lift; the lift is off by at most 2 (X ex + Y ey + Z ez) + ex² + ey²
// + ez² <= 2 (X' ex + Y' ey + Z' ez). Rounding 376u, the subtraction 24 * 7u = 168u; sum 544u, taken as 600u.
int insphere_segment(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d,
                     const ExactPoint& e) {
  const ExactPoint* const p[5] = {&a, &b, &c, &d, &e};
  const Evaluation v = evaluate_insphere(a.approx, b.approx, c.approx, d.approx, e.approx);
  const Point error = difference_errors(p);
  const double x = v.x + error.x, y = v.y + error.y, z = v.z + error.z;
  const double wide = x * y * z * (v.lift + 2 * (x * error.x + y * error.y + z * error.z));
  const double bound = 24 * (wide - v.x * v.y * v.z * v.lift) + 600 * kRoundoff * wide + kTinyInsphere;
  if (std::fabs(v.det) > bound) return v.det > 0 ? 1 : -1;
  return exact_sign<4, 3>(p, [](const auto& rows) { return insphere_sign(rows); });
}

int compare_segment(const ExactPoint& a, const ExactPoint& b) {
  const ExactPoint* const p[2] = {&a, &b};
  const Point error = difference_errors(p);
  for (int k = 0; k < 3; ++k) {
    const double d = a.approx[k] - b.approx[k];
    if (std::fabs(d) > 2 * error[k]) return d > 0 ? 1 : -1;
    BinaryRange range;
    add_coordinate(range, a, k);
    add_coordinate(range, b, k);
    const int bits = range.difference_bits();
    const auto difference_sign = [&]<int L>() {
      return sign(exact_coordinate<L>(a, k, range.low) - exact_coordinate<L>(b, k, range.low));
    };
    const int s = bits == 0             ? 0
                  : bits <= max_bits(2) ? difference_sign.operator()<2>()
                                        : difference_sign.operator()<50>();
    if (s != 0) return s;
  }
  return 0;
}

}  // namespace detail
}  // namespace delfront
