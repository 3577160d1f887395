// SPDX-License-Identifier: Apache-2.0
#include "support/tet_fixtures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "delaunay/delaunay.hpp"

namespace delfront::fixtures {

namespace {

using FaceMap = std::map<std::array<VertexIndex, 3>, FaceRef>;

std::array<VertexIndex, 3> sorted_face(const TetComplex& c, FaceRef ref) {
  auto key = c.face_nodes(ref);
  std::sort(key.begin(), key.end());
  return key;
}

void bond_or_keep(TetComplex& c, FaceMap& open, FaceRef ref) {
  const auto key = sorted_face(c, ref);
  const auto found = open.find(key);
  if (found == open.end()) {
    open.emplace(key, ref);
    return;
  }
  c.bond(ref, found->second);
  open.erase(found);
}

bool is_star_positive(const TetComplex& c, VertexIndex v, std::vector<TetIndex>& star) {
  c.star(v, star);
  return std::all_of(star.begin(), star.end(), [&](TetIndex t) {
    const std::uint32_t* n = &c.node[4 * t];
    return c.is_ghost(t) || c.orient(n[0], n[1], n[2], n[3]) > 0;
  });
}

}  // namespace

TetComplex complex_from_tets(const std::vector<Point>& points, const std::vector<std::array<VertexIndex, 4>>& tets,
                             double h) {
  TetComplex c;
  for (const Point& p : points) c.add_vertex(p, h);
  FaceMap open;
  for (const auto& n : tets) {
    const TetIndex t = c.new_tet();
    c.set_nodes(t, n[0], n[1], n[2], n[3]);
    c.region[t] = 0;
    for (unsigned f = 0; f < 4; ++f) {
      c.vertex_tet[n[f]] = t;
      bond_or_keep(c, open, 4 * t + f);
    }
  }
  const FaceMap hull = open;
  for (const auto& [key, ref] : hull) {
    const auto n = c.face_nodes(ref);
    const TetIndex t = c.new_tet();
    c.set_nodes(t, n[0], n[2], n[1], kGhost);
    for (unsigned f = 0; f < 4; ++f) bond_or_keep(c, open, 4 * t + f);
    c.set_constrained_both(ref, true);
    for (const VertexIndex v : n) c.on_boundary[v] = 1;
  }
  return c;
}

namespace {

/// The cube as n^3 cells of six tets, in place.
TetComplex build_lattice(int n) {
  const auto id = [n](int i, int j, int k) { return static_cast<VertexIndex>((k * (n + 1) + j) * (n + 1) + i); };
  std::vector<Point> points;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) points.push_back({double(i) / n, double(j) / n, double(k) / n});
  std::vector<std::array<VertexIndex, 4>> tets;
  constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int cell = 0; cell < n * n * n; ++cell) {
    for (int path = 0; path < 6; ++path) {
      int at[3] = {cell % n, cell / n % n, cell / n / n};
      std::array<VertexIndex, 4> tet{id(at[0], at[1], at[2])};
      for (unsigned step = 0; step < 3; ++step) {
        ++at[kPaths[path][step]];
        tet[step + 1] = id(at[0], at[1], at[2]);
      }
      if (path >= 3) std::swap(tet[2], tet[3]);
      tets.push_back(tet);
    }
  }
  return complex_from_tets(points, tets, 1.0 / n);
}

void jitter_free_vertices(TetComplex& c, double reach, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  std::vector<TetIndex> star;
  for (VertexIndex v = 0; v < c.num_vertices(); ++v) {
    if (c.on_boundary[v]) continue;
    const Point old = c.point(v);
    Point move{uniform(random), uniform(random), uniform(random)};
    do {
      const Point p = old + move;
      c.vertex[v] = {p.x, p.y, p.z, c.vertex[v].h};
      move = 0.5 * move;
    } while (!is_star_positive(c, v, star));
  }
}

/// Points at least `apart` from each other, by buckets of that size.
class SpacedPoints {
 public:
  explicit SpacedPoints(double apart) : apart_(apart) {}
  bool has_room(const Point& p) const {
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          if (is_crowded(p, {apart_ * dx, apart_ * dy, apart_ * dz})) return false;
    return true;
  }
  void add(const Point& p) { buckets_[key(p)].push_back(p); }

 private:
  std::array<int, 3> key(const Point& p) const {
    return {int(std::floor(p.x / apart_)), int(std::floor(p.y / apart_)), int(std::floor(p.z / apart_))};
  }
  bool is_crowded(const Point& p, const Point& offset) const {
    const auto bucket = buckets_.find(key(p + offset));
    return bucket != buckets_.end() && std::any_of(bucket->second.begin(), bucket->second.end(),
                                                   [&](const Point& q) { return distance(p, q) < apart_; });
  }
  double apart_;
  std::map<std::array<int, 3>, std::vector<Point>> buckets_;
};

}  // namespace

TetComplex jittered_cube(int n, double jitter, unsigned seed) {
  TetComplex c = build_lattice(n);
  jitter_free_vertices(c, jitter / n, seed);
  return c;
}

TetComplex jittered_cube_with_wall(int n, double jitter, unsigned seed) {
  TetComplex c = build_lattice(n);
  for (VertexIndex v = 0; v < c.num_vertices(); ++v)
    if (c.point(v).z == 0.5) c.on_boundary[v] = 1;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_ghost(t)) continue;
    for (unsigned f = 0; f < 4; ++f) {
      const auto n3 = c.face_nodes(4 * t + f);
      if (c.point(n3[0]).z == 0.5 && c.point(n3[1]).z == 0.5 && c.point(n3[2]).z == 0.5)
        c.set_constrained_both(4 * t + f, true);
      if (c.point(c.node[4 * t + f]).z > 0.5) c.region[t] = 1;
    }
  }
  jitter_free_vertices(c, jitter / n, seed);
  return c;
}

TetComplex sliver_ball(double h, int near_surface, unsigned seed) {
  TetComplex c;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  SpacedPoints spaced(0.6 * h);
  const auto add = [&](const Point& p) {
    c.add_vertex(p, h);
    spaced.add(p);
  };
  const int on_surface = int(4 * std::numbers::pi / (0.866 * h * h));
  for (int i = 0; i < on_surface; ++i) {
    const double z = 1 - 2 * (i + 0.5) / on_surface, r = std::sqrt(1 - z * z), turn = i * 2.399963229728653;
    add({r * std::cos(turn), r * std::sin(turn), z});
  }
  for (int i = 0; i < near_surface;) {
    const Point p{uniform(random), uniform(random), uniform(random)};
    const double r = length(p);
    if (r > 1 || r < 0.1) continue;
    add(((1 - 0.02 * h - h * h / 5) / r) * p);  // the facets lie up to about h^2 / 6 below the sphere
    ++i;
  }
  for (int i = 0; i < int(60 / (h * h * h)); ++i) {
    const Point p{uniform(random), uniform(random), uniform(random)};
    if (length(p) < 1 - 0.5 * h && spaced.has_room(p)) add(p);
  }
  connect_hull(c);
  return c;
}

void connect_hull(TetComplex& c) {
  Context context;
  build_delaunay(c, context);
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t)) continue;
    c.flag[t] = 0;
    c.region[t] = c.is_ghost(t) ? TetComplex::kOutside : 0;
  }
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || !c.is_ghost(t)) continue;
    c.set_constrained_both(4 * t + 3, true);
    for (unsigned i = 0; i < 3; ++i) c.on_boundary[c.node[4 * t + i]] = 1;
  }
}

TetComplex tets_around_edge(int n, double wobble, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-wobble, wobble);
  std::vector<Point> points{{0, 0, -0.6}, {0, 0, 0.6}};
  std::vector<std::array<VertexIndex, 4>> tets;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    const double r = 1 + uniform(random);
    points.push_back({r * std::cos(angle), r * std::sin(angle), 0.3 * uniform(random)});
    tets.push_back({0, 1, static_cast<VertexIndex>(2 + i), static_cast<VertexIndex>(2 + (i + 1) % n)});
  }
  return complex_from_tets(points, tets, 1);
}

double total_volume(const TetComplex& c) {
  double sum = 0;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    const std::uint32_t* n = &c.node[4 * t];
    const Point a = c.point(n[0]);
    sum += dot(cross(c.point(n[1]) - a, c.point(n[2]) - a), c.point(n[3]) - a) / 6;
  }
  return sum;
}

std::vector<std::array<VertexIndex, 3>> constrained_faces(const TetComplex& c) {
  std::vector<std::array<VertexIndex, 3>> faces;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t)) continue;
    for (unsigned f = 0; f < 4; ++f)
      if (c.is_constrained(4 * t + f)) faces.push_back(sorted_face(c, 4 * t + f));
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

}  // namespace delfront::fixtures
