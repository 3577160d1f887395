// SPDX-License-Identifier: Apache-2.0
#include "pipeline/facts_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "pipeline/report_json.hpp"

namespace delfront {

namespace {

constexpr const char* kUnnamedCurve = "curve_";  ///< and its number: what edges without a name are called
constexpr std::size_t kMostUnnamed = 12;         ///< of these in a list
constexpr std::size_t kMostNamed = 100;          ///< groups of one dimension in a list

const char* yes_no(bool value) { return value ? "yes" : "no"; }

/// To three digits: more would be made up.
std::size_t rounded(double value) {
  const double unit = std::pow(10, std::max(0.0, std::floor(std::log10(std::max(value, 1.0))) - 2));
  return static_cast<std::size_t>(std::min(unit * std::round(value / unit), 1e18));
}

}  // namespace

constexpr std::size_t kMostIds = 8;  // of a place

std::string findings_text(const std::vector<Finding>& findings, std::size_t places_shown) {
  std::string text;
  std::vector<const Finding*> sorted;
  for (const Finding& f : findings) sorted.push_back(&f);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Finding* a, const Finding* b) { return a->severity > b->severity; });
  for (const Finding* f : sorted) {
    text +=
        fmt::format("{:<8} {:<26} {:>9}  {}\n", severity_name(f->severity), f->kind, with_commas(f->count), f->message);
    for (std::size_t i = 0; i < std::min(places_shown, f->places.size()); ++i) {
      const Place& place = f->places[i];
      const std::size_t shown = std::min(place.ids.size(), kMostIds);
      text += fmt::format("{:>45}  at ({:.9g}, {:.9g}, {:.9g}), ids {}{}\n", "", place.at.x, place.at.y, place.at.z,
                          fmt::join(place.ids.begin(), place.ids.begin() + static_cast<std::ptrdiff_t>(shown), " "),
                          shown < place.ids.size() ? " …" : "");
    }
    if (!f->remedy.empty()) text += fmt::format("{:>45}  try: {}\n", "", f->remedy);
  }
  return text;
}

std::string quality_text(const QualityReport& report, std::size_t worst_shown) {
  std::string text;
  const bool is_planar = !report.find("min_dihedral");
  text += fmt::format("{:<14} {:.9g}\n", is_planar ? "area" : "volume", report.volume);
  text += fmt::format("{:<14} {:>11} {:>11} {:>11}\n", "quality", "min", "mean", "max");
  for (const Measure& m : report.measures) {
    text += fmt::format("  {:<12} {:>11.4g} {:>11.4g} {:>11.4g}{}{}\n", m.name, m.min, m.mean, m.max,
                        m.unit.empty() ? "" : " ", m.unit);
    for (std::size_t i = 0; i < std::min({worst_shown, m.worst.size(), m.worst_values.size()}); ++i) {
      const Point at = m.worst[i].at;
      text += fmt::format("      {:>11.5g}  at ({:.6g}, {:.6g}, {:.6g}), cell {}\n", m.worst_values[i], at.x, at.y,
                          at.z, fmt::join(m.worst[i].ids, " "));
    }
  }
  text += fmt::format("  cells with {} angle below 5 deg: {}, below 10 deg: {}\n", is_planar ? "an" : "a dihedral",
                      with_commas(report.cells_below_5_deg), with_commas(report.cells_below_10_deg));
  return text;
}

std::string mesh_facts_text(const Mesh& mesh) {
  std::string text = fmt::format("points         {}\n", with_commas(mesh.points.size()));
  for (const CellBlock& block : mesh.blocks)
    if (block.size()) text += fmt::format("{:<14} {}\n", name_of(block.type), with_commas(block.size()));
  std::vector<std::size_t> count(mesh.groups.size());
  for (const CellBlock& block : mesh.blocks)
    for (const GroupId group : block.group)
      if (group.is_valid() && group.index() < count.size()) ++count[group.index()];
  for (const auto& [codimension, title] : {std::pair{0, "regions"}, {1, "patches"}, {2, "curves"}}) {
    const int dim = mesh.dimension - codimension;
    if (dim < 1) continue;
    std::string line;
    std::size_t unnamed = 0, named = 0;
    for (std::size_t g = 0; g < count.size(); ++g) {
      const Group& group = mesh.groups[GroupId(g)];
      if (group.dimension != dim) continue;
      if (codimension == 2 && group.name.starts_with(kUnnamedCurve) && ++unnamed > kMostUnnamed) continue;
      if (++named > kMostNamed) continue;
      line += fmt::format("{}{} ({}{}{})", line.empty() ? "" : ", ", group.name, with_commas(count[g]),
                          group.kind.empty() ? "" : ", ", group.kind);
    }
    if (named > kMostNamed) line += fmt::format(" and {} more, which a report lists", with_commas(named - kMostNamed));
    if (unnamed > kMostUnnamed) line += fmt::format(" and {} more without names", with_commas(unnamed - kMostUnnamed));
    if (!line.empty()) text += fmt::format("{:<14} {}\n", title, line);
  }
  const Box box = mesh.bounding_box();
  if (!box.is_empty())
    text += fmt::format("box            ({:.9g}, {:.9g}, {:.9g}) to ({:.9g}, {:.9g}, {:.9g})\n", box.low.x, box.low.y,
                        box.low.z, box.high.x, box.high.y, box.high.z);
  return text;
}

std::string surface_facts_text(const SurfaceReport& r) {
  std::string text =
      fmt::format("closed         {}; manifold {}; oriented {}; can bound a volume {}\n", yes_no(r.is_closed),
                  yes_no(r.is_manifold), yes_no(r.is_oriented), yes_no(r.can_bound_volume));
  text += fmt::format("area           {:.9g}\n", r.area);
  if (r.is_closed)
    text += fmt::format("volume         {:.9g}{}\n", std::abs(r.volume),
                        r.volume < 0 ? ", inside out: its faces look inwards (they are turned for a grid)" : "");
  text += fmt::format("edges          {:.4g} to {:.4g}, mean {:.4g}\n", r.min_edge, r.max_edge, r.mean_edge);
  text += fmt::format("angles         of triangles from {:.3g} deg; between neighbours from {:.3g} deg\n",
                      r.min_angle_deg, r.min_dihedral_deg);
  if (!r.likely_unit.empty()) text += fmt::format("unit           probably {}\n", r.likely_unit);
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(kShown, r.components.size()); ++i) {
    const SurfaceComponent& c = r.components[i];
    text += fmt::format("component {:<4} {} triangles, {}{}\n", i, with_commas(c.num_triangles),
                        c.is_closed ? fmt::format("closed, volume {:.6g}{}", std::abs(c.signed_volume),
                                                  c.signed_volume < 0 ? ", faces look inwards" : "")
                                    : "open",
                        c.inside_of >= 0 ? fmt::format(", inside component {}", c.inside_of) : "");
  }
  if (r.components.size() > kShown)
    text += fmt::format("               and {} more components\n", r.components.size() - kShown);
  return text;
}

std::string estimate_text(const Estimate& e, std::uint64_t max_cells) {
  std::string text =
      fmt::format("cells          {}{}\n", e.is_at_least ? "at least " : "about ", with_commas(rounded(e.cells)));
  if (max_cells > 0 && e.cells > static_cast<double>(max_cells))
    text += fmt::format("limit          limits.max_cells is {}: mesh would stop there\n", with_commas(max_cells));
  text += fmt::format("points         about {}\n", with_commas(rounded(e.points)));
  text += fmt::format("sizes          {:.4g} to {:.4g}\n", e.least_size, e.greatest_size);
  text += fmt::format("memory         about {}\n", e.memory < 1e9 ? fmt::format("{:.0f} MB", e.memory / 1e6)
                                                                  : fmt::format("{:.1f} GB", e.memory / 1e9));
  text += fmt::format("time           about {}\n",
                      e.seconds < 120 ? fmt::format("{:.2g} s", e.seconds) : fmt::format("{:.0f} min", e.seconds / 60));
  return text;
}

}  // namespace delfront
