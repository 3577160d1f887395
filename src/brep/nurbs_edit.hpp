// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "delfront/nurbs.hpp"

namespace delfront {

/// @brief Curves raised to one degree and refined to common clamped knots from 0 to 1: as many control points each.
void make_compatible(std::vector<NurbsCurveData>& curves);

}  // namespace delfront
