// SPDX-License-Identifier: Apache-2.0
#include "tetra/quality.hpp"

#include <array>

namespace delfront {

Point measure_quality_gradient(const Point& p, const Point& q, const Point& r, const Point& v) {
  const Point a = p - v, b = q - v, c = r - v;
  const std::array<Point, 3> n{cross(b, c), cross(c, a), cross(a, b)};  // opposite p, q, r
  const Point base = n[0] + n[1] + n[2];
  const double volume = -dot(a, n[0]);
  if (!(volume > 0)) return base;
  const std::array<Point, 3> opposite{q - r, r - p, p - q};
  std::array<double, 3> nn;
  std::array<Point, 3> log_gradient;  // of n . n
  for (unsigned i = 0; i < 3; ++i) {
    nn[i] = squared_length(n[i]);
    log_gradient[i] = (2 / (nn[i] + kTiniestProduct)) * cross(opposite[i], n[i]);
  }
  const double bb = squared_length(base);
  const std::array<Point, 3> spoke{a, b, c};
  double least = std::numeric_limits<double>::infinity();
  Point log_of_least;
  for (unsigned i = 0; i < 3; ++i) {
    const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
    // The spoke to corner i: faces j and k meet there. The side opposite corner i: the base and face i meet.
    const double spoke_squared = squared_length(spoke[i]);
    const double w = dot(n[j], n[k]) > 0 ? kObtuseWeightSquared : 1.0;
    const double of_spoke = w * spoke_squared / (nn[j] * nn[k] + kTiniestProduct);
    if (of_spoke < least) {
      least = of_spoke;
      log_of_least = (-2 / (spoke_squared + kTiniestProduct)) * spoke[i] - log_gradient[j] - log_gradient[k];
    }
    const double u = dot(base, n[i]) < 0 ? kObtuseWeightSquared : 1.0;
    const double of_side = u * squared_length(opposite[i]) / (bb * nn[i] + kTiniestProduct);
    if (of_side < least) {
      least = of_side;
      log_of_least = -1.0 * log_gradient[i];
    }
  }
  const double quality = volume * volume * least;
  return quality * ((2 / volume) * base + log_of_least);
}

DihedralRange measure_dihedrals(const Point& p, const Point& q, const Point& r, const Point& v) {
  const Point a = p - v, b = q - v, c = r - v;
  const std::array<Point, 3> side{cross(b, c), cross(c, a), cross(a, b)};
  std::array<Point, 4> n{side[0], side[1], side[2], -1.0 * (side[0] + side[1] + side[2])};
  for (Point& normal : n) normal = normal / (length(normal) + kTiniestProduct);
  // Cosines find the extremes, but only the arc tangent is exact near 0 and pi.
  std::array<unsigned, 2> sharp{0, 1}, flat{0, 1};
  double greatest = -2, least = 2;  // minus the cosine
  for (unsigned i = 0; i < 4; ++i) {
    for (unsigned j = 0; j < i; ++j) {
      const double flatness = dot(n[i], n[j]);
      if (flatness > greatest) greatest = flatness, flat = {i, j};
      if (flatness < least) least = flatness, sharp = {i, j};
    }
  }
  const auto angle = [&n](const std::array<unsigned, 2>& faces) {
    return std::atan2(length(cross(n[faces[0]], n[faces[1]])), -dot(n[faces[0]], n[faces[1]]));
  };
  return {angle(sharp), angle(flat)};
}

}  // namespace delfront
