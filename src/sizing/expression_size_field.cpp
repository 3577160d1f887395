// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"
#include "fmt/format.h"
#include "sizing/expression_program.hpp"

namespace delfront {
namespace {

constexpr std::size_t kChunk = 512;
constexpr double kLeast = std::numeric_limits<double>::min();  // the lower bound where none better is proved

/// A formula and the part of ExpressionSizes that it is.
struct Formula {
  Expression expression;
  const char* part;

  const char* what() const { return part == std::string_view("delta") ? "sizes" : "stretchings"; }
};

[[noreturn]] void fail_value(const Formula& formula, Point at, double value) {
  throw ExpressionError(
      formula.part,
      fmt::format("expression {} gives {:.6g} at ({:.6g}, {:.6g}, {:.6g}); {} must be positive: use max(…, the least "
                  "you want){}",
                  quoted(formula.expression.text()), std::isnan(value) ? std::abs(value) : value, at.x, at.y, at.z,
                  formula.what(), std::isnan(value) ? " inside of roots, logarithms and divisors" : ""),
      {{at, {}}});
}

void check_values(const Formula& formula, std::span<const Point> at, std::span<const double> values) {
  bool is_good = true;
  for (const double value : values) is_good &= value > 0;
  if (is_good) return;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!(values[i] > 0)) fail_value(formula, at[i], values[i]);
}

void check_samples(const Formula& formula, std::span<const Point> at) {
  std::vector<double> values(at.size());
  formula.expression.evaluate(at, values);
  check_values(formula, at, values);
}

std::vector<Point> corners_and_centre(const Box& box) {
  std::vector<Point> at{box.low + 0.5 * (box.high - box.low)};
  for (unsigned k = 0; k < 8; ++k)
    at.push_back({k & 1 ? box.high.x : box.low.x, k & 2 ? box.high.y : box.low.y, k & 4 ? box.high.z : box.low.z});
  return at;
}

std::vector<Point> grid_of(const Box& box) {
  constexpr int kSide = 33;
  std::vector<Point> at;
  std::array<int, 3> count;
  for (int axis = 0; axis < 3; ++axis) count[std::size_t(axis)] = box.high[axis] > box.low[axis] ? kSide : 1;
  const auto part = [](int i, int n) { return n > 1 ? double(i) / (n - 1) : 0.0; };
  const Point side = box.high - box.low;
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i)
        at.push_back(box.low +
                     Point{part(i, count[0]) * side.x, part(j, count[1]) * side.y, part(k, count[2]) * side.z});
  return at;
}

/// Cuts the domain wherever intervals do not prove the values positive, and samples what is left.
void look_for_bad_values(const Formula& formula, const Box& domain, Context& context) {
  constexpr std::size_t kMostParts = 2048;
  constexpr int kMostCuts = 48;
  const auto is_proved = [&](const Box& box) {
    const ExpressionBounds bounds = formula.expression.bounds(box);
    return bounds.low > 0 && bounds.low <= bounds.high && !bounds.may_be_no_number;
  };
  std::vector<Box> open{domain};
  for (int cut = 0; cut < kMostCuts && open.size() <= kMostParts; ++cut) {
    context.check_limits();
    std::vector<Box> next;
    for (const Box& box : open) {
      if (is_proved(box)) continue;
      check_samples(formula, corners_and_centre(box));
      const Point side = box.high - box.low;
      const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
      const double middle = box.low[axis] + 0.5 * side[axis];
      if (!(middle > box.low[axis] && middle < box.high[axis])) continue;
      Box lower = box, upper = box;
      lower.high[axis] = upper.low[axis] = middle;
      next.push_back(lower);
      next.push_back(upper);
    }
    open = std::move(next);
    if (open.empty()) return;
  }
  check_samples(formula, grid_of(domain));
}

using Direction = std::array<Expression, 3>;

class ExpressionSizeField final : public SizeField {
 public:
  ExpressionSizeField(const ExpressionSizes& in, Context& context)
      : delta_{compile("size", in.delta, in.names), "delta"} {
    if (in.s1) s1_ = Formula{compile("s1", *in.s1, in.names), "s1"};
    if (in.s2) s2_ = Formula{compile("s2", *in.s2, in.names), "s2"};
    if (s2_ && in.first && !in.second)
      throw UsageError("size expression with s2 and first: say in second along which direction s2 acts");
    if (in.first) first_ = compile("first", *in.first, in.names);
    if (in.second) second_ = compile("second", *in.second, in.names);
    const Point far = Point{1, 1, 1} * std::numeric_limits<double>::max();
    const Box everywhere{-1 * far, far};
    const ExpressionBounds bounds = delta_.expression.bounds(everywhere);
    if (bounds.low <= bounds.high) largest_ = std::max(bounds.high, kLeast);
    if (!in.domain.is_empty()) look_for_bad_values(in.domain, context);
  }

  bool is_isotropic() const override { return !s1_ && !s2_; }
  double largest() const override { return largest_; }

  void sizes(std::span<const Point> at, std::span<double> size) const override {
    DELFRONT_CHECK(at.size() == size.size());
    delta_.expression.evaluate(at, size);
    check_values(delta_, at, size);
    if (is_isotropic()) return;
    std::array<double, kChunk> s1, s2;
    for (std::size_t first = 0; first < at.size(); first += kChunk) {
      const auto part = at.subspan(first, std::min(kChunk, at.size() - first));
      stretchings(part, s1, s2);
      for (std::size_t i = 0; i < part.size(); ++i) size[first + i] *= std::min({1.0, s1[i], s2[i]});
    }
  }

  void metrics(std::span<const Point> at, std::span<Metric> metric) const override {
    DELFRONT_CHECK(at.size() == metric.size());
    if (is_isotropic()) return SizeField::metrics(at, metric);
    std::array<double, kChunk> delta, s1, s2;
    std::array<Point, kChunk> first, second;
    for (std::size_t begin = 0; begin < at.size(); begin += kChunk) {
      const auto part = at.subspan(begin, std::min(kChunk, at.size() - begin));
      delta_.expression.evaluate(part, std::span(delta).first(part.size()));
      check_values(delta_, part, std::span(delta).first(part.size()));
      stretchings(part, s1, s2);
      directions(part, first, second);
      for (std::size_t i = 0; i < part.size(); ++i)
        metric[begin + i] = std::isinf(delta[i]) ? isotropic_metric(delta[i])
                                                 : stretched_metric(delta[i], {s1[i], s2[i], first[i], second[i]});
    }
  }

  double lower_bound(const Box& box) const override {
    const auto least = [&](const Formula& formula) {
      const ExpressionBounds bounds = formula.expression.refined_bounds(box);
      return bounds.low <= bounds.high ? bounds.low : std::numeric_limits<double>::infinity();
    };
    double bound = least(delta_);
    if (!is_isotropic() && bound > 0)
      bound *= std::min({1.0, s1_ ? std::max(0.0, least(*s1_)) : 1.0, s2_ ? std::max(0.0, least(*s2_)) : 1.0});
    return bound > kLeast ? bound : kLeast;
  }

 private:
  static Expression compile(const char* word, const std::string& text, const Expression::Names& names) {
    try {
      return Expression(text, names);
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("{}: {}", word, error.what()));
    }
  }
  static Direction compile(const char* word, const std::array<std::string, 3>& text, const Expression::Names& names) {
    return {compile(word, text[0], names), compile(word, text[1], names), compile(word, text[2], names)};
  }

  void look_for_bad_values(const Box& domain, Context& context) const {
    if (!is_finite(domain.low) || !is_finite(domain.high)) throw UsageError("domain of a size expression not finite");
    delfront::look_for_bad_values(delta_, domain, context);
    if (s1_) delfront::look_for_bad_values(*s1_, domain, context);
    if (s2_) delfront::look_for_bad_values(*s2_, domain, context);
    if (is_isotropic()) return;
    const std::vector<Point> at = grid_of(domain);
    std::vector<Metric> metric(at.size());
    metrics(at, metric);
  }

  void stretchings(std::span<const Point> at, std::array<double, kChunk>& s1, std::array<double, kChunk>& s2) const {
    const auto fill = [&](const std::optional<Formula>& formula, std::array<double, kChunk>& values) {
      if (!formula) return values.fill(1);
      formula->expression.evaluate(at, std::span(values).first(at.size()));
      check_values(*formula, at, std::span(values).first(at.size()));
      for (std::size_t i = 0; i < at.size(); ++i)
        if (std::isinf(values[i])) fail_infinite(*formula, at[i]);
    };
    fill(s1_, s1);
    fill(s2_, s2);
  }

  [[noreturn]] static void fail_infinite(const Formula& formula, Point at) {
    throw ExpressionError(
        formula.part,
        fmt::format("expression {} gives infinity at ({:.6g}, {:.6g}, {:.6g}); stretchings must be finite: "
                    "use min(…, the largest you want)",
                    quoted(formula.expression.text()), at.x, at.y, at.z),
        {{at, {}}});
  }

  static void vectors(const Direction& direction, std::span<const Point> at, std::array<Point, kChunk>& vector) {
    std::array<double, kChunk> value;
    for (int axis = 0; axis < 3; ++axis) {
      direction[std::size_t(axis)].evaluate(at, std::span(value).first(at.size()));
      for (std::size_t i = 0; i < at.size(); ++i) vector[i][axis] = value[i];
    }
  }

  static Point unit(Point v, const char* word, Point at) {
    const double size = length(v);
    if (!(size > 0) || !std::isfinite(size))
      throw ExpressionError(
          word,
          fmt::format("direction '{}' has the length {:.6g} at ({:.6g}, {:.6g}, {:.6g}); it must be "
                      "positive{}",
                      word, size, at.x, at.y, at.z, word[0] == 's' ? ", also of what is not along 'first'" : ""),
          {{at, {}}});
    return v / size;
  }

  /// Unit vectors; second square to first.
  void directions(std::span<const Point> at, std::array<Point, kChunk>& first,
                  std::array<Point, kChunk>& second) const {
    first.fill({1, 0, 0});
    second.fill({0, 1, 0});
    if (first_) vectors(*first_, at, first);
    if (second_) vectors(*second_, at, second);
    for (std::size_t i = 0; i < at.size(); ++i) {
      first[i] = unit(first[i], "first", at[i]);
      if (!second_ && first_) second[i] = any_square_to(first[i]);
      Point rest = unit(second[i], "second", at[i]);
      rest = rest - dot(rest, first[i]) * first[i];
      constexpr double kParallel = 1e-6;
      if (length(rest) < kParallel) rest = {};
      second[i] = unit(rest, "second", at[i]);
      second[i] = unit(second[i] - dot(second[i], first[i]) * first[i], "second", at[i]);
    }
  }

  /// Without s2 the wanted length is the same in all directions square to the first.
  static Point any_square_to(Point first) {
    const bool is_x_least = std::abs(first.x) <= std::abs(first.y) && std::abs(first.x) <= std::abs(first.z);
    return cross(first, is_x_least                               ? Point{1, 0, 0}
                        : std::abs(first.y) <= std::abs(first.z) ? Point{0, 1, 0}
                                                                 : Point{0, 0, 1});
  }

  Formula delta_;
  std::optional<Formula> s1_, s2_;
  std::optional<Direction> first_, second_;
  double largest_ = std::numeric_limits<double>::infinity();
};

class CallbackSizeField final : public SizeField {
 public:
  CallbackSizeField(std::function<void(std::span<const Point>, std::span<double>)> function, double smallest)
      : function_(std::move(function)), smallest_(smallest) {
    if (!function_) throw UsageError("size callback: no function given");
    if (!(smallest_ > 0) || std::isinf(smallest_))
      throw UsageError(fmt::format("size callback: the smallest size it promises must be positive, not {}", smallest_));
  }

  void sizes(std::span<const Point> at, std::span<double> size) const override {
    DELFRONT_CHECK(at.size() == size.size());
    // what the function leaves alone is found out below
    std::fill(size.begin(), size.end(), std::numeric_limits<double>::quiet_NaN());
    function_(at, size);
    for (std::size_t i = 0; i < at.size(); ++i)
      if (!(size[i] >= smallest_))
        throw InputError(fmt::format("size callback gives {:.6g} at ({:.6g}, {:.6g}, {:.6g}); it promised no less than "
                                     "{:.6g}: promise less or bound the function",
                                     size[i], at[i].x, at[i].y, at[i].z, smallest_),
                         {{at[i], {}}});
  }

  double lower_bound(const Box&) const override { return smallest_; }

 private:
  std::function<void(std::span<const Point>, std::span<double>)> function_;
  double smallest_;
};

}  // namespace

std::unique_ptr<SizeField> build_expression_size_field(const ExpressionSizes& sizes, Context& context) {
  return std::make_unique<ExpressionSizeField>(sizes, context);
}

std::unique_ptr<SizeField> build_callback_size_field(
    std::function<void(std::span<const Point>, std::span<double>)> function, double smallest, Context&) {
  return std::make_unique<CallbackSizeField>(std::move(function), smallest);
}

}  // namespace delfront
