// SPDX-License-Identifier: Apache-2.0
#include "sizing/sampled_bounds.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <random>

#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"
#include "sizing/within_domain.hpp"

namespace delfront {
namespace {

std::shared_ptr<const SizeField> field_of(std::function<double(Point)> function, Context& context) {
  return build_callback_size_field(
      [function](std::span<const Point> at, std::span<double> size) {
        for (std::size_t i = 0; i < at.size(); ++i) size[i] = function(at[i]);
      },
      1e-300, context);
}

const Box kDomain{{-1, -2, 0}, {3, 2, 1}};

TEST(SampledBounds, of_functions_hold_in_random_boxes_and_are_near_their_least_value) {
  Context context;
  const std::function<double(Point)> functions[] = {
      [](Point p) { return 0.1 + 0.2 * std::abs(p.x); },
      [](Point p) { return 0.3 + 0.2 * std::sin(3 * p.x) * std::cos(2 * p.y); },
      [](Point p) { return 0.05 + 0.1 * length(p); },
      [](Point p) { return p.x < 0.3 ? 0.1 : 0.5; },
  };
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  for (const auto& function : functions) {
    const bool has_jump = &function == &functions[3];
    const auto field = sample_bounds(field_of(function, context), kDomain, {}, context);
    for (int i = 0; i < 300; ++i) {
      Box box;
      const double width = std::pow(0.5, i % 8);
      for (int k = 0; k < 3; ++k) {
        const double side = kDomain.high[k] - kDomain.low[k];
        box.low[k] = kDomain.low[k] + (1 - width) * side * share(random);
        box.high[k] = box.low[k] + width * side;
      }
      double least = 1e300;
      for (int s = 0; s < 1000; ++s) {
        const Point t{share(random), share(random), share(random)}, side = box.high - box.low;
        least = std::min(least, function(box.low + Point{t.x * side.x, t.y * side.y, t.z * side.z}));
      }
      EXPECT_LE(field->lower_bound(box), least * 1.01);
      EXPECT_GE(field->lower_bound(box), has_jump ? 0.1 * 0.99 : 0.35 * least);  // beside a jump that of its low side
    }
  }
}

TEST(SampledBounds, values_are_the_functions_own_and_infinite_ones_stay) {
  Context context;
  const auto field =
      sample_bounds(field_of([](Point p) { return p.x > 1 ? std::numeric_limits<double>::infinity() : 0.25; }, context),
                    kDomain, {}, context);
  EXPECT_EQ(field->size({0.123, 0, 0}), 0.25);
  EXPECT_TRUE(std::isinf(field->size({2, 0, 0})));
  EXPECT_GT(field->lower_bound({{2, -1, 0}, {3, 1, 1}}), 1e100);
  EXPECT_LE(field->lower_bound({{0, -1, 0}, {3, 1, 1}}), 0.25);
}

TEST(SampledBounds, a_function_is_asked_for_many_places_at_once) {
  Context context;
  std::atomic<std::size_t> calls = 0, places = 0;
  const std::shared_ptr<const SizeField> counted = build_callback_size_field(
      [&](std::span<const Point> at, std::span<double> size) {
        ++calls;
        places += at.size();
        for (std::size_t i = 0; i < at.size(); ++i) size[i] = 0.1 + 0.1 * length(at[i]);
      },
      1e-300, context);
  sample_bounds(counted, kDomain, {}, context);
  EXPECT_LT(calls.load() * 100, places.load());
  EXPECT_LT(places.load(), 3'000'000u);
}

TEST(WithinDomain, beyond_the_box_the_field_answers_as_at_the_nearest_place) {
  Context context;
  const auto field = ask_within(field_of([](Point p) { return 0.1 + 0.05 * (p.x + 1); }, context), kDomain);
  EXPECT_EQ(field->size({-5, 0, 0.5}), 0.1);
  EXPECT_EQ(field->size({7, 9, 9}), field->size({3, 2, 1}));
  EXPECT_EQ(field->size({1, 0, 0.5}), 0.1 + 0.05 * 2);
  std::vector<double> sizes(2, 0.15);
  const std::vector<Point> at = {{-9, 0, 0}, {1, 0, 0}};
  field->lower_sizes(at, sizes);
  EXPECT_EQ(sizes, (std::vector<double>{0.1, 0.15}));
}

}  // namespace
}  // namespace delfront
