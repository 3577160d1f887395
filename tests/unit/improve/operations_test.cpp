// SPDX-License-Identifier: Apache-2.0
#include "improve/operations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/tet_fixtures.hpp"

namespace delfront {
namespace {

double worst_of(const TetComplex& c, const std::vector<TetIndex>& tets) {
  double worst = 1;
  for (const TetIndex t : tets) {
    const std::uint32_t* n = &c.node[4 * t];
    worst = std::min(worst, measure_quality(c.point(n[0]), c.point(n[1]), c.point(n[2]), c.point(n[3])));
  }
  return worst;
}

/// n tets around an edge with the edge split by a vertex near its lower end.
TetComplex split_edge(int n, double z) {
  TetComplex c = fixtures::tets_around_edge(n, 0, 1);
  const VertexIndex v = c.add_vertex({0, 0, z}, 1);
  std::vector<TetIndex> ring, made;
  c.edge_ring(0, 0, 1, ring);
  std::vector<std::array<VertexIndex, 4>> fill;
  for (const TetIndex t : ring) {
    std::array<VertexIndex, 4> low{c.node[4 * t], c.node[4 * t + 1], c.node[4 * t + 2], c.node[4 * t + 3]}, high = low;
    std::replace(low.begin(), low.end(), VertexIndex{1}, v);
    std::replace(high.begin(), high.end(), VertexIndex{0}, v);
    fill.push_back(low);
    fill.push_back(high);
  }
  c.replace(ring, fill, made);
  return c;
}

TEST(Smooth, moves_a_badly_placed_vertex_to_the_middle) {
  TetComplex c = split_edge(6, -0.599);
  const auto v = static_cast<VertexIndex>(c.num_vertices() - 1);
  LocalOperations operations(c);
  EXPECT_TRUE(operations.smooth(v, 1));
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(operations.touched.size(), 12u);
  EXPECT_NEAR(length(c.point(v)), 0, 0.02);  // by symmetry the best place is the centre
}

TEST(Smooth, leaves_boundary_vertices_and_those_beside_constrained_faces) {
  TetComplex c = split_edge(6, -0.5);
  const auto v = static_cast<VertexIndex>(c.num_vertices() - 1);
  LocalOperations operations(c);
  EXPECT_FALSE(operations.smooth(0, 1));
  std::vector<TetIndex> scratch;
  const FaceRef inside = c.find_face(v, 2, 3, scratch);
  c.set_constrained_both(inside, true);
  EXPECT_FALSE(operations.smooth(v, 1));
  EXPECT_FALSE(operations.contract(v));
  c.set_constrained_both(inside, false);
  c.on_boundary[v] = 1;
  EXPECT_FALSE(operations.smooth(v, 1));
  EXPECT_FALSE(operations.contract(v));
}

TEST(Contract, removes_a_vertex_that_makes_slivers) {
  TetComplex c = split_edge(5, -0.59);
  const auto v = static_cast<VertexIndex>(c.num_vertices() - 1);
  std::vector<TetIndex> star;
  c.star(v, star);
  const double before = worst_of(c, star), volume = fixtures::total_volume(c);
  LocalOperations operations(c);
  EXPECT_TRUE(operations.contract(v));
  EXPECT_EQ(c.vertex_tet[v], kNoIndex);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_GT(worst_of(c, operations.touched), before);
  EXPECT_NEAR(fixtures::total_volume(c), volume, 1e-13);
}

TEST(Insert, helps_where_nothing_else_can) {
  // A tall spindle whose axis has too many tets for a swap and whose vertices are all fixed: the large angles at the
  // rim go when a point halves the axis.
  constexpr int kRing = 12;
  TetComplex c = fixtures::tets_around_edge(kRing, 0, 1);
  c.vertex[0].z = -3;
  c.vertex[1].z = 3;
  const double before = worst_of(c, {0}), volume = fixtures::total_volume(c);
  LocalOperations operations(c);
  EXPECT_EQ(operations.swap(0, 1), LocalOperations::Swap::none);
  EXPECT_FALSE(operations.contract(0));
  ASSERT_TRUE(operations.insert(0, 0.2, 1));
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(operations.touched.size(), 2u * kRing);
  EXPECT_GT(worst_of(c, operations.touched), 1.4 * before);
  EXPECT_NEAR(length(c.point(static_cast<VertexIndex>(c.num_vertices() - 1))), 0, 0.2);
  EXPECT_NEAR(fixtures::total_volume(c), volume, 1e-12);
}

TEST(Insert, makes_no_edge_far_shorter_than_wanted) {
  TetComplex c = fixtures::tets_around_edge(12, 0, 1);
  for (VertexIndex v = 0; v < c.num_vertices(); ++v) c.vertex[v].h = 10;
  c.vertex[0].z = -3;
  c.vertex[1].z = 3;
  EXPECT_FALSE(LocalOperations(c).insert(0, 0.2, 1));
  EXPECT_EQ(c.find_defect(), "");
}

/// Every operation must raise the worst of what it replaces, so the worst of all never falls.
void operate_at_random(TetComplex c, unsigned seed, int steps, int (&done)[4]) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const auto faces = fixtures::constrained_faces(c);
  const double volume = fixtures::total_volume(c);
  std::mt19937 choice(seed + 100);
  for (int i = 0; i < 20; ++i) {
    const auto t = static_cast<TetIndex>(choice() % c.num_slots());
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    const auto& e = kEdgeNodes[choice() % 6];
    c.kept_edges.insert(c.node[4 * t + e[0]], c.node[4 * t + e[1]]);
    for (const int k : {0, 1}) c.on_boundary[c.node[4 * t + e[k]]] = 1;
  }
  const auto vertices = c.vertex;
  std::mt19937 random(seed);
  LocalOperations operations(c);
  for (int step = 0; step < steps; ++step) {
    const auto t = static_cast<TetIndex>(random() % c.num_slots());
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    const VertexIndex v = c.node[4 * t + random() % 4];
    const std::uint32_t kind = random() % 4;
    const double enough = random() % 2 ? 1 : quality_of_angle(30);
    std::vector<TetIndex> near{t};
    if (kind == 1 || kind == 2) c.star(v, near);
    near.erase(std::remove_if(near.begin(), near.end(), [&](TetIndex u) { return c.is_ghost(u); }), near.end());
    const double before = worst_of(c, near);
    const bool changed = kind == 0   ? operations.swap(t, enough) != LocalOperations::Swap::none
                         : kind == 1 ? operations.smooth(v, enough)
                         : kind == 2 ? operations.contract(v)
                                     : operations.insert(t, 0, enough);
    if (!changed) continue;
    ++done[kind];
    ASSERT_EQ(c.find_defect(), "") << "step " << step << " kind " << kind;
    ASSERT_GT(worst_of(c, operations.touched), before) << "step " << step << " kind " << kind;
    ASSERT_NEAR(fixtures::total_volume(c), volume, 1e-11) << "step " << step << " kind " << kind;
  }
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
  std::vector<TetIndex> scratch;
  for (const auto& [a, b] : c.kept_edges.sorted()) EXPECT_NE(c.find_edge(a, b, scratch), kNoIndex) << a << " " << b;
  for (VertexIndex v = 0; v < vertices.size(); ++v)
    if (c.on_boundary[v]) {
      EXPECT_EQ(c.point(v), vertices[v].point());
    }
}

TEST(LocalOperations, random_sequences_keep_the_complex_valid_and_improve_it) {
  int done[4] = {};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    operate_at_random(fixtures::jittered_cube(4, 0.5, seed), seed, 400, done);
    operate_at_random(fixtures::jittered_cube_with_wall(4, 0.5, seed), seed, 400, done);
  }
  operate_at_random(fixtures::sliver_ball(0.4, 20, 4), 4, 600, done);
  for (const int count : done) EXPECT_GT(count, 5);
}

}  // namespace
}  // namespace delfront
