// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"
#include "fmt/format.h"
#include "support/errors.hpp"

namespace delfront {
namespace {

using fixtures::expect_mentions;

constexpr std::uint64_t kSeed = 20261122;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double value_of(const std::string& text, Point at = {}) { return Expression(text)(at); }

std::string error_of(const std::string& text, const Expression::Names& names = {}) {
  return fixtures::message_of<UsageError>([&] { Expression(text, names); });
}

TEST(Expression, S2_values_are_those_of_the_formulas) {
  const Point at{0.3, -1.7, 2.5};
  const auto [x, y, z] = at;
  const struct {
    const char* text;
    double value;
  } cases[] = {
      {"0.01 + 0.1*abs(z)", 0.01 + 0.1 * std::abs(z)},
      {"-x^2", -x * x},
      {"2^3^2", 512},
      {"2^-1", 0.5},
      {"x - y - z", x - y - z},
      {"x / y / z", x / y / z},
      {"2 + 3 * 4 ^ 2 / 8", 8},
      {"-2 - -3", 1},
      {"sqrt(x^2 + y^2 + z^2)", std::sqrt(x * x + y * y + z * z)},
      {"hypot(x, y, z)", std::sqrt(x * x + y * y + z * z)},
      {"cbrt(y)", std::cbrt(y)},
      {"exp(y) + log(z) * log10(z)", std::exp(y) + std::log(z) * std::log10(z)},
      {"sin(x) * cos(y) - tan(z)", std::sin(x) * std::cos(y) - std::tan(z)},
      {"asin(x) + acos(x)", std::asin(x) + std::acos(x)},
      {"atan(y) - atan2(y, -x)", std::atan(y) - std::atan2(y, -x)},
      {"sinh(x) + cosh(y) / tanh(z)", std::sinh(x) + std::cosh(y) / std::tanh(z)},
      {"min(3, x, y, z) + max(x, z)", y + z},
      {"pow(z, 1.5) + z^3 + z^-2 + z^0.5", std::pow(z, 1.5) + z * z * z + 1 / (z * z) + std::sqrt(z)},
      {"floor(y) + 10 * ceil(y) + 100 * sign(y)", -2 - 10 - 100},
      {"mod(y, 1) + mod(z, -2)", 0.3 + -1.5},
      {"step(0, x) + 10 * step(0, y)", 1},
      {"clamp(z, 0, 1) + clamp(y, 0, 1) + clamp(x, 0, 1)", 1 + 0 + x},
      {"x < 1 && y < 0 || z < 0", 1},
      {"x <= 0.3 && x >= 0.3 && x == 0.3 && !(x != 0.3)", 1},
      {"!x + !0", 1},
      {"x > 1 ? 5 : y > 0 ? 6 : 7", 7},
      {"if(x < 1, 0.25, 4)", 0.25},
      {"z > 0 || log(-1) > 0", 1},
      {"x < 0 && log(-1) > 0", 0},
      {"x > 0 ? 2 : sqrt(-1)", 2},
      {"2 * pi * e", 2 * M_PI * M_E},
      {".5e1 + 1.E-1", 5.1},
      {"inf", kInfinity},
      {"1 / (x - x)", kInfinity},
      {"1 / -(x - x)", kInfinity},
      {"  +x  ", x},
  };
  for (const auto& c : cases) {
    const double value = value_of(c.text, at);
    if (std::isinf(c.value))
      EXPECT_EQ(value, c.value) << c.text;
    else
      EXPECT_NEAR(value, c.value, 1e-12 * std::abs(c.value)) << c.text;
  }
}

TEST(Expression, S2_no_number_stays_none) {
  for (const char* text :
       {"min(1, log(-1))", "max(log(-1), 1)", "min(sqrt(y), 1)", "sqrt(y) ^ 0", "hypot(inf, sqrt(y))", "sqrt(y) < 1",
        "!sqrt(y)", "sqrt(y) ? 1 : 2", "sign(sqrt(y))", "0/0", "clamp(sqrt(y), 0, 1)"})
    EXPECT_TRUE(std::isnan(value_of(text, {1, -1, 1}))) << text;
}

TEST(Expression, S2_constants_of_the_caller_and_what_is_constant) {
  const Expression::Names names{{{"h0", 0.25}, {"chord", 4}}, {}};
  EXPECT_EQ(Expression("h0 * chord", names)({}), 1);
  EXPECT_TRUE(Expression("h0 * chord + sin(1)", names).is_constant());
  EXPECT_FALSE(Expression("h0 * x", names).is_constant());
  expect_mentions(error_of("h0 * cord", names), {"did you mean chord?"});
}

TEST(Expression, S2_errors_name_the_column_the_word_and_what_was_expected) {
  const struct {
    const char* text;
    const char* column;
    const char* what;
  } cases[] = {
      {"", "column 1:", "expected a number, a name or ("},
      {"1 +", "column 4:", "the text ends"},
      {"0.01+0.1*abz(z)", "column 10:", "did you mean abs?"},
      {"2x", "column 2:", "write *"},
      {"0.1mm", "column 4:", "no units"},
      {"x y", "column 3:", "'y'"},
      {"(x", "column 3:", "( in column 1"},
      {"x)", "column 2:", "no ( that it closes"},
      {"sqrt(x, y)", "column 1:", "takes 1 argument, not 2"},
      {"atan2(x)", "column 1:", "takes 2 arguments, not 1"},
      {"hypot(x)", "column 1:", "takes 2 or more arguments, not 1"},
      {"min()", "column 1:", "takes 1 or more"},
      {"sqrt(x", "column 7:", ", or )"},
      {"sqrt", "column 1:", "write sqrt(…)"},
      {"distance", "column 1:", "distance(\"name\")"},
      {"distance(wing)", "column 10:", "in quotes"},
      {"distance(\"wing)", "column 10:", "has no end"},
      {"distance(\"wing\")", "column 10:", "nothing is called 'wing'"},
      {"x = 3", "column 3:", "=="},
      {"x & y", "column 3:", "&&"},
      {"x ** 2", "column 3:", "a ^ b"},
      {"x % 2", "column 3:", "mod(a, b)"},
      {"x @ 2", "column 3:", "'@' has no meaning"},
      {"0 < x < 1", "column 7:", "a < b && b < c"},
      {"x ? 1", "column 6:", "expected :"},
      {"1e999", "column 1:", "out of range"},
      {"x(2)", "column 1:", "is no function"},
      {"quux + 1", "column 1:", "unknown name 'quux'"},
      {"1 + * 2", "column 5:", "not '*'"},
      {"min(1,,2)", "column 7:", "not ','"},
  };
  for (const auto& c : cases) {
    const std::string error = error_of(c.text);
    expect_mentions(error, {c.column, c.what});
  }
}

TEST(Expression, S2_deep_and_long_texts_are_refused_without_harm) {
  const auto repeated = [](const std::string& part, int n) {
    std::string all;
    for (int i = 0; i < n; ++i) all += part;
    return all;
  };
  for (const char* part : {"(", "-", "!", "2^", "x?", "x?1:", "abs(", "if(1,"})
    expect_mentions(error_of(repeated(part, 4000 / int(std::string(part).size()))), {"nested deeper"});
  expect_mentions(error_of(repeated("1+", 20000) + "1"), {"20000 at most"});
  EXPECT_EQ(value_of(repeated("x+", 4000) + "x", {1, 0, 0}), 4001);
  EXPECT_EQ(value_of(repeated("(", 90) + "x" + repeated(")", 90), {3, 0, 0}), 3);
}

TEST(Expression, S2_the_names_of_distances_are_found_without_a_model) {
  EXPECT_EQ(distances_in("min(distance(\"wing\"), distance('tail'), 2 * distance(\"wing\"))"),
            (std::vector<std::string>{"wing", "tail"}));
  EXPECT_THROW(distances_in("distance(1)"), UsageError);
}

/// Random text of the grammar; all operations, numbers of all sizes.
std::string random_text(std::mt19937_64& random, int depth) {
  const auto pick = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const auto sub = [&] { return random_text(random, depth - 1); };
  if (depth == 0 || pick(8) == 0) {
    const char* const leaves[] = {"x",   "y",    "z",    "x",   "y",  "z",   "0",      "1",     "2",  "0.1",
                                  "3.7", "-2.5", "1e-3", "100", "pi", "1e8", "1e-200", "1e200", "inf"};
    return leaves[pick(pick(4) == 0 ? 19 : 14)];
  }
  const char* const unary[] = {"abs",  "sqrt", "cbrt", "exp",  "log",  "log10", "sin",   "cos",  "tan",
                               "asin", "acos", "atan", "sinh", "cosh", "tanh",  "floor", "ceil", "sign"};
  const char* const binary[] = {"+", "-", "*", "/", "+", "-", "*", "/", "<", "<=", ">", ">=", "==", "!=", "&&", "||"};
  const char* const calls[] = {"min", "max", "atan2", "hypot", "mod", "pow", "step"};
  switch (pick(8)) {
    case 0:
      return fmt::format("-({})", sub());
    case 1:
    case 2:
      return fmt::format("{}({})", unary[pick(18)], sub());
    case 3:
      return fmt::format("({})^{}", sub(), pick(3) == 0 ? "(" + sub() + ")" : std::to_string(pick(9) - 3));
    case 4:
      return fmt::format("{}({}, {})", calls[pick(7)], sub(), sub());
    case 5:
      return fmt::format("(({}) ? ({}) : ({}))", sub(), sub(), sub());
    default:
      return fmt::format("(({}) {} ({}))", sub(), binary[pick(16)], sub());
  }
}

Box random_box(std::mt19937_64& random) {
  std::uniform_real_distribution<double> centre(-3, 3), exponent(-6, 0.7);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_round = random() % 4 == 0;
    const double low = is_round ? std::floor(centre(random)) : centre(random);
    const double side = is_round ? double(random() % 3) : std::pow(10, exponent(random));
    box.low[axis] = low;
    box.high[axis] = low + side;
  }
  return box;
}

TEST(Expression, S2_values_lie_within_the_bounds_over_a_box) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::size_t tested = 0;
  constexpr std::size_t kPoints = 50;
  std::vector<Point> at(kPoints);
  std::vector<double> value(kPoints);
  for (int trial = 0; trial < 20000; ++trial) {
    const std::string text = random_text(random, 1 + trial % 5);
    const Expression expression(text);
    const Box box = random_box(random);
    for (Point& p : at)
      for (int axis = 0; axis < 3; ++axis) {
        const double t = random() % 4 == 0 ? double(random() % 3) / 2 : unit(random);
        p[axis] = std::clamp(box.low[axis] + t * (box.high[axis] - box.low[axis]), box.low[axis], box.high[axis]);
      }
    expression.evaluate(at, value);
    const ExpressionBounds bounds = trial % 10 == 0 ? expression.refined_bounds(box) : expression.bounds(box);
    for (std::size_t i = 0; i < kPoints; ++i) {
      ++tested;
      const bool fits =
          std::isnan(value[i]) ? bounds.may_be_no_number : bounds.low <= value[i] && value[i] <= bounds.high;
      ASSERT_TRUE(fits) << text
                        << fmt::format(" at ({}, {}, {}): {} not in [{}, {}] nan {}\nbox ({}, {}, {}) ({}, {}, {})",
                                       at[i].x, at[i].y, at[i].z, value[i], bounds.low, bounds.high,
                                       bounds.may_be_no_number, box.low.x, box.low.y, box.low.z, box.high.x, box.high.y,
                                       box.high.z);
    }
  }
  EXPECT_EQ(tested, 1000000u);
}

TEST(Expression, S2_refined_bounds_are_tight) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  const struct {
    const char* text;
    double least;
  } cases[] = {{"0.01 + 0.1 * abs(z)", 0.01}, {"0.1 + x^2 + y^2 + z^2", 0.1},   {"exp(x + y + z)", std::exp(-3)},
               {"2 + sin(3 * x)", 1},         {"0.5 + sqrt(hypot(x, y))", 0.5}, {"1 + x * x - x", 0.75},
               {"x > 0 ? 0.1 : 0.3", 0.1},    {"1 / (1.5 + x)", 0.4},           {"1.25 + x * y", 0.25}};
  for (const auto& c : cases) {
    const ExpressionBounds bounds = Expression(c.text).refined_bounds(box);
    EXPECT_LE(bounds.low, c.least * (1 + 1e-12)) << c.text;
    EXPECT_GE(bounds.low, 0.85 * c.least) << c.text;
    EXPECT_FALSE(bounds.may_be_no_number) << c.text;
  }
  EXPECT_TRUE(Expression("1 / (x - x)").bounds(box).high == kInfinity);
}

TEST(Expression, S2_same_bits_in_any_batch) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> place(-2, 2);
  std::vector<Point> at(333);
  for (Point& p : at) p = {place(random), place(random), place(random)};
  for (int trial = 0; trial < 300; ++trial) {
    const std::string text = random_text(random, 5);
    const Expression expression(text);
    std::vector<double> all(at.size());
    expression.evaluate(at, all);
    for (std::size_t i = 0; i < at.size(); i += 7) {
      const double alone = expression(at[i]);
      ASSERT_TRUE(alone == all[i] || (std::isnan(alone) && std::isnan(all[i]))) << text << ", seed " << kSeed;
    }
  }
}

TEST(Expression, S2_is_fast_enough_not_to_be_noticed) {
  const Expression expression("0.01 + 0.1*abs(z)");
  std::vector<Point> at(1 << 16, Point{1, 2, 3});
  std::vector<double> value(at.size());
  double best = kInfinity;
  for (int round = 0; round < 20; ++round) {
    const auto start = std::chrono::steady_clock::now();
    expression.evaluate(at, value);
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  const double rate = static_cast<double>(at.size()) / best;
  RecordProperty("points_per_second", fmt::format("{:.3g}", rate));
#ifdef NDEBUG
  EXPECT_GT(rate, 2e7) << "points a second";
#endif
}

}  // namespace
}  // namespace delfront
