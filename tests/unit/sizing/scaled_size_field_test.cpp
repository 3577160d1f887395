// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "delfront/errors.hpp"
#include "sizing/asked_sizes.hpp"
#include "unit/sizing/function_field.hpp"

namespace delfront {
namespace {

using fixtures::FunctionField;

std::shared_ptr<const SizeField> ramp() {
  return std::make_shared<FunctionField>([](Point p) { return 0.1 + 0.2 * std::abs(p.x); },
                                         [](const Box& box) {
                                           const double x = std::max({box.low.x, -box.high.x, 0.0});
                                           return 0.1 + 0.2 * x;
                                         });
}

/// Long along x, as a metric.
class StretchedField final : public SizeField {
 public:
  void sizes(std::span<const Point>, std::span<double> size) const override {
    for (double& h : size) h = 0.5;
  }
  void metrics(std::span<const Point>, std::span<Metric> metric) const override {
    for (Metric& m : metric) m = stretched_metric(0.5, {4, 1, {1, 0, 0}, {0, 1, 0}});
  }
  bool is_isotropic() const override { return false; }
  double lower_bound(const Box&) const override { return 0.5; }
};

TEST(ScaledSizeField, sizes_and_bounds_are_those_of_the_field_times_the_factor) {
  const auto field = ramp();
  for (const double factor : {0.25, 2.0, 3.0}) {
    const auto scaled = scale_sizes(field, factor);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-2, 2);
    for (int i = 0; i < 200; ++i) {
      const Point p{place(random), place(random), place(random)};
      EXPECT_EQ(scaled->size(p), factor * field->size(p));
      const Box box{p, p + Point{0.3, 0.3, 0.3}};
      EXPECT_EQ(scaled->lower_bound(box), factor * field->lower_bound(box));
      for (double given : {0.05, 0.4, std::numeric_limits<double>::infinity()}) {
        const double before = given;
        scaled->lower_sizes({&p, 1}, {&given, 1});
        EXPECT_LE(given, before);
        EXPECT_NEAR(given, std::min(before, factor * field->size(p)), 1e-15);
      }
    }
  }
}

TEST(ScaledSizeField, lengths_of_metrics_are_scaled_in_every_direction) {
  const auto scaled = scale_sizes(std::make_shared<StretchedField>(), 2);
  EXPECT_FALSE(scaled->is_isotropic());
  const Point at{0, 0, 0};
  Metric metric;
  scaled->metrics({&at, 1}, {&metric, 1});
  EXPECT_NEAR(length_in(metric, {4, 0, 0}), 1, 1e-12);
  EXPECT_NEAR(length_in(metric, {0, 1, 0}), 1, 1e-12);
  EXPECT_NEAR(length_in(metric, {0, 0, 1}), 1, 1e-12);
}

TEST(ScaledSizeField, a_factor_that_makes_no_sizes_is_refused) {
  for (const double factor : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_THROW(scale_sizes(ramp(), factor), UsageError);
}

TEST(SteeperGrowth, multiplies_the_slope_up_to_a_half_of_the_distance) {
  const auto slope = [](double growth) { return (growth - 1) / growth; };
  EXPECT_EQ(steeper_growth(1.2, 1), 1.2);
  EXPECT_NEAR(slope(steeper_growth(1.2, 2)), 2 * slope(1.2), 1e-12);
  EXPECT_NEAR(slope(steeper_growth(1.2, 8)), 0.5, 1e-12);
  EXPECT_NEAR(steeper_growth(3, 2), 3, 1e-12);  // steeper than that from the beginning
}

TEST(AddSizeField, stretched_sizes_come_with_their_metric) {
  Mesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}};
  Context context;
  add_size_field(mesh, StretchedField(), context);
  ASSERT_EQ(mesh.fields.size(), 2u);
  EXPECT_EQ(mesh.fields[1].name, "metric");
  EXPECT_EQ(mesh.fields[1].components, 6);
  const std::array<double, 6> expected = {0.25, 4, 4, 0, 0, 0};  // xx yy zz xy yz xz
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(mesh.fields[1].values[i], expected[i % 6], 1e-12) << i;
  Mesh plain;
  plain.points = {{0, 0, 0}};
  add_size_field(plain, *ramp(), context);
  EXPECT_EQ(plain.fields.size(), 1u);
}

}  // namespace
}  // namespace delfront
