// SPDX-License-Identifier: Apache-2.0
// Any text: an expression or a UsageError; of an expression, values within the bounds over a box.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace delfront;
  const std::string_view text{reinterpret_cast<const char*>(data), size};
  Expression::Names names;
  names.constants["h0"] = 0.1;
  names.distances["wing"] = build_distance_field({{{0, 0, 0}}, {}, {{{Point{1, 0, 0}, {1, 1, 0}, {1, 0, 1}}}}});
  try {
    distances_in(text, names.constants);
    const Expression expression(text, names);
    const Box box{{-1, 0, 0.5}, {1, 0.5, 0.5}};
    const ExpressionBounds bounds = expression.bounds(box);
    const ExpressionBounds refined = expression.refined_bounds(box, 9);
    const std::array<Point, 5> at{{{-1, 0, 0.5}, {1, 0.5, 0.5}, {0, 0, 0.5}, {0.1, 0.2, 0.5}, {-0.7, 0.3, 0.5}}};
    std::array<double, 5> value;
    expression.evaluate(at, value);
    for (const double v : value)
      for (const ExpressionBounds& b : {bounds, refined})
        if (std::isnan(v) ? !b.may_be_no_number : !(b.low <= v && v <= b.high)) std::abort();
  } catch (const UsageError&) {
  }
  return 0;
}
