// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <random>

#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"
#include "fmt/format.h"
#include "support/errors.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

using fixtures::expect_mentions;
using fixtures::message_of;

constexpr std::uint64_t kSeed = 20261123;

Model cube_model() {
  Context context;
  return build_model({{fixtures::cube_surface(), "cube"}}, context);
}

Model build_sphere(int levels) {
  Context context;
  return build_model({{fixtures::sphere_surface(levels), "sphere"}}, context);
}

std::unique_ptr<SizeField> field_of(const std::string& delta, const Box& domain = {{-1, -1, -1}, {1, 1, 1}}) {
  Context context;
  ExpressionSizes sizes;
  sizes.delta = delta;
  sizes.domain = domain;
  return build_expression_size_field(sizes, context);
}

Point random_point(std::mt19937_64& random, double range) {
  std::uniform_real_distribution<double> place(-range, range);
  return {place(random), place(random), place(random)};
}

TEST(DistanceField, S2_is_the_least_distance_to_any_simplex) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  SimplexSet set;
  for (int i = 0; i < 40; ++i) {
    set.points.push_back(random_point(random, 1));
    const Point p = random_point(random, 1);
    set.segments.push_back({p, p + random_point(random, 0.2)});
    set.triangles.push_back({p, p + random_point(random, 0.3), p + random_point(random, 0.3)});
  }
  const auto field = build_distance_field(set);
  const auto alone = [](const SimplexSet& one) { return build_distance_field(one); };
  std::vector<std::shared_ptr<const DistanceField>> parts;
  for (const auto& p : set.points) parts.push_back(alone({{p}, {}, {}}));
  for (const auto& s : set.segments) parts.push_back(alone({{}, {s}, {}}));
  for (const auto& t : set.triangles) parts.push_back(alone({{}, {}, {t}}));
  std::vector<Point> at;
  for (int i = 0; i < 200; ++i) at.push_back(random_point(random, 2));
  std::vector<double> all(at.size());
  field->distances(at, all);
  for (std::size_t i = 0; i < at.size(); ++i) {
    double best = 1e300, found = 0;
    for (const auto& part : parts) {
      double d = 0;
      part->distances({&at[i], 1}, {&d, 1});
      best = std::min(best, d);
    }
    field->distances({&at[i], 1}, {&found, 1});
    EXPECT_EQ(found, best);
    EXPECT_EQ(all[i], best);
  }
  EXPECT_THROW(build_distance_field({}), UsageError);
}

TEST(DistanceField, S2_last_bits_do_not_depend_on_the_batch) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  SimplexSet set;  // many corners and edges are nearest to a place at once
  for (const double scale : {1.0, 1e-3}) {
    const Model model = build_sphere(3);
    for (const auto& [a, b, c] : model.triangles)
      set.triangles.push_back({scale * model.points[a], scale * model.points[b], scale * model.points[c]});
  }
  const auto field = build_distance_field(set);
  std::vector<Point> at;
  for (int i = 0; i < 500; ++i) at.push_back(random_point(random, i % 2 ? 2 : 2e-3));
  for (int i = 0; i < 500; ++i) at.push_back((1 + 1e-9 * (i % 3)) * set.triangles[std::size_t(i)][0]);
  std::vector<double> all(at.size()), one(at.size());
  field->distances(at, all);
  for (std::size_t i = 0; i < at.size(); ++i) field->distances({&at[i], 1}, {&one[i], 1});
  EXPECT_EQ(all, one);
  std::reverse(at.begin(), at.end());
  std::reverse(one.begin(), one.end());
  field->distances(at, all);
  EXPECT_EQ(all, one);
}

TEST(DistanceField, S2_ranges_over_boxes_hold) {
  std::mt19937_64 random(kSeed);
  const auto field = build_distance_field(named_part(cube_model(), "xmin"));
  std::uniform_real_distribution<double> exponent(-5, 0);
  std::vector<Point> at(100);
  std::vector<double> distance(at.size());
  for (int i = 0; i < 300; ++i) {
    const double side = std::pow(10, exponent(random));
    const Point low = random_point(random, 2);
    const Box box{low, low + Point{side, side, side}};
    for (Point& p : at) p = box.low + 0.5 * (random_point(random, side) + Point{side, side, side});
    field->distances(at, distance);
    const auto range = field->range(box);
    for (std::size_t k = 0; k < at.size(); ++k) {
      EXPECT_NEAR(distance[k],
                  std::hypot(at[k].x, std::max({0.0, -at[k].y, at[k].y - 1}), std::max({0.0, -at[k].z, at[k].z - 1})),
                  1e-14);
      ASSERT_LE(range.low, distance[k]) << "seed " << kSeed;
      ASSERT_GE(range.high, distance[k]) << "seed " << kSeed;
    }
  }
}

TEST(DistanceField, S2_unknown_names_are_told_with_those_known) {
  const std::string error = message_of<UsageError>([] { named_part(cube_model(), "xmim"); });
  expect_mentions(error, {"did you mean 'xmi", "ymax"});
}

TEST(ExpressionSizeField, S2_sizes_and_distances) {
  Context context;
  ExpressionSizes sizes;
  sizes.delta = "h0 + 0.5 * distance(\"xmin\")";
  sizes.names.constants["h0"] = 0.125;
  sizes.names.distances["xmin"] = build_distance_field(named_part(cube_model(), "xmin"));
  sizes.domain = {{-2, -2, -2}, {2, 2, 2}};
  const auto field = build_expression_size_field(sizes, context);
  EXPECT_TRUE(field->is_isotropic());
  EXPECT_EQ(field->size({0.5, 0.5, 0.5}), 0.125 + 0.25);
  EXPECT_EQ(field->size({-1, 0.5, 0.25}), 0.125 + 0.5);
  EXPECT_GE(field->lower_bound({{1, 0, 0}, {2, 1, 1}}), 0.85 * 0.625);
  EXPECT_LE(field->lower_bound({{1, 0, 0}, {2, 1, 1}}), 0.625);
  EXPECT_EQ(field_of("min(0.3, 1 + x^2)")->largest(), 0.3);
}

TEST(ExpressionSizeField, S2_stretchings_become_metrics) {
  Context context;
  ExpressionSizes sizes;
  sizes.delta = "0.1 * (2 + x)";
  sizes.s1 = "100";
  sizes.s2 = "0.5 + y^2";
  sizes.first = {{"cos(pi / 6)", "sin(pi / 6)", "0"}};
  sizes.second = {{"0", "3", "0"}};
  sizes.domain = {{-1, -1, -1}, {1, 1, 1}};
  const auto field = build_expression_size_field(sizes, context);
  EXPECT_FALSE(field->is_isotropic());
  const Point at{0.5, 0.25, -1};
  Metric metric;
  field->metrics({&at, 1}, {&metric, 1});
  const double delta = 0.25, s2 = 0.5625;
  const Point first{std::cos(M_PI / 6), 0.5, 0}, second{-0.5, std::cos(M_PI / 6), 0};
  EXPECT_NEAR(length_in(metric, first), 1 / (delta * 100), 1e-12);
  EXPECT_NEAR(length_in(metric, second), 1 / (delta * s2), 1e-11);
  EXPECT_NEAR(length_in(metric, {0, 0, 1}), 1 / delta, 1e-12);
  EXPECT_NEAR(field->size(at), delta * s2, 1e-15);
  EXPECT_NEAR(least_size(metric), field->size(at), 1e-12);
}

TEST(ExpressionSizeField, S2_lower_bounds_hold_over_random_boxes) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> exponent(-4, 0);
  Context context;
  for (const char* text :
       {"0.01 + 0.1*abs(z)", "0.2 + 0.1 * sin(9 * x) * cos(5 * y)", "max(0.01, 0.1 * hypot(x, y, z)^1.5)",
        "exp(-(x^2 + y^2)) + 0.01", "x > y ? 0.1 : 0.2 + 0.01 * z", "0.1 + mod(x, 0.25) / (2 + y)"}) {
    ExpressionSizes sizes;
    sizes.delta = text;
    if (random() % 2 == 0) sizes.s1 = "0.25 + x^2";
    const auto field = build_expression_size_field(sizes, context);
    std::vector<Point> at(100);
    std::vector<double> size(at.size());
    for (int i = 0; i < 300; ++i) {
      const double side = std::pow(10, exponent(random));
      const Point low = random_point(random, 1);
      const Box box{low, low + Point{side, side, side}};
      for (Point& p : at) p = box.low + 0.5 * (random_point(random, side) + Point{side, side, side});
      field->sizes(at, size);
      const double bound = field->lower_bound(box);
      EXPECT_GT(bound, 0);
      ASSERT_LE(bound, *std::min_element(size.begin(), size.end())) << text;
    }
  }
}

TEST(ExpressionSizeField, S2_bad_values_are_found_before_the_run) {
  for (const char* text : {"x", "x - 0.999", "0.1 - abs(z)", "log(y + 0.9)", "sqrt(x + 0.99) + 0.1", "0", "-1", "0/0",
                           "-1/x", "(x - 0.3)^2 + (y - 0.4)^2 + (z - 0.1)^2 - 1e-4"}) {
    const std::string error = message_of<InputError>([&] { field_of(text); });
    expect_mentions(error, {text, " at (", "use max("});
  }
  for (const char* text : {"1/x + 10", "abs(x) + 1e-9", "1/abs(x)", "inf", "x > 0 ? 1/x : 0.1"}) {
    if (std::string(text) == "1/x + 10")
      expect_mentions(message_of<InputError>([&] { field_of(text); }),
                      {"positive"});  // 1 / x is very negative left of 0
    else
      EXPECT_NO_THROW(field_of(text)) << text;
  }
}

TEST(ExpressionSizeField, S2_bad_values_are_named_at_evaluation) {
  const auto field = field_of("x - 1.3", {});
  const std::string error = message_of<InputError>([&] { field->size({1, 2, 3}); });
  expect_mentions(error, {"'x - 1.3' gives -0.3 at (1, 2, 3)"});
  EXPECT_EQ(field->size({2, 0, 0}), 2 - 1.3);
  EXPECT_EQ(field->lower_bound({{0, 0, 0}, {2, 2, 2}}), DBL_MIN);
  EXPECT_TRUE(std::isinf(field_of("1/abs(x)")->size({0, 0, 0})));
}

TEST(ExpressionSizeField, S2_bad_options_are_refused) {
  Context context;
  ExpressionSizes sizes;
  sizes.delta = "0.1";
  sizes.domain = {{0, 0, 0}, {1, 1, 1}};
  sizes.s2 = "2";
  sizes.first = {{"1", "0", "0"}};
  EXPECT_THROW(build_expression_size_field(sizes, context), UsageError);  // no second
  sizes.second = {{"2", "0", "0"}};
  EXPECT_THROW(build_expression_size_field(sizes, context), InputError);  // along first
  sizes.second = {{"0", "y", "0"}};
  EXPECT_THROW(build_expression_size_field(sizes, context), InputError);  // no length at y = 0
  sizes.second = {{"0", "0", "1"}};
  EXPECT_NO_THROW(build_expression_size_field(sizes, context));
  sizes.s1 = "1 / x";
  EXPECT_THROW(build_expression_size_field(sizes, context), InputError);  // infinite stretching
  sizes.s1 = "1 +";
  const std::string error = message_of<UsageError>([&] { build_expression_size_field(sizes, context); });
  expect_mentions(error, {"s1: expression '1 +', column 4"});
}

TEST(ExpressionSizeField, S2_scales_and_turns_with_the_model) {
  std::mt19937_64 random(kSeed);
  const auto field = field_of("0.1 + 0.2 * hypot(x - 0.3, y, z)");
  for (const double scale : {1e6, 1e-6, 1048576.0}) {
    const auto scaled =
        field_of(fmt::format("{} * (0.1 + 0.2 * hypot(x / {} - 0.3, y / {}, z / {}))", scale, scale, scale, scale),
                 {{-scale, -scale, -scale}, {scale, scale, scale}});
    for (int i = 0; i < 100; ++i) {
      const Point p = random_point(random, 1);
      const double expected = scale * field->size(p), found = scaled->size(scale * p);
      if (scale == 1048576.0)
        EXPECT_EQ(found, expected);
      else
        EXPECT_NEAR(found, expected, 1e-12 * expected);
    }
  }
}

TEST(CallbackSizeField, S2_calls_in_batches_and_holds_the_promise) {
  Context context;
  int calls = 0;
  const auto field = build_callback_size_field(
      [&](std::span<const Point> at, std::span<double> size) {
        ++calls;
        for (std::size_t i = 0; i < at.size(); ++i) size[i] = 0.1 + 0.1 * at[i].x;
      },
      0.05, context);
  const std::vector<Point> at{{0, 0, 0}, {1, 0, 0}, {-0.25, 0, 0}};
  std::vector<double> size(3);
  field->sizes(at, size);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(size, (std::vector<double>{0.1, 0.2, 0.1 + 0.1 * -0.25}));
  EXPECT_EQ(field->lower_bound({{-9, -9, -9}, {9, 9, 9}}), 0.05);
  const std::string error = message_of<InputError>([&] { field->size({-0.75, 2, 3}); });
  expect_mentions(error, {"gives 0.025 at (-0.75, 2, 3)"});
  EXPECT_THROW(build_callback_size_field({}, 0.1, context), UsageError);
  EXPECT_THROW(build_callback_size_field([](auto, auto) {}, 0, context), UsageError);
  const auto idle = build_callback_size_field([](auto, auto) {}, 0.1, context);
  EXPECT_THROW(idle->size({}), InputError);  // wrote nothing
}

}  // namespace
}  // namespace delfront
