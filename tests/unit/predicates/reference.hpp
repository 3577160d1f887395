// SPDX-License-Identifier: Apache-2.0
#pragma once
// Arbitrary-precision reference for the predicates' tests, and the point sets that they are tried on.
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "predicates/predicates.hpp"

namespace delfront::reference {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;

template <class T>
using Vector = std::array<T, 3>;

template <class T>
int sign_of(const T& value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

inline Rational rational(double value) {
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  exponent -= 53;
  const Integer power = Integer(1) << std::abs(exponent);
  return exponent < 0 ? Rational(Integer(mantissa), power) : Rational(Integer(mantissa) * power);
}

inline Vector<Rational> rational(const Point& p) { return {rational(p.x), rational(p.y), rational(p.z)}; }

inline Vector<Rational> rational(const ExactPoint& p) {
  if (p.is_explicit()) return rational(p.approx);
  Vector<Rational> out;
  for (int k = 0; k < 3; ++k) {
    const Rational a = rational(p.a[k]), b = rational(p.b[k]);
    out[static_cast<std::size_t>(k)] = a + rational(p.t) * (b - a);
  }
  return out;
}

/// @brief The points as integers on a common power-of-two scale: quicker than fractions.
inline std::vector<Vector<Integer>> integers(const std::vector<Point>& points) {
  int low = 10000;
  for (const Point& p : points)
    for (int k = 0; k < 3; ++k) {
      int exponent = 0;
      if (p[k] != 0) low = std::min(low, (std::frexp(p[k], &exponent), exponent - 53));
    }
  std::vector<Vector<Integer>> out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      int exponent = 0;
      const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(points[i][k], &exponent), 53));
      out[i][static_cast<std::size_t>(k)] = mantissa == 0 ? Integer(0) : Integer(mantissa) << (exponent - 53 - low);
    }
  return out;
}

template <class T>
Vector<T> minus(const Vector<T>& a, const Vector<T>& b) {
  return {T(a[0] - b[0]), T(a[1] - b[1]), T(a[2] - b[2])};
}

template <class T>
T det3(const Vector<T>& a, const Vector<T>& b, const Vector<T>& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

template <class T>
T squared(const Vector<T>& a) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

/// @brief det[b - a, c - a, d - a].
template <class T>
int orient3d(const std::vector<Vector<T>>& p) {
  return sign_of(det3(minus(p[1], p[0]), minus(p[2], p[0]), minus(p[3], p[0])));
}

/// @brief Expanded along the lift, with differences to the first point (the code under test takes the last).
/// e inside a positive tet: its lift is below the plane through the others', so minus the determinant.
template <class T>
int insphere(const std::vector<Vector<T>>& p) {
  const Vector<T> b = minus(p[1], p[0]), c = minus(p[2], p[0]), d = minus(p[3], p[0]), e = minus(p[4], p[0]);
  const T det =
      squared(e) * det3(b, c, d) - squared(d) * det3(b, c, e) + squared(c) * det3(b, d, e) - squared(b) * det3(c, d, e);
  return -sign_of(det);
}

/// @brief det[b - a, c - a] in x and y.
template <class T>
int orient2d(const std::vector<Vector<T>>& p) {
  const Vector<T> b = minus(p[1], p[0]), c = minus(p[2], p[0]);
  return sign_of(T(b[0] * c[1] - b[1] * c[0]));
}

template <class T>
int incircle(const std::vector<Vector<T>>& p) {
  Vector<T> b = minus(p[1], p[0]), c = minus(p[2], p[0]), d = minus(p[3], p[0]);
  for (Vector<T>* v : {&b, &c, &d}) (*v)[2] = (*v)[0] * (*v)[0] + (*v)[1] * (*v)[1];
  return -sign_of(det3(b, c, d));
}

using Random = std::mt19937_64;

inline double uniform(Random& random, double low = -1, double high = 1) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
inline int integer(Random& random, int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); }
inline Point random_point(Random& random) { return {uniform(random), uniform(random), uniform(random)}; }
inline Point lattice_point(Random& random, int n) {
  return {double(integer(random, 0, n)), double(integer(random, 0, n)), double(integer(random, 0, n))};
}
inline Point sphere_point(Random& random) {
  Point p;
  do p = random_point(random);
  while (squared_length(p) > 1 || squared_length(p) < 0.01);
  return p / length(p);
}
/// @brief Moved by up to so many units of 2^-53 on each axis.
inline Point nudged(Random& random, Point p, int units) {
  for (int k = 0; k < 3; ++k) p[k] += integer(random, -units, units) * 0x1p-53;
  return p;
}

/// @brief Five points of one of kNumKinds kinds, from well apart to exactly degenerate.
inline constexpr int kNumKinds = 12;
inline std::vector<Point> some_points(Random& random, int kind) {
  std::vector<Point> p(5);
  const Point origin = random_point(random), u = random_point(random), v = random_point(random);
  const int scale_bits = integer(random, -90, 90);
  constexpr double kSphere41[4][3] = {{1, 2, 6}, {2, 6, 1}, {6, 1, 2}, {4, 3, 4}};  // squares add up to 41
  for (Point& q : p) switch (kind) {
      case 0:
        q = random_point(random);
        break;
      case 1:
        q = lattice_point(random, 3);
        break;
      case 2:
        q = origin + uniform(random) * u + uniform(random) * v;
        break;  // nearly coplanar
      case 3:
        q = origin + uniform(random) * u;
        break;  // nearly in line
      case 4:
        q = sphere_point(random);
        break;  // nearly cospherical
      case 5:
        q = nudged(random, lattice_point(random, 2), 4);
        break;
      case 6:
        q = Point{1e6, -2e6, 3e6} + sphere_point(random);
        break;
      case 7:
        q = 1e-6 * (origin + uniform(random) * u + uniform(random) * v);
        break;
      case 8: {
        const auto& on_sphere = kSphere41[integer(random, 0, 3)];  // exactly cospherical
        q = {on_sphere[0], on_sphere[1], on_sphere[2]};
        for (int k = 0; k < 3; ++k) q[k] *= integer(random, 0, 1) ? 1 : -1;
        q = std::ldexp(1.0, scale_bits) * (q + Point{17, -5, 3});
        break;
      }
      case 9:
        q = Point{0.37, 0.11, 0.93} + 1e-4 * sphere_point(random);
        break;    // small sphere far away
      case 10: {  // coordinates of widely different size, down to 2^-300
        for (int k = 0; k < 3; ++k)
          q[k] = std::ldexp(uniform(random), integer(random, 0, 3) ? -2 : -integer(random, 0, 300));
        break;
      }
      default:
        q = {std::cos(integer(random, 0, 15) * 0.39269908169872414),
             std::sin(integer(random, 0, 15) * 0.39269908169872414),
             0.25 * integer(random, 0, 4)};  // cylinder: 6e-17 beside 1
    }
  if (integer(random, 0, 3) == 0) p[4] = 0.5 * (p[0] + p[1]);
  if (integer(random, 0, 19) == 0) p[4] = p[integer(random, 0, 3)];
  return p;
}

}  // namespace delfront::reference
