// SPDX-License-Identifier: Apache-2.0
#include "brep/nurbs_basis.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

constexpr std::size_t kBucketsPerSpan = 2, kMostBuckets = 1 << 16;

void check_points(const std::vector<Point>& points, const std::vector<double>& weights) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points[i])) throw InputError(fmt::format("control point {} is not finite", i + 1));
  if (!weights.empty() && weights.size() != points.size())
    throw InputError(
        fmt::format("there are {} weights for {} control points; give one each", weights.size(), points.size()));
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!(weights[i] > 0) || !std::isfinite(weights[i]))
      throw InputError(
          fmt::format("weight {} is {:g}; weights are positive: leave them out for all 1", i + 1, weights[i]));
}

}  // namespace

KnotLine::KnotLine(int degree, std::vector<double> knots)
    : degree_(degree),
      knots_(std::move(knots)),
      first_span_(std::size_t(degree)),
      last_span_(knots_.size() - 2 - std::size_t(degree)) {
  while (knots_[first_span_] == knots_[first_span_ + 1]) ++first_span_;
  while (knots_[last_span_] == knots_[last_span_ + 1]) --last_span_;
  const std::size_t buckets = std::min(kMostBuckets, kBucketsPerSpan * (last_span_ - first_span_ + 1));
  buckets_over_ = double(buckets) / (high() - low());
  auto last = std::uint32_t(first_span_);
  before_.assign(knots_.size(), last);
  for (std::size_t i = first_span_; i <= last_span_; ++i) {
    before_[i] = last;
    if (knots_[i] < knots_[i + 1]) last = std::uint32_t(i);
  }
  const std::size_t terms = std::size_t(degree_) * (std::size_t(degree_) + 1) / 2;  // a span
  over_.assign((last_span_ + 1) * terms, 0.0);
  for (std::size_t span = first_span_; span <= last_span_; ++span) {
    if (!(knots_[span] < knots_[span + 1])) continue;
    double* over = over_.data() + span * terms;
    for (std::size_t j = 1; j <= std::size_t(degree_); ++j)
      for (std::size_t r = 0; r < j; ++r) *over++ = 1 / (knots_[span + r + 1] - knots_[span + r + 1 - j]);
  }
  std::size_t i = first_span_;
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    const double t = low() + double(bucket) / buckets_over_;
    while (i < last_span_ && knots_[i + 1] <= t) ++i;
    first_.push_back(std::uint32_t(i));
  }
}

std::vector<Point4> weighted(const std::vector<Point>& points, const std::vector<double>& weights) {
  std::vector<Point4> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    result.push_back(to_point4(points[i], weights.empty() ? 1 : weights[i]));
  return result;
}

void put_weighted(const std::vector<Point4>& from, std::vector<Point>& points, std::vector<double>& weights) {
  points.clear();
  weights.clear();
  const bool is_rational = std::any_of(from.begin(), from.end(), [](const Point4& p) { return p[3] != 1; });
  for (const Point4& p : from) {
    points.push_back(to_point(p) / p[3]);
    if (is_rational) weights.push_back(p[3]);
  }
}

void check_knots(const std::vector<double>& knots, int degree, std::size_t points, const std::string& what) {
  if (degree < 1 || degree > kMostDegree)
    throw InputError(fmt::format("the degree{} is {}; it can be 1 to {}", what, degree, kMostDegree));
  const auto p = std::size_t(degree);
  if (points < p + 1)
    throw InputError(
        fmt::format("degree {}{} needs {} control points at least, there are {}", degree, what, p + 1, points));
  if (knots.size() != points + p + 1)
    throw InputError(fmt::format("there are {} knots{} where {} control points and degree {} need {}", knots.size(),
                                 what, points, degree, points + p + 1));
  std::size_t same = 1;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i])) throw InputError(fmt::format("knot {}{} is not finite", i + 1, what));
    if (i == 0) continue;
    if (knots[i] < knots[i - 1])
      throw InputError(fmt::format("knot {}{} is {:g}, below the one before ({:g}); knots ascend", i + 1, what,
                                   knots[i], knots[i - 1]));
    same = knots[i] == knots[i - 1] ? same + 1 : 1;
    const bool is_end = knots[i] == knots[p] || knots[i] == knots[points];
    if (same > p + (is_end ? 1 : 0))
      throw InputError(fmt::format("knot {:g}{} is there too often: {} times at most, so that nothing is torn there",
                                   knots[i], what, p + (is_end ? 1 : 0)));
  }
  if (!(knots[p] < knots[points]) || !std::isfinite(knots[points] - knots[p]))
    throw InputError(fmt::format("the knots{} leave no range: knot {} must be below knot {}", what, p + 1, points + 1));
}

void check_nurbs(const NurbsCurveData& data) {
  check_knots(data.knots, data.degree, data.points.size(), "");
  check_points(data.points, data.weights);
}

void check_nurbs(const NurbsSurfaceData& data) {
  check_knots(data.knots[0], data.degree[0], data.count[0], " along u");
  check_knots(data.knots[1], data.degree[1], data.count[1], " along v");
  if (data.points.size() != data.count[0] * data.count[1])
    throw InputError(fmt::format("there are {} control points where {} by {} are said", data.points.size(),
                                 data.count[0], data.count[1]));
  check_points(data.points, data.weights);
}

std::vector<double> even_knots(std::size_t points, int degree) {
  const auto p = std::size_t(std::max(degree, 0));
  std::vector<double> knots(p + 1, 0.0);
  for (std::size_t i = 1; i + p < points; ++i) knots.push_back(double(i) / double(points - p));
  knots.insert(knots.end(), p + 1, 1.0);
  return knots;
}

void solve_banded(std::vector<std::vector<double>>& rows, std::size_t band, std::vector<Point4>& right) {
  const std::size_t n = rows.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t below = i + 1; below < std::min(n, i + band + 1); ++below) {
      const std::size_t lead = i + band - below;  // where column i stands in the row below
      const double factor = rows[below][lead] / rows[i][band];
      if (factor == 0) continue;
      for (std::size_t k = 0; k <= band; ++k) rows[below][lead + k] -= factor * rows[i][band + k];
      right[below] -= factor * right[i];
    }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = 1; k <= band && i + k < n; ++k) right[i] -= rows[i][band + k] * right[i + k];
    right[i] /= rows[i][band];
  }
}

}  // namespace delfront
