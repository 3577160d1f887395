// SPDX-License-Identifier: Apache-2.0
#include "sizing/model_names.hpp"

#include <algorithm>

#include "base/nearest_name.hpp"
#include "fmt/format.h"

namespace delfront {

std::vector<std::string> names_on(const Model& model) {
  std::vector<std::string> names;
  for (const Patch& patch : model.patches) names.push_back(patch.name);
  for (const Curve& curve : model.curves) names.push_back(curve.name);
  names.insert(names.end(), model.corner_names.begin(), model.corner_names.end());
  std::erase(names, std::string());
  return names;
}

std::string say_names(std::string_view wrong, const std::vector<std::string>& names) {
  constexpr std::size_t kMostShown = 20;
  const std::string near = nearest_name(wrong, names);
  const std::size_t shown = std::min(names.size(), kMostShown), more = names.size() - shown;
  return fmt::format("{}; there are: {}{}", near.empty() ? "" : fmt::format("; did you mean '{}'?", near),
                     names.empty()
                         ? "none with a name"
                         : fmt::format("{}", fmt::join(names.begin(), names.begin() + std::ptrdiff_t(shown), ", ")),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace delfront
