// SPDX-License-Identifier: Apache-2.0
#include "sizing/size_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

SizeLaw make_law(SizeLaw::Kind kind, double delta0, double r0, double r1, double gamma) {
  SizeLaw law;
  law.kind = kind;
  law.delta0 = delta0;
  law.r0 = r0;
  law.r1 = r1;
  law.gamma = gamma;
  return law;
}

std::vector<SizeLaw> many_laws() {
  std::vector<SizeLaw> laws;
  for (const double r0 : {0.0, 0.3})
    for (const double r1 : {0.05, 0.7, 4.0}) {
      for (const double gamma : {0.3, 0.5, 1.0, 1.5, 1.7, 2.0, 4.0})
        laws.push_back(make_law(SizeLaw::Kind::power, 0.02, r0, r1, gamma));
      for (const double gamma : {0.2, 1.0, 3.0})
        laws.push_back(make_law(SizeLaw::Kind::exponential, 0.02, r0, r1, gamma));
      for (const std::vector<double>& a : std::initializer_list<std::vector<double>>{
               {}, {0, 0}, {1}, {0, 2}, {1, 0.5}, {3, -3, 1}, {0, 0, 1, 0.1}, {12, -6, 2}, {5, -10, 10, -5, 1}}) {
        laws.push_back(make_law(SizeLaw::Kind::polynomial, 0.02, r0, r1, 1));
        laws.back().polynomial = a;
      }
      laws.push_back(make_law(SizeLaw::Kind::step, 0.02, r0, r1, 1));
    }
  return laws;
}

TEST(SizeLaw, S4_gives_the_formulas) {
  const double rho = (2.7 - 0.2) / 0.8;
  EXPECT_NEAR(make_law(SizeLaw::Kind::power, 0.1, 0.2, 0.8, 1.3).size_at(2.7), 0.1 * (1 + std::pow(rho, 1.3)), 1e-13);
  EXPECT_NEAR(make_law(SizeLaw::Kind::power, 0.1, 0.2, 0.8, 1.5).size_at(2.7), 0.1 * (1 + std::pow(rho, 1.5)), 1e-13);
  EXPECT_NEAR(make_law(SizeLaw::Kind::exponential, 0.1, 0.2, 0.8, 0.9).size_at(2.7), 0.1 * std::exp(0.9 * rho), 1e-13);
  SizeLaw polynomial = make_law(SizeLaw::Kind::polynomial, 0.1, 0.2, 0.8, 1);
  polynomial.polynomial = {0.5, 0, 2};
  EXPECT_NEAR(polynomial.size_at(2.7), 0.1 * (1 + 0.5 * rho + 2 * rho * rho * rho), 1e-13);
  const SizeLaw step = make_law(SizeLaw::Kind::step, 0.1, 0.2, 0.8, 1);
  EXPECT_EQ(step.size_at(0.2), 0.1);
  EXPECT_EQ(step.size_at(0.2000001), kInfinity);
  for (const SizeLaw& law : many_laws()) EXPECT_EQ(law.size_at(0), 0.02);
}

TEST(SizeLaw, S4_limited_law_is_the_least_over_all_lines) {
  constexpr int kSteps = 4000;
  constexpr double kStep = 0.001;
  for (const SizeLaw& law : many_laws())
    for (const double slope : {0.01, 0.05, 1.0 / 6, 0.9}) {
      const LimitedLaw limited(law, slope);
      double line = kInfinity, before = 0;
      for (int i = 0; i <= kSteps; ++i) {
        const double r = i * kStep;
        line = std::min(line + slope * kStep, law.size_at(r));
        const double g = limited(r);
        // The law between two steps may be lower than the line by what the law rises within a step at most.
        const double rise = i > 0 ? std::min(slope * kStep, law.size_at(r) - law.size_at(r - kStep)) : 0;
        ASSERT_LE(g, line * (1 + 1e-12)) << "law " << int(law.kind) << " gamma " << law.gamma;
        ASSERT_GE(g, line - rise - 1e-12) << "kind " << int(law.kind) << " gamma " << law.gamma << " r1 " << law.r1
                                          << " r " << r << " slope " << slope;
        ASSERT_GE(g, before * (1 - 1e-14));
        ASSERT_LE(g - before, i > 0 ? slope * kStep + 1e-14 : kInfinity);
        before = g;
      }
    }
}

TEST(SizeLaw, S4_a_step_with_growth_is_a_ramp) {
  const LimitedLaw ramp(make_law(SizeLaw::Kind::step, 0.1, 0.25, 1, 1), 0.5);
  EXPECT_EQ(ramp(0.25), 0.1);
  EXPECT_DOUBLE_EQ(ramp(1.25), 0.6);
}

TEST(SizeLaw, S5_beyond_its_reach_no_size_is_smaller) {
  for (const SizeLaw& law : many_laws())
    for (const double slope : {0.01, 1.0 / 6, kInfinity}) {
      const LimitedLaw limited(law, slope);
      for (double size = 0.005; size < 5; size *= 1.07) {
        const double reach = limited.reach(size);
        if (reach < 0) {
          ASSERT_GE(limited(0), size);
          continue;
        }
        if (std::isinf(reach)) continue;
        for (const double factor : {1.0 + 1e-12, 1.001, 2.0, 1e3})
          ASSERT_TRUE(limited(reach * factor + 1e-300) >= size) << int(law.kind) << " " << law.gamma << " " << size;
        // And it is not much more than needed.
        if (reach > law.r0 * 1.001 && reach > 1e-6) {
          ASSERT_LE(limited(reach * (1 - 1e-3)), size);
        }
      }
      EXPECT_EQ(limited.reach(0.01), -1);
    }
}

TEST(SizeLaw, S4_refuses_what_is_no_law) {
  auto message = [](const SizeLaw& law) -> std::string {
    try {
      check_law(law);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  for (const SizeLaw& law : many_laws()) EXPECT_EQ(message(law), "");
  const auto power = SizeLaw::Kind::power;
  EXPECT_NE(message(make_law(power, 0, 0, 1, 1)).find("delta0 = 0"), std::string::npos);
  EXPECT_NE(message(make_law(power, std::nan(""), 0, 1, 1)).find("delta0"), std::string::npos);
  EXPECT_NE(message(make_law(power, 1, -1, 1, 1)).find("r0 = -1"), std::string::npos);
  EXPECT_NE(message(make_law(power, 1, 0, 0, 1)).find("r1 = 0"), std::string::npos);
  EXPECT_NE(message(make_law(power, 1, 0, kInfinity, 1)).find("r1 = inf"), std::string::npos);
  EXPECT_NE(message(make_law(SizeLaw::Kind::exponential, 1, 0, 1, -2)).find("gamma = -2"), std::string::npos);
  SizeLaw law = make_law(SizeLaw::Kind::polynomial, 1, 0, 1, 1);
  for (const std::vector<double>& a : std::initializer_list<std::vector<double>>{
           {-1}, {1, -0.1}, {3, -3.01, 1}, {12, -9.5, 2}, {-0.5, 1}, {1, std::nan("")}, {0, 0, -1}}) {
    law.polynomial = a;
    EXPECT_NE(message(law).find("coefficients"), std::string::npos) << a[0];
  }
  law.polynomial = {3, -3.01, 1};
  EXPECT_NE(message(law).find("decreases near rho = 1.0"), std::string::npos) << message(law);
}

TEST(SizeLaw, roots_of_products_are_found) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(0.1, 5);
  for (int i = 0; i < 200; ++i) {
    std::vector<double> roots = {unit(random), unit(random), unit(random)}, c = {1};
    std::sort(roots.begin(), roots.end());
    if (roots[1] - roots[0] < 0.01 || roots[2] - roots[1] < 0.01) continue;
    for (const double root : roots) {
      c.insert(c.begin(), 0);
      for (std::size_t k = 0; k + 1 < c.size(); ++k) c[k] -= root * c[k + 1];
    }
    const std::vector<double> found = positive_roots(c);
    ASSERT_EQ(found.size(), 3u) << "seed " << kSeed;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], roots[k], 1e-9);
  }
}

}  // namespace
}  // namespace delfront
