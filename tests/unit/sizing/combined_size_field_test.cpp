// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "delfront/errors.hpp"
#include "unit/sizing/function_field.hpp"

namespace delfront {
namespace {

using fixtures::FunctionField;
using fixtures::step_field;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::shared_ptr<const SizeField> shared(FunctionField field) {
  return std::make_shared<FunctionField>(std::move(field));
}

TEST(CombinedSizeField, is_the_minimum_clamped) {
  const auto left = shared(step_field({{0, 0, 0}, {1, 1, 1}}, 0.1, 5));
  const auto right = shared(step_field({{2, 0, 0}, {3, 1, 1}}, 0.01, 4));
  const auto both = combine_size_fields({left, nullptr, right}, 0.05, 2);
  EXPECT_EQ(both->size({0.5, 0.5, 0.5}), 0.1);
  EXPECT_EQ(both->size({2.5, 0.5, 0.5}), 0.05);
  EXPECT_EQ(both->size({9, 9, 9}), 2);
  EXPECT_EQ(both->largest(), 2);
  EXPECT_EQ(both->lower_bound({{0, 0, 0}, {1, 1, 1}}), 0.1);
  EXPECT_EQ(both->lower_bound({{0, 0, 0}, {2, 1, 1}}), 0.05);
  EXPECT_TRUE(both->is_isotropic());
  Metric metric;
  const Point at{2.5, 0.5, 0.5};
  both->metrics({&at, 1}, {&metric, 1});
  EXPECT_EQ(metric, isotropic_metric(0.05));
}

TEST(CombinedSizeField, refuses_contradictory_limits_and_nothing) {
  const auto one = shared(step_field({{0, 0, 0}, {1, 1, 1}}, 0.1, 5));
  EXPECT_THROW(combine_size_fields({one}, 2, 1), UsageError);
  EXPECT_THROW(combine_size_fields({one}, 0, 0), UsageError);
  EXPECT_THROW(combine_size_fields({nullptr}, 0, 1), UsageError);
}

TEST(LimitGrowth, leaves_fields_alone_that_keep_it) {
  Context context;
  const double slope = 0.16;  // below (1.2 - 1) / 1.2
  const auto size = [=](Point p) { return 0.05 + slope * std::abs(p.x); };
  const auto least = [=](const Box& b) {
    return 0.05 + slope * (b.low.x > 0 ? b.low.x : b.high.x < 0 ? -b.high.x : 0);
  };
  const auto field = shared({size, least});
  EXPECT_EQ(limit_growth(field, {{-1, -1, -1}, {1, 1, 1}}, 1.2, context), field);
  EXPECT_EQ(limit_growth(field, {{-1, -1, -1}, {1, 1, 1}}, kInfinity, context), field);
  EXPECT_THROW(limit_growth(field, {{-1, -1, -1}, {1, 1, 1}}, 1, context), UsageError);
}

/// Sizes at two places differ by no more than growth allows over their distance, but for what a leaf of half a size
/// may hide.
TEST(LimitGrowth, is_never_exceeded_and_never_raises) {
  Context context;
  const Box domain{{-1, -1, -1}, {1, 1, 1}}, inside{{-0.31, -0.2, -0.11}, {0.17, 0.23, 0.05}};
  for (const double growth : {1.1, 1.3, 2.0}) {
    const double k = (growth - 1) / growth;
    const auto field = shared(step_field(inside, 0.03, 1));
    const auto limited = limit_growth(field, domain, growth, context);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> in(-1, 1), near(-0.1, 0.1);
    for (int i = 0; i < 20000; ++i) {
      const Point a{in(random), in(random), in(random)};
      const Point b = a + Point{near(random), near(random), near(random)};
      if (!domain.overlaps({b, b})) continue;
      const double ha = limited->size(a), hb = limited->size(b);
      EXPECT_LE(ha, field->size(a));
      EXPECT_LE(std::abs(ha - hb), k * distance(a, b) * (1 + 1e-12)) << growth;
      EXPECT_LE(limited->lower_bound({{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
                                      {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}}),
                std::min(ha, hb));
      // Not lower than growth from the box asks: a leaf of half a size on its border, and one size of plateau.
      Point nearest = a;
      for (int axis = 0; axis < 3; ++axis) nearest[axis] = std::clamp(a[axis], inside.low[axis], inside.high[axis]);
      EXPECT_GE(ha, std::min(1.0, 0.03 + k * (distance(a, nearest) - 2.5 * 0.03)) * (1 - 1e-12)) << growth;
    }
  }
}

TEST(LimitGrowth, works_in_the_plane) {
  Context context;
  const auto field = shared(step_field({{0.2, 0.2, -1}, {0.4, 0.3, 1}}, 0.01, 1));
  const auto limited = limit_growth(field, {{0, 0, 0}, {1, 1, 0}}, 1.25, context);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> in(0, 1), near(-0.05, 0.05);
  for (int i = 0; i < 20000; ++i) {
    const Point a{in(random), in(random), 0}, b{in(random), a.y + near(random), 0};
    if (b.y < 0 || b.y > 1) continue;
    EXPECT_LE(std::abs(limited->size(a) - limited->size(b)), 0.2 * distance(a, b) * (1 + 1e-12));
  }
}

}  // namespace
}  // namespace delfront
