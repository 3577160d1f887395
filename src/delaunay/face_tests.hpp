// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the kernel asks most, for the four faces of a cavity tet at once, one face a lane: is the tet across the face in
// conflict with p, and does p see the face? Plain arithmetic with error bounds; lanes that the bounds leave open are
// decided by the exact predicates.
//
// With coordinates relative to p and l = x^2 + y^2 + z^2, let face i of tet (v0, v1, v2, v3) have the vertices a, b, c
// = v_i+1, v_i+2, v_i+3 (mod 4). Then m_i = det[a, b, c] is the orientation of p and the face up to sign, and the
// lifted points of the face and p span a hyperplane with normal (-q_i, m_i), q_i = l_a (b x c) + l_b (c x a) + l_c (a x
// b). The in-sphere determinant of the tet across, with apex w, is m_i l_w - q_i . w up to sign: seven multiplications
// where the determinant from scratch takes forty. The cross products are shared by the four faces.
//
// Error bounds, in the notation of predicates_inline.hpp (u = 2^-53; X, Y, Z, L the largest |x|, |y|, |z|, l of the
// five points): minors 8u XY, at most 2XY. m: 46u XYZ, at most 6XYZ (kOrient3dBound). q's terms: minor times lift (5u
// L): 8u + 10u + 2u = 20u XYL; the sum of three 60u + 4u + 6u = 70u, at most 6XYL. q_x w_x: 70u + 6u + 6u = 82u, at
// most 6XYZL; the sum of three: 246u + 12u + 18u = 276u, at most 18XYZL. m l_w: 46u + 30u + 6u = 82u, at most 6XYZL.
// Their difference: 276u + 82u + 24u = 382u XYZL. Two more pay for second order terms and the bound's own rounding.
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <limits>

#include "predicates/predicates.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief Bits by face of a tet (1 << face).
struct FaceTests {
  unsigned inside = 0;   ///< surely in conflict: the tet across the face has p in its circumsphere
  unsigned outside = 0;  ///< surely not
  unsigned seen = 0;     ///< surely seen strictly from inside of the tet
  unsigned unseen = 0;   ///< surely seen strictly from outside
  unsigned close = 0;    ///< the apex across is nearer to p than asked
};

namespace lanes {

typedef double Vector __attribute__((vector_size(32)));
typedef long long Mask __attribute__((vector_size(32)));

inline constexpr double kInsphereFaceBound = 384 * detail::kRoundoff;

inline Vector all(double x) { return Vector{x, x, x, x}; }
inline Vector next(Vector v) { return __builtin_shufflevector(v, v, 1, 2, 3, 0); }
inline Vector opposite(Vector v) { return __builtin_shufflevector(v, v, 2, 3, 0, 1); }
inline Vector previous(Vector v) { return __builtin_shufflevector(v, v, 3, 0, 1, 2); }
inline Vector magnitude(Vector v) { return reinterpret_cast<Vector>(reinterpret_cast<Mask>(v) & 0x7fffffffffffffffll); }
#ifdef __AVX2__
inline Vector larger(Vector a, Vector b) { return _mm256_max_pd(a, b); }
/// Bit i: lane i is set.
inline unsigned bits(Mask m) { return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<Vector>(m))); }
#else
inline Vector larger(Vector a, Vector b) { return a > b ? a : b; }
inline unsigned bits(Mask m) { return static_cast<unsigned>((m[0] & 1) | (m[1] & 2) | (m[2] & 4) | (m[3] & 8)); }
#endif
/// The largest of the four, in every lane.
inline Vector largest(Vector v) {
  v = larger(v, next(v));
  return larger(v, opposite(v));
}

/// Four points relative to p, and their squared distances.
struct Four {
  Vector x, y, z, lift;
};

inline Vector load(const TetVertex& v) {
  static_assert(alignof(TetVertex) == sizeof(Vector));
  Vector loaded;
  __builtin_memcpy(&loaded, __builtin_assume_aligned(&v, sizeof loaded), sizeof loaded);
  return loaded;
}

inline Four relative(const TetVertex& v0, const TetVertex& v1, const TetVertex& v2, const TetVertex& v3, Vector p) {
  const Vector a = load(v0) - p, b = load(v1) - p, c = load(v2) - p, d = load(v3) - p;
  const Vector ab_xz = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab_y = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vector cd_xz = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd_y = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  Four f;
  f.x = __builtin_shufflevector(ab_xz, cd_xz, 0, 1, 4, 5);
  f.z = __builtin_shufflevector(ab_xz, cd_xz, 2, 3, 6, 7);
  f.y = __builtin_shufflevector(ab_y, cd_y, 0, 1, 4, 5);
  f.lift = f.x * f.x + f.y * f.y + f.z * f.z;
  return f;
}

}  // namespace lanes

namespace lanes {

/// What is needed of the four corners of a tet, relative to p: v_i+1 in `a`, v_i+2 x v_i+3 in `bc`.
struct Corners {
  Four v;
  Vector ax, ay, az, bx, by, bz, bcx, bcy, bcz, ux, uy, uz;
  Vector side, side_bound, mx, my, mz;
};

inline Corners corners_of(const TetVertex* const v[4], Vector p) {
  Corners c;
  c.v = relative(*v[0], *v[1], *v[2], *v[3], p);
  c.ax = next(c.v.x), c.ay = next(c.v.y), c.az = next(c.v.z);
  c.bx = opposite(c.v.x), c.by = opposite(c.v.y), c.bz = opposite(c.v.z);
  c.ux = c.v.y * c.az - c.v.z * c.ay, c.uy = c.v.z * c.ax - c.v.x * c.az, c.uz = c.v.x * c.ay - c.v.y * c.ax;
  c.bcx = opposite(c.ux), c.bcy = opposite(c.uy), c.bcz = opposite(c.uz);
  c.side = c.ax * c.bcx + c.ay * c.bcy + c.az * c.bcz;
  c.mx = largest(magnitude(c.v.x)), c.my = largest(magnitude(c.v.y)), c.mz = largest(magnitude(c.v.z));
  c.side_bound = all(detail::kOrient3dBound) * (c.mx * c.my * c.mz) + all(detail::kTinyOrient3d);
  return c;
}

/// Faces 0 and 2 are seen where m > 0 and in conflict where det < 0; faces 1 and 3 the other way round.
inline Vector turned(Vector v) {
  return reinterpret_cast<Vector>(reinterpret_cast<Mask>(v) ^ Mask{0, std::numeric_limits<long long>::min(), 0,
                                                                   std::numeric_limits<long long>::min()});
}

inline void decide_sides(const Corners& c, FaceTests& tests) {
  const Vector side = turned(c.side);
  tests.seen = bits(side > c.side_bound);
  tests.unseen = bits(side < -c.side_bound);
}

}  // namespace lanes

/// @brief Which faces of tet (v0 … v3) see p.
inline FaceTests test_sides(const TetVertex* const v[4], const TetVertex& at) {
  FaceTests tests;
  lanes::decide_sides(lanes::corners_of(v, lanes::load(at)), tests);
  return tests;
}

/// @brief Test p against the faces of tet (v0 … v3) and the apexes w0 … w3 across them; lanes of faces that have no
/// apex may be anything. `min_distance2` is the square of the distance below which an apex is close.
/// Without kWithSides `seen`, `unseen` and `close` stay 0.
template <bool kWithSides>
inline FaceTests test_faces(const TetVertex* const v[4], const TetVertex* const w[4], const TetVertex& at,
                            double min_distance2) {
  using namespace lanes;
  const Vector p = load(at);
  const Corners c = corners_of(v, p);
  const Four apex = relative(*w[0], *w[1], *w[2], *w[3], p);
  const Vector tx = c.v.y * c.bz - c.v.z * c.by, ty = c.v.z * c.bx - c.v.x * c.bz, tz = c.v.x * c.by - c.v.y * c.bx;
  const Vector la = next(c.v.lift), lb = opposite(c.v.lift), lc = previous(c.v.lift);
  const Vector qx = la * c.bcx - lb * next(tx) + lc * next(c.ux);
  const Vector qy = la * c.bcy - lb * next(ty) + lc * next(c.uy);
  const Vector qz = la * c.bcz - lb * next(tz) + lc * next(c.uz);
  const Vector power = turned(c.side * apex.lift - (qx * apex.x + qy * apex.y + qz * apex.z));
  const Vector extent = larger(c.mx, magnitude(apex.x)) * larger(c.my, magnitude(apex.y)) *
                        larger(c.mz, magnitude(apex.z)) * larger(largest(c.v.lift), apex.lift);
  const Vector bound = all(kInsphereFaceBound) * extent + all(detail::kTinyInsphere);
  FaceTests tests;
  tests.inside = bits(power < -bound);
  tests.outside = bits(power > bound);
  if (kWithSides) {
    decide_sides(c, tests);
    tests.close = bits(apex.lift < all(min_distance2));
  }
  return tests;
}

}  // namespace delfront
