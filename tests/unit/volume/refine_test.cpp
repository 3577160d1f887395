// SPDX-License-Identifier: Apache-2.0
// Refinement alone: sizes, growth, limits, regions, determinism. Surfaces keep their faces.
#include "volume/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "delfront/errors.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"
#include "support/tet_fixtures.hpp"

namespace delfront {
namespace {

/// The same size everywhere, or one that grows along x.
class LinearSize : public SizeField {
 public:
  LinearSize(double at_zero, double slope) : at_zero_(at_zero), slope_(slope) {}
  void sizes(std::span<const Point> at, std::span<double> size) const override {
    for (std::size_t i = 0; i < at.size(); ++i) size[i] = at_zero_ + slope_ * std::abs(at[i].x);
  }
  double lower_bound(const Box&) const override { return at_zero_; }

 private:
  double at_zero_, slope_;
};

/// The recovered boundary of a surface, every vertex with the field's size.
TetComplex complex_of(const Model& model, const SizeField& size) {
  Context context;
  RecoveryReport report;
  TetComplex c = tetrahedralize_boundary(model, {}, {false}, report, context).complex;
  for (TetVertex& v : c.vertex) v.h = size.size(v.point());
  return c;
}

Model sphere(int levels) {
  Context context;
  return build_model({{fixtures::sphere_surface(levels), "sphere"}}, context);
}

std::set<std::pair<VertexIndex, VertexIndex>> inner_edges(const TetComplex& c) {
  std::set<std::pair<VertexIndex, VertexIndex>> edges;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    for (const auto& e : kEdgeNodes) {
      const VertexIndex a = c.node[4 * t + e[0]], b = c.node[4 * t + e[1]];
      if (!(c.on_boundary[a] && c.on_boundary[b])) edges.insert(std::minmax(a, b));
    }
  }
  return edges;
}

/// Share of the inner edges whose length is within [0.5, 2] of the size wanted in their middle.
double share_in_band(const TetComplex& c, const SizeField& size) {
  std::size_t good = 0;
  const auto edges = inner_edges(c);
  for (const auto& [a, b] : edges) {
    const double ratio = distance(c.point(a), c.point(b)) / size.size(0.5 * (c.point(a) + c.point(b)));
    good += ratio >= 0.5 && ratio <= 2 ? 1 : 0;
  }
  return static_cast<double>(good) / static_cast<double>(std::max<std::size_t>(edges.size(), 1));
}

TEST(Refine, a_sphere_of_one_size_has_edges_of_that_size) {
  const LinearSize size(0.15, 0);  // about the surface's own
  TetComplex c = complex_of(sphere(3), size);
  const auto faces = fixtures::constrained_faces(c);
  const double volume = fixtures::total_volume(c);
  Context context;
  const RefineReport report = refine_complex(c, size, {}, context);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
  EXPECT_NEAR(fixtures::total_volume(c), volume, 1e-12);
  EXPECT_GT(inner_edges(c).size(), 3000u);
  EXPECT_GT(share_in_band(c, size), 0.99);
  EXPECT_GE(report.candidates, report.points_inserted);
  EXPECT_GT(report.rounds, 1u);
}

TEST(Refine, sizes_that_grow_are_kept_too) {
  const LinearSize size(0.15, 0.3);
  TetComplex c = complex_of(sphere(3), size);
  Context context;
  refine_complex(c, size, {}, context);
  EXPECT_EQ(c.find_defect(), "");
  std::size_t good = 0, all = 0;
  for (const auto& [a, b] : inner_edges(c)) {  // the surface is finer than asked for far from x = 0: inside alone
    if (c.on_boundary[a] || c.on_boundary[b]) continue;
    const double ratio = distance(c.point(a), c.point(b)) / size.size(0.5 * (c.point(a) + c.point(b)));
    good += ratio >= 0.5 && ratio <= 2 ? 1 : 0;
    ++all;
  }
  ASSERT_GT(all, 100u);
  EXPECT_GT(static_cast<double>(good), 0.99 * static_cast<double>(all));
}

TEST(Refine, a_size_larger_than_the_body_adds_nothing_to_a_tet) {
  const LinearSize size(10, 0);
  TetComplex c =
      complex_of(fixtures::to_model(fixtures::tetrahedron_facets({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})), size);
  Context context;
  EXPECT_EQ(refine_complex(c, size, {}, context).points_inserted, 0u);
}

TEST(Refine, no_two_points_are_nearer_than_seven_tenths_of_the_size) {
  const LinearSize size(0.12, 0);
  TetComplex c = complex_of(fixtures::to_model(fixtures::box_facets({0, 0, 0}, {1, 1, 1})), size);
  const std::size_t given = c.num_vertices();
  Context context;
  refine_complex(c, size, {}, context);
  double nearest = 1;
  for (VertexIndex v = static_cast<VertexIndex>(given); v < c.num_vertices(); ++v)
    for (VertexIndex w = 0; w < v; ++w)
      if (c.vertex_tet[v] != kNoIndex && c.vertex_tet[w] != kNoIndex)
        nearest = std::min(nearest, distance(c.point(v), c.point(w)));
  EXPECT_GE(nearest, 0.7 * 0.12 * (1 - 1e-12));
}

TEST(Refine, sizes_of_neighbours_keep_the_growth_and_the_limits) {
  const Model model = sphere(3);
  Context context;
  RecoveryReport recovery;
  TetComplex c = tetrahedralize_boundary(model, {}, {false}, recovery, context).complex;
  BoundarySizes boundary;
  for (VertexIndex v = 0; v < c.num_vertices(); ++v) {
    if (c.vertex_tet[v] == kNoIndex) continue;
    boundary.points.push_back(c.point(v));
    boundary.size.push_back(v == 0 ? 0.01 : c.vertex[v].h);  // one place far finer than the rest
  }
  boundary.growth = 1.4;
  boundary.hmin = 0.03;
  boundary.hmax = 0.25;
  const auto size = build_boundary_size_field(boundary, context);
  for (TetVertex& v : c.vertex) v.h = size->size(v.point());
  refine_complex(c, *size, {}, context);
  EXPECT_EQ(c.find_defect(), "");
  const double slope = (boundary.growth - 1) / boundary.growth;
  for (const auto& [a, b] : inner_edges(c)) {
    const double ha = c.vertex[a].h, hb = c.vertex[b].h;
    ASSERT_LE(std::abs(ha - hb), slope * distance(c.point(a), c.point(b)) + 1e-12);
    ASSERT_GE(std::min(ha, hb), boundary.hmin);
    ASSERT_LE(std::max(ha, hb), boundary.hmax);
  }
  EXPECT_GT(share_in_band(c, *size), 0.98);
}

TEST(Refine, regions_stay_apart) {
  fixtures::Facets shells = fixtures::box_facets({-2, -2, -2}, {2, 2, 2});
  shells.add(fixtures::box_facets({-1, -1, -1}, {1, 1, 1}));
  const LinearSize size(0.4, 0);
  TetComplex c = complex_of(fixtures::to_model(shells), size);
  const auto faces = fixtures::constrained_faces(c);
  Context context;
  refine_complex(c, size, {}, context);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
  double inner = 0;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    Point centre;
    for (unsigned k = 0; k < 4; ++k) centre = centre + 0.25 * c.point(c.node[4 * t + k]);
    const bool is_inside = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)}) < 1;
    ASSERT_LT(c.region[t], 2u);
    for (unsigned f = 0; f < 4; ++f) {
      const TetIndex other = c.neigh[4 * t + f] >> 2;
      if (!c.is_constrained(4 * t + f)) {
        EXPECT_EQ(c.region[other], c.region[t]);
      }
    }
    const std::uint32_t* n = &c.node[4 * t];
    if (is_inside)
      inner +=
          dot(cross(c.point(n[1]) - c.point(n[0]), c.point(n[2]) - c.point(n[0])), c.point(n[3]) - c.point(n[0])) / 6;
  }
  EXPECT_NEAR(inner, 8, 1e-10);
}

TEST(Refine, two_runs_are_the_same) {
  const LinearSize size(0.2, 0.1);
  const TetComplex start = complex_of(sphere(2), size);
  TetComplex a = start, b = start;
  Context context;
  refine_complex(a, size, {}, context);
  refine_complex(b, size, {}, context);
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(a.neigh, b.neigh);
}

TEST(Refine, ends_on_thin_bodies_and_keeps_them_valid) {
  for (const double thickness : {1e-2, 1e-4, 1e-6}) {
    SCOPED_TRACE(thickness);
    const LinearSize size(0.2, 0);
    TetComplex c = complex_of(fixtures::to_model(fixtures::box_facets({0, 0, 0}, {1, 1, thickness})), size);
    Context context;
    context.time_limit = 20;
    refine_complex(c, size, {}, context);
    EXPECT_EQ(c.find_defect(), "");
    EXPECT_NEAR(fixtures::total_volume(c), thickness, 1e-12);
  }
}

TEST(Refine, stops_at_limits) {
  const LinearSize size(0.1, 0);
  const TetComplex start = complex_of(sphere(3), size);
  TetComplex c = start;
  Context few;
  few.max_cells = 500;
  EXPECT_THROW(refine_complex(c, size, {}, few), LimitError);
  c = start;
  std::atomic<bool> cancel = true;
  Context context;
  context.cancel = &cancel;
  EXPECT_THROW(refine_complex(c, size, {}, context), Cancelled);
}

}  // namespace
}  // namespace delfront
