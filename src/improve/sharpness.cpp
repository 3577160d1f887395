// SPDX-License-Identifier: Apache-2.0
#include "improve/sharpness.hpp"

#include <algorithm>

namespace delfront {

namespace {

double squared_sine(const Point& u, const Point& v) {
  const double lengths = squared_length(u) * squared_length(v);
  return lengths > 0 ? squared_length(cross(u, v)) / lengths : 0;
}

double sharpest_corner(const Point& a, const Point& b, const Point& c) {
  return std::min({squared_sine(b - a, c - a), squared_sine(c - b, a - b), squared_sine(a - c, b - c)});
}

Point normal_of(const TetComplex& c, FaceRef ref) {
  const auto n = c.face_nodes(ref);
  const Point p = c.point(n[0]);
  return cross(c.point(n[1]) - p, c.point(n[2]) - p);
}

/// The constrained face that is met first when turning round the edge opposite face node k, on ref's side of it.
FaceRef next_round_edge(const TetComplex& c, FaceRef ref, unsigned k) {
  const auto n = c.face_nodes(ref);
  const VertexIndex u = n[(k + 1) % 3], v = n[(k + 2) % 3];
  FaceRef into = ref;
  for (;;) {
    const TetIndex t = into >> 2;
    unsigned leave = 0;
    while (c.node[4 * t + leave] == u || c.node[4 * t + leave] == v || leave == (into & 3)) ++leave;
    const FaceRef out = 4 * t + leave;
    if (c.is_constrained(out)) return out;
    into = c.neigh[out];
  }
}

/// Both normals point into what lies between the two faces: they tell an acute angle from an obtuse one, and one above
/// 180 degrees only with this.
bool is_reflex(const TetComplex& c, FaceRef ref, const Point& normal, FaceRef across) {
  const auto n = c.face_nodes(ref);
  const auto m = c.face_nodes(across);
  const Point at = c.point(n[0]);
  return std::any_of(m.begin(), m.end(), [&](VertexIndex v) {
    return std::find(n.begin(), n.end(), v) == n.end() && dot(normal, c.point(v) - at) < 0;
  });
}

}  // namespace

std::vector<float> measure_sharpness(const TetComplex& complex) {
  std::vector<float> sharpness(complex.num_vertices(), 1);
  const auto lower = [&](VertexIndex v, double value) {
    sharpness[v] = std::min(sharpness[v], static_cast<float>(value));
  };
  for (TetIndex t = 0; t < complex.num_slots(); ++t) {
    if (complex.is_dead(t) || complex.is_ghost(t)) continue;
    for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) {
      if (!complex.is_constrained(ref)) continue;
      const auto n = complex.face_nodes(ref);
      const double corner = sharpest_corner(complex.point(n[0]), complex.point(n[1]), complex.point(n[2]));
      for (const VertexIndex v : n) lower(v, corner);
      const Point normal = normal_of(complex, ref);
      for (unsigned k = 0; k < 3; ++k) {
        const FaceRef across = next_round_edge(complex, ref, k);
        const Point next = normal_of(complex, across);
        if (dot(normal, next) > 0 || is_reflex(complex, ref, normal, across)) continue;
        lower(n[(k + 1) % 3], squared_sine(normal, next));
        lower(n[(k + 2) % 3], squared_sine(normal, next));
      }
    }
  }
  return sharpness;
}

}  // namespace delfront
