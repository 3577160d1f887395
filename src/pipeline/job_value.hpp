// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace delfront {

/// @brief A value of a job file, whatever it was written in (TOML, JSON, the command line), with its line.
struct JobValue {
  enum class Kind : std::uint8_t { none, boolean, integer, number, text, list, table };

  Kind kind = Kind::none;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0;  ///< also set for integers
  std::string text;
  std::vector<std::string> names;  ///< of a table's members
  std::vector<JobValue> items;     ///< of a list or a table
  int line = 0;                    ///< in its file, from 1; 0: not from a file

  static JobValue of(bool value);
  static JobValue of(std::int64_t value);
  static JobValue of(double value);
  static JobValue of(const std::string& value);
  static JobValue list(std::vector<JobValue> items = {});
  static JobValue table();

  bool is(Kind k) const { return kind == k; }
  bool is_number() const { return kind == Kind::integer || kind == Kind::number; }
  void add(const std::string& name, JobValue value);
  /// @return nullptr where there is no such member
  const JobValue* find(const std::string& name) const;
};

/// @brief A value that an option does not take; the reason only, whoever catches it knows the key and the line.
struct BadValue : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// @return "a number", "text", "a table", … with the value where it is short
std::string describe(const JobValue& value);

/// @return the value as TOML on one line; numbers with the fewest digits that read back the same
std::string to_toml(const JobValue& value);

/// @return a key as TOML wants it: bare where possible, quoted otherwise
std::string toml_key(const std::string& name);

}  // namespace delfront
