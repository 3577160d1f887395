// SPDX-License-Identifier: Apache-2.0
// Insertion into complexes with constrained faces: those stay where they are, and the complex stays valid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "delaunay/delaunay.hpp"
#include "delaunay/territories.hpp"
#include "support/tet_fixtures.hpp"

namespace delfront {
namespace {

using Insert = DelaunayKernel::Insert;
constexpr DelaunayKernel::Limits kConstrained{.min_distance = 0, .constrained = true};

/// Inserts one point with constraints; a refused one is taken away again.
Insert insert_point(TetComplex& c, DelaunayKernel& kernel, Point p, const DelaunayKernel::Limits& limits) {
  const VertexIndex v = c.add_vertex(p, 1);
  const Insert result = kernel.insert(v, c.vertex_tet[0], limits);
  if (result != Insert::done) c.remove_last_vertex();
  return result;
}

double volume_of_region(const TetComplex& c, std::uint32_t region) {
  double sum = 0;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t) || c.region[t] != region) continue;
    const std::uint32_t* n = &c.node[4 * t];
    const Point a = c.point(n[0]);
    sum += dot(cross(c.point(n[1]) - a, c.point(n[2]) - a), c.point(n[3]) - a) / 6;
  }
  return sum;
}

TEST(ConstrainedInsertion, keeps_hull_and_wall_of_a_cube) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    TetComplex c = fixtures::jittered_cube_with_wall(4, 0.3, seed);
    const auto faces = fixtures::constrained_faces(c);
    DelaunayKernel kernel(c);
    kernel.last_tet = 0;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.01, 0.99);
    int done = 0;
    for (int i = 0; i < 400; ++i) {
      const Insert result = insert_point(c, kernel, {uniform(random), uniform(random), uniform(random)}, kConstrained);
      ASSERT_TRUE(result == Insert::done || result == Insert::not_visible);
      done += result == Insert::done ? 1 : 0;
      if (i % 20 == 0) {
        ASSERT_EQ(c.find_defect(), "") << "after point " << i;
      }
    }
    EXPECT_GT(done, 380);
    EXPECT_EQ(c.find_defect(), "");
    EXPECT_EQ(fixtures::constrained_faces(c), faces);
    EXPECT_NEAR(volume_of_region(c, 0), 0.5, 1e-12);
    EXPECT_NEAR(volume_of_region(c, 1), 0.5, 1e-12);
  }
}

TEST(ConstrainedInsertion, next_to_the_wall_nothing_reaches_across) {
  TetComplex c = fixtures::jittered_cube_with_wall(4, 0, 1);
  const auto faces = fixtures::constrained_faces(c);
  DelaunayKernel kernel(c);
  kernel.last_tet = 0;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.01, 0.99);
  for (int i = 0; i < 200; ++i) {
    const double off = (i % 2 ? 1 : -1) * std::pow(10.0, -1 - 0.05 * i);
    insert_point(c, kernel, {uniform(random), uniform(random), 0.5 + off}, kConstrained);
  }
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    for (unsigned k = 0; k < 4; ++k) {
      const double z = c.point(c.node[4 * t + k]).z;
      EXPECT_TRUE(c.region[t] == 0 ? z <= 0.5 : z >= 0.5);
    }
  }
}

TEST(ConstrainedInsertion, outside_of_the_hull_is_refused) {
  TetComplex c = fixtures::jittered_cube(2, 0.2, 5);
  DelaunayKernel kernel(c);
  kernel.last_tet = 0;
  EXPECT_EQ(insert_point(c, kernel, {1.5, 0.5, 0.5}, kConstrained), Insert::outside);
  EXPECT_EQ(insert_point(c, kernel, {0.5, 0.5, -1e-9}, kConstrained), Insert::outside);
  EXPECT_EQ(c.find_defect(), "");
}

TEST(ConstrainedInsertion, a_point_on_a_constrained_face_is_refused) {
  TetComplex c = fixtures::jittered_cube_with_wall(2, 0, 1);
  const auto faces = fixtures::constrained_faces(c);
  DelaunayKernel kernel(c);
  kernel.last_tet = 0;
  EXPECT_NE(insert_point(c, kernel, {0.3, 0.4, 0.5}, kConstrained), Insert::done);
  EXPECT_NE(insert_point(c, kernel, {0.25, 0.5, 1}, kConstrained), Insert::done);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(fixtures::constrained_faces(c), faces);
}

TEST(ConstrainedInsertion, duplicates_and_near_points) {
  TetComplex c = fixtures::jittered_cube(3, 0.2, 6);
  DelaunayKernel kernel(c);
  kernel.last_tet = 0;
  const std::size_t live = c.num_live();
  for (VertexIndex v = 0; v < 64; ++v) {
    const Point p = c.point(v);
    EXPECT_EQ(insert_point(c, kernel, p, kConstrained), Insert::duplicate);
    EXPECT_EQ(kernel.duplicate_of, v);
  }
  const Point near = c.point(21) + Point{0.01, 0.01, 0.01};
  EXPECT_EQ(insert_point(c, kernel, near, {.min_distance = 0.05, .constrained = true}), Insert::too_close);
  EXPECT_EQ(c.num_live(), live);
  EXPECT_EQ(c.find_defect(), "");
  EXPECT_EQ(insert_point(c, kernel, near, {.min_distance = 0.01, .constrained = true}), Insert::done);
  EXPECT_EQ(c.find_defect(), "");
}

TEST(Insertion, implicit_points_on_segments_are_exact) {
  TetComplex c = fixtures::jittered_cube(2, 0, 1);
  for (TetIndex t = 0; t < c.num_slots(); ++t) c.flag[t] = 0;
  DelaunayKernel kernel(c);
  kernel.last_tet = 0;
  const Point a{0, 0, 0}, b{1, 1, 0};
  for (const double t : {1.0 / 3, 0.1, 0.7, 1e-9, 0.9999999}) {
    const ExactPoint p = ExactPoint::on_segment(a, b, t);
    const VertexIndex v = c.add_vertex(p.approx, 1);
    c.segment_points.emplace(v, p);
    ASSERT_EQ(kernel.insert(v, 0), Insert::done) << "t " << t;
    ASSERT_EQ(c.find_defect(), "") << "t " << t;
  }
  const ExactPoint again = ExactPoint::on_segment(b, a, 0.75);  // the point (0.25, 0.25, 0), written from the other end
  const VertexIndex v = c.add_vertex(again.approx, 1);
  c.segment_points.emplace(v, again);
  EXPECT_EQ(kernel.insert(v, 0), Insert::done);
  const ExactPoint same = ExactPoint::on_segment(a, b, 0.25);
  const VertexIndex w = c.add_vertex(same.approx, 1);
  c.segment_points.emplace(w, same);
  EXPECT_EQ(kernel.insert(w, 0), Insert::duplicate);
  EXPECT_EQ(kernel.duplicate_of, v);
}

/// In the order of a curve that is not the one of the territories: those must be told apart all the same.
TEST(InsertBatch, any_number_of_threads_gives_the_same_complex) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(0.01, 0.99);
  std::vector<Point> points(40000);
  for (Point& p : points) p = {uniform(random), uniform(random), uniform(random)};
  auto filled = [&](int threads) {
    TetComplex c = fixtures::jittered_cube_with_wall(4, 0.3, 1);
    std::vector<VertexIndex> vertices;
    for (const Point& p : points) vertices.push_back(c.add_vertex(p, 1));
    Context context;
    context.threads = threads;
    KernelCounts counts;
    insert_batch(c, vertices, kConstrained, 0, counts, context);
    EXPECT_GT(counts.points, 39000u);
    return c;
  };
  const TetComplex expected = filled(1);
  EXPECT_EQ(expected.find_defect(), "");
  for (const int threads : {2, 3}) {
    const TetComplex found = filled(threads);
    EXPECT_EQ(found.node, expected.node);
    EXPECT_EQ(found.neigh, expected.neigh);
  }
}

}  // namespace
}  // namespace delfront
