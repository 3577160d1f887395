// SPDX-License-Identifier: Apache-2.0
// Evaluation by blocks: each instruction runs over up to kBlock points before the next one starts, in loops that the
// compiler turns into vector instructions. Functions of the C library are called point by point (no vector versions,
// which round differently), so that a value does not depend on where in a batch its point stands.
#include <algorithm>
#include <array>
#include <memory>

#include "base/nearest_name.hpp"
#include "delfront/errors.hpp"
#include "delfront/size_expression.hpp"
#include "fmt/format.h"
#include "sizing/expression_program.hpp"
#include "sizing/interval.hpp"

namespace delfront {
namespace {

constexpr std::size_t kBlock = 64;

class KnownNames final : public ExpressionScope {
 public:
  explicit KnownNames(const Expression::Names& names) : names_(names) {}
  const std::map<std::string, double>& constants() const override { return names_.constants; }
  int distance(const std::string& name, const std::function<void(const std::string&)>& fail) override {
    const auto found = names_.distances.find(name);
    if (found == names_.distances.end() || !found->second) {
      std::vector<std::string> known;
      for (const auto& [other, field] : names_.distances) known.push_back(other);
      const std::string near = nearest_name(name, known);
      fail(fmt::format("nothing is called {}{}", quoted(name),
                       !near.empty()   ? fmt::format("; did you mean {}?", near)
                       : known.empty() ? "; no names are known here"
                                       : fmt::format("; there are {}", fmt::join(known, ", "))));
    }
    const auto at = std::find(used.begin(), used.end(), found->second);
    if (at == used.end()) used.push_back(found->second);
    return static_cast<int>(std::find(used.begin(), used.end(), found->second) - used.begin());
  }
  std::vector<std::shared_ptr<const DistanceField>> used;

 private:
  const Expression::Names& names_;
};

/// Takes any name for a distance and notes it.
class NameCollector final : public ExpressionScope {
 public:
  explicit NameCollector(const std::map<std::string, double>& constants) : constants_(constants) {}
  const std::map<std::string, double>& constants() const override { return constants_; }
  int distance(const std::string& name, const std::function<void(const std::string&)>&) override {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  std::vector<std::string> names;

 private:
  const std::map<std::string, double>& constants_;
};

/// One instruction over `count` points.
void run(const Instruction& in, std::span<const Point> at, std::size_t width, double* registers,
         const std::vector<std::shared_ptr<const DistanceField>>& distances) {
  const std::size_t count = at.size();
  double* __restrict const to = registers + in.to * width;  // never an argument's register
  const double* const a = registers + in.a * width;
  const double* const b = registers + in.b * width;
  const double* const c = registers + in.c * width;
  switch (in.operation) {
    case Operation::constant:
      for (std::size_t i = 0; i < count; ++i) to[i] = in.value;
      return;
    case Operation::x:
      for (std::size_t i = 0; i < count; ++i) to[i] = plus_zero(at[i].x);
      return;
    case Operation::y:
      for (std::size_t i = 0; i < count; ++i) to[i] = plus_zero(at[i].y);
      return;
    case Operation::z:
      for (std::size_t i = 0; i < count; ++i) to[i] = plus_zero(at[i].z);
      return;
    case Operation::distance:
      return distances[std::size_t(in.n)]->distances(at, {to, count});
    case Operation::choose:
      for (std::size_t i = 0; i < count; ++i) to[i] = chosen(a[i], b[i], c[i]);
      return;
    default:
      break;
  }
  const bool is_unary = with_unary(in.operation, in.n, [&](auto f) {
    for (std::size_t i = 0; i < count; ++i) to[i] = f(a[i]);
  });
  if (is_unary) return;
  with_binary(in.operation, [&](auto f) {
    for (std::size_t i = 0; i < count; ++i) to[i] = f(a[i], b[i]);
  });
}

Interval range_of(const Instruction& in, const Box& box, const std::vector<Interval>& registers,
                  const std::vector<std::shared_ptr<const DistanceField>>& distances) {
  const auto side = [&](int axis) { return Interval{plus_zero(box.low[axis]), plus_zero(box.high[axis]), false}; };
  switch (in.operation) {
    case Operation::constant:
      return is_nan(in.value) ? Interval{1, 0, true} : Interval{in.value, in.value, false};
    case Operation::x:
      return side(0);
    case Operation::y:
      return side(1);
    case Operation::z:
      return side(2);
    case Operation::distance: {
      const DistanceField::Range range = distances[std::size_t(in.n)]->range(box);
      return {range.low, range.high, false};
    }
    case Operation::choose:
      return choice_range(registers[in.a], registers[in.b], registers[in.c]);
    default:
      break;
  }
  if (num_arguments(in.operation) == 1) return unary_range(in.operation, in.n, registers[in.a]);
  return binary_range(in.operation, registers[in.a], registers[in.b], in.a == in.b);
}

}  // namespace

Expression::Expression(std::string_view text, const Names& names) : text_(text) {
  KnownNames scope(names);
  ProgramBuilder builder;
  const ProgramBuilder::Value result = parse_expression(text_, scope, builder);
  ProgramBuilder::Finished made = builder.finish(result);
  auto program = std::make_shared<Program>();
  program->code = std::move(made.code);
  program->num_constants = made.num_constants;
  program->num_registers = made.num_registers;
  program->result = made.result;
  program->uses_axis = made.uses_axis;
  program->distances = std::move(scope.used);
  program_ = std::move(program);
}

bool Expression::is_constant() const {
  const auto [x, y, z] = program_->uses_axis;
  return !x && !y && !z;
}

void Expression::evaluate(std::span<const Point> at, std::span<double> value) const {
  DELFRONT_CHECK(at.size() == value.size());
  const Program& program = *program_;
  const std::size_t width = std::min(kBlock, at.size());
  std::array<double, 1024> small;
  std::unique_ptr<double[]> large;
  double* registers = small.data();
  if (program.num_registers * width > small.size()) {
    large = std::make_unique_for_overwrite<double[]>(program.num_registers * width);
    registers = large.get();
  }
  const std::span code(program.code);
  for (const Instruction& in : code.first(program.num_constants))
    run(in, at.first(width), width, registers, program.distances);
  const double* const result = registers + program.result * width;
  for (std::size_t first = 0; first < at.size(); first += width) {
    const auto block = at.subspan(first, std::min(width, at.size() - first));
    for (const Instruction& in : code.subspan(program.num_constants))
      run(in, block, width, registers, program.distances);
    std::copy_n(result, block.size(), value.data() + first);
  }
}

double Expression::operator()(Point at) const {
  double value = 0;
  evaluate({&at, 1}, {&value, 1});
  return value;
}

ExpressionBounds Expression::bounds(const Box& box) const {
  DELFRONT_CHECK(!box.is_empty());
  std::vector<Interval> registers(program_->num_registers);
  for (const Instruction& in : program_->code) registers[in.to] = range_of(in, box, registers, program_->distances);
  const Interval& result = registers[program_->result];
  return {result.low, result.high, result.may_be_nan};
}

ExpressionBounds Expression::refined_bounds(const Box& box, int max_boxes) const {
  constexpr double kCloseEnough = 0.95;
  struct Part {
    Box box;
    ExpressionBounds bounds;
  };
  std::vector<Part> parts{{box, bounds(box)}};
  const auto is_better = [](const Part& p, const Part& q) { return p.bounds.low > q.bounds.low; };  // least on top
  double least_value = std::numeric_limits<double>::infinity();
  for (int made = 1; made + 2 <= max_boxes; made += 2) {
    const Part top = parts.front();
    const Point side = top.box.high - top.box.low;
    int axis = 0;
    double longest = -1;
    for (int k = 0; k < 3; ++k)
      if (program_->uses_axis[std::size_t(k)] && side[k] > longest) longest = side[axis = k];
    const double middle = top.box.low[axis] + 0.5 * side[axis];
    if (!(middle > top.box.low[axis] && middle < top.box.high[axis])) break;  // a point, or endless
    const double value = (*this)(top.box.low + 0.5 * side);
    if (!is_nan(value)) least_value = std::min(least_value, value);
    if (top.bounds.low > 0 && top.bounds.low >= kCloseEnough * least_value) break;
    std::pop_heap(parts.begin(), parts.end(), is_better);
    parts.pop_back();
    for (const bool upper : {false, true}) {
      Part part{top.box, {}};
      (upper ? part.box.low : part.box.high)[axis] = middle;
      part.bounds = bounds(part.box);
      parts.push_back(part);
      std::push_heap(parts.begin(), parts.end(), is_better);
    }
  }
  ExpressionBounds all = parts.front().bounds;
  for (const Part& part : parts) {
    all.low = std::min(all.low, part.bounds.low);
    all.high = std::max(all.high, part.bounds.high);
    all.may_be_no_number = all.may_be_no_number || part.bounds.may_be_no_number;
  }
  return all;
}

std::vector<std::string> distances_in(std::string_view text, const std::map<std::string, double>& constants) {
  NameCollector scope(constants);
  ProgramBuilder builder;
  parse_expression(text, scope, builder);
  return scope.names;
}

}  // namespace delfront
