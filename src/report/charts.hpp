// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "report/html.hpp"

namespace delfront {

/// @brief What a histogram marks: values on the good side of `goal`, or those between two.
struct Marks {
  std::optional<double> at_least = {}, at_most = {};  ///< bars with nothing on the good side are shown as bad
};

/// @brief A histogram of the schema ({low, high, counts}) as SVG; the counts on a scale of powers of ten, so that a
/// single bad cell among millions can be seen.
/// @param unit  "deg" or ""
std::string histogram_svg(const Json& histogram, const std::string& unit, const Marks& marks);

}  // namespace delfront
