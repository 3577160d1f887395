// SPDX-License-Identifier: Apache-2.0
// Random valid surfaces: the boundary of a connected set of tets or of cells of a lattice. They are what users'
// surfaces are not: non-manifold, full of reflex edges, with tunnels and holes; and their volume is known exactly.
// DELFRONT_RANDOM_CASES=n runs n of each kind instead of a few, DELFRONT_RANDOM_SEED=s starts at seed s.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>

#include "delaunay/delaunay.hpp"
#include "delfront/errors.hpp"
#include "delfront/surface_check.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using fixtures::Facets;

/// A linear map that shears and squeezes: Delaunay tets become what no Delaunay tetrahedrization of their vertices has.
class RandomMap {
 public:
  explicit RandomMap(std::mt19937& random) {
    std::uniform_int_distribution<int> squeeze(0, 6), shear(-3, 3);
    for (double& f : factor_) f = std::exp2(-squeeze(random));
    for (double& s : shear_) s = shear(random) / 2.0;
  }
  Point operator()(Point p) const {
    p = {factor_[0] * p.x, factor_[1] * p.y, factor_[2] * p.z};
    p.x += shear_[0] * p.y + shear_[1] * p.z;
    p.y += shear_[2] * p.z;
    return p;
  }

 private:
  double factor_[3], shear_[3];
};

enum class Places { uniform, lattice, cospherical, clustered };

/// Multiples of 2^-20, so that the map above is exact.
Point random_place(Places kind, std::mt19937& random) {
  std::uniform_int_distribution<int> fine(0, (1 << 20) - 1), coarse(0, 5);
  const Point p{fine(random) * 0x1p-20, fine(random) * 0x1p-20, fine(random) * 0x1p-20};
  switch (kind) {
    case Places::lattice:
      return {double(coarse(random)), double(coarse(random)), double(coarse(random))};
    case Places::cospherical: {
      const Point d = p - Point{0.5, 0.5, 0.5}, on = d / std::max(length(d), 0.01);
      return {std::round(on.x * 0x1p20) * 0x1p-20, std::round(on.y * 0x1p20) * 0x1p-20,
              std::round(on.z * 0x1p20) * 0x1p-20};
    }
    case Places::clustered:
      return {double(coarse(random)) + 0x1p-6 * p.x, double(coarse(random)) + 0x1p-6 * p.y, p.z};
    case Places::uniform:
      break;
  }
  return p;
}

struct Body {
  Facets surface;
  double volume = 0;
};

/// Grows a connected set from one tet, and takes its boundary; mapped afterwards.
Body random_tets(unsigned seed) {
  std::mt19937 random(seed);
  const auto kind = static_cast<Places>(seed % 4);
  std::uniform_int_distribution<int> number(30, 200);
  std::set<std::array<double, 3>> taken;
  TetComplex c;
  for (int i = number(random); i > 0; --i) {
    const Point p = random_place(kind, random);
    if (taken.insert({p.x, p.y, p.z}).second) c.add_vertex(p, 1);
  }
  Context context;
  build_delaunay(c, context);
  std::vector<TetIndex> real;
  for (TetIndex t = 0; t < c.num_slots(); ++t)
    if (!c.is_dead(t) && !c.is_ghost(t)) real.push_back(t);
  const std::size_t most = 1 + random() % real.size();
  std::set<TetIndex> chosen = {real[random() % real.size()]};
  std::vector<TetIndex> front(chosen.begin(), chosen.end());
  while (chosen.size() < most && !front.empty()) {
    const std::size_t i = random() % front.size();
    std::vector<TetIndex> next;
    for (unsigned f = 0; f < 4; ++f)
      if (const TetIndex t = c.neigh[4 * front[i] + f] >> 2; !c.is_ghost(t) && !chosen.contains(t)) next.push_back(t);
    if (next.empty()) {
      front.erase(front.begin() + static_cast<std::ptrdiff_t>(i));
      continue;
    }
    const TetIndex t = next[random() % next.size()];
    chosen.insert(t);
    front.push_back(t);
  }
  const RandomMap map(random);
  Body body;
  std::map<VertexIndex, std::size_t> number_of;
  for (const TetIndex t : chosen) {
    const std::uint32_t* n = &c.node[4 * t];
    const Point a = map(c.point(n[0]));
    body.volume += dot(cross(map(c.point(n[1])) - a, map(c.point(n[2])) - a), map(c.point(n[3])) - a) / 6;
    for (unsigned f = 0; f < 4; ++f) {
      if (chosen.contains(c.neigh[4 * t + f] >> 2)) continue;
      std::vector<std::size_t> face;
      const auto corners = c.face_nodes(4 * t + f);
      for (const VertexIndex v : {corners[0], corners[2], corners[1]}) {
        const auto [it, is_new] = number_of.try_emplace(v, body.surface.points.size());
        if (is_new) body.surface.points.push_back(map(c.point(v)));
        face.push_back(it->second);
      }
      body.surface.faces.push_back(face);
    }
  }
  return body;
}

using Cell = std::array<int, 3>;

/// Cells of an n^3 lattice, n^3 numbers; 0 outside.
class Lattice {
 public:
  Lattice(int n, std::vector<unsigned> numbers) : n_(n), numbers_(std::move(numbers)) {}
  unsigned operator()(Cell c) const {
    const bool is_in = std::min({c[0], c[1], c[2]}) >= 0 && std::max({c[0], c[1], c[2]}) < n_;
    return is_in ? numbers_[static_cast<std::size_t>((c[2] * n_ + c[1]) * n_ + c[0])] : 0u;
  }
  /// `visit(number on this side, number beyond, corners)` for every side; corners run round the axis that it crosses.
  template <class Visit>
  void for_each_side(Visit&& visit) const {
    for (int i = -1; i < n_; ++i)
      for (int j = -1; j < n_; ++j)
        for (int k = -1; k < n_; ++k)
          for (std::size_t axis = 0; axis < 3; ++axis) {
            Cell next{i, j, k};
            ++next[axis];
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            Cell b = next, c = next, d = next;
            ++b[u], ++c[u], ++c[v], ++d[v];
            visit((*this)({i, j, k}), (*this)(next), std::array{next, b, c, d});
          }
  }

 private:
  int n_;
  std::vector<unsigned> numbers_;
};

/// Lattice sides as pairs of triangles, their corners mapped and numbered as they come.
class SideCollector {
 public:
  explicit SideCollector(const RandomMap& map) : map_(map) {}
  /// @param first  which corner the diagonal starts from, 0 or 1
  void add(const std::array<Cell, 4>& side, bool is_reversed, std::size_t first) {
    std::vector<std::size_t> q;
    for (const Cell& corner : side) q.push_back(vertex(corner));
    if (is_reversed) std::reverse(q.begin(), q.end());
    surface.faces.push_back({q[first], q[first + 1], q[first + 2]});
    surface.faces.push_back({q[first], q[first + 2], q[(first + 3) % 4]});
  }

  Facets surface;

 private:
  std::size_t vertex(Cell at) {
    const auto [it, is_new] = index_.try_emplace(at, surface.points.size());
    if (is_new) surface.points.push_back(map_({double(at[0]), double(at[1]), double(at[2])}));
    return it->second;
  }

  RandomMap map_;
  std::map<Cell, std::size_t> index_;
};

/// A random set of cells of an n^3 lattice, 2 <= n < 2 + num_sizes, with random diagonals, mapped.
Body random_cells(unsigned seed, unsigned num_sizes) {
  std::mt19937 random(seed);
  const int n = 2 + static_cast<int>(random() % num_sizes);
  std::vector<unsigned> is_full;
  for (int i = 0; i < n * n * n; ++i) is_full.push_back(random() % 3 != 0);
  is_full[0] = 1;
  SideCollector sides{RandomMap(random)};
  Lattice(n, is_full).for_each_side([&](unsigned here, unsigned there, const std::array<Cell, 4>& side) {
    if (here != there) sides.add(side, there != 0, random() % 2);
  });
  Body body{std::move(sides.surface), 0};
  body.volume = body.surface.volume();
  return body;
}

/// Cells of an n^3 lattice of three materials and none, n = 2 or 3, faces between them stored once and turned as they
/// come, and some faces between cells of one material: sheets, which hang, float, or meet three and more in an edge.
Facets random_rooms(unsigned seed) {
  std::mt19937 random(seed);
  const int n = 2 + static_cast<int>(random() % 2);
  std::vector<unsigned> material;
  for (int i = 0; i < n * n * n; ++i) material.push_back(random() % 4);
  material[0] = 1;
  SideCollector sides{RandomMap(random)};
  Lattice(n, material).for_each_side([&](unsigned here, unsigned there, const std::array<Cell, 4>& side) {
    if (here == there && (here == 0 || random() % 8 != 0)) return;
    const std::size_t first = random() % 2;
    sides.add(side, random() % 2 == 0, first);
  });
  return std::move(sides.surface);
}

void expect_recovered(const Body& body, const char* kind, unsigned seed) {
  SCOPED_TRACE(std::string(kind) + ", seed " + std::to_string(seed) + ": DELFRONT_RANDOM_SEED=" + std::to_string(seed) +
               " DELFRONT_RANDOM_CASES=1");
  try {
    const auto r = fixtures::expect_recovered(body.surface, body.volume);
    EXPECT_EQ(r.report.steiner_left, 0u);
  } catch (const Error& e) {
    ADD_FAILURE() << e.what();
  }
}

TEST(RandomPolyhedra, sets_of_tets) {
  const unsigned first = fixtures::setting("DELFRONT_RANDOM_SEED", 1),
                 cases = fixtures::setting("DELFRONT_RANDOM_CASES", 200);
  for (unsigned seed = first; seed < first + cases; ++seed) expect_recovered(random_tets(seed), "tets", seed);
}

TEST(RandomPolyhedra, sets_of_cells) {
  const unsigned first = fixtures::setting("DELFRONT_RANDOM_SEED", 1),
                 cases = fixtures::setting("DELFRONT_RANDOM_CASES", 90);
  for (unsigned seed = first; seed < first + cases; ++seed) expect_recovered(random_cells(seed, 3), "cells", seed);
}

/// Only a border that a sheet has to itself may keep points, and then says so; the fixture compares.
TEST(RandomPolyhedra, rooms_of_several_materials_with_sheets) {
  const unsigned first = fixtures::setting("DELFRONT_RANDOM_SEED", 1),
                 cases = fixtures::setting("DELFRONT_RANDOM_CASES", 150);
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    DomainOptions all;
    all.keep = "all";
    try {
      const auto r = fixtures::expect_recovered(random_rooms(seed), std::numeric_limits<double>::quiet_NaN(), all);
      EXPECT_EQ(r.report.left.size(), r.report.steiner_left);
      EXPECT_EQ(r.report.left_why.size(), r.report.steiner_left);
      for (const std::string& why : r.report.left_why) EXPECT_TRUE(why.starts_with("a sheet ends")) << why;
    } catch (const Error& e) {
      ADD_FAILURE() << e.what();
    }
  }
}

TEST(RandomPolyhedra, cells_that_kept_a_point_on_an_edge) { expect_recovered(random_cells(97, 3), "cells", 97); }

TEST(RandomPolyhedra, cells_with_a_point_that_could_not_be_rounded) {
  expect_recovered(random_cells(54, 4), "cells of four sizes", 54);
}

}  // namespace
}  // namespace delfront
