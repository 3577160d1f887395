// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/errors.hpp"
#include "delfront/model.hpp"
#include "delfront/point.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief Exact distance (to rounding) from a set of points, segments and triangles: what distance("name") asks.
class DistanceField {
 public:
  virtual ~DistanceField() = default;
  /// @brief Distance from each point to the nearest of the set, model units.
  virtual void distances(std::span<const Point> at, std::span<double> distance) const = 0;
  struct Range {
    double low = 0, high = 0;
  };
  /// @brief No distance from a place in the box is below low or above high.
  virtual Range range(const Box& box) const = 0;
};

/// @brief Simplices of one, two or three corners; degenerate ones are legal.
struct SimplexSet {
  std::vector<Point> points;
  std::vector<std::array<Point, 2>> segments;
  std::vector<std::array<Point, 3>> triangles;
};

/// @throws UsageError  an empty set, a coordinate that is not finite
/// @par Cost  O(n log n) to build; a search in a tree a point, tens of microseconds with 1e5 triangles
std::shared_ptr<const DistanceField> build_distance_field(const SimplexSet& set);

/// @brief The set of a model that has a name: a patch, a curve, a corner, or (the only region) all triangles.
/// @throws UsageError  no such name; says which there are
SimplexSet named_part(const Model& model, const std::string& name);

/// @brief Bounds of what an expression gives over a box.
struct ExpressionBounds {
  double low = 0, high = 0;       ///< every value that is a number lies within; low > high: none is a number
  bool may_be_no_number = false;  ///< some value may be NaN
};

/// @brief A formula in x, y, z, compiled once, evaluated for many points at a time.
///
/// Numbers; x y z; pi e inf; constants of the caller; + - * / ^ (from the right; -x^2 is -(x^2)); < <= > >= == !=;
/// && || !; c ? a : b or if(c, a, b); abs sqrt cbrt exp log log10 sin cos tan asin acos atan atan2 sinh cosh tanh min
/// max (any number) pow hypot floor ceil step clamp mod sign; distance("name"). True is 1, false 0, and what is not 0
/// is true. An argument that is no number makes the result none, also in min and max; only what && || and the choice
/// do not need may be none. A divisor of -0 counts as 0: 1 / 0 is infinite.
class Expression {
 public:
  struct Names {
    std::map<std::string, double> constants;
    std::map<std::string, std::shared_ptr<const DistanceField>> distances;
  };

  /// @throws UsageError  column (from 1), the word there, what was expected, the name that was probably meant
  explicit Expression(std::string_view text, const Names& names = {});

  const std::string& text() const { return text_; }
  /// @brief Whether it holds neither x, y, z nor a distance.
  bool is_constant() const;

  /// @brief The value at each point, the same bits in whatever batches they come; may be negative, infinite or NaN.
  /// @par Cost  sums and products about 1 ns an operation and point, exp and the like 5 to 20 ns
  void evaluate(std::span<const Point> at, std::span<double> value) const;
  double operator()(Point at) const;

  /// @brief Bounds by interval arithmetic: guaranteed for the values as evaluate() rounds them; not always tight.
  ExpressionBounds bounds(const Box& box) const;
  /// @brief As bounds(), tightened by cutting the box where its lower bound is least, at most max_boxes evaluations;
  /// ends early where the lower bound is within 5 % of a value.
  ExpressionBounds refined_bounds(const Box& box, int max_boxes = 64) const;

 private:
  struct Program;
  std::string text_;
  std::shared_ptr<const Program> program_;
};

/// @brief The names that distance() is asked for in a text, each once: to be built before the expression is.
/// @throws UsageError  as Expression, but for unknown names in distance()
std::vector<std::string> distances_in(std::string_view text, const std::map<std::string, double>& constants = {});

/// @brief A bad value of one of the formulas of ExpressionSizes.
struct ExpressionError : InputError {
  ExpressionError(const std::string& part_at_fault, const std::string& message, std::vector<Place> where)
      : InputError(message, std::move(where)), part(part_at_fault) {}
  std::string part;  ///< "delta", "s1", "s2", "first", "second"
};

/// @brief Sizes by formulas (S2).
struct ExpressionSizes {
  std::string delta;                                 ///< size, > 0; infinite where the formula has no opinion
  std::optional<std::string> s1, s2;                 ///< stretchings, > 0; absent: 1
  std::optional<std::array<std::string, 3>> first;   ///< direction of s1, of any length but 0; absent: x
  std::optional<std::array<std::string, 3>> second;  ///< of s2; its part along first is taken off; absent: y
  Expression::Names names;
  Box domain;  ///< where sizes will be asked for: bad values there are looked for at once; empty: not looked for
};

/// @brief A field that evaluates formulas. lower_bound() is DBL_MIN where no better one is proved.
///
/// Before it returns it looks for bad values in the domain, by intervals and on a grid: finding none is no proof, and
/// a bad value met later throws ExpressionError from sizes() or metrics() with the place and the value.
/// @throws UsageError  a text that is no expression; s2 with first but without second
/// @throws ExpressionError  a value in the domain that is not positive: the place, the value and the expression
/// @par Source  Löhner (2008), 3.2.1, analytic functions
std::unique_ptr<SizeField> build_expression_size_field(const ExpressionSizes& sizes, Context& context);

/// @brief Sizes by a function of the caller's, which is called with many points at a time and from several threads.
/// @param smallest  promised: no value is below it; > 0. It is the field's lower bound; a value below it (or NaN)
/// throws InputError with the place. Infinite values have no opinion.
/// @throws UsageError  no function; smallest not positive
std::unique_ptr<SizeField> build_callback_size_field(
    std::function<void(std::span<const Point>, std::span<double>)> function, double smallest, Context& context);

}  // namespace delfront
