// SPDX-License-Identifier: Apache-2.0
#include "tetra/tet_complex.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "delfront/errors.hpp"
#include "support/tet_fixtures.hpp"

namespace delfront {
namespace {

std::array<VertexIndex, 4> nodes(const TetComplex& c, TetIndex t) {
  return {c.node[4 * t], c.node[4 * t + 1], c.node[4 * t + 2], c.node[4 * t + 3]};
}

TEST(TetComplex, fixtures_are_valid_and_fill_their_shape) {
  const TetComplex cube = fixtures::jittered_cube(4, 0.3, 1);
  EXPECT_EQ(cube.find_defect(), "");
  EXPECT_NEAR(fixtures::total_volume(cube), 1, 1e-12);
  EXPECT_EQ(fixtures::constrained_faces(cube).size(), 6u * 4 * 4 * 2);
  EXPECT_EQ(fixtures::tets_around_edge(5, 0.2, 3).find_defect(), "");
}

TEST(TetComplex, star_holds_exactly_the_tets_with_the_vertex) {
  const TetComplex c = fixtures::jittered_cube(3, 0.2, 2);
  std::vector<TetIndex> star;
  for (VertexIndex v = 0; v < c.num_vertices(); ++v) {
    c.star(v, star);
    const std::set<TetIndex> found(star.begin(), star.end());
    EXPECT_EQ(found.size(), star.size());
    for (TetIndex t = 0; t < c.num_slots(); ++t) EXPECT_EQ(found.count(t) == 1, c.has_vertex(t, v));
  }
  EXPECT_EQ(c.find_defect(), "");
}

TEST(TetComplex, edge_ring_turns_in_positive_order) {
  const TetComplex c = fixtures::jittered_cube(2, 0.2, 3);
  std::vector<TetIndex> ring;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    for (const auto& e : kEdgeNodes) {
      const VertexIndex a = c.node[4 * t + e[0]], b = c.node[4 * t + e[1]];
      c.edge_ring(t, a, b, ring);
      std::size_t expected = 0;
      for (TetIndex u = 0; u < c.num_slots(); ++u) expected += c.has_vertex(u, a) && c.has_vertex(u, b) ? 1 : 0;
      ASSERT_EQ(ring.size(), expected);
      EXPECT_EQ(ring[0], t);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        // the common face of tets i and i + 1 holds a, b and the one vertex that turns (a, b, p_i, p_i+1) positive
        const TetIndex u = ring[i], w = ring[(i + 1) % ring.size()];
        VertexIndex behind = kNoIndex - 1, ahead = kNoIndex - 1;
        for (const VertexIndex v : nodes(c, u)) {
          if (v == a || v == b) continue;
          (c.has_vertex(w, v) ? ahead : behind) = v;
        }
        ASSERT_TRUE(ahead != kNoIndex - 1 && behind != kNoIndex - 1);
        if (a != kGhost && b != kGhost && behind != kGhost && ahead != kGhost) {
          EXPECT_GT(c.orient(a, b, behind, ahead), 0);
        }
      }
    }
  }
}

TEST(TetComplex, finds_edges_and_faces_that_are_there_and_no_others) {
  const TetComplex c = fixtures::jittered_cube(2, 0.1, 4);
  std::vector<TetIndex> scratch;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_ghost(t)) continue;
    for (unsigned f = 0; f < 4; ++f) {
      const auto n = c.face_nodes(4 * t + f);
      const FaceRef ref = c.find_face(n[1], n[0], n[2], scratch);
      EXPECT_TRUE(ref == 4 * t + f || ref == c.neigh[4 * t + f]);
      const TetIndex with = c.find_edge(n[0], n[1], scratch);
      EXPECT_TRUE(c.has_vertex(with, n[0]) && c.has_vertex(with, n[1]));
    }
  }
  const auto last = static_cast<VertexIndex>(c.num_vertices() - 1);
  EXPECT_EQ(c.find_edge(0, last, scratch), kNoIndex);
  EXPECT_EQ(c.find_face(0, 1, last, scratch), kNoIndex);
}

TEST(TetComplex, replace_removes_an_edge_and_puts_it_back) {
  TetComplex c = fixtures::tets_around_edge(3, 0, 1);
  c.on_boundary[0] = 1;
  const auto faces = fixtures::constrained_faces(c);
  const double volume = fixtures::total_volume(c);
  std::vector<TetIndex> ring, made;
  c.edge_ring(c.find_edge(0, 1, ring), 0, 1, made);
  c.replace(made, {{2, 3, 4, 1}, {2, 4, 3, 0}}, ring);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(c.num_live(), 2u + 6u);
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
  EXPECT_NEAR(fixtures::total_volume(c), volume, 1e-14);
  EXPECT_EQ(c.region[ring[0]], 0u);
  EXPECT_TRUE(c.flag[ring[1]] & TetComplex::fresh);
  c.replace(std::vector<TetIndex>(ring), {{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 2}}, ring);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
  EXPECT_NEAR(fixtures::total_volume(c), volume, 1e-14);
}

TEST(TetComplex, replace_takes_ghosts_in_any_place_and_drops_lost_vertices) {
  TetComplex c = fixtures::tets_around_edge(4, 0, 1);
  const VertexIndex v = c.add_vertex({0, 0, 0.1}, 1);
  std::vector<TetIndex> star, made;
  // Split the ring's tets by v on the edge, then join them again.
  const TetIndex first = c.find_edge(0, 1, star);
  c.edge_ring(first, 0, 1, star);
  std::vector<std::array<VertexIndex, 4>> fill;
  const std::vector<TetIndex> ring = star;
  for (const TetIndex t : ring) {
    auto low = nodes(c, t), high = nodes(c, t);
    std::replace(low.begin(), low.end(), VertexIndex{1}, v);
    std::replace(high.begin(), high.end(), VertexIndex{0}, v);
    fill.push_back(low);
    fill.push_back(high);
  }
  c.replace(ring, fill, made);
  EXPECT_EQ(c.find_defect(), "");
  c.star(v, star);
  EXPECT_EQ(star.size(), 8u);
  c.replace(star, {{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 5}, {0, 1, 5, 2}}, made);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(c.vertex_tet[v], kNoIndex);
  // A hull tet's ghost, given with the ghost first.
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || !c.is_ghost(t)) continue;
    const auto n = nodes(c, t);
    c.replace({t}, {{n[3], n[1], n[0], n[2]}}, made);
    break;
  }
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_TRUE(c.is_ghost(made[0]));
  EXPECT_EQ(c.region[made[0]], TetComplex::kOutside);
}

TEST(TetComplex, replace_refuses_a_filling_that_does_not_close) {
  TetComplex c = fixtures::tets_around_edge(3, 0, 1);
  std::vector<TetIndex> ring, made;
  c.edge_ring(c.find_edge(0, 1, ring), 0, 1, made);
  EXPECT_THROW(c.replace(made, {{2, 3, 4, 1}}, ring), InternalError);
}

TEST(TetComplex, find_defect_sees_each_kind_of_damage) {
  const TetComplex good = fixtures::jittered_cube(2, 0, 5);
  TetComplex c = good;
  std::swap(c.node[0], c.node[1]);
  EXPECT_NE(c.find_defect(), "");
  c = good;
  c.set_constrained(0, !c.is_constrained(0));
  EXPECT_NE(c.find_defect(), "");
  c = good;
  c.neigh[0] = c.neigh[1];
  EXPECT_NE(c.find_defect(), "");
  c = good;
  c.flag[0] |= TetComplex::marked;
  EXPECT_NE(c.find_defect(), "");
  c = good;
  c.vertex_tet[0] = c.vertex_tet[c.num_vertices() - 1];
  EXPECT_NE(c.find_defect(), "");
  c = good;
  c.vertex[13].x += 2;
  EXPECT_NE(c.find_defect(), "");
}

}  // namespace
}  // namespace delfront
