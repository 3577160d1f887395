// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "delfront/errors.hpp"
#include "delfront/size_field.hpp"

namespace delfront {
namespace {

constexpr std::uint64_t kSeed = 20240611;

/// The definition, point by point.
double brute_force(const BoundarySizes& b, Point at) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < b.points.size(); ++i) {
    const double s = distance(at, b.points[i]);
    best = std::min(best, std::max(b.size[i], (s * (b.growth - 1) + b.size[i]) / b.growth));
  }
  return std::min(std::max(best, b.hmin), b.hmax);
}

enum class Shape { sphere, box_volume, line, cluster, one_point };

BoundarySizes random_boundary(Shape shape, int n, double growth, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  BoundarySizes b;
  b.growth = growth;
  for (int i = 0; i < n; ++i) {
    Point p{unit(random), unit(random), unit(random)};
    if (shape == Shape::sphere) p = Point{normal(random), normal(random), normal(random)}, p = p / length(p);
    if (shape == Shape::line) p = {p.x, 2 * p.x, -p.x};
    if (shape == Shape::cluster) p = {std::pow(p.x, 9), std::pow(p.y, 9), 0};
    if (shape == Shape::one_point) p = {3, -1, 2};
    b.points.push_back(p);
    b.size.push_back(0.01 * std::pow(30, unit(random)));
  }
  return b;
}

Point random_place(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(-2, 2), exponent(-6, 0);
  const double scale = std::pow(10, exponent(random));
  return scale * Point{place(random), place(random), place(random)};
}

TEST(BoundarySizeField, S1_equals_the_minimum_over_all_points) {
  std::mt19937_64 random(kSeed);
  Context context;
  for (const Shape shape : {Shape::sphere, Shape::box_volume, Shape::line, Shape::cluster, Shape::one_point})
    for (const int n : {1, 2, 7, 8, 9, 33, 500})
      for (const double growth : {1.001, 1.2, 3.0}) {
        const BoundarySizes b = random_boundary(shape, n, growth, random);
        const auto field = build_boundary_size_field(b, context);
        std::vector<Point> at;
        for (int i = 0; i < 30; ++i) at.push_back(random_place(random));
        for (int i = 0; i < 5; ++i) at.push_back(b.points[random() % b.points.size()]);
        at.push_back({1e4, -2e4, 5});
        std::vector<double> size(at.size());
        field->sizes(at, size);
        for (std::size_t i = 0; i < at.size(); ++i) {
          const double expected = brute_force(b, at[i]);
          EXPECT_NEAR(size[i], expected, 1e-12 * expected)
              << "seed " << kSeed << " shape " << int(shape) << " n " << n << " growth " << growth << " place " << i;
        }
      }
}

TEST(BoundarySizeField, S1_graded_sphere_equals_the_minimum_over_all_points) {
  std::mt19937_64 random(kSeed + 1);
  Context context;
  BoundarySizes b = random_boundary(Shape::sphere, 5000, 1.3, random);
  for (std::size_t i = 0; i < b.points.size(); ++i)
    b.size[i] = 0.02 * (1 + 0.25 * b.points[i].x);  // gentle: none undercut
  const auto field = build_boundary_size_field(b, context);
  for (int i = 0; i < 300; ++i) {
    const Point at = random_place(random);
    EXPECT_NEAR(field->size(at), brute_force(b, at), 1e-12) << "seed " << kSeed + 1 << " place " << i;
  }
  EXPECT_NEAR(field->size({0, 0, 0}), brute_force(b, {0, 0, 0}), 1e-12);
}

TEST(BoundarySizeField, S1_offset_coordinates_lose_nothing_but_their_own_rounding) {
  std::mt19937_64 random(kSeed + 2);
  Context context;
  BoundarySizes b = random_boundary(Shape::sphere, 2000, 1.2, random);
  for (Point& p : b.points) p = p + Point{1e6, -1e6, 1e6};
  const auto field = build_boundary_size_field(b, context);
  for (int i = 0; i < 200; ++i) {
    const Point at = random_place(random) + Point{1e6, -1e6, 1e6};
    EXPECT_NEAR(field->size(at), brute_force(b, at), 1e-9) << "seed " << kSeed + 2 << " place " << i;
  }
}

TEST(BoundarySizeField, S1_one_source_follows_the_law_and_the_limits) {
  Context context;
  BoundarySizes b{{{0, 0, 0}}, {0.1}, 1.25, 0, 0.5};
  const auto field = build_boundary_size_field(b, context);
  EXPECT_DOUBLE_EQ(field->size({0, 0, 0}), 0.1);
  EXPECT_DOUBLE_EQ(field->size({0.1, 0, 0}), 0.1);                  // s = delta1: the first ring
  EXPECT_DOUBLE_EQ(field->size({0.1 + 0.125, 0, 0}), 0.125);        // eq. 3.16: one ring further, delta1 * c
  EXPECT_DOUBLE_EQ(field->size({0, 0.225 + 0.15625, 0}), 0.15625);  // and one more
  EXPECT_DOUBLE_EQ(field->size({0, 0, 100}), 0.5);
  b.hmin = 0.2;
  EXPECT_DOUBLE_EQ(build_boundary_size_field(b, context)->size({0, 0, 0}), 0.2);
}

TEST(BoundarySizeField, S1_does_not_depend_on_batches_order_or_threads) {
  std::mt19937_64 random(kSeed + 3);
  Context context;
  const BoundarySizes b = random_boundary(Shape::sphere, 3000, 1.2, random);
  const auto field = build_boundary_size_field(b, context);
  std::vector<Point> at;
  for (int i = 0; i < 2000; ++i) at.push_back(random_place(random));
  std::vector<double> together(at.size()), alone(at.size()), parallel(at.size());
  field->sizes(at, together);
  for (std::size_t i = at.size(); i-- > 0;) alone[i] = field->size(at[i]);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t)
    threads.emplace_back(
        [&, t] { field->sizes(std::span(at).subspan(t * 500, 500), std::span(parallel).subspan(t * 500, 500)); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(together, alone) << "seed " << kSeed + 3;
  EXPECT_EQ(together, parallel) << "seed " << kSeed + 3;
}

TEST(BoundarySizeField, S1_lower_bound_is_never_violated_and_is_tight_for_small_boxes) {
  std::mt19937_64 random(kSeed + 4);
  std::uniform_real_distribution<double> unit(0, 1);
  Context context;
  for (const Shape shape : {Shape::sphere, Shape::box_volume, Shape::line, Shape::cluster}) {
    const BoundarySizes b = random_boundary(shape, 700, 1.2, random);
    const auto field = build_boundary_size_field(b, context);
    for (int i = 0; i < 200; ++i) {
      Box box;
      box.add(random_place(random));
      box.add(random_place(random));
      const double bound = field->lower_bound(box);
      EXPECT_GT(bound, 0);
      for (int j = 0; j < 20; ++j) {
        Point at = box.low;
        for (int k = 0; k < 3; ++k) at[k] += std::floor(5 * unit(random)) / 4 * (box.high[k] - box.low[k]);
        for (int k = 0; k < 3; ++k) at[k] = std::clamp(at[k], box.low[k], box.high[k]);
        EXPECT_LE(bound, field->size(at)) << "seed " << kSeed + 4 << " box " << i;
      }
      Box point;
      point.add(box.low);
      EXPECT_NEAR(field->lower_bound(point), field->size(box.low), 1e-12);
    }
  }
}

TEST(BoundarySizeField, metrics_are_isotropic_by_default) {
  Context context;
  const auto field = build_boundary_size_field({{{0, 0, 0}, {1, 0, 0}}, {0.5, 0.25}, 1.2, 0, 1e300}, context);
  const Point at[2] = {{0, 0, 0}, {1, 0, 0}};
  Metric metric[2];
  field->metrics(at, metric);
  EXPECT_EQ(metric[1], (Metric{16, 0, 0, 16, 0, 16}));
  EXPECT_NEAR(metric[0].xx, std::pow(field->size(at[0]), -2), 1e-12);
}

TEST(BoundarySizeField, refuses_what_makes_no_sense_and_says_where) {
  Context context;
  EXPECT_THROW(build_boundary_size_field({{{0, 0, 0}}, {1}, 1.0, 0, 1}, context), UsageError);
  EXPECT_THROW(build_boundary_size_field({{{0, 0, 0}}, {1}, 1.2, 2, 1}, context), UsageError);
  EXPECT_THROW(build_boundary_size_field({{}, {}, 1.2, 0, 1}, context), InputError);
  EXPECT_THROW(build_boundary_size_field({{{0, 0, 0}}, {}, 1.2, 0, 1}, context), InputError);
  try {
    build_boundary_size_field({{{0, 0, 0}, {7, 0, 0}}, {1, 0}, 1.2, 0, 1}, context);
    FAIL() << "a size of 0 was accepted";
  } catch (const InputError& error) {
    ASSERT_EQ(error.places.size(), 1u);
    EXPECT_EQ(error.places[0].at, (Point{7, 0, 0}));
  }
}

}  // namespace
}  // namespace delfront
