// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

// The quality that improvement maximises: the smallest sine of the six dihedral angles, sines of obtuse angles weighted
// by kObtuseWeight ("biased minimum sine", Klingner & Shewchuk 2007), squared, with the sign of the volume. Squared,
// because it then needs no root and one division: with N_i twice the area of face i, D six times the volume and e the
// edge's length, sin^2 = D^2 e^2 / (N_i^2 N_j^2) where faces i and j meet at the edge.

/// @brief With 0.7 a goal of 15 degrees for the small angles is one of 158 for the large ones.
inline constexpr double kObtuseWeight = 0.7;
inline constexpr double kObtuseWeightSquared = kObtuseWeight * kObtuseWeight;
/// @brief Keeps 0 / 0 out; far below the product of squared areas of any tet the predicates admit.
inline constexpr double kTiniestProduct = 1e-300;

/// @brief Quality (squared sine) of a tet whose smallest dihedral angle is `degrees` and that has no obtuse one.
inline double quality_of_angle(double degrees) {
  const double sine = std::sin(degrees * std::numbers::pi / 180);
  return sine * sine;
}

#ifdef __AVX__
inline constexpr std::size_t kLanes = 4;
#else
inline constexpr std::size_t kLanes = 2;
#endif
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

/// @brief kLanes triangles: coordinate k of corner c of triangle i is corner[c][k][i].
struct alignas(32) FaceBlock {
  Lanes corner[3][3];
};

/// @brief Quality of the tets (p, q, r, v) of one block; v holds the apex of each lane.
inline Lanes measure_block(const FaceBlock& f, const Lanes (&v)[3]) {
  const Lanes ax = f.corner[0][0] - v[0], ay = f.corner[0][1] - v[1], az = f.corner[0][2] - v[2];
  const Lanes bx = f.corner[1][0] - v[0], by = f.corner[1][1] - v[1], bz = f.corner[1][2] - v[2];
  const Lanes cx = f.corner[2][0] - v[0], cy = f.corner[2][1] - v[1], cz = f.corner[2][2] - v[2];
  // Twice the area vectors of the faces opposite p, q, r; their sum is that of the triangle (p, q, r).
  const Lanes px = by * cz - bz * cy, py = bz * cx - bx * cz, pz = bx * cy - by * cx;
  const Lanes qx = cy * az - cz * ay, qy = cz * ax - cx * az, qz = cx * ay - cy * ax;
  const Lanes rx = ay * bz - az * by, ry = az * bx - ax * bz, rz = ax * by - ay * bx;
  const Lanes pp = px * px + py * py + pz * pz;
  const Lanes qq = qx * qx + qy * qy + qz * qz;
  const Lanes rr = rx * rx + ry * ry + rz * rz;
  const Lanes pq = px * qx + py * qy + pz * qz;
  const Lanes qr = qx * rx + qy * ry + qz * rz;
  const Lanes rp = rx * px + ry * py + rz * pz;
  const Lanes vp = pp + pq + rp, vq = qq + pq + qr, vr = rr + qr + rp;  // area vector of (p, q, r) times each
  const Lanes vv = vp + vq + vr;
  const Lanes volume = -(ax * px + ay * py + az * pz);
  const Lanes abx = ax - bx, aby = ay - by, abz = az - bz;
  const Lanes bcx = bx - cx, bcy = by - cy, bcz = bz - cz;
  const Lanes cax = cx - ax, cay = cy - ay, caz = cz - az;
  const Lanes zero = volume - volume, one = zero + 1.0, weight = zero + kObtuseWeightSquared;
  // Edge length squared times the squared areas of the two faces that do not meet there; obtuse where the outward
  // normals (p, q, r and minus the triangle's) point the same way.
  Lanes least = (ax * ax + ay * ay + az * az) * (pp * vv) * (qr > zero ? weight : one);
  const auto lower = [&least](Lanes value) { least = value < least ? value : least; };
  lower((bx * bx + by * by + bz * bz) * (qq * vv) * (rp > zero ? weight : one));
  lower((cx * cx + cy * cy + cz * cz) * (rr * vv) * (pq > zero ? weight : one));
  lower((abx * abx + aby * aby + abz * abz) * (pp * qq) * (vr < zero ? weight : one));
  lower((bcx * bcx + bcy * bcy + bcz * bcz) * (qq * rr) * (vp < zero ? weight : one));
  lower((cax * cax + cay * cay + caz * caz) * (rr * pp) * (vq < zero ? weight : one));
  const Lanes product = (pp * qq) * (rr * vv) + kTiniestProduct;
  const Lanes magnitude = volume * volume * least / product;
  return volume > zero ? magnitude : -magnitude;
}

/// @brief Triangles whose tets with one apex are measured together: the boundary of a star or of a cavity.
///
/// Triangles are ordered so that (p, q, r, apex) is positive.
class FaceBatch {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }

  void add(const Point& p, const Point& q, const Point& r) {
    const std::size_t block = size_ / kLanes, lane = size_ % kLanes;
    if (block == blocks_.size()) blocks_.emplace_back();
    // A new block starts with all lanes the same, so that what lies beyond the end never lowers a minimum.
    const std::size_t end = lane == 0 ? kLanes : lane + 1;
    for (std::size_t i = lane; i < end; ++i) {
      put(blocks_[block].corner[0], i, p);
      put(blocks_[block].corner[1], i, q);
      put(blocks_[block].corner[2], i, r);
    }
    ++size_;
  }

  Point corner(std::size_t face, int c) const {
    const auto& at = blocks_[face / kLanes].corner[c];
    const std::size_t lane = face % kLanes;
    return {at[0][lane], at[1][lane], at[2][lane]};
  }

  /// @brief Quality of every (triangle, apex), into `quality` (rounded up to whole blocks).
  void measure(const Point& apex, std::vector<double>& quality) const {
    const Lanes v[3] = {Lanes{} + apex.x, Lanes{} + apex.y, Lanes{} + apex.z};
    const std::size_t blocks = (size_ + kLanes - 1) / kLanes;
    if (quality.size() < blocks * kLanes) quality.resize(blocks * kLanes);
    for (std::size_t b = 0; b < blocks; ++b) {
      const Lanes q = measure_block(blocks_[b], v);
      for (std::size_t i = 0; i < kLanes; ++i) quality[b * kLanes + i] = q[i];
    }
  }

  /// @brief The worst quality over all triangles, or some value <= floor as soon as one is not above it.
  double worst(const Point& apex, double floor = -std::numeric_limits<double>::infinity()) const {
    const Lanes v[3] = {Lanes{} + apex.x, Lanes{} + apex.y, Lanes{} + apex.z};
    const std::size_t blocks = (size_ + kLanes - 1) / kLanes;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < blocks && least > floor; ++b) {
      const Lanes q = measure_block(blocks_[b], v);
      for (std::size_t i = 0; i < kLanes; ++i) least = std::min(least, q[i]);
    }
    return least;
  }

 private:
  static void put(Lanes (&corner)[3], std::size_t lane, const Point& p) {
    corner[0][lane] = p.x;
    corner[1][lane] = p.y;
    corner[2][lane] = p.z;
  }

  std::vector<FaceBlock> blocks_;
  std::size_t size_ = 0;
};

/// @brief Quality of one tet (p, q, r, v), bit for bit what a batch gives.
inline double measure_quality(const Point& p, const Point& q, const Point& r, const Point& v) {
  FaceBlock f;
  const Point* corners[3] = {&p, &q, &r};
  for (int c = 0; c < 3; ++c) {
    f.corner[c][0] = Lanes{} + corners[c]->x;
    f.corner[c][1] = Lanes{} + corners[c]->y;
    f.corner[c][2] = Lanes{} + corners[c]->z;
  }
  const Lanes apex[3] = {Lanes{} + v.x, Lanes{} + v.y, Lanes{} + v.z};
  return measure_block(f, apex)[0];
}

/// @brief Gradient of the quality of (p, q, r, v) with respect to v. Where the tet is not positive: the direction that
/// raises its volume.
Point measure_quality_gradient(const Point& p, const Point& q, const Point& r, const Point& v);

/// @brief The six dihedral angles' extremes, radians; for reports and tests.
struct DihedralRange {
  double least, greatest;
};
DihedralRange measure_dihedrals(const Point& p, const Point& q, const Point& r, const Point& v);

}  // namespace delfront
