// SPDX-License-Identifier: Apache-2.0
// Exact layer for explicit points. Instead of floating-point expansions, the differences become integers on a common
// power-of-two scale, and the determinant is evaluated in fixed-width integer arithmetic: one 64-bit limb a difference
// where 61 bits do (nearly always: points close together, lattices, points on a sphere), wider ones by need, up to the
// whole range of double. No allocation, no underflow, and the cost does not depend on how degenerate the case is.
#include "predicates/load_exact.hpp"

namespace delfront {
namespace detail {
namespace {

template <int Rows, int Axes, class Kernel>
int sign_of(const double (&p)[Rows + 1][Axes], const Kernel& kernel) {
  FixedInt<1> rows[Rows][Axes];
  if (load_small<Rows, Axes>(p, rows)) return kernel(rows);
  ExactPoint exact[Rows + 1];
  const ExactPoint* pointer[Rows + 1];
  for (int i = 0; i <= Rows; ++i) {
    for (int k = 0; k < Axes; ++k) exact[i].approx[k] = p[i][k];
    pointer[i] = &exact[i];
  }
  return exact_sign<Rows, Axes>(pointer, kernel);
}

/// @brief Every coordinate the same along some axis: the determinant is 0 whatever the others.
template <int Count>
bool is_flat_on_an_axis(const double (&p)[Count][3]) {
  for (int k = 0; k < 3; ++k) {
    bool all_equal = true;
    for (int i = 1; i < Count; ++i) all_equal &= p[i][k] == p[0][k];
    if (all_equal) return true;
  }
  return false;
}

}  // namespace

int orient2d_exact(const double* a, const double* b, const double* c) {
  const double p[3][2] = {{a[0], a[1]}, {b[0], b[1]}, {c[0], c[1]}};
  return sign_of<2, 2>(p, [](const auto& rows) { return det2_sign(rows); });
}

int orient3d_exact(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double p[4][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}, {d.x, d.y, d.z}};
  if (is_flat_on_an_axis(p)) return 0;
  return -sign_of<3, 3>(p, [](const auto& rows) { return det3_sign(rows); });
}

int incircle_exact(const double* a, const double* b, const double* c, const double* d) {
  const double p[4][2] = {{a[0], a[1]}, {b[0], b[1]}, {c[0], c[1]}, {d[0], d[1]}};
  return sign_of<3, 2>(p, [](const auto& rows) { return incircle_sign(rows); });
}

int insphere_exact(const Point& a, const Point& b, const Point& c, const Point& d, const Point& e) {
  const double p[5][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}, {d.x, d.y, d.z}, {e.x, e.y, e.z}};
  if (is_flat_on_an_axis(p)) return 0;
  return sign_of<4, 3>(p, [](const auto& rows) { return insphere_sign(rows); });
}

namespace {

// Cospherical points. The determinant with rows (x, y, z, w, 1) and w_i + eps_i for the lift is
//   D = D_0 + sum_i eps_i C_i,   C_i = (-1)^(i+3) det[the other rows (x, y, z, 1)] = (-1)^i orient3d(the other four),
// and insphere = -D (raising e's lift takes it out of the sphere of a positive a, b, c, d). The eps_i are positive,
// that of the lexicographically largest point dominates, and so on down: the first C_i != 0 in that order gives the
// sign. No point order but the coordinates' is used, so any renumbering gives the same triangulation.
bool comes_after(const Point& a, const Point& b) {  // without branches, which would be unpredictable here
  return (a.x > b.x) | ((a.x == b.x) & ((a.y > b.y) | ((a.y == b.y) & (a.z > b.z))));
}
bool comes_after(const ExactPoint& a, const ExactPoint& b) { return compare_xyz(a, b) > 0; }

template <class AnyPoint>
int sign_of_tie(const AnyPoint* const (&p)[5]) {
  static constexpr unsigned char kOthers[5][4] = {{1, 2, 3, 4}, {0, 2, 3, 4}, {0, 1, 3, 4}, {0, 1, 2, 4}, {0, 1, 2, 3}};
  int left[5] = {0, 1, 2, 3, 4};
  for (int count = 5; count > 0; --count) {  // nearly always the first or second decides: no need to sort them all
    int largest = 0;
    for (int k = 1; k < count; ++k) largest = comes_after(*p[left[k]], *p[left[largest]]) ? k : largest;
    const int i = left[largest];
    left[largest] = left[count - 1];
    const unsigned char* q = kOthers[i];
    const int orientation = orient3d(*p[q[0]], *p[q[1]], *p[q[2]], *p[q[3]]);
    if (orientation != 0) return i % 2 == 0 ? -orientation : orientation;
  }
  return 0;
}

}  // namespace

int insphere_tie(const Point& a, const Point& b, const Point& c, const Point& d, const Point& e) {
  const Point* const p[5] = {&a, &b, &c, &d, &e};
  return sign_of_tie(p);
}

int insphere_tie(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& d,
                 const ExactPoint& e) {
  const ExactPoint* const p[5] = {&a, &b, &c, &d, &e};
  return sign_of_tie(p);
}

}  // namespace detail

int dot_sign(Point a, Point b, Point c) {
  const double bx = b.x - a.x, by = b.y - a.y, bz = b.z - a.z, cx = c.x - a.x, cy = c.y - a.y, cz = c.z - a.z;
  const double x = bx * cx, y = by * cy, z = bz * cz;
  // Products 3u each, two sums 2u: 5u of the sum of magnitudes; the bound's own rounding and u^2 one u more.
  const double bound = 6 * detail::kRoundoff * (std::fabs(x) + std::fabs(y) + std::fabs(z)) + detail::kTinyPlane;
  const double sum = x + y + z;
  if (std::fabs(sum) > bound) return sum > 0 ? 1 : -1;
  const double p[3][3] = {{b.x, b.y, b.z}, {c.x, c.y, c.z}, {a.x, a.y, a.z}};
  return detail::sign_of<2, 3>(
      p, [](const auto& r) { return detail::sign(r[0][0] * r[1][0] + r[0][1] * r[1][1] + r[0][2] * r[1][2]); });
}

}  // namespace delfront
