// SPDX-License-Identifier: Apache-2.0
#include "report/page.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "report/page_style.hpp"
#include "report/sections.hpp"

namespace delfront {

/// The files that were gridded, without their folders.
static std::string title_of(const Json& r) {
  std::string title;
  const auto add = [&](const std::string& path) {
    std::filesystem::path file(path);
    if (!file.has_filename()) file = file.parent_path();
    title += (title.empty() ? "" : ", ") + file.filename().string();
  };
  for (const Json& input : part_of(r, "inputs")) add(text_of(input, "path"));
  if (title.empty())  // none could be read
    for (const Json& file : part_of(part_of(part_of(r, "options"), "input"), "files")) add(file.get<std::string>());
  if (title.empty()) add(text_of(r, "input"));
  if (title.empty())  // geometry of the job file itself
    for (const Json& file : part_of(part_of(part_of(r, "options"), "output"), "files")) add(file.get<std::string>());
  return title.empty() ? "delfront" : title;
}

std::string report_page(std::string_view json, std::string_view defaults, const Mesh& mesh) {
  const Json r = Json::parse(json);
  const Json usual = defaults.empty() ? Json() : Json::parse(defaults);
  const std::string title = html(title_of(r));
  const std::string version = text_of(r, r.contains("delfront") ? "delfront" : "version");
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{} – delfront</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n"
      "<header><h1>{}</h1><p class=\"sub mono\">{}</p></header>\n",
      title, kPageStyle, title, html(text_of(r, "command")));
  for (const std::string& section :
       {verdict_section(r), tiles_section(r), problems_section(r), warnings_section(r), overview_section(mesh),
        worst_section(r, mesh), quality_section(r), groups_section(r), surface_section(r), times_section(r),
        options_section(r, usual)})
    if (!section.empty()) page += section + "\n";
  page += fmt::format(
      "<footer>delfront {}. Lengths are in model units, areas and volumes in their squares and cubes, angles in "
      "degrees; "
      "numbers of cells, facets and points count from 0. The same run as data: the JSON file beside this "
      "page.</footer>\n"
      "</main>\n</body>\n</html>\n",
      html(version));
  return page;
}

}  // namespace delfront
