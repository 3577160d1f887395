// SPDX-License-Identifier: Apache-2.0
#include "tetra/quality.hpp"

#include <gtest/gtest.h>

#include <random>

namespace delfront {
namespace {

struct Tet {
  Point p, q, r, v;
};

Tet random_tet(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] { return Point{uniform(random), uniform(random), uniform(random)}; };
  return {point(), point(), point(), point()};
}

double volume(const Tet& t) { return dot(cross(t.q - t.p, t.r - t.p), t.v - t.p) / 6; }

/// The definition, from angles: min of sin(small) and weight * sin(large), squared.
double quality_from_angles(const Tet& t) {
  const Point corner[4] = {t.p, t.q, t.r, t.v};
  double least = 1;
  for (unsigned i = 0; i < 4; ++i) {
    for (unsigned j = 0; j < i; ++j) {
      const unsigned k = i != 0 && j != 0 ? 0 : (i != 1 && j != 1 ? 1 : 2);
      const Point axis = corner[j] - corner[i];
      const Point from = corner[k] - corner[i], to = corner[6 - i - j - k] - corner[i];
      const Point u = cross(axis, from), w = cross(axis, to);
      const double angle = std::acos(dot(u, w) / (length(u) * length(w)));
      least = std::min(least, (angle > std::numbers::pi / 2 ? kObtuseWeight : 1) * std::sin(angle));
    }
  }
  return least * least;
}

TEST(Quality, is_the_biased_minimum_sine_squared_with_the_volume_s_sign) {
  std::mt19937 random(11);
  for (int i = 0; i < 2000; ++i) {
    const Tet t = random_tet(random);
    const double quality = measure_quality(t.p, t.q, t.r, t.v);
    EXPECT_EQ(quality > 0, volume(t) > 0) << i;
    EXPECT_NEAR(std::abs(quality), quality_from_angles(t), 1e-7) << i;
    EXPECT_NEAR(quality, -measure_quality(t.q, t.p, t.r, t.v), 1e-9) << i;
  }
}

TEST(Quality, of_known_tets) {
  const Point a{1, 1, 1}, b{1, -1, -1}, c{-1, 1, -1}, d{-1, -1, 1};
  EXPECT_NEAR(std::abs(measure_quality(a, b, c, d)), 8.0 / 9, 1e-14);  // all angles have the cosine 1/3
  EXPECT_NEAR(measure_dihedrals(a, b, c, d).least, std::acos(1.0 / 3), 1e-14);
  EXPECT_NEAR(measure_dihedrals(a, b, c, d).greatest, std::acos(1.0 / 3), 1e-14);
  EXPECT_EQ(measure_quality({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}), 0);
  EXPECT_EQ(measure_quality({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}), 0);
  EXPECT_NEAR(quality_of_angle(30), 0.25, 1e-15);
}

TEST(Quality, does_not_depend_on_scale) {
  std::mt19937 random(12);
  for (const double scale : {1e-6, 1e6}) {
    const Tet t = random_tet(random);
    EXPECT_NEAR(measure_quality(t.p, t.q, t.r, t.v),
                measure_quality(scale * t.p, scale * t.q, scale * t.r, scale * t.v), 1e-12);
  }
}

TEST(Quality, batch_equals_single_tets_bit_for_bit) {
  std::mt19937 random(13);
  FaceBatch batch;
  std::vector<double> quality;
  for (std::size_t n = 1; n < 11; ++n) {
    batch.clear();
    std::vector<Tet> tets;
    for (std::size_t i = 0; i < n; ++i) {
      tets.push_back(random_tet(random));
      batch.add(tets[i].p, tets[i].q, tets[i].r);
    }
    const Point apex = tets[0].v;
    batch.measure(apex, quality);
    double worst = 1;
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ(quality[i], measure_quality(tets[i].p, tets[i].q, tets[i].r, apex));
      EXPECT_EQ(batch.corner(i, 1), tets[i].q);
      worst = std::min(worst, quality[i]);
    }
    EXPECT_EQ(batch.worst(apex), worst);
    EXPECT_LE(batch.worst(apex, 0.5), std::max(worst, 0.5));
  }
}

TEST(Quality, gradient_agrees_with_differences) {
  std::mt19937 random(14);
  for (int i = 0; i < 300; ++i) {
    Tet t = random_tet(random);
    if (volume(t) < 0) std::swap(t.p, t.q);
    if (measure_quality(t.p, t.q, t.r, t.v) < 1e-3) continue;
    const Point gradient = measure_quality_gradient(t.p, t.q, t.r, t.v);
    constexpr double kStep = 1e-6;
    Point central, forward;
    const double here = measure_quality(t.p, t.q, t.r, t.v);
    for (int k = 0; k < 3; ++k) {
      Point plus = t.v, minus = t.v;
      plus[k] += kStep;
      minus[k] -= kStep;
      const double above = measure_quality(t.p, t.q, t.r, plus), below = measure_quality(t.p, t.q, t.r, minus);
      central[k] = (above - below) / (2 * kStep);
      forward[k] = (above - here) / kStep;
    }
    if (length(central - forward) > 1e-3 * length(central)) continue;  // the smallest angle changes place here
    EXPECT_LT(length(gradient - central), 1e-3 * length(central)) << i;
  }
}

}  // namespace
}  // namespace delfront
