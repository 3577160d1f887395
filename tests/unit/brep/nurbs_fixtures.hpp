// SPDX-License-Identifier: Apache-2.0
// Random splines from fixed seeds.
#pragma once
#include <random>

#include "delfront/nurbs.hpp"

namespace delfront::fixtures {

/// @brief Random numbers of a seed, the same on every machine.
class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * double(engine_()) / 4294967295.0; }
  std::size_t up_to(std::size_t most) { return std::min(most, std::size_t((*this)(0, double(most) + 1))); }

 private:
  std::mt19937 engine_;
};

/// @brief Clamped or not, some of them repeated within.
inline std::vector<double> random_knots(Dice& dice, std::size_t points, int degree, bool is_clamped) {
  const auto p = std::size_t(degree);
  std::vector<double> knots = {-1};
  while (knots.size() < points + p + 1) {
    const std::size_t inside = knots.size();
    const bool is_end = inside <= p || inside >= points;
    std::size_t same = 1;
    while (same < knots.size() && knots[knots.size() - same] == knots.back()) ++same;
    const bool is_repeated = is_clamped && is_end ? inside != points : !is_end && same + 1 < p && dice(0, 1) < 0.3;
    knots.push_back(is_repeated ? knots.back() : knots.back() + dice(0.2, 1));
  }
  return knots;
}

inline std::vector<double> random_weights(Dice& dice, std::size_t count) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < count; ++i) weights.push_back(dice(0.3, 3));
  return weights;
}

inline NurbsCurveData random_curve(Dice& dice, int degree, bool is_rational, bool is_clamped) {
  NurbsCurveData data;
  data.degree = degree;
  const std::size_t count = std::size_t(degree) + 1 + dice.up_to(8);
  data.knots = random_knots(dice, count, degree, is_clamped);
  for (std::size_t i = 0; i < count; ++i) data.points.push_back({dice(-1, 1), dice(-1, 1), dice(-1, 1)});
  if (is_rational) data.weights = random_weights(dice, count);
  return data;
}

inline NurbsSurfaceData random_surface(Dice& dice, std::array<int, 2> degree, bool is_rational, bool is_clamped) {
  NurbsSurfaceData data;
  data.degree = degree;
  for (std::size_t k = 0; k < 2; ++k) {
    data.count[k] = std::size_t(degree[k]) + 1 + dice.up_to(5);
    data.knots[k] = random_knots(dice, data.count[k], degree[k], is_clamped);
  }
  for (std::size_t i = 0; i < data.count[0]; ++i)
    for (std::size_t j = 0; j < data.count[1]; ++j)
      data.points.push_back({double(i) + dice(-0.3, 0.3), double(j) + dice(-0.3, 0.3), dice(-1, 1)});
  if (is_rational) data.weights = random_weights(dice, data.points.size());
  return data;
}

}  // namespace delfront::fixtures
