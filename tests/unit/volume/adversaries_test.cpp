// SPDX-License-Identifier: Apache-2.0
// Large or degenerate families made to break or to slow down boundary recovery: many components, shells in shells,
// thousands of cospherical, cocylindrical and lattice points, thin bodies turned out of the axes, sheets inside; and
// random local edits of a recovered grid. DELFRONT_ADVERSARIES=large takes the sizes of the nightly run.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "improve/operations.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"
#include "tetra/flips.hpp"
#include "volume/thin_out.hpp"

namespace delfront {
namespace {

using fixtures::box_facets;
using fixtures::expect_recovered;
using fixtures::Facets;
using fixtures::Recovered;

bool is_large() {
  const char* given = std::getenv("DELFRONT_ADVERSARIES");
  return given && std::string(given) == "large";
}

/// n tetrahedra of random shape, one a cell of a lattice, in a box.
Facets scattered_tets(int n) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-0.4, 0.4);
  const int side = static_cast<int>(std::ceil(std::cbrt(n)));
  Facets all = box_facets({-1, -1, -1}, {side + 1.0, side + 1.0, side + 1.0});
  for (int i = 0; i < n;) {
    const Point centre{i % side + 0.5, i / side % side + 0.5, i / side / side + 0.5};
    Point p[4];
    for (Point& corner : p) corner = centre + Point{unit(random), unit(random), unit(random)};
    Facets tet = fixtures::tetrahedron_facets(p[0], p[1], p[2], p[3]);
    if (std::abs(tet.volume()) < 1e-3) continue;
    if (tet.volume() < 0) tet.turn();
    all.add(tet);
    ++i;
  }
  return all;
}

double recover_seconds(int n) {
  const Model model = fixtures::to_model(scattered_tets(n));
  RecoveryReport report;
  Context context;
  const auto start = std::chrono::steady_clock::now();
  const BoundaryGrid grid =
      tetrahedralize_boundary(model, {}, std::vector<bool>(model.patches.size(), false), report, context);
  EXPECT_EQ(grid.regions.size(), static_cast<std::size_t>(n) + 1);
  EXPECT_EQ(report.steiner_left, 0u);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(Adversaries, many_tiny_components) {
  const int n = 1000, side = 10;
  const Recovered r = expect_recovered(scattered_tets(n), std::pow(side + 2, 3));
  EXPECT_EQ(r.grid.regions.size(), static_cast<std::size_t>(n) + 1);
  EXPECT_EQ(r.report.steiner_left, 0u);
}

/// Ten times the components, no more than thirty times the time: linear but for a noisy clock and caches.
TEST(Adversaries, the_time_for_components_is_linear) {
  const int n = is_large() ? 10000 : 1000;
  const double few = recover_seconds(n), many = recover_seconds(10 * n);
  EXPECT_LT(many, 30 * few + 0.5);
}

TEST(Adversaries, shells_in_shells) {
  for (const int n : {3, 30, is_large() ? 1000 : 60})
    for (const double step : {1.0, 1e-6}) {
      SCOPED_TRACE(std::to_string(n) + " shells, " + std::to_string(step) + " apart");
      Facets shells;
      for (int i = 0; i < n; ++i) {
        const double r = 1 + i * step;
        shells.add(box_facets({-r, -r, -r}, {r, r, r}));
      }
      const double outer = 1 + (n - 1) * step;
      EXPECT_EQ(expect_recovered(shells, 8 * outer * outer * outer).grid.regions.size(), static_cast<std::size_t>(n));
    }
}

/// A sphere by longitude and latitude: all its points on one sphere, many on one circle.
Facets globe(int n, double radius) {
  Facets ball;
  ball.points.push_back({0, 0, -radius});
  for (int i = 1; i < n; ++i)
    for (int k = 0; k < 2 * n; ++k) {
      const double up = std::numbers::pi * (double(i) / n - 0.5), round = std::numbers::pi * k / n;
      ball.points.push_back(radius *
                            Point{std::cos(up) * std::cos(round), std::cos(up) * std::sin(round), std::sin(up)});
    }
  ball.points.push_back({0, 0, radius});
  const std::size_t around = 2 * static_cast<std::size_t>(n), top = ball.points.size() - 1;
  for (std::size_t k = 0; k < around; ++k) {
    const std::size_t next = (k + 1) % around;
    ball.faces.push_back({0, 1 + next, 1 + k});
    for (std::size_t i = 0; i + 2 < static_cast<std::size_t>(n); ++i) {
      const std::size_t low = 1 + i * around, high = low + around;
      ball.faces.push_back({low + k, low + next, high + next});
      ball.faces.push_back({low + k, high + next, high + k});
    }
    ball.faces.push_back({top, top - around + k, top - around + next});
  }
  return ball;
}

TEST(Adversaries, points_on_spheres) {
  for (const int n : {4, 16, is_large() ? 128 : 32}) {
    SCOPED_TRACE(n);
    Facets balls = globe(n, 1);
    const double volume = balls.volume();
    expect_recovered(balls, volume);
    Facets inner = globe(n, 0.999);
    const double hollow = volume - inner.volume();
    inner.turn();
    balls.add(inner);
    EXPECT_EQ(expect_recovered(balls, hollow).grid.regions.size(), 1u);
  }
}

/// A drum of n sides in m storeys: points on a cylinder, caps of n corners.
Facets drum(int n, int m) {
  Facets body;
  for (int i = 0; i <= m; ++i)
    for (int k = 0; k < n; ++k)
      body.points.push_back(
          {std::cos(2 * std::numbers::pi * k / n), std::sin(2 * std::numbers::pi * k / n), double(i)});
  const auto sides = static_cast<std::size_t>(n), floors = static_cast<std::size_t>(m);
  std::vector<std::size_t> bottom, top;
  for (std::size_t k = 0; k < sides; ++k) {
    const std::size_t next = (k + 1) % sides;
    for (std::size_t i = 0; i < floors; ++i) {
      body.faces.push_back({i * sides + k, i * sides + next, (i + 1) * sides + next});
      body.faces.push_back({i * sides + k, (i + 1) * sides + next, (i + 1) * sides + k});
    }
    top.push_back(floors * sides + k);
    bottom.push_back(sides - 1 - k);
  }
  body.faces.push_back(bottom);
  body.faces.push_back(top);
  return body;
}

TEST(Adversaries, points_on_cylinders) {
  for (const int sides : {3, 24, is_large() ? 400 : 100})
    for (const int storeys : {1, 10}) {
      SCOPED_TRACE(std::to_string(sides) + " sides, " + std::to_string(storeys) + " storeys");
      const Facets body = drum(sides, storeys);
      EXPECT_EQ(expect_recovered(body, body.volume()).report.steiner_left, 0u);
    }
}

/// Cubes of a lattice, each a region, with common faces stored once: all points on a lattice.
TEST(Adversaries, points_on_lattices_with_shared_faces) {
  const int n = is_large() ? 20 : 6;
  for (const double offset : {0.0, 1e6}) {
    SCOPED_TRACE(offset);
    Facets lattice;
    const auto at = [n](int i, int j, int k) { return static_cast<std::size_t>((k * (n + 1) + j) * (n + 1) + i); };
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) lattice.points.push_back({i + offset, j - offset, k + offset});
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {  // outwards on the high sides, and turned on the low ones
          const auto add = [&](std::vector<std::size_t> face, int layer) {
            if (layer == 0) std::reverse(face.begin(), face.end());
            lattice.faces.push_back(std::move(face));
          };
          if (j < n && k < n) add({at(i, j, k), at(i, j + 1, k), at(i, j + 1, k + 1), at(i, j, k + 1)}, i);
          if (i < n && k < n) add({at(i, j, k), at(i, j, k + 1), at(i + 1, j, k + 1), at(i + 1, j, k)}, j);
          if (i < n && j < n) add({at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k)}, k);
        }
    DomainOptions all;
    all.keep = "all";
    const Recovered r = expect_recovered(lattice, n * n * n, all);
    EXPECT_EQ(r.grid.regions.size(), static_cast<std::size_t>(n * n * n));
    EXPECT_EQ(r.report.steiner_left, 0u);
  }
}

/// A slab of a jagged pattern, a thousand times as wide as thick, turned out of the axes.
TEST(Adversaries, thin_slabs_out_of_the_axes) {
  const unsigned first = fixtures::setting("DELFRONT_RANDOM_SEED", 1),
                 cases = fixtures::setting("DELFRONT_RANDOM_CASES", 300);
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const int n = 2 + static_cast<int>(random() % 5);
    const double thickness = std::pow(10, -1 - 3 * unit(random));
    const Point u{unit(random) + 1, unit(random), unit(random)}, v = cross(u, {unit(random), 0.3, 1});
    const Point w = cross(u, v) / length(cross(u, v));
    Facets slab;
    const auto at = [n](int side, int i, int j) {
      return static_cast<std::size_t>((side * (n + 1) + j) * (n + 1) + i);
    };
    for (int side = 0; side < 2; ++side)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) slab.points.push_back(i * u + j * v + (side + 0.4 * unit(random)) * thickness * w);
    const auto add = [&slab](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
      slab.faces.push_back({a, b, c});
      slab.faces.push_back({a, c, d});
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        add(at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1));
        add(at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j));
      }
    for (int i = 0; i < n; ++i) {
      add(at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0));
      add(at(0, i + 1, n), at(0, i, n), at(1, i, n), at(1, i + 1, n));
      add(at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1));
      add(at(0, n, i), at(0, n, i + 1), at(1, n, i + 1), at(1, n, i));
    }
    const double volume = slab.volume();
    if (volume < 0) slab.turn();
    EXPECT_EQ(expect_recovered(slab, std::abs(volume)).report.steiner_left, 0u);
  }
}

/// Random flips, insertions and removals on a recovered grid: whatever they do, it stays a valid grid of the same
/// boundary.
TEST(Adversaries, random_local_edits_keep_the_grid_valid) {
  const unsigned first = fixtures::setting("DELFRONT_RANDOM_SEED", 1),
                 cases = fixtures::setting("DELFRONT_RANDOM_CASES", 40);
  const Facets bodies[] = {globe(8, 1), fixtures::chazelle(2, 0.1), scattered_tets(20), drum(12, 3)};
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    const Facets& body = bodies[seed % 4];
    Recovered r = expect_recovered(body, std::numeric_limits<double>::quiet_NaN());
    TetComplex& c = r.grid.complex;
    std::mt19937 random(seed);
    Flips flips(c);
    LocalOperations operations(c);
    Retriangulation plan;
    std::vector<TetIndex> made;
    std::size_t edits = 0;
    for (int i = 0; i < 400; ++i) {
      if (i % 8 == 0) {
        edits += contract_free_vertex(c, static_cast<VertexIndex>(random() % c.num_vertices()), false) ? 1 : 0;
        continue;
      }
      const auto t = static_cast<TetIndex>(random() % c.num_slots());
      if (c.is_dead(t) || c.is_ghost(t)) continue;
      if (i % 8 == 1) {
        edits += operations.insert(t, 0, 1, true) ? 1 : 0;
      } else {
        const auto& e = kEdgeNodes[random() % 6];
        const bool planned = random() % 2 == 0
                                 ? flips.plan_face_removal(4 * t + static_cast<unsigned>(random() % 4), 0, plan)
                                 : flips.plan_edge_removal(t, c.node[4 * t + e[0]], c.node[4 * t + e[1]], 0, plan);
        edits += planned && flips.commit(plan, made) ? 1 : 0;
      }
      if (i % 50 == 0) {
        ASSERT_EQ(c.find_defect(), "");
      }
    }
    ASSERT_EQ(c.find_defect(), "");
    EXPECT_GT(edits, 0u);
    double volume = 0;
    for (TetIndex t = 0; t < c.num_slots(); ++t) {
      if (c.is_dead(t) || c.is_ghost(t)) continue;
      const Point a = c.point(c.node[4 * t]);
      volume +=
          dot(cross(c.point(c.node[4 * t + 1]) - a, c.point(c.node[4 * t + 2]) - a), c.point(c.node[4 * t + 3]) - a);
    }
    EXPECT_NEAR(volume / 6, r.volume, 1e-12 * r.volume);
  }
}

}  // namespace
}  // namespace delfront
