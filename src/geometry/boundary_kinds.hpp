// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace delfront {

/// @brief What a patch may be said to be, by the words of solvers.
inline const std::vector<std::string>& boundary_kinds() {
  static const std::vector<std::string> kinds = {"wall",     "patch", "inlet", "outlet", "farfield",
                                                 "symmetry", "empty", "wedge", "cyclic", "interface"};
  return kinds;
}

}  // namespace delfront
