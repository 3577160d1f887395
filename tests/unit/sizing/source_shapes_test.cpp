// SPDX-License-Identifier: Apache-2.0
#include "sizing/source_shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "delfront/errors.hpp"
#include "delfront/size_sources.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

constexpr std::uint64_t kSeed = 20261123;

struct Random {
  std::mt19937_64 engine{kSeed};
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  Point point(double size) {
    const double x = between(-size, size), y = between(-size, size);
    return {x, y, between(-size, size)};
  }
};

Simplex triangle(Point a, Point b, Point c) { return {{a, b, c}, 3}; }

/// Independent of the code under test: minimise over the triangle by nested golden sections in long double.
long double reference(const Simplex& s, Point p) {
  auto squared = [&](long double u, long double v) {
    long double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const long double a = s.corner[0][k], b = s.corner[1][k], c = s.corner[2][k];
      const long double d = a + u * (b - a) + v * (1 - u) * (c - a) - p[k];
      sum += d * d;
    }
    return sum;
  };
  auto golden = [](auto f) {
    long double low = 0, high = 1;
    const long double ratio = 0.61803398874989484820L;
    for (int i = 0; i < 60; ++i) {
      const long double x = high - ratio * (high - low), y = low + ratio * (high - low);
      (f(x) < f(y) ? high : low) = f(x) < f(y) ? y : x;
    }
    return std::min({f(low), f((low + high) / 2), f(high), f(0.0L), f(1.0L)});
  };
  return std::sqrt(golden([&](long double u) { return golden([&](long double v) { return squared(u, v); }); }));
}

TEST(SourceShapes, S4_distance_to_a_triangle_is_that_of_the_nearest_place) {
  Random random;
  for (int i = 0; i < 150; ++i) {
    const Simplex s = triangle(random.point(1), random.point(1), random.point(1));
    const Point p = random.point(i % 2 ? 1 : 5);
    EXPECT_NEAR(distance_to(s, p), static_cast<double>(reference(s, p)), 1e-8) << "seed " << kSeed << " case " << i;
  }
}

TEST(SourceShapes, S4_distances_of_known_places) {
  const Simplex t = triangle({0, 0, 0}, {4, 0, 0}, {0, 3, 0});
  EXPECT_EQ(distance_to(t, {1, 1, 0}), 0);
  EXPECT_DOUBLE_EQ(distance_to(t, {1, 1, -2}), 2);
  EXPECT_DOUBLE_EQ(distance_to(t, {2, -3, 4}), 5);
  EXPECT_DOUBLE_EQ(distance_to(t, {-3, -4, 12}), 13);
  EXPECT_NEAR(distance_to(t, {4, 3, 0}), 2.4, 1e-15);
  EXPECT_DOUBLE_EQ(distance_to(Simplex{{Point{1, 0, 0}, Point{3, 0, 0}}, 2}, {2, 3, 4}), 5);
  EXPECT_DOUBLE_EQ(distance_to(Simplex{{Point{1, 0, 0}}, 1}, {1, 3, 4}), 5);
  // An obtuse triangle: the place is beyond one edge, but nearest to another.
  const Simplex obtuse = triangle({0, 0, 0}, {10, 0, 0}, {-8, 1, 0});
  EXPECT_NEAR(distance_to(obtuse, {-6, 0.5, 0}), static_cast<double>(reference(obtuse, {-6, 0.5, 0})), 1e-9);
}

TEST(SourceShapes, S4_degenerate_triangles_are_lines_and_points) {
  Random random;
  for (int i = 0; i < 300; ++i) {
    const Point a = random.point(1), b = random.point(1), p = random.point(3);
    const double line = distance_to(Simplex{{a, b}, 2}, p);
    EXPECT_DOUBLE_EQ(distance_to(triangle(a, b, a), p), line);
    EXPECT_DOUBLE_EQ(distance_to(triangle(a, a, b), p), line);
    EXPECT_NEAR(distance_to(triangle(a, b, 0.5 * (a + b)), p), line, 1e-14);
    EXPECT_DOUBLE_EQ(distance_to(triangle(a, a, a), p), distance(a, p));
    EXPECT_DOUBLE_EQ(distance_to(Simplex{{a, a}, 2}, p), distance(a, p));
    // Needles: between the line and the line less the height of the triangle.
    for (double height = 1e-3; height > 1e-16; height /= 10) {
      const double needle = distance_to(triangle(a, b, 0.3 * a + 0.7 * b + Point{0, 0, height}), p);
      EXPECT_LE(needle, line * (1 + 1e-14));
      EXPECT_GE(needle, line - height - 1e-14);
    }
  }
}

TEST(SourceShapes, S4_scale_does_not_matter) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const Point a = random.point(1), b = random.point(1), c = random.point(1), p = random.point(2);
    for (int n = 1; n <= 3; ++n) {
      const double unit = distance_to(Simplex{{a, b, c}, n}, p);
      for (const double scale : {1e-6, 1e6, 1e-100, 1e100})
        EXPECT_NEAR(distance_to(Simplex{{scale * a, scale * b, scale * c}, n}, scale * p) / scale, unit, 1e-12);
      for (const double scale : {0x1p-20, 0x1p20, 0x1p-300, 0x1p300})
        EXPECT_EQ(distance_to(Simplex{{scale * a, scale * b, scale * c}, n}, scale * p) / scale, unit);
    }
  }
}

TEST(SourceShapes, S3_boxes_balls_cylinders_and_cones) {
  const AlignedBox box{{{0, 0, 0}, {1, 2, 3}}};
  EXPECT_EQ(distance_to(box, {0.5, 1, 1.5}), 0);
  EXPECT_EQ(distance_to(box, {0.5, -2, 1}), 2);
  EXPECT_DOUBLE_EQ(distance_to(box, {4, 6, 15}), 13);
  const SolidSphere ball{{1, 1, 1}, 0.5};
  EXPECT_EQ(distance_to(ball, {1, 1.4, 1}), 0);
  EXPECT_DOUBLE_EQ(distance_to(ball, {1, 3, 1}), 1.5);
  const Frustum cylinder{{0, 0, 0}, {0, 0, 2}, 1, 1};
  EXPECT_EQ(distance_to(cylinder, {0.6, 0.6, 1}), 0);
  EXPECT_DOUBLE_EQ(distance_to(cylinder, {3, 0, 1}), 2);
  EXPECT_DOUBLE_EQ(distance_to(cylinder, {0.5, 0, 5}), 3);
  EXPECT_DOUBLE_EQ(distance_to(cylinder, {4, 0, -4}), 5);
  const Frustum cone{{0, 0, 0}, {4, 0, 0}, 3, 0};  // its mantle: 3-4-5
  EXPECT_EQ(distance_to(cone, {1, 2.2, 0}), 0);
  EXPECT_NEAR(distance_to(cone, {2 + 3, 1.5 + 4, 0}), 5, 1e-14);
  EXPECT_DOUBLE_EQ(distance_to(cone, {7, 0, 0}), 3);
  EXPECT_DOUBLE_EQ(distance_to(cone, {-2, 1, 1}), 2);
}

TEST(SourceShapes, S3_frustum_equals_a_fine_search_of_its_section) {
  Random random;
  for (int i = 0; i < 60; ++i) {
    const double a = random.between(0, 2), b = random.between(0, 2), c = random.between(0.1, 3);
    const Point at = random.point(4);
    const double rho = std::hypot(at.x, at.y);
    double best = 1e300;
    for (int j = 0; j <= 2000; ++j) {
      const double z = c * j / 2000, radius = a + (b - a) * j / 2000;
      best = std::min(best, std::hypot(std::max(0.0, rho - radius), at.z - z));
    }
    EXPECT_NEAR(distance_to(Frustum{{0, 0, 0}, {0, 0, c}, a, b}, at), best, 2e-3) << "seed " << kSeed << " case " << i;
  }
}

std::vector<std::array<Point, 3>> triangles_of(const Mesh& mesh) {
  std::vector<std::array<Point, 3>> result;
  const CellBlock& block = *mesh.find_block(CellType::triangle);
  for (std::size_t c = 0; c < block.size(); ++c)
    result.push_back({mesh.points[block[c][0]], mesh.points[block[c][1]], mesh.points[block[c][2]]});
  return result;
}

TEST(SourceShapes, S3_a_region_of_facets_equals_the_box_it_describes) {
  Random random;
  const FacetShape cube{build_facet_surface(triangles_of(fixtures::cube_surface()), true)};
  const FacetShape shell{build_facet_surface(triangles_of(fixtures::cube_surface()), false)};
  const AlignedBox box{{{0, 0, 0}, {1, 1, 1}}};
  for (int i = 0; i < 4000; ++i) {
    Point p = random.point(2);
    // Places in line with edges, corners and the diagonals of the sides too.
    if (i % 2) p = {std::round(4 * p.x) / 4, std::round(4 * p.y) / 4, std::round(4 * p.z) / 4};
    if (i % 5 == 0) p.y = p.x;
    EXPECT_NEAR(distance_to(cube, p), distance_to(box, p), 1e-15) << p.x << " " << p.y << " " << p.z;
    const double inside = std::min({p.x, 1 - p.x, p.y, 1 - p.y, p.z, 1 - p.z});
    if (inside > 0) {
      EXPECT_NEAR(distance_to(shell, p), inside, 1e-15);
    }
  }
}

TEST(SourceShapes, S3_inside_of_a_sphere_of_facets) {
  Random random;
  const FacetShape sphere{build_facet_surface(triangles_of(fixtures::sphere_surface(3)), true)};
  for (int i = 0; i < 3000; ++i) {
    const Point p = random.point(1.3);
    const double away = distance_to(sphere, p);
    if (length(p) < 0.985) {
      EXPECT_EQ(away, 0);
    }
    if (length(p) > 1) {
      EXPECT_NEAR(away, length(p) - 1, 0.015);
      EXPECT_GT(away, 0);
    }
  }
}

TEST(SourceShapes, S3_a_region_must_be_closed) {
  auto triangles = triangles_of(fixtures::cube_surface());
  triangles.pop_back();
  EXPECT_NO_THROW(build_facet_surface(triangles, false));
  try {
    build_facet_surface(triangles, true);
    FAIL() << "an open surface was taken for a region";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("must be closed"), std::string::npos);
    EXPECT_EQ(error.places.size(), 1u);
  }
  EXPECT_THROW(build_facet_surface({}, false), InputError);
}

TEST(SourceShapes, S4_a_moved_shape_is_as_far_from_moved_places) {
  Random random;
  const Motion motion{{0.3, -1, 2}, {1, 2, 3}, {1, -1, 0.5}, 77};
  const FacetShape cube{build_facet_surface(triangles_of(fixtures::cube_surface()), true)};
  const std::vector<SourceShape> shapes = {triangle({0, 0, 0}, {1, 0.2, 0}, {0, 1, 0.4}),
                                           AlignedBox{{{0, 0, 0}, {1, 2, 3}}}, SolidSphere{{1, 1, 1}, 0.5},
                                           Frustum{{0, 0, 0}, {1, 2, 3}, 0.5, 0.2}, cube};
  for (const SourceShape& shape : shapes)
    for (int i = 0; i < 200; ++i) {
      const Point p = random.point(3);
      const PlacedShape moved(shape, motion, 1.7);
      EXPECT_NEAR(moved.distance(motion.at(1.7, p)), distance_to(shape, p), 1e-13);
      const Point q = random.point(6);
      double to_box = 0;
      for (int k = 0; k < 3; ++k)
        to_box = std::hypot(to_box, std::max({moved.box().low[k] - q[k], 0.0, q[k] - moved.box().high[k]}));
      EXPECT_LE(to_box, moved.distance(q) + 1e-13);
    }
}

TEST(SourceShapes, S4_motion_turns_right_handed_and_exactly_by_right_angles) {
  const Motion motion{{1, 0, 0}, {0, 0, 0}, {0, 0, 2}, 90};
  EXPECT_EQ(motion.at(1, {1, 0, 0}), (Point{1, 1, 0}));
  EXPECT_EQ(motion.at(2, {1, 0, 0}), (Point{1, 0, 0}));
  EXPECT_EQ(motion.at(0, {1, 2, 3}), (Point{1, 2, 3}));
}

TEST(SourceShapes, S4_refuses_what_is_no_shape) {
  const double nan = std::nan("");
  EXPECT_THROW(check_shape(Simplex{{}, 4}), UsageError);
  EXPECT_THROW(check_shape(Simplex{{}, 0}), UsageError);
  EXPECT_THROW(check_shape(Simplex{{Point{nan, 0, 0}}, 1}), UsageError);
  EXPECT_THROW(check_shape(AlignedBox{{{0, 0, 0}, {1, -1, 1}}}), UsageError);
  EXPECT_THROW(check_shape(SolidSphere{{0, 0, 0}, -1}), UsageError);
  EXPECT_THROW(check_shape(Frustum{{1, 0, 0}, {1, 0, 0}, 1, 1}), UsageError);
  EXPECT_THROW(check_shape(FacetShape{}), UsageError);
  EXPECT_NO_THROW(check_shape(AlignedBox{{{0, 0, 0}, {0, 1, 1}}}));
}

}  // namespace
}  // namespace delfront
