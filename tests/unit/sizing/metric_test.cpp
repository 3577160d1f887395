// SPDX-License-Identifier: Apache-2.0
#include "delfront/metric.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

void expect_near(const Metric& a, const Metric& b, double relative) {
  const double unit = std::max({std::abs(b.xx), std::abs(b.yy), std::abs(b.zz)});
  for (const auto member : {&Metric::xx, &Metric::xy, &Metric::xz, &Metric::yy, &Metric::yz, &Metric::zz})
    EXPECT_NEAR(a.*member, b.*member, relative * unit);
}

class RandomMetrics {
 public:
  explicit RandomMetrics(unsigned seed) : random_(seed) {}

  Point direction() {
    std::normal_distribution<double> normal;
    const Point p{normal(random_), normal(random_), normal(random_)};
    return p / length(p);
  }
  /// @param low, high  of the wanted lengths
  Metric metric(double low, double high) {
    std::uniform_real_distribution<double> log_size(std::log(low), std::log(high));
    Point first = direction(), second = cross(first, direction());
    second = second / length(second);
    const double delta = std::exp(log_size(random_));
    return stretched_metric(delta,
                            {std::exp(log_size(random_)) / delta, std::exp(log_size(random_)) / delta, first, second});
  }

 private:
  std::mt19937 random_;
};

TEST(Metric, stretchings_are_lengths_along_their_directions) {
  const double c = std::cos(0.3), s = std::sin(0.3);
  const Stretching stretching{10, 3, {c, s, 0}, {-s, c, 0}};
  const Metric m = stretched_metric(0.01, stretching);
  EXPECT_NEAR(length_in(m, 0.1 * stretching.first), 1, 1e-14);
  EXPECT_NEAR(length_in(m, 0.03 * stretching.second), 1, 1e-14);
  EXPECT_NEAR(length_in(m, {0, 0, 0.01}), 1, 1e-14);
  EXPECT_NEAR(least_size(m), 0.01, 1e-15);
  EXPECT_NEAR(greatest_size(m), 0.1, 1e-13);
}

TEST(Metric, of_one_size_is_exact) {
  EXPECT_EQ(isotropic_metric(0.25), (Metric{16, 0, 0, 16, 0, 16}));
  EXPECT_EQ(least_size(isotropic_metric(0.25)), 0.25);
  EXPECT_EQ(greatest_size(isotropic_metric(0.25)), 0.25);
}

TEST(Metric, refuses_bad_stretchings) {
  EXPECT_THROW(stretched_metric(0, {}), UsageError);
  EXPECT_THROW(stretched_metric(-1, {}), UsageError);
  EXPECT_THROW(stretched_metric(std::nan(""), {}), UsageError);
  EXPECT_THROW(stretched_metric(1, {0, 1}), UsageError);
  EXPECT_THROW(stretched_metric(1, {1, 1, {1, 0, 0}, {1, 0, 0}}), UsageError);
  EXPECT_THROW(stretched_metric(1, {1, 1, {2, 0, 0}, {0, 1, 0}}), UsageError);
}

TEST(Metric, intersection_lies_inside_both_and_touches) {
  RandomMetrics random(7);
  for (int i = 0; i < 2000; ++i) {
    const Metric a = random.metric(1e-3, 1), b = random.metric(1e-3, 1), both = intersection(a, b);
    double slack = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 50; ++k) {
      const Point e = random.direction();
      const double wanted = std::max(length_in(a, e), length_in(b, e));
      EXPECT_GE(length_in(both, e), wanted * (1 - 1e-9)) << "case " << i;
      slack = std::min(slack, length_in(both, e) / wanted);
    }
    EXPECT_LE(slack, std::numbers::sqrt2 * (1 + 1e-9)) << "case " << i;  // M <= A + B
    expect_near(intersection(b, a), both, 1e-9);
  }
}

TEST(Metric, intersection_of_common_axes_takes_the_smaller_of_each) {
  const Metric a{100, 0, 0, 1, 0, 25}, b{4, 0, 0, 9, 0, 400};
  expect_near(intersection(a, b), {100, 0, 0, 9, 0, 400}, 1e-14);
  expect_near(intersection(a, a), a, 1e-14);
}

TEST(Metric, intersection_with_no_opinion_is_the_other) {
  const Metric none{0, 0, 0, 0, 0, 0}, a = stretched_metric(0.1, {5, 2});
  expect_near(intersection(a, none), a, 1e-14);
  expect_near(intersection(none, a), a, 1e-14);
  EXPECT_EQ(intersection(none, none), none);
}

TEST(Metric, scales_by_powers_of_two_exactly_and_by_any_factor_to_rounding) {
  RandomMetrics random(8);
  for (const double factor : {0x1p40, 1e6, 1e-6}) {
    const Metric a = random.metric(1e-2, 1), b = random.metric(1e-2, 1);
    const auto scaled = [&](const Metric& m) {
      const double w = 1 / (factor * factor);
      return Metric{w * m.xx, w * m.xy, w * m.xz, w * m.yy, w * m.yz, w * m.zz};
    };
    if (factor == 0x1p40) {
      EXPECT_EQ(intersection(scaled(a), scaled(b)), scaled(intersection(a, b)));
    }
    expect_near(intersection(scaled(a), scaled(b)), scaled(intersection(a, b)), 1e-10);
    EXPECT_NEAR(least_size(scaled(a)) / (factor * least_size(a)), 1, 1e-12);
  }
}

TEST(Metric, clamps_lengths_along_its_axes) {
  const Metric m = clamped(stretched_metric(0.01, {100, 10}), 0.05, 0.5);
  EXPECT_NEAR(length_in(m, {0.5, 0, 0}), 1, 1e-12);
  EXPECT_NEAR(length_in(m, {0, 0.1, 0}), 1, 1e-12);
  EXPECT_NEAR(length_in(m, {0, 0, 0.05}), 1, 1e-12);
}

TEST(Metric, logarithm_and_exponential_are_inverse) {
  RandomMetrics random(9);
  for (int i = 0; i < 500; ++i) {
    const Metric a = random.metric(1e-3, 10);
    expect_near(exp_of(log_of(a)), a, 1e-10);
  }
}

TEST(Metric, mean_of_logarithms_has_the_geometric_mean_of_volumes) {
  RandomMetrics random(10);
  const auto log_volume = [](const Metric& m) {
    const MetricAxes axes = metric_axes(m);
    return std::log(axes.value[0]) + std::log(axes.value[1]) + std::log(axes.value[2]);
  };
  for (int i = 0; i < 200; ++i) {
    const Metric a = random.metric(1e-2, 10), b = random.metric(1e-2, 10), la = log_of(a), lb = log_of(b);
    const Metric mean = exp_of({(la.xx + lb.xx) / 2, (la.xy + lb.xy) / 2, (la.xz + lb.xz) / 2, (la.yy + lb.yy) / 2,
                                (la.yz + lb.yz) / 2, (la.zz + lb.zz) / 2});
    EXPECT_NEAR(log_volume(mean), (log_volume(a) + log_volume(b)) / 2, 1e-8);
  }
}

}  // namespace
}  // namespace delfront
