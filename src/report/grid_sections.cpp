// SPDX-License-Identifier: Apache-2.0
// The grid in detail: its worst cells drawn, histograms, named groups.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "report/cell_pictures.hpp"
#include "report/charts.hpp"
#include "report/sections.hpp"

namespace delfront {

namespace {

/// What a measure is called for people.
std::string title_of(const std::string& measure) {
  static const std::pair<const char*, const char*> kTitles[] = {{"min_dihedral", "Smallest dihedral angle of a cell"},
                                                                {"max_dihedral", "Largest dihedral angle of a cell"},
                                                                {"min_angle", "Smallest angle of a cell"},
                                                                {"max_angle", "Largest angle of a cell"},
                                                                {"mean_ratio", "Mean ratio (1: regular)"},
                                                                {"radius_ratio", "Radius ratio (1: regular)"},
                                                                {"aspect_ratio", "Aspect ratio (1: regular)"},
                                                                {"openfoam_aspect", "Aspect ratio as OpenFOAM has it"},
                                                                {"max_nonortho", "Non-orthogonality of a face"},
                                                                {"skewness", "Skewness of a face"},
                                                                {"volume_ratio", "Volume ratio of neighbours"},
                                                                {"edge_length", "Length of an edge"}};
  for (const auto& [name, title] : kTitles)
    if (measure == name) return title;
  return measure;
}

std::string with_unit(const Json& value, const Json& measure) {
  return number_text(value) + (text_of(measure, "unit") == "deg" ? "°" : "");
}

const Json& measures_of(const Json& r) { return part_of(part_of(r, "quality"), "measures"); }

/// Bars beyond the goals of improvement are marked.
Marks marks_of(const Json& r, const std::string& measure) {
  const Json& goals = part_of(part_of(part_of(r, "options"), "improve"), "goals");
  Marks marks;
  if (const Json& goal = part_of(goals, "min_dihedral"); measure == "min_dihedral" && goal.is_number())
    marks.at_least = goal.get<double>();
  if (const Json& goal = part_of(goals, "max_nonortho"); measure == "max_nonortho" && goal.is_number())
    marks.at_most = goal.get<double>();
  return marks;
}

std::string chart(const std::string& title, const std::string& key, const Json& measure, const Marks& marks) {
  std::string ends =
      fmt::format("min {} · mean {} · max {}", with_unit(part_of(measure, "min"), measure),
                  with_unit(part_of(measure, "mean"), measure), with_unit(part_of(measure, "max"), measure));
  return fmt::format("<figure><figcaption><b>{}</b> <span class=\"mono\">{}</span><br>{}</figcaption>{}</figure>",
                     html(title), html(key), ends,
                     histogram_svg(part_of(measure, "histogram"), text_of(measure, "unit"), marks));
}

std::vector<std::uint32_t> ids_of(const Json& worst) {
  return part_of(worst, "cells").get<std::vector<std::uint32_t>>();
}

std::string card(std::size_t rank, const Json& worst, const Json& measure, const CellPicture& picture) {
  std::string names;
  for (const std::string& name : picture.touches) names += (names.empty() ? "" : ", ") + name;
  const std::vector<std::uint32_t> ids = ids_of(worst);
  return fmt::format(
      "<figure>{}<figcaption><b>{}. {}</b> cell{} {}<br><span class=\"mono\">{}</span>{}</figcaption></figure>",
      picture.svg, rank, with_unit(part_of(worst, "value"), measure), ids.size() > 1 ? "s" : "",
      ids_text(part_of(worst, "cells")), point_text(part_of(worst, "at")),
      names.empty() ? "" : "<br>on " + html(names));
}

/// Measures of cells, and of faces with their two cells, whose gate is not met; then the one that all are judged by.
std::vector<std::string> drawn_measures(const Json& r) {
  std::vector<std::string> result;
  for (const auto& [name, measure] : measures_of(r).items())
    if (misses_gate(r, name) && name != "edge_length") result.push_back(name);  // that is of points
  const std::string main = main_measure(r);
  if (!main.empty() && std::find(result.begin(), result.end(), main) == result.end()) result.push_back(main);
  return result;
}

std::string worst_of_all(const Json& r) {
  std::string rows;
  for (const auto& [name, measure] : measures_of(r).items()) {
    const Json& worst = part_of(measure, "worst");
    if (worst.empty()) continue;
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"num\">{}</td><td class=\"mono\">{}</td><td class=\"mono\">{}{}</td></tr>",
        html(title_of(name)), with_unit(part_of(worst[0], "value"), measure), point_text(part_of(worst[0], "at")),
        name == "edge_length" ? "points " : "", ids_text(part_of(worst[0], "cells")));
  }
  return rows.empty()
             ? ""
             : "<details><summary>The worst by every measure</summary><div class=\"wide\"><table><tr><th>Measure</th>"
               "<th class=\"num\">Worst</th><th>Where</th><th>Cells</th></tr>" +
                   rows + "</table></div></details>";
}

bool has_colours(const Json& groups) {
  return std::any_of(groups.begin(), groups.end(), [](const Json& group) { return !text_of(group, "colour").empty(); });
}

/// @param has_colour  whether there is a column for it
std::string group_rows(const Json& groups, const std::string& what, bool has_colour) {
  std::string rows;
  for (const Json& group : groups) {
    const std::string colour = text_of(group, "colour"), kind = text_of(group, "kind");
    const bool is_plain = colour.size() == 6 && colour.find_first_not_of("0123456789ABCDEFabcdef") == std::string::npos;
    const std::string swatch =
        is_plain ? fmt::format("<span class=\"swatch\" style=\"background:#{0}\"></span>{0}", colour) : "–";
    rows += fmt::format(
        "<tr><td class=\"name\">{}</td><td>{}</td><td>{}</td>{}<td class=\"num\">{}</td><td class=\"num\">{}</td></tr>",
        html(text_of(group, "name")), what, kind.empty() ? "–" : html(kind),
        has_colour ? "<td>" + swatch + "</td>" : "", count_text(part_of(group, "num_cells")),
        number_text(part_of(group, "measure")));
  }
  return rows;
}

std::string groups_table(const std::string& rows, bool has_colour) {
  if (rows.empty()) return "";
  return fmt::format(
      "<div class=\"wide\"><table><tr><th>Name</th><th></th><th>Kind</th>{}<th class=\"num\">Facets or cells</th>"
      "<th class=\"num\">Area, volume or length</th></tr>{}</table></div>",
      has_colour ? "<th>Colour in CAD</th>" : "", rows);
}

}  // namespace

bool misses_gate(const Json& r, const std::string& measure) {
  const Json& gates = part_of(r, "failed_gates");
  return std::any_of(gates.begin(), gates.end(),
                     [&](const Json& gate) { return gate.get<std::string>().starts_with(measure + " "); });
}

std::string main_measure(const Json& r) {
  for (const char* name : {"min_dihedral", "min_angle"})
    if (const Json& measure = part_of(measures_of(r), name); !part_of(measure, "worst").empty()) return name;
  return "";
}

std::string worst_section(const Json& r, const Mesh& mesh) {
  const std::vector<std::string> names = drawn_measures(r);
  std::vector<std::vector<std::uint32_t>> picks;
  for (const std::string& name : names)
    for (const Json& worst : part_of(part_of(measures_of(r), name.c_str()), "worst")) picks.push_back(ids_of(worst));
  if (picks.empty()) return "";
  const std::vector<CellPicture> pictures = draw_cells(mesh, picks);
  std::string text = "<h2>Worst cells</h2>";
  std::size_t next = 0;
  for (const std::string& name : names) {
    const Json& measure = part_of(measures_of(r), name.c_str());
    text += fmt::format("<p class=\"note\">{}{}</p><div class=\"cells\">", html(title_of(name)),
                        name == "min_dihedral" ? ", seen nearly along its edge (red); neighbours are thin lines" : "");
    std::size_t rank = 0;
    for (const Json& worst : part_of(measure, "worst")) text += card(++rank, worst, measure, pictures[next++]);
    text += "</div>";
  }
  return "<section class=\"long\">" + text + worst_of_all(r) + "</section>";
}

std::string quality_section(const Json& r) {
  std::string charts;
  if (const Json& fit = part_of(r, "size_fit"); !fit.is_null())
    charts += chart("Side over wanted size (1: as wanted)", "size_fit", part_of(fit, "ratio"), {});
  for (const auto& [name, measure] : measures_of(r).items())
    charts += chart(title_of(name), name, measure, marks_of(r, name));
  for (const Json& geometry : part_of(r, "geometry"))
    if (const Json& rounds = part_of(geometry, "rounds"); !rounds.empty()) {
      const Json& last = rounds.back();
      charts += fmt::format(
          "<figure><figcaption><b>Smallest angle of a facet, {}</b><br>min {}° · mean {}° · at most {} off the geometry"
          "</figcaption>{}</figure>",
          html(text_of(geometry, "file")), number_text(part_of(last, "min_angle")),
          number_text(part_of(last, "mean_min_angle")), number_text(part_of(part_of(last, "deviation"), "value")),
          histogram_svg(part_of(last, "angles"), "deg", {}));
    }
  if (charts.empty()) return "";
  return "<section class=\"long\"><h2>Quality</h2><p class=\"note\">Counts on a scale of powers of ten: few bad cells "
         "among "
         "many stay visible. Red bars miss the goal of improvement. The last bar holds all beyond it too.</p><div "
         "class=\"charts\">" +
         charts + "</div></section>";
}

std::string groups_section(const Json& r) {
  const bool is_planar = part_of(r, "regions").empty() && part_of(part_of(r, "surface"), "num_triangles") == 0 &&
                         !part_of(r, "curves").empty();
  const bool has_colour = has_colours(part_of(r, "boundaries"));
  const auto rows = [&](const char* key, const char* what) { return group_rows(part_of(r, key), what, has_colour); };
  std::string text = groups_table((is_planar ? rows("curves", "boundary") : "") +
                                      rows("boundaries", is_planar ? "region" : "boundary") + rows("regions", "region"),
                                  has_colour);
  const std::string rest =
      groups_table((is_planar ? "" : rows("curves", "curve")) + rows("points", "points"), has_colour);
  if (!rest.empty()) text += "<details><summary>Curves and points</summary>" + rest + "</details>";
  return text.empty() ? "" : "<section class=\"long\"><h2>Boundaries and regions</h2>" + text + "</section>";
}

}  // namespace delfront
