// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "base/base64.hpp"
#include "report/overview.hpp"
#include "report/sections.hpp"

namespace delfront {

constexpr std::size_t kMostNames = 40;  ///< a part of a thousand faces would fill a page with colours

std::string overview_section(const Mesh& mesh) {
  const Overview overview = draw_overview(mesh);
  if (overview.png.empty()) return {};
  std::string names;
  for (std::size_t i = 0; i < std::min(kMostNames, overview.names.size()); ++i)
    names += fmt::format("<span><i style=\"background:{}\"></i>{}</span> ", overview.names[i].colour,
                         html(overview.names[i].name));
  if (overview.names.size() > kMostNames) names += fmt::format("and {} more", overview.names.size() - kMostNames);
  return fmt::format(
      "<section><h2>The grid</h2><figure class=\"overview\"><img alt=\"The boundary of the grid, by names\" "
      "src=\"data:image/png;base64,{}\"><figcaption class=\"names\">{}{}</figcaption></figure></section>",
      to_base64(overview.png), names,
      overview.is_cut_open ? "<br>What lies round the body is shown where it is behind it." : "");
}

}  // namespace delfront
