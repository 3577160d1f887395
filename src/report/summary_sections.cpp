// SPDX-License-Identifier: Apache-2.0
// What is read first: how it ended, the figures, what is wrong, warnings.
#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "base/with_commas.hpp"
#include "report/sections.hpp"

namespace delfront {

namespace {

std::size_t count_of(const Json& value, const char* key) {
  const Json& count = part_of(value, key);
  return count.is_number() ? count.get<std::size_t>() : 0;
}

const Json& quality_of(const Json& r) { return part_of(r, "quality"); }
const Json& measure_of(const Json& r, const char* name) { return part_of(part_of(quality_of(r), "measures"), name); }

bool has_errors_in(const Json& findings) {
  for (const Json& finding : findings)
    if (text_of(finding, "severity") == "error") return true;
  return false;
}

/// A sentence begins with a capital letter and ends with a stop.
std::string sentence(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z' && text.find(' ') != std::string::npos)
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text.empty() || text.ends_with('.') ? text : text + ".";
}

std::string joined(const Json& list) {
  std::string text;
  for (const Json& item : list) text += (text.empty() ? "" : ", ") + item.get<std::string>();
  return text;
}

/// "12,345 cells, 2,345 points, smallest dihedral angle 12.3°".
std::string grid_words(const Json& r) {
  const Json& quality = quality_of(r);
  std::string words =
      plural(count_of(quality, "num_cells"), "cell") + ", " + plural(count_of(quality, "num_points"), "point");
  if (const Json& angle = measure_of(r, "min_dihedral"); !angle.is_null())
    words += fmt::format(", smallest dihedral angle {}°", number_text(part_of(angle, "min")));
  else if (const Json& corner = measure_of(r, "min_angle"); !corner.is_null())
    words += fmt::format(", smallest angle {}°", number_text(part_of(corner, "min")));
  return words;
}

struct Verdict {
  const char *kind, *mark;
  std::string words, more;
};

/// A run that is done, or whose grid misses a gate.
Verdict verdict_of_grid(const Json& r) {
  const Json& findings = part_of(r, "grid_findings");
  if (has_errors_in(findings)) return {"bad", "✗", "The grid is not valid: " + grid_words(r) + ".", ""};
  const std::string name = findings.is_null() ? "Grid" : "Valid grid";
  if (text_of(r, "outcome") == "gate_not_met")
    return {"warn", "!", name + ", but " + joined(part_of(r, "failed_gates")) + ".", sentence(grid_words(r))};
  const std::string gates = text_of(part_of(part_of(r, "options"), "output"), "require");
  const bool is_looked_at = !findings.is_null();
  return {"good", "✓", name + ": " + grid_words(r) + ".",
          (gates.empty() ? "" : "All gates are met: " + gates + ". ") +
              (is_looked_at ? "Looked at exactly: every cell is positive, faces match, the boundary is closed." : "")};
}

Verdict verdict_without_grid(const Json& r) {
  if (const Json& estimate = part_of(r, "estimate"); !estimate.is_null()) {
    const bool is_least = part_of(estimate, "is_at_least") == true;
    return {"good", "✓",
            fmt::format("{} {:.3g} cells are to be expected.", is_least ? "At least" : "About",
                        part_of(estimate, "cells").is_number() ? estimate["cells"].get<double>() : 0.0),
            ""};
  }
  std::size_t facets = 0;
  for (const Json& group : part_of(r, "boundaries")) facets += count_of(group, "num_cells");
  const bool is_written = !part_of(r, "files_written").empty();
  if (facets == 0) return {"good", "✓", "Done.", ""};
  return {"good", "✓", fmt::format("Surface {}: {}.", is_written ? "written" : "looked at", plural(facets, "facet")),
          part_of(part_of(r, "surface"), "can_bound_volume") == true ? "It is valid and can bound a volume." : ""};
}

Verdict verdict_of(const Json& r) {
  const std::string outcome = text_of(r, "outcome");
  const bool has_grid = count_of(quality_of(r), "num_cells") > 0;
  if (outcome == "gate_not_met" || (outcome == "done" && has_grid)) return verdict_of_grid(r);
  if (outcome == "done") return verdict_without_grid(r);
  const bool is_stopped = outcome == "limit_reached" || outcome == "interrupted";
  const std::string stage = text_of(r, "stage");
  return {is_stopped ? "warn" : "bad", is_stopped ? "!" : "✗", "No grid. " + sentence(text_of(r, "error")),
          fmt::format("Exit code {} ({}){}.", part_of(r, "exit_code").get<int>(), outcome,
                      stage.empty() ? "" : fmt::format(", in the stage “{}”", stage))};
}

std::string tile(const std::string& value, const std::string& what, const char* kind = "") {
  return fmt::format("<div class=\"tile {}\"><b>{}</b><span>{}</span></div>", kind, html(value), html(what));
}

/// A measure against the goal that improvement had.
std::string goal_tile(const Json& r, const char* measure, const char* end, const char* what, const Json& goal,
                      bool is_least) {
  const Json& value = part_of(measure_of(r, measure), end);
  if (!value.is_number()) return "";
  if (misses_gate(r, measure)) return tile(number_text(value) + "°", std::string(what) + " (gate not met)", "bad");
  if (!goal.is_number()) return tile(number_text(value) + "°", what);
  const bool is_met = is_least ? value.get<double>() >= goal.get<double>() : value.get<double>() <= goal.get<double>();
  return tile(number_text(value) + "°", fmt::format("{} (goal {:g}°)", what, goal.get<double>()),
              is_met ? "good" : "warn");
}

std::string memory_text(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
}

std::string quality_tiles(const Json& r) {
  const Json& quality = quality_of(r);
  if (count_of(quality, "num_cells") == 0) return "";
  const Json& goals = part_of(part_of(part_of(r, "options"), "improve"), "goals");
  const bool is_planar = measure_of(r, "min_dihedral").is_null();
  std::string tiles =
      tile(count_text(part_of(quality, "num_cells")), "cells") +
      tile(count_text(part_of(quality, "num_points")), "points") +
      tile(count_text(part_of(quality, "num_boundary_faces")), is_planar ? "boundary edges" : "boundary faces");
  const Json& least = part_of(part_of(part_of(r, "options"), "planar"), "min_angle");
  tiles += is_planar
               ? goal_tile(r, "min_angle", "min", "smallest angle", least, true)
               : goal_tile(r, "min_dihedral", "min", "smallest dihedral angle", part_of(goals, "min_dihedral"), true);
  if (!is_planar) {
    tiles += goal_tile(r, "max_nonortho", "max", "largest non-orthogonality", part_of(goals, "max_nonortho"), false);
    const std::size_t thin = count_of(quality, "cells_below_5_deg");
    tiles += tile(with_commas(thin), "cells below 5°", thin ? "bad" : "good");
  }
  if (const Json& share = part_of(part_of(r, "size_fit"), "share_of_right_sides"); share.is_number())
    tiles += tile(fmt::format("{:.1f} %", 100 * share.get<double>()), "of sides 0.7 to 1.4 of the wanted size");
  return tiles;
}

/// @param all  how many there are; the report may hold the first of them only
std::string places_list(const Json& places, std::size_t all, std::size_t most) {
  std::string rows;
  const std::size_t shown = std::min(most, places.size());
  for (std::size_t i = 0; i < shown; ++i) {
    const std::string ids = ids_text(part_of(places[i], "ids"));
    rows += fmt::format("<li class=\"mono\">at {}{}</li>", point_text(part_of(places[i], "at")),
                        ids.empty() ? "" : ", number " + ids);
  }
  if (rows.empty()) return "";
  const std::size_t rest = std::max(all, places.size()) - shown;
  return "<ul>" + rows + (rest ? fmt::format("<li>and {} more</li>", with_commas(rest)) : "") + "</ul>";
}

std::string finding_row(const Json& finding) {
  constexpr std::size_t kPlaces = 5;
  const std::string severity = text_of(finding, "severity"), remedy = text_of(finding, "remedy");
  return fmt::format(
      "<tr><td><span class=\"word {}\">{}</span></td><td class=\"kind\">{}</td><td "
      "class=\"num\">{}</td><td>{}{}{}</td></tr>",
      html(severity), html(severity), html(text_of(finding, "kind")), count_text(part_of(finding, "count")),
      html(text_of(finding, "message")), remedy.empty() ? "" : "<p class=\"note\">Try: " + html(remedy) + "</p>",
      places_list(part_of(finding, "places"), count_of(finding, "count"), kPlaces));
}

/// @param severities  those shown, in this order
std::string findings_table(const Json& findings, std::initializer_list<const char*> severities) {
  std::string rows;
  for (const char* severity : severities)
    for (const Json& finding : findings)
      if (text_of(finding, "severity") == severity) rows += finding_row(finding);
  if (rows.empty()) return "";
  return "<div class=\"wide\"><table><tr><th></th><th>What</th><th class=\"num\">How many</th><th>Where</th></tr>" +
         rows + "</table></div>";
}

void add_item(std::string& list, const std::string& text) { list += "<li>" + html(text) + "</li>"; }

/// What the grid is not as it was given.
std::string changes_list(const Json& r) {
  std::string list;
  const auto say = [&](std::size_t count, const std::string& what, const std::string& done) {
    if (count) add_item(list, plural(count, what) + " " + done);
  };
  say(count_of(part_of(r, "surface"), "reoriented"), "facet", "turned, so that closed shells are consistent");
  const Json& recovery = part_of(r, "recovery");
  say(count_of(recovery, "steiner_left"), "point", "left on the given facets, which are divided there");
  for (const Json& left : part_of(recovery, "left"))
    if (list.size() < 4000)
      add_item(list, "divided at " + point_text(part_of(left, "at")) + ": " + text_of(left, "why"));
  for (const Json& fallback : part_of(part_of(r, "surface_grid"), "fallbacks"))
    add_item(list, fmt::format("piece of “{}” at {}: {} ({})", text_of(fallback, "patch"),
                               point_text(part_of(fallback, "at")),
                               text_of(fallback, "kind") == "kept" ? "the given triangles stayed"
                                                                   : "the given triangles were changed locally",
                               text_of(fallback, "why")));
  for (const Json& geometry : part_of(r, "geometry")) {
    say(part_of(geometry, "bridges").size(), "place",
        "narrower than hmin gridded across in " + text_of(geometry, "file"));
    if (const std::string stopped = text_of(geometry, "stopped"); !stopped.empty()) add_item(list, stopped);
  }
  if (const std::string why = text_of(part_of(r, "front"), "gave_up"); !why.empty())
    add_item(list, "no front, refinement took its place: " + why);
  const Json& levels = r.contains("levels") && r["levels"].is_object() ? r["levels"] : r;
  say(count_of(levels, "halved"), "new boundary point", "moved only halfway to the geometry, for valid cells");
  say(count_of(levels, "reversed"), "new boundary point", "put back in the middle of the edge, for valid cells");
  for (const Json& change : part_of(r, "name_changes")) add_item(list, change.get<std::string>());
  return list;
}

}  // namespace

std::string verdict_section(const Json& r) {
  const Verdict verdict = verdict_of(r);
  return fmt::format(
      "<div class=\"verdict {}\" role=\"status\"><span class=\"mark\">{}</span><div class=\"words\">{}{}</div></div>",
      verdict.kind, verdict.mark, html(verdict.words), verdict.more.empty() ? "" : "<p>" + html(verdict.more) + "</p>");
}

std::string tiles_section(const Json& r) {
  std::string tiles = quality_tiles(r);
  if (const Json& estimate = part_of(r, "estimate"); !estimate.is_null()) {
    tiles +=
        tile(number_text(part_of(estimate, "least_size")) + " to " + number_text(part_of(estimate, "greatest_size")),
             "sizes");
    if (part_of(estimate, "memory_bytes").is_number())
      tiles += tile(memory_text(estimate["memory_bytes"].get<double>()), "memory, about");
    if (part_of(estimate, "seconds").is_number())
      tiles += tile(seconds_text(estimate["seconds"].get<double>()), "time, about");
  }
  const std::size_t warnings = part_of(r, "warnings").size();
  tiles += tile(with_commas(warnings), warnings == 1 ? "warning" : "warnings", warnings ? "warn" : "good");
  if (part_of(r, "seconds").is_number()) tiles += tile(seconds_text(r["seconds"].get<double>()), "time");
  if (part_of(r, "peak_memory_bytes").is_number())
    tiles += tile(memory_text(r["peak_memory_bytes"].get<double>()), "peak memory");
  return "<div class=\"tiles\">" + tiles + "</div>";
}

std::string problems_section(const Json& r) {
  constexpr std::size_t kPlaces = 20;
  std::string text = findings_table(part_of(part_of(r, "surface"), "findings"), {"error"});
  text += findings_table(part_of(r, "grid_findings"), {"error", "warning"});
  if (text.empty()) text = places_list(part_of(r, "places"), 0, kPlaces);  // else they are those of the findings
  for (const Json& gate : part_of(r, "failed_gates"))
    text += "<p>Gate not met: " + html(gate.get<std::string>()) + "</p>";
  for (const auto& [key, what] :
       {std::pair{"defects_file", "Every place, to look at: "}, {"partial_file", "The grid as far as it came: "}})
    if (const std::string file = text_of(r, key); !file.empty())
      text += "<p>" + std::string(what) + "<code>" + html(file) + "</code></p>";
  return text.empty() ? "" : "<section class=\"long\"><h2>What is wrong</h2>" + text + "</section>";
}

std::string warnings_section(const Json& r) {
  std::string warnings;
  for (const Json& warning : part_of(r, "warnings")) add_item(warnings, warning.get<std::string>());
  const std::string changes = changes_list(r);
  std::string text;
  if (!warnings.empty()) text += "<h2>Warnings</h2><ul>" + warnings + "</ul>";
  if (!changes.empty()) text += "<h2>Changed on the way</h2><ul>" + changes + "</ul>";
  return text.empty() ? "" : "<section class=\"long\">" + text + "</section>";
}

std::string surface_section(const Json& r) {
  const Json& surface = part_of(r, "surface");
  if (count_of(surface, "num_triangles") == 0 && part_of(surface, "findings").empty()) return "";
  const auto yes_no = [&](const char* key) { return part_of(surface, key) == true ? "yes" : "no"; };
  const auto row = [](const std::string& what, const std::string& value) {
    return "<tr><td>" + what + "</td><td class=\"num\">" + value + "</td></tr>";
  };
  std::string rows =
      row("Triangles", count_text(part_of(surface, "num_triangles"))) +
      row("Points", count_text(part_of(surface, "num_vertices"))) +
      row("Closed, manifold, can bound a volume",
          fmt::format("{}, {}, {}", yes_no("is_closed"), yes_no("is_manifold"), yes_no("can_bound_volume"))) +
      row("Components", count_text(part_of(surface, "components").size())) +
      row("Area", number_text(part_of(surface, "area"))) +
      row("Volume inside", part_of(surface, "is_closed") == true ? number_text(part_of(surface, "volume")) : "–") +
      row("Edges", number_text(part_of(surface, "min_edge")) + " to " + number_text(part_of(surface, "max_edge"))) +
      row("Smallest angle of a triangle", number_text(part_of(surface, "min_angle")) + "°") +
      row("Smallest angle between neighbours", number_text(part_of(surface, "min_dihedral")) + "°");
  if (count_of(surface, "num_triangles") == 0) rows.clear();
  std::string text = rows.empty() ? "" : "<table class=\"facts\">" + rows + "</table>";
  text += findings_table(part_of(surface, "findings"), {"warning", "note"});  // errors stand above
  return text.empty() ? "" : "<section><h2>The surface</h2>" + text + "</section>";
}

}  // namespace delfront
