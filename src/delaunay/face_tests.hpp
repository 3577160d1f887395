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
//
// What these bounds leave open, points on spheres and lattices above all, is evaluated again in numbers of twofold
// precision (twofold.hpp; U = u^2; sums 4U of both magnitudes, products 8U), the differences to p without error. Minors
// 16U + 8U = 24U XY. m: a term 24U + 16U = 40U, the sum of three 120U + 16U + 24U = 160U XYZ. Lifts: 8U + 8U = 16U L.
// q's terms: 24U + 32U + 16U = 72U, the sum 216U + 16U + 24U = 256U. q_x w_x: 256U + 48U = 304U, the sum 912U + 48U +
// 72U = 1032U. m l_w: 160U + 96U + 48U = 304U. Their difference: 1032U + 304U + 96U = 1432U XYZL; a tenth more pays for
// the bound's own rounding and for the low part that is not looked at. Where all differences are multiples of some g
// and less than 2^16 g, a determinant is a multiple of g^5 (g^3 for m), so that one within its bound, if this is below
// half of that, is 0: a tie. With less than 2^9 g no sum passes 72 * 2^45 g^5: there plain arithmetic is exact.
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <bit>
#include <cstdint>
#include <limits>

#include "delaunay/twofold.hpp"
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
  unsigned tie = 0;      ///< surely on the circumsphere
};

namespace lanes {

typedef double Vector __attribute__((vector_size(32)));
typedef long long Mask __attribute__((vector_size(32)));

inline constexpr double kInsphereFaceBound = 384 * detail::kRoundoff;
inline constexpr double kTwofoldInsphereBound = 1536 * detail::kRoundoff * detail::kRoundoff;
inline constexpr double kTwofoldOrient3dBound = 192 * detail::kRoundoff * detail::kRoundoff;
inline constexpr int kPlainBits = 9, kTwofoldBits = 16;
inline constexpr double kTinyTwofold = 0x1p-740;  ///< lost low parts, 2^-1074 each, times at most 2^306

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
template <class Number>
struct Four {
  Number x, y, z;
  decltype(Number() * Number()) lift;
};

inline Vector load(const TetVertex& v) {
  static_assert(alignof(TetVertex) == sizeof(Vector));
  Vector loaded;
  __builtin_memcpy(&loaded, __builtin_assume_aligned(&v, sizeof loaded), sizeof loaded);
  return loaded;
}

/// Four points, one a vector, to their coordinates by axis.
inline void transpose(const Vector (&p)[4], Vector& x, Vector& y, Vector& z) {
  const Vector ab_xz = __builtin_shufflevector(p[0], p[1], 0, 4, 2, 6);
  const Vector ab_y = __builtin_shufflevector(p[0], p[1], 1, 5, 3, 7);
  const Vector cd_xz = __builtin_shufflevector(p[2], p[3], 0, 4, 2, 6);
  const Vector cd_y = __builtin_shufflevector(p[2], p[3], 1, 5, 3, 7);
  x = __builtin_shufflevector(ab_xz, cd_xz, 0, 1, 4, 5);
  z = __builtin_shufflevector(ab_xz, cd_xz, 2, 3, 6, 7);
  y = __builtin_shufflevector(ab_y, cd_y, 0, 1, 4, 5);
}

inline Four<Vector> relative(const TetVertex* const v[4], Vector p) {
  const Vector difference[4] = {load(*v[0]) - p, load(*v[1]) - p, load(*v[2]) - p, load(*v[3]) - p};
  Four<Vector> f;
  transpose(difference, f.x, f.y, f.z);
  f.lift = f.x * f.x + f.y * f.y + f.z * f.z;
  return f;
}

/// What is needed of the four corners of a tet, relative to p: v_i+1 in `a`, v_i+2 in `b`, v_i+2 x v_i+3 in `bc`.
template <class Number>
struct Corners {
  using Product = decltype(Number() * Number());
  Four<Number> v;
  Number ax, ay, az, bx, by, bz;
  Product bcx, bcy, bcz, ux, uy, uz;
  Product side;
};

template <class Number>
inline Corners<Number> corners_of(const Four<Number>& v) {
  Corners<Number> c;
  c.v = v;
  c.ax = next(v.x), c.ay = next(v.y), c.az = next(v.z);
  c.bx = opposite(v.x), c.by = opposite(v.y), c.bz = opposite(v.z);
  c.ux = v.y * c.az - v.z * c.ay, c.uy = v.z * c.ax - v.x * c.az, c.uz = v.x * c.ay - v.y * c.ax;
  c.bcx = opposite(c.ux), c.bcy = opposite(c.uy), c.bcz = opposite(c.uz);
  c.side = c.ax * c.bcx + c.ay * c.bcy + c.az * c.bcz;
  return c;
}

/// The in-sphere determinants of the tets across, up to sign.
template <class Number>
inline auto powers_of(const Corners<Number>& c, const Four<Number>& apex) {
  const auto tx = c.v.y * c.bz - c.v.z * c.by, ty = c.v.z * c.bx - c.v.x * c.bz, tz = c.v.x * c.by - c.v.y * c.bx;
  const auto la = next(c.v.lift), lb = opposite(c.v.lift), lc = previous(c.v.lift);
  const auto qx = la * c.bcx - lb * next(tx) + lc * next(c.ux);
  const auto qy = la * c.bcy - lb * next(ty) + lc * next(c.uy);
  const auto qz = la * c.bcz - lb * next(tz) + lc * next(c.uz);
  return c.side * apex.lift - (qx * apex.x + qy * apex.y + qz * apex.z);
}

/// The largest |x|, |y|, |z| and lift of the corners, in every lane.
struct Extent {
  Vector x, y, z, lift;
};

inline Extent extent_of(const Four<Vector>& v) {
  return {largest(magnitude(v.x)), largest(magnitude(v.y)), largest(magnitude(v.z)), largest(v.lift)};
}
inline Extent extent_of(const Extent& e, const Four<Vector>& apex) {
  return {larger(e.x, magnitude(apex.x)), larger(e.y, magnitude(apex.y)), larger(e.z, magnitude(apex.z)),
          larger(e.lift, apex.lift)};
}

/// Faces 0 and 2 are seen where m > 0 and in conflict where det < 0; faces 1 and 3 the other way round.
inline Vector turned(Vector v) {
  return reinterpret_cast<Vector>(reinterpret_cast<Mask>(v) ^ Mask{0, std::numeric_limits<long long>::min(), 0,
                                                                   std::numeric_limits<long long>::min()});
}

inline void decide_sides(Vector sides, Vector bound, FaceTests& tests) {
  const Vector side = turned(sides);
  tests.seen = bits(side > bound);
  tests.unseen = bits(side < -bound);
}

inline void decide_sides(const Corners<Vector>& c, const Extent& e, FaceTests& tests) {
  decide_sides(c.side, all(detail::kOrient3dBound) * (e.x * e.y * e.z) + all(detail::kTinyOrient3d), tests);
}

}  // namespace lanes

/// @brief Which faces of tet (v0 … v3) see p.
inline FaceTests test_sides(const TetVertex* const v[4], const TetVertex& at) {
  const lanes::Corners<lanes::Vector> c = corners_of(lanes::relative(v, lanes::load(at)));
  FaceTests tests;
  lanes::decide_sides(c, extent_of(c.v), tests);
  return tests;
}

/// @brief Test p against the faces of tet (v0 … v3) and the apexes w0 … w3 across them; lanes of faces that have no
/// apex may be anything. `min_distance2` is the square of the distance below which an apex is close.
/// Without kWithSides `seen`, `unseen` and `close` stay 0.
template <bool kWithSides>
[[gnu::always_inline]] inline FaceTests test_faces(const TetVertex* const v[4], const TetVertex* const w[4],
                                                   const TetVertex& at, double min_distance2) {
  using namespace lanes;
  const Vector p = load(at);
  const Corners<Vector> c = corners_of(relative(v, p));
  const Extent corners = extent_of(c.v);
  const Four<Vector> apex = relative(w, p);
  const Vector power = turned(powers_of(c, apex));
  const Extent e = extent_of(corners, apex);
  const Vector bound = all(kInsphereFaceBound) * (e.x * e.y * e.z * e.lift) + all(detail::kTinyInsphere);
  FaceTests tests;
  tests.inside = bits(power < -bound);
  tests.outside = bits(power > bound);
  if (kWithSides) {
    decide_sides(c, corners, tests);
    tests.close = bits(apex.lift < all(min_distance2));
  }
  return tests;
}

#ifdef DELFRONT_HAS_TWOFOLD

inline constexpr bool kHasTwofoldTests = true;

namespace lanes {

inline Exact next(Exact v) { return {next(v.value)}; }
inline Exact opposite(Exact v) { return {opposite(v.value)}; }
inline Twofold next(const Twofold& v) { return {next(v.high), next(v.low)}; }
inline Twofold opposite(const Twofold& v) { return {opposite(v.high), opposite(v.low)}; }
inline Twofold previous(const Twofold& v) { return {previous(v.high), previous(v.low)}; }

/// Four points relative to p without error.
/// @return whether the low parts are all 0
inline bool exact_relative(const TetVertex* const v[4], Vector p, Four<Twofold>& f) {
  Vector high[4], low[4], any = all(0);
  for (int i = 0; i < 4; ++i) {
    const Twofold difference = exact_sum(load(*v[i]), -p);
    high[i] = difference.high, low[i] = difference.low;
    any = larger(any, magnitude(low[i]));
  }
  transpose(high, f.x.high, f.y.high, f.z.high);
  transpose(low, f.x.low, f.y.low, f.z.low);
  return (bits(any > all(0)) & 7) == 0;  // the fourth number is no coordinate
}

inline Four<Vector> rounded(const Four<Twofold>& f) {
  const Vector x = f.x.high, y = f.y.high, z = f.z.high;
  return {x, y, z, x * x + y * y + z * z};
}

inline Four<Exact> narrowed(const Four<Twofold>& f) {
  const Exact x{f.x.high}, y{f.y.high}, z{f.z.high};
  return {x, y, z, x * x + y * y + z * z};
}

/// The unit that all coordinates of both are multiples of if they are whole on a scale where the largest has so many
/// bits; else 0.
inline double unit_of(const Four<Vector>& v, const Four<Vector>& w, const Extent& e, int num_bits) {
  const Vector extent = largest(larger(larger(e.x, e.y), e.z));
  const auto exponent = static_cast<int>(std::bit_cast<std::uint64_t>(extent[0]) >> 52);
  constexpr int kBias = 1023, kSmallest = 840;  // so that the fifth power of a unit of 16 bits is a normal number
  if (exponent < kSmallest) return 0;
  const auto power_of_two = [](int n) { return std::bit_cast<double>(static_cast<std::uint64_t>(n) << 52); };
  const Vector scale = all(power_of_two(2 * kBias + num_bits - 1 - exponent));
  const auto part = [&](Vector x) {  // what is not whole
    const Vector scaled = x * scale;
    return reinterpret_cast<Mask>(scaled != _mm256_round_pd(scaled, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
  };
  const Mask broken = part(v.x) | part(v.y) | part(v.z) | part(w.x) | part(w.y) | part(w.z);
  return bits(broken) ? 0 : power_of_two(exponent - num_bits + 1);
}

}  // namespace lanes

namespace lanes {

inline Vector high(Vector v) { return v; }
inline Vector high(const Twofold& v) { return v.high; }

/// @param unit  see unit_of()
template <class Number>
inline FaceTests decide(const Four<Number>& corner, const Four<Number>& apex, Vector side_bound, Vector bound,
                        double unit) {
  const Corners<Number> c = corners_of(corner);
  const double unit3 = unit * unit * unit;
  FaceTests tests;
  decide_sides(high(c.side), side_bound, tests);
  tests.unseen |= ~tests.seen & bits(side_bound < all(unit3 / 2));
  const Vector power = turned(high(powers_of(c, apex)));
  tests.inside = bits(power < -bound);
  tests.outside = bits(power > bound);
  tests.tie = ~(tests.inside | tests.outside) & bits(bound < all(unit3 * unit * unit / 2));
  return tests;
}

}  // namespace lanes

/// @brief test_faces<true> in numbers of twofold precision: it leaves next to nothing open but ties of points that are
/// not on a coarse lattice. `unseen` is set also where p lies in the plane of the face.
inline FaceTests test_faces_twofold(const TetVertex* const v[4], const TetVertex* const w[4], const TetVertex& at) {
  using namespace lanes;
  const Vector p = load(at);
  Four<Twofold> corner, apex;
  const bool is_corner_short = exact_relative(v, p, corner), is_short = exact_relative(w, p, apex) && is_corner_short;
  const Four<Vector> corner_high = rounded(corner), apex_high = rounded(apex);
  const Extent corners = extent_of(corner_high), e = extent_of(corners, apex_high);
  if (const double unit = is_short ? unit_of(corner_high, apex_high, e, kPlainBits) : 0; unit > 0)
    return decide(corner_high, apex_high, all(0), all(0), unit);
  const Vector side_bound = all(kTwofoldOrient3dBound) * (corners.x * corners.y * corners.z) + all(kTinyTwofold);
  const Vector bound = all(kTwofoldInsphereBound) * (e.x * e.y * e.z * e.lift) + all(kTinyTwofold);
  if (is_short) {
    const double unit = unit_of(corner_high, apex_high, e, kTwofoldBits);
    return decide(narrowed(corner), narrowed(apex), side_bound, bound, unit);
  }
  corner.lift = corner.x * corner.x + corner.y * corner.y + corner.z * corner.z;
  apex.lift = apex.x * apex.x + apex.y * apex.y + apex.z * apex.z;
  return decide(corner, apex, side_bound, bound, 0);
}

#else

inline constexpr bool kHasTwofoldTests = false;

inline FaceTests test_faces_twofold(const TetVertex* const*, const TetVertex* const*, const TetVertex&) { return {}; }

#endif

}  // namespace delfront
