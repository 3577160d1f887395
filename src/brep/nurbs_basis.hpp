// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "delfront/nurbs.hpp"

namespace delfront {

/// @brief A control point times its weight, and the weight.
using Point4 = Eigen::Array4d;

inline Point4 to_point4(Point p, double w) { return {w * p.x, w * p.y, w * p.z, w}; }
inline Point to_point(const Point4& p) { return {p[0], p[1], p[2]}; }

/// @brief The basis functions that are not 0 at a place, with derivatives.
struct Basis {
  double value[kMostDegree + 1], first[kMostDegree + 1], second[kMostDegree + 1];
};

/// @brief The knots along one parameter: spans, and basis functions on them.
class KnotLine {
 public:
  KnotLine(int degree, std::vector<double> knots);

  int degree() const { return degree_; }
  const std::vector<double>& knots() const { return knots_; }
  double low() const { return knots_[std::size_t(degree_)]; }
  double high() const { return knots_[knots_.size() - 1 - std::size_t(degree_)]; }

  /// @brief Into the range, where it is a period.
  double wrapped(double t) const {
    if (t >= low() && t <= high()) return t;
    const double period = high() - low(), turned = t - period * std::floor((t - low()) / period);
    return turned < low() ? low() : turned > high() ? high() : turned;  // rounding
  }

  /// @return i with knots[i] <= t < knots[i + 1], that of the end where t is not within the range
  std::size_t span(double t) const {
    const double place = (t - low()) * buckets_over_;
    const double last = double(first_.size() - 1);
    std::size_t i = first_[place > 0 ? std::size_t(place < last ? place : last) : 0];
    while (i < last_span_ && knots_[i + 1] <= t) ++i;
    while (i > first_span_ && knots_[i] > t) i = before_[i];
    return i;
  }

  /// @brief Basis functions span - degree … span; kDegree 0: any, else the degree, known to the compiler.
  template <int kDegree>
  void basis(std::size_t span, double t, int orders, Basis& b) const {
    const int p = kDegree > 0 ? kDegree : degree_;
    constexpr std::size_t kRoom = kDegree > 0 ? std::size_t(kDegree) + 1 : std::size_t(kMostDegree) + 1;
    const double* const u = knots_.data() + span;
    double left[kRoom], right[kRoom], top[kRoom], below[kRoom];
    const double* over = over_.data() + span * std::size_t(p * (p + 1) / 2);
    if (p < 1) __builtin_unreachable();
    b.value[0] = 1;
    for (int j = 1; j <= p; ++j) {  // A2.2
      left[j] = t - u[1 - j];
      right[j] = u[j] - t;
      double saved = 0;
      for (int r = 0; r < j; ++r) {
        const double ratio = b.value[r] * over[r];
        if (j == p) top[r] = ratio;
        if (j == p - 1) below[r] = ratio;
        b.value[r] = saved + right[r + 1] * ratio;
        saved = left[j - r] * ratio;
      }
      b.value[j] = saved;
      if (j < p) over += j;
    }
    if (orders < 1) return;
    differences(top, p, p, b.first);
    if (orders < 2) return;
    double steps[kRoom];
    differences(below, p - 1, p - 1, steps);
    for (int r = 0; r < p; ++r) steps[r] *= over[r];
    differences(steps, p, p, b.second);
  }

 private:
  /// The derivative's values from those of the degree below over their knots' distance (2.7).
  static void differences(const double* ratio, int count, double factor, double* result) {
    if (count == 0) {
      result[0] = 0;
      return;
    }
    result[0] = -factor * ratio[0];
    for (int r = 1; r < count; ++r) result[r] = factor * (ratio[r - 1] - ratio[r]);
    result[count] = factor * ratio[count - 1];
  }

  int degree_;
  std::vector<double> knots_;
  std::size_t first_span_, last_span_;  ///< with a length
  double buckets_over_;
  std::vector<std::uint32_t> first_;   ///< by bucket of t: the span of its beginning
  std::vector<std::uint32_t> before_;  ///< the span with a length before a span
  std::vector<double> over_;  ///< by span, degree j = 1 …, r < j: 1 / (knots[span + r + 1] - knots[span + r + 1 - j])
};

/// @brief Control points of data with their weights.
std::vector<Point4> weighted(const std::vector<Point>& points, const std::vector<double>& weights);

/// @brief Data of weighted control points; weights that are all 1 are left out.
void put_weighted(const std::vector<Point4>& from, std::vector<Point>& points, std::vector<double>& weights);

/// @throws InputError  knots that do not ascend, are too few, too often the same, or have no range between them
void check_knots(const std::vector<double>& knots, int degree, std::size_t points, const std::string& what);

/// @brief Solve a banded system by elimination without exchanges: those of B-splines at good places need none.
/// @param rows  rows[i][k] belongs to column i + k - band; destroyed
/// @param right  columns of the right-hand side, one a row; becomes the solution
void solve_banded(std::vector<std::vector<double>>& rows, std::size_t band, std::vector<Point4>& right);

}  // namespace delfront
