// SPDX-License-Identifier: Apache-2.0
// The formulas of cell_geometry.cpp for tetrahedra, four of them at a time, in vectors of four numbers. Lanes never
// meet, every operation is rounded as IEEE 754 says, and none is contracted: a lane's result does not depend on its
// neighbours or on the CPU's width.
//
// acos is a polynomial here: asin(s) = s + s z P(z), z = s^2, on z <= 1/4 with P the best one of degree 12 (found with
// mpmath's chebyfit; relative error 1.5e-17 before rounding), and acos(x) = 2 asin(sqrt((1 - x) / 2)) for x > 1/2,
// where 1 - x is exact. All in all within 4e-16 of acos, relative to pi.
#include "mesh/tet_lanes.hpp"

#ifdef __AVX__
#include <immintrin.h>
#endif

#include <cmath>
#include <limits>
#include <numbers>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // no vector is passed to or from another file
#endif

namespace delfront {

namespace {

typedef double Vector __attribute__((vector_size(32)));

constexpr double kTiny = 1e-150;  // as in cell_geometry.cpp

struct Vector3 {
  Vector x, y, z;
};

inline Vector all(double x) { return Vector{x, x, x, x}; }
inline Vector smaller(Vector a, Vector b) { return a < b ? a : b; }
inline Vector larger(Vector a, Vector b) { return a > b ? a : b; }
inline Vector magnitude(Vector a) { return a < 0 ? -a : a; }
inline Vector root(Vector a) {
#ifdef __AVX__
  return _mm256_sqrt_pd(a);
#else
  return Vector{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
#endif
}
inline Vector cube_root(Vector a) { return Vector{std::cbrt(a[0]), std::cbrt(a[1]), std::cbrt(a[2]), std::cbrt(a[3])}; }

inline Vector load(const LaneValues& v) { return Vector{v.lane[0], v.lane[1], v.lane[2], v.lane[3]}; }
inline Vector3 load(const LanePoints& p) { return {load(p.x), load(p.y), load(p.z)}; }
inline void store(Vector v, LaneValues& to) {
  for (int i = 0; i < kLanes; ++i) to.lane[i] = v[i];
}

inline Vector3 operator+(const Vector3& a, const Vector3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector3 operator-(const Vector3& a, const Vector3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector3 operator*(Vector s, const Vector3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vector dot(const Vector3& a, const Vector3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vector length(const Vector3& a) { return root(dot(a, a)); }

/// Of arguments in [-1, 1].
inline Vector degrees_of_cosine(Vector x) {
  constexpr double kCoefficients[] = {
      0.028757851367421566, -0.014851887071247204, 0.01740087944269402,  0.005457506718640358, 0.01032281435018578,
      0.011479177415184906, 0.013971212973552933,  0.017352392720869973, 0.02237217294214989,  0.030381944138531247,
      0.04464285714635543,  0.07499999999998433,   0.16666666666666669};
  const Vector a = magnitude(x);
  const auto is_steep = a > 0.5;
  const Vector z = is_steep ? 0.5 * (1.0 - a) : a * a;
  const Vector s = is_steep ? root(z) : a;
  Vector p = all(kCoefficients[0]);
  for (std::size_t i = 1; i < std::size(kCoefficients); ++i) p = p * z + kCoefficients[i];
  const Vector arcsine = s + s * (z * p);
  const Vector angle = is_steep ? 2.0 * arcsine : std::numbers::pi / 2 - arcsine;
  return (180 / std::numbers::pi) * (x < 0 ? std::numbers::pi - angle : angle);
}

inline Vector clamp_cosine(Vector x) { return larger(smaller(x, all(1)), all(-1)); }

/// Length of `off` over the facet's extent in that direction, but at least `least`: see skewness in cell_geometry.cpp.
inline Vector skewness(const Vector3 (&p)[5], const Vector3& centre, const Vector3& off, Vector least) {
  const Vector away = length(off);
  const Vector3 direction = (1.0 / (away + kTiny)) * off;
  Vector extent = least + kTiny;
  for (int i = 0; i < 3; ++i) extent = larger(extent, magnitude(dot(direction, p[i] - centre)));
  return away / extent;
}

}  // namespace

void measure_tets(const LanePoints (&corners)[4], TetLanes& result) {
  Vector3 p[4];
  for (int i = 0; i < 4; ++i) p[i] = load(corners[i]);
  const Vector3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
  const Vector3 e = p[2] - p[1], f = p[3] - p[1], g = p[3] - p[2];
  // twice the facets' area vectors, outward; facet i lies opposite corner i
  const Vector3 area[4] = {cross(e, f), cross(w, v), cross(u, w), cross(v, u)};
  Vector size[4];
  Vector3 unit[4];
  for (int i = 0; i < 4; ++i) {
    size[i] = length(area[i]);
    unit[i] = (1.0 / larger(size[i], all(kTiny))) * area[i];
  }
  Vector lowest = all(1), highest = all(-1);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) {
      const Vector cosine = -dot(unit[i], unit[j]);
      lowest = smaller(lowest, cosine);
      highest = larger(highest, cosine);
    }
  store(degrees_of_cosine(clamp_cosine(highest)), result.min_dihedral);
  store(degrees_of_cosine(clamp_cosine(lowest)), result.max_dihedral);

  const Vector squares[6] = {dot(u, u), dot(v, v), dot(w, w), dot(e, e), dot(f, f), dot(g, g)};
  Vector sum = all(0), longest = squares[0], shortest = squares[0];
  for (const Vector square : squares) {
    sum += square;
    longest = larger(longest, square);
    shortest = smaller(shortest, square);
  }
  store(shortest, result.shortest_squared);
  store(longest, result.longest_squared);

  const Vector volume = -dot(area[3], w) / 6.0;
  const Vector positive = larger(volume, all(0));
  const Vector inradius = 6.0 * positive / larger(size[0] + size[1] + size[2] + size[3], all(kTiny));
  const Vector3 offset = squares[0] * cross(v, w) + squares[1] * cross(w, u) + squares[2] * cross(u, v);
  const Vector side = cube_root(larger(volume, all(kTiny)));
  const Vector side_of_positive = volume > 0 ? side * side : all(0);
  store(volume, result.volume);
  constexpr double kMeanRatio = 12 * 2.080083823051904114530056824357885;  // 12 * 3^(2/3)
  store(kMeanRatio * side_of_positive / larger(sum, all(kTiny)), result.mean_ratio);
  store(36.0 * inradius * positive / larger(length(offset), all(kTiny)), result.radius_ratio);
  const double height = 2 * std::sqrt(6.0);  // inradii in the side of the regular one
  store(root(longest) / larger(height * inradius, all(kTiny)), result.aspect_ratio);

  // OpenFOAM's: of the sums of |area| along the axes the largest over the smallest, or a sixth of all over V^(2/3)
  Vector3 along = {all(0), all(0), all(0)};
  for (const Vector3& a : area) along = along + Vector3{magnitude(a.x), magnitude(a.y), magnitude(a.z)};
  along = all(0.5) * along;
  const Vector most = larger(larger(along.x, along.y), along.z), least = smaller(smaller(along.x, along.y), along.z);
  const Vector by_volume = (along.x + along.y + along.z) / (6.0 * side * side);
  store(larger(most / (least + kTiny), by_volume), result.openfoam_aspect);
}

void measure_tet_facets(const LanePoints (&points)[5], FacetLanes& result) {
  Vector3 p[5];
  for (int i = 0; i < 5; ++i) p[i] = load(points[i]);
  const Vector3 area = cross(p[1] - p[0], p[2] - p[0]);  // twice the facet's
  const Vector3 sum = p[0] + p[1] + p[2];
  const Vector3 centre = all(1.0 / 3) * sum;
  const Vector3 owner = all(0.25) * (sum + p[3]), neighbour = all(0.25) * (sum + p[4]);
  const Vector3 d = neighbour - owner;
  const Vector along = dot(area, d), distance = length(d);
  const Vector cosine = clamp_cosine(along / larger(distance * length(area), all(kTiny)));
  store(cosine, result.cosine);
  store(degrees_of_cosine(cosine), result.nonortho);

  const Vector3 to_facet = centre - owner;
  const Vector share = dot(area, to_facet) / (along < 0 ? along - kTiny : along + kTiny);
  store(skewness(p, centre, to_facet - share * d, 0.2 * distance), result.skewness);

  const Vector mine = dot(area, p[0] - p[3]), yours = dot(area, p[4] - p[0]);
  const Vector small = smaller(mine, yours), large = larger(mine, yours);
  store(small > 0 ? large / small : all(std::numeric_limits<double>::infinity()), result.volume_ratio);
}

}  // namespace delfront
