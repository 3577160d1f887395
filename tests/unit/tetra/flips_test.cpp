// SPDX-License-Identifier: Apache-2.0
#include "tetra/flips.hpp"

#include <gtest/gtest.h>

#include <random>

#include "support/tet_fixtures.hpp"

namespace delfront {
namespace {

/// Best worst quality over all triangulations of ring i ... k, by plain recursion.
double best_by_force(const TetComplex& c, std::size_t i, std::size_t k) {
  if (k < i + 2) return 1;
  double best = -1;
  const auto p = [&](std::size_t at) { return c.point(static_cast<VertexIndex>(2 + at)); };
  for (std::size_t j = i + 1; j < k; ++j) {
    const double upper = measure_quality(p(i), p(j), p(k), c.point(1));
    const double lower = measure_quality(p(i), p(k), p(j), c.point(0));
    best = std::max(best, std::min({upper, lower, best_by_force(c, i, j), best_by_force(c, j, k)}));
  }
  return best;
}

TEST(Flips, edge_removal_finds_the_best_triangulation_of_the_ring) {
  for (int n = 3; n <= 9; ++n) {
    for (unsigned seed = 0; seed < 8; ++seed) {
      SCOPED_TRACE(testing::Message() << "ring " << n << " seed " << seed);
      TetComplex c = fixtures::tets_around_edge(n, 0.25, seed);
      const auto faces = fixtures::constrained_faces(c);
      const double volume = fixtures::total_volume(c);
      const double expected = best_by_force(c, 0, static_cast<std::size_t>(n - 1));
      Flips flips(c);
      Retriangulation plan;
      std::vector<TetIndex> made;
      const bool found = flips.plan_edge_removal(0, 0, 1, 0, plan);
      ASSERT_EQ(found, expected > 0);
      if (!found) continue;
      EXPECT_NEAR(plan.worst, expected, 1e-9);
      EXPECT_EQ(plan.made.size(), 2 * static_cast<std::size_t>(n - 2));
      EXPECT_FALSE(flips.plan_edge_removal(0, 1, 0, expected * 1.0001, plan));
      ASSERT_TRUE(flips.commit(plan, made));
      EXPECT_EQ(c.find_defect(), "");
      EXPECT_EQ(c.find_edge(0, 1, made), kNoIndex);
      EXPECT_NEAR(fixtures::total_volume(c), volume, 1e-13);
      EXPECT_EQ(fixtures::constrained_faces(c), faces);
    }
  }
}

TEST(Flips, edge_removal_leaves_constrained_hull_and_crowded_edges) {
  Retriangulation plan;
  TetComplex c = fixtures::tets_around_edge(4, 0, 1);
  Flips flips(c);
  ASSERT_TRUE(flips.plan_edge_removal(0, 0, 1, 0, plan));
  EXPECT_FALSE(flips.plan_edge_removal(0, 0, 2, 0, plan));  // on the hull
  c.set_constrained_both(4 * 0 + 2, true);                  // the face (0, 1, 3) inside
  EXPECT_FALSE(flips.plan_edge_removal(0, 0, 1, 0, plan));
  EXPECT_FALSE(flips.plan_face_removal(4 * 0 + 2, 0, plan));
  TetComplex crowded = fixtures::tets_around_edge(static_cast<int>(Flips::kMaxRing) + 1, 0, 1);
  EXPECT_FALSE(Flips(crowded).plan_edge_removal(0, 0, 1, 0, plan));
}

TEST(Flips, face_removal_undoes_edge_removal) {
  for (int n = 3; n <= 6; ++n) {
    TetComplex c = fixtures::tets_around_edge(n, 0.05, 5);
    const double volume = fixtures::total_volume(c);
    double bound = 1;  // what only the whole ring reaches
    for (TetIndex t = 0; t < static_cast<TetIndex>(n); ++t) {
      const std::uint32_t* v = &c.node[4 * t];
      bound = std::min(bound, 0.999 * measure_quality(c.point(v[0]), c.point(v[1]), c.point(v[2]), c.point(v[3])));
    }
    Flips flips(c);
    Retriangulation plan;
    std::vector<TetIndex> made, scratch;
    ASSERT_TRUE(flips.plan_edge_removal(0, 0, 1, 0, plan));
    ASSERT_TRUE(flips.commit(plan, made));
    // The edge comes back by removing any face between the two apices, together with its neighbours.
    bool is_back = false;
    for (const TetIndex t : made) {
      for (unsigned f = 0; f < 4 && !is_back; ++f) {
        const VertexIndex apex = c.node[4 * t + f], other = c.node[c.neigh[4 * t + f]];
        if (apex > 1 || other > 1) continue;
        ASSERT_TRUE(flips.plan_face_removal(4 * t + f, bound, plan)) << n;
        EXPECT_GT(plan.worst, bound);
        ASSERT_TRUE(flips.commit(plan, scratch));
        is_back = true;
      }
      if (is_back) break;
    }
    EXPECT_TRUE(is_back);
    EXPECT_EQ(c.find_defect(), "");
    EXPECT_NE(c.find_edge(0, 1, scratch), kNoIndex);
    EXPECT_NEAR(fixtures::total_volume(c), volume, 1e-13);
  }
}

TEST(Flips, no_plan_makes_a_tet_as_bad_as_the_bound) {
  TetComplex c = fixtures::jittered_cube(4, 0.4, 9);
  Flips flips(c);
  Retriangulation plan;
  std::size_t found = 0;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_ghost(t)) continue;
    if (!flips.plan_best(t, 0.02, 1, plan)) continue;
    ++found;
    double worst = 1;
    for (const auto& n : plan.made)
      worst = std::min(worst, measure_quality(c.point(n[0]), c.point(n[1]), c.point(n[2]), c.point(n[3])));
    EXPECT_NEAR(worst, plan.worst, 1e-9);
    EXPECT_GT(worst, 0.02);
  }
  EXPECT_GT(found, 50u);
}

/// Random exchanges that need not improve anything, the whole complex checked after each.
void flip_at_random(TetComplex c, unsigned seed, int steps) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const auto faces = fixtures::constrained_faces(c);
  const double volume = fixtures::total_volume(c);
  std::mt19937 random(seed);
  Flips flips(c);
  Retriangulation plan;
  std::vector<TetIndex> made;
  int done = 0;
  for (int step = 0; step < steps; ++step) {
    const auto t = static_cast<TetIndex>(random() % c.num_slots());
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    const auto& edge = kEdgeNodes[random() % 6];
    const bool planned = random() % 2
                             ? flips.plan_edge_removal(t, c.node[4 * t + edge[0]], c.node[4 * t + edge[1]], 0, plan)
                             : flips.plan_face_removal(4 * t + random() % 4, 0, plan);
    if (!planned || !flips.commit(plan, made)) continue;
    ++done;
    ASSERT_EQ(c.find_defect(), "") << "step " << step;
    ASSERT_NEAR(fixtures::total_volume(c), volume, 1e-11) << "step " << step;
  }
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
  EXPECT_GT(done, steps / 20);
}

TEST(Flips, random_sequences_keep_the_complex_valid) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    flip_at_random(fixtures::jittered_cube(3, 0.3, seed), seed, 400);
    flip_at_random(fixtures::jittered_cube_with_wall(4, 0.3, seed), seed, 200);
    flip_at_random(fixtures::jittered_cube(2, 0, seed), seed, 100);  // lattice: coplanar everywhere
  }
}

}  // namespace
}  // namespace delfront
