// SPDX-License-Identifier: Apache-2.0
#include "sizing/expression_program.hpp"

#include <cmath>
#include <cstring>

#include "delfront/errors.hpp"

namespace delfront {

int num_arguments(Operation operation) {
  if (operation <= Operation::distance) return 0;
  if (operation <= Operation::power_of_integer) return 1;
  return operation == Operation::choose ? 3 : 2;
}

ProgramBuilder::Value ProgramBuilder::append(const Instruction& node) {
  const std::uint32_t words[5] = {static_cast<std::uint32_t>(node.operation), node.a, node.b, node.c,
                                  static_cast<std::uint32_t>(node.n)};
  std::string key(sizeof words + sizeof node.value, '\0');
  std::memcpy(key.data(), words, sizeof words);
  std::memcpy(key.data() + sizeof words, &node.value, sizeof node.value);
  const auto [it, is_new] = known_.try_emplace(key, static_cast<Value>(nodes_.size()));
  if (is_new) {
    nodes_.push_back(node);
    nodes_.back().to = it->second;
  }
  return it->second;
}

ProgramBuilder::Value ProgramBuilder::constant(double value) {
  Instruction node;
  node.value = value;
  return append(node);
}

ProgramBuilder::Value ProgramBuilder::add(Operation operation, Value a, Value b, Value c, int n) {
  const int arguments = num_arguments(operation);
  if (operation == Operation::choose) {
    if (is_constant(a)) return is_nan(value_of(a)) ? a : value_of(a) != 0 ? b : c;
  } else if (arguments == 1 && is_constant(a)) {
    double folded = 0;
    with_unary(operation, n, [&](auto f) { folded = f(value_of(a)); });
    return constant(folded);
  } else if (arguments == 2 && is_constant(a) && is_constant(b)) {
    double folded = 0;
    with_binary(operation, [&](auto f) { folded = f(value_of(a), value_of(b)); });
    return constant(folded);
  }
  Instruction node;
  node.operation = operation;
  node.a = a;
  node.b = b;
  node.c = c;
  node.n = n;
  return append(node);
}

ProgramBuilder::Value ProgramBuilder::power(Value a, Value b) {
  constexpr double kLargest = 64;
  if (is_constant(b)) {
    const double n = value_of(b);
    if (n == 1) return a;
    if (n == 0.5) return add(Operation::sqrt, a);
    if (n != 0 && std::abs(n) <= kLargest && std::floor(n) == n)
      return add(Operation::power_of_integer, a, 0, 0, static_cast<int>(n));
  }
  return add(Operation::power, a, b);
}

ProgramBuilder::Finished ProgramBuilder::finish(Value result) const {
  std::vector<std::uint32_t> last_use(nodes_.size(), 0);  // number of the last reader; 0: none
  std::vector<bool> is_used(nodes_.size(), false);
  is_used[result] = true;
  const auto for_each_argument = [&](const Instruction& node, auto&& visit) {
    const std::uint32_t arguments[3] = {node.a, node.b, node.c};
    for (int k = 0; k < num_arguments(node.operation); ++k) visit(arguments[k]);
  };
  for (std::size_t i = nodes_.size(); i-- > 0;)
    if (is_used[i])
      for_each_argument(nodes_[i], [&](std::uint32_t v) {
        is_used[v] = true;
        last_use[v] = std::max(last_use[v], nodes_[i].to);
      });
  Finished done;
  std::vector<std::uint32_t> register_of(nodes_.size(), 0), free;
  for (const Instruction& node : nodes_)
    if (is_used[node.to] && node.operation == Operation::constant) {
      register_of[node.to] = done.num_registers++;
      done.code.push_back(node);
      done.code.back().to = register_of[node.to];
    }
  done.num_constants = done.num_registers;
  for (const Instruction& node : nodes_) {
    if (!is_used[node.to] || node.operation == Operation::constant) continue;
    const bool is_distance = node.operation == Operation::distance;
    done.uses_axis[0] |= is_distance || node.operation == Operation::x;
    done.uses_axis[1] |= is_distance || node.operation == Operation::y;
    done.uses_axis[2] |= is_distance || node.operation == Operation::z;
    Instruction made = node;
    made.a = register_of[node.a];
    made.b = register_of[node.b];
    made.c = register_of[node.c];
    // the result goes to a register that no argument holds, which lets loops be vectorised without a look at overlaps
    if (free.empty()) {
      made.to = done.num_registers++;
    } else {
      made.to = free.back();
      free.pop_back();
    }
    for_each_argument(node, [&](std::uint32_t v) {
      if (nodes_[v].operation == Operation::constant || last_use[v] != node.to || v == result) return;
      last_use[v] = 0;  // read twice by one instruction, freed once
      free.push_back(register_of[v]);
    });
    register_of[node.to] = made.to;
    done.code.push_back(made);
  }
  done.result = register_of[result];
  return done;
}

}  // namespace delfront
