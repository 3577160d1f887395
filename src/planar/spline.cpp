// SPDX-License-Identifier: Apache-2.0
// Cubic splines with continuous curvature over the length of the chords. Unknown are the second derivatives at the
// points: one tridiagonal system, closed to a ring by the formula of Sherman and Morrison.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planar/pieces.hpp"
#include "planar/tri_complex.hpp"

namespace delfront {

namespace {

constexpr std::size_t kStepsASpan = 64;
constexpr double kMostTurn = 10 * std::numbers::pi / 180;  ///< of a piece
constexpr double kMostPiecesASpan = 1000;                  ///< at cusps

class Spline {
 public:
  Spline(std::span<const Point2> through, bool closed) : p_(through.begin(), through.end()) {
    if (closed) p_.push_back(p_.front());
    const std::size_t spans = p_.size() - 1;
    for (std::size_t i = 0; i < spans; ++i) chord_.push_back(std::sqrt(squared_length(p_[i + 1] - p_[i])));
    bend_.assign(p_.size(), {});
    if (closed && spans > 2)
      solve_ring(spans);
    else if (spans > 1)
      solve_open(spans);
  }

  std::size_t num_spans() const { return chord_.size(); }
  double chord(std::size_t i) const { return chord_[i]; }

  struct Place {
    Point2 at, slope, bend;  ///< derivatives over the length of the chord
  };
  /// @param t  from 0 to 1 in span i
  Place at(std::size_t i, double t) const {
    const double l = chord_[i], s = 1 - t;
    const Point2 a = bend_[i], b = bend_[i + 1];
    return {s * p_[i] + t * p_[i + 1] + (l * l / 6) * ((s * s * s - s) * a + (t * t * t - t) * b),
            (1 / l) * (p_[i + 1] - p_[i]) + (l / 6) * ((1 - 3 * s * s) * a + (3 * t * t - 1) * b), s * a + t * b};
  }

 private:
  Point2 jump_at(std::size_t before, std::size_t i) const {
    return 6 * ((1 / chord_[i]) * (p_[i + 1] - p_[i]) - (1 / chord_[before]) * (p_[before + 1] - p_[before]));
  }

  /// No bend at the ends.
  void solve_open(std::size_t spans) {
    std::vector<double> diagonal(spans + 1, 1), above(spans + 1, 0), below(spans + 1, 0);
    for (std::size_t i = 1; i < spans; ++i) {
      below[i] = chord_[i - 1];
      diagonal[i] = 2 * (chord_[i - 1] + chord_[i]);
      above[i] = chord_[i];
      bend_[i] = jump_at(i - 1, i);
    }
    solve(below, diagonal, above, bend_);
  }

  void solve_ring(std::size_t n) {
    std::vector<double> diagonal(n), above(n), below(n);
    std::vector<Point2> x(n), y(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t before = (i + n - 1) % n;
      below[i] = chord_[before];
      diagonal[i] = 2 * (chord_[before] + chord_[i]);
      above[i] = chord_[i];
      x[i] = jump_at(before, i);
    }
    // The corner entries below[0] and above[n - 1] are equal: a matrix of rank one.
    const double corner = below[0], gamma = -diagonal[0];
    diagonal[0] -= gamma;
    diagonal[n - 1] -= corner * corner / gamma;
    y[0].x = gamma;
    y[n - 1].x = corner;
    solve(below, diagonal, above, x);
    solve(below, diagonal, above, y);
    const double f = 1 / (1 + y[0].x + corner / gamma * y[n - 1].x);
    const Point2 share = f * (x[0] + (corner / gamma) * x[n - 1]);
    for (std::size_t i = 0; i < n; ++i) bend_[i] = x[i] - y[i].x * share;
    bend_[n] = bend_[0];
  }

  static void solve(const std::vector<double>& below, std::vector<double> diagonal, const std::vector<double>& above,
                    std::vector<Point2>& right) {
    const std::size_t n = diagonal.size();
    for (std::size_t i = 1; i < n; ++i) {
      const double f = below[i] / diagonal[i - 1];
      diagonal[i] -= f * above[i - 1];
      right[i] = right[i] - f * right[i - 1];
    }
    right[n - 1] = (1 / diagonal[n - 1]) * right[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) right[i] = (1 / diagonal[i]) * (right[i] - above[i] * right[i + 1]);
  }

  std::vector<Point2> p_;
  std::vector<double> chord_;  ///< by span
  std::vector<Point2> bend_;   ///< by point: second derivative
};

}  // namespace

std::size_t number_of_pieces(double wanted, const Context& context) {
  if (!(wanted < static_cast<double>(kMostTriangles)))
    throw LimitError(
        fmt::format("stopped: a line would be divided into {:.1e} pieces, more than the {:.1e} that fit; {}", wanted,
                    static_cast<double>(kMostTriangles), context.limit_advice));
  const auto pieces = static_cast<std::size_t>(std::fmax(1, std::round(wanted)));
  context.check_cells(pieces / 3);  // no triangle has more sides
  return pieces;
}

void check_curve_points(std::span<const Point2> through, bool closed) {
  const std::size_t least = closed ? 3 : 2;
  if (through.size() < least)
    throw InputError(fmt::format("{} curve goes through at least {} points, got {}", closed ? "a closed" : "an open",
                                 least, through.size()));
  for (std::size_t i = 0; i + (closed ? 0 : 1) < through.size(); ++i) {
    const Point2 a = through[i], b = through[(i + 1) % through.size()];
    if (!std::isfinite(a.x) || !std::isfinite(a.y) || !(squared_length(b - a) > 0))
      throw InputError(
          fmt::format("points {} and {} of the curve are the same, or not finite{}", i, (i + 1) % through.size(),
                      closed && i + 1 == through.size() ? "; a closed curve does not repeat its first" : ""),
          {{{a.x, a.y, 0}, {}}});
  }
}

std::vector<Point2> sample_spline(std::span<const Point2> through, bool closed, double h, const Context& context) {
  check_curve_points(through, closed);
  const Spline spline(through, closed);
  // Pieces a unit of t: by size, or where the curve turns by its curvature.
  const auto pieces_at = [&](std::size_t i, double t) {
    const Spline::Place place = spline.at(i, t);
    const double speed = std::sqrt(squared_length(place.slope));
    const double by_size = speed * spline.chord(i) / (h > 0 ? h : spline.chord(i));
    const double turn = std::fabs(cross(place.slope, place.bend)) / (speed * speed) * spline.chord(i);
    return std::min(std::fmax(by_size, turn / kMostTurn), std::fmax(by_size, kMostPiecesASpan));
  };
  std::vector<double> sum(1, 0);
  for (std::size_t i = 0; i < spline.num_spans(); ++i)
    for (std::size_t k = 0; k < kStepsASpan; ++k)
      sum.push_back(sum.back() + pieces_at(i, (static_cast<double>(k) + 0.5) / kStepsASpan) / kStepsASpan);
  const std::size_t pieces = std::max<std::size_t>(number_of_pieces(sum.back(), context), closed ? 3 : 1);
  std::vector<Point2> result(1, through[0]);
  for (std::size_t piece = 1, k = 1; piece < pieces; ++piece) {
    if (piece % kPiecesPerLimitCheck == 0) context.check_limits();
    const double wanted = sum.back() * static_cast<double>(piece) / static_cast<double>(pieces);
    while (sum[k] < wanted) ++k;
    const double t = static_cast<double>(k - 1) + (wanted - sum[k - 1]) / (sum[k] - sum[k - 1]);
    const auto span = std::min(static_cast<std::size_t>(t) / kStepsASpan, spline.num_spans() - 1);
    result.push_back(spline.at(span, t / kStepsASpan - static_cast<double>(span)).at);
  }
  if (!closed) result.push_back(through.back());
  return result;
}

}  // namespace delfront
