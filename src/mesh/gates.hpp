// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/grid_check.hpp"

namespace delfront {

/// @brief One gate: "min_dihedral > 8".
struct Gate {
  std::string name, op;  ///< op: > >= < <=
  double limit = 0;
  bool is_from_below() const { return op[0] == '>'; }
};

/// @throws UsageError  a malformed gate
std::vector<Gate> parse_gates(const std::string& text);

bool is_met(double value, const Gate& gate);

/// @return a sentence; empty where the gate is met
/// @throws UsageError  an unknown measure
std::string judge(const QualityReport& report, const Gate& gate);

}  // namespace delfront
