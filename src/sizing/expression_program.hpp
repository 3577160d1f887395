// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "delfront/size_expression.hpp"
#include "sizing/expression_operations.hpp"

namespace delfront {

struct Instruction {
  Operation operation = Operation::constant;
  std::uint32_t to = 0;               ///< register written
  std::uint32_t a = 0, b = 0, c = 0;  ///< registers read, as many as the operation has arguments
  double value = 0;                   ///< of a constant
  int n = 0;                          ///< exponent of power_of_integer; number of the distance
};

/// @brief Straight code over registers; the first num_constants instructions fill constants that nothing overwrites.
struct Expression::Program {
  std::vector<Instruction> code;
  std::uint32_t num_constants = 0, num_registers = 0, result = 0;
  std::array<bool, 3> uses_axis{};  ///< whether values change along x, y, z
  std::vector<std::shared_ptr<const DistanceField>> distances;
};

/// @brief How many arguments an operation reads from registers.
int num_arguments(Operation operation);

/// @brief Collects instructions while a text is read: equal ones are made once, those of constants are worked out.
///
/// Values are numbered as they come; finish() hands out registers, which are used again after a value's last use.
class ProgramBuilder {
 public:
  using Value = std::uint32_t;
  Value constant(double value);
  Value add(Operation operation, Value a = 0, Value b = 0, Value c = 0, int n = 0);
  bool is_constant(Value v) const { return nodes_[v].operation == Operation::constant; }
  double value_of(Value v) const { return nodes_[v].value; }
  /// a ^ b, by products where b is a small whole number
  Value power(Value a, Value b);

  struct Finished {
    std::vector<Instruction> code;
    std::uint32_t num_constants = 0, num_registers = 0, result = 0;
    std::array<bool, 3> uses_axis{};
  };
  Finished finish(Value result) const;

 private:
  Value append(const Instruction& node);
  std::vector<Instruction> nodes_;  // `to` is the node's own number
  std::map<std::string, Value> known_;
};

/// @brief Knows the names that a text may hold.
class ExpressionScope {
 public:
  virtual ~ExpressionScope() = default;
  virtual const std::map<std::string, double>& constants() const = 0;
  /// @return its number
  /// @throws UsageError through `fail(message)`, which adds the place
  virtual int distance(const std::string& name, const std::function<void(const std::string&)>& fail) = 0;
};

/// @brief Reads a text into a builder. @return the value that is the result
/// @throws UsageError
ProgramBuilder::Value parse_expression(std::string_view text, ExpressionScope& scope, ProgramBuilder& builder);

/// @brief A text for a message: cut where it is long, no control characters.
std::string quoted(std::string_view text);

}  // namespace delfront
