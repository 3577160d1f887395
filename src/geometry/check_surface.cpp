// SPDX-License-Identifier: Apache-2.0
// The order of the look: what is no PLC first, since shells and nesting can be computed for a PLC only; then openings,
// junctions, components, and what is merely hard.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "delfront/surface_check.hpp"
#include "geometry/shells.hpp"
#include "geometry/surface.hpp"
#include "geometry/surface_findings.hpp"

namespace delfront {
namespace {

double area_of(const Surface& surface, std::size_t t) {
  const Point a = surface.corner(t, 0);
  const double area = 0.5 * length(cross(surface.corner(t, 1) - a, surface.corner(t, 2) - a));
  return area / surface.scale / surface.scale;
}

void measure_sizes(const Surface& surface, SurfaceReport& report) {
  report.num_vertices = surface.points.size();
  report.num_triangles = surface.num_triangles();
  report.num_edges = surface.edges.size();
  report.box = surface.model.bounding_box();
  for (std::size_t t = 0; t < surface.num_triangles(); ++t) report.area += area_of(surface, t);
  double sum = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto [a, b] = surface.edges.ends(e);
    const double edge = distance(surface.points[a], surface.points[b]) / surface.scale;
    sum += edge;
    least = std::min(least, edge);
    report.max_edge = std::max(report.max_edge, edge);
  }
  if (surface.edges.size() == 0) return;
  report.min_edge = least;
  report.mean_edge = sum / double(surface.edges.size());
}

/// What edges say: closed, manifold, oriented; by component: does it have an open edge?
std::vector<bool> look_at_edges(const Surface& surface, const std::vector<std::uint32_t>& component,
                                std::uint32_t num_components, SurfaceReport& report) {
  std::vector<bool> is_open(num_components, false);
  report.is_closed = report.is_manifold = report.is_oriented = surface.edges.size() > 0;
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto half_edges = surface.edges.half_edges(e);
    if (half_edges.size() == 1) is_open[component[half_edges[0] / 3]] = true;
    if (half_edges.size() != 2) report.is_closed = false;
    if (half_edges.size() > 2) report.is_manifold = false;
    const auto up =
        std::count_if(half_edges.begin(), half_edges.end(), [&](std::uint32_t h) { return runs_up(surface, h); });
    if (half_edges.size() == 2 && up != 1) report.is_oriented = false;
  }
  for (const Finding& finding : report.findings)
    if (finding.kind == "pinched_vertices") report.is_manifold = false;
  return is_open;
}

/// Volume under a triangle, seen from `origin`, model units.
double volume_under(const Surface& surface, std::size_t t, Point origin) {
  const Point a = surface.corner(t, 0) - origin, b = surface.corner(t, 1) - origin, c = surface.corner(t, 2) - origin;
  return dot(a, cross(b, c)) / 6 / surface.scale / surface.scale / surface.scale;
}

/// Components with area, box and signed volume. The volume is that of the facets between outside and inside: internal
/// faces and sheets do not count.
void measure_components(const Surface& surface, const SurfaceShells* shells, SurfaceReport& report) {
  std::uint32_t num_components = 0;
  const std::vector<std::uint32_t> component = find_components(surface, num_components);
  const std::vector<bool> is_open = look_at_edges(surface, component, num_components, report);
  report.components.resize(num_components);
  std::vector<Point> origin(num_components);
  for (std::size_t t = 0; t < component.size(); ++t) {
    if (component[t] == kNoTriangle) continue;
    SurfaceComponent& part = report.components[component[t]];
    if (part.num_triangles++ == 0) origin[component[t]] = surface.corner(t, 0);
    part.area += area_of(surface, t);
    for (VertexId v : surface.corners(t)) part.box.add(surface.model.points[v]);
    const bool bounds = shells ? shells->shells[shells->front(t)].is_outer != shells->shells[shells->back(t)].is_outer
                               : !is_open[component[t]];
    if (bounds) part.signed_volume += volume_under(surface, t, origin[component[t]]);
  }
  std::vector<bool> encloses(num_components, shells == nullptr);
  if (shells)
    for (const Shell& shell : shells->shells)
      if (!shell.is_outer) encloses[shell.component] = true;
  for (std::uint32_t c = 0; c < num_components; ++c) {
    SurfaceComponent& part = report.components[c];
    part.is_closed = !is_open[c] && encloses[c];
    if (shells && shells->parent_shell[c] != kNoShell)
      part.inside_of = static_cast<int>(shells->shells[shells->parent_shell[c]].component);
    report.volume += part.signed_volume;
  }
}

/// A guess from the longest side, and from where it is: far from the origin are map coordinates.
std::string guess_unit(const Box& box) {
  constexpr double kSmallestInMetres = 0.02, kSmallestInMillimetres = 15, kLargestInMillimetres = 20000;
  const double side = box.longest_side();
  const std::string why = fmt::format("longest side {:.6g}", side);
  constexpr double kFarAway = 300;  ///< sides from the origin
  if (side > 0 && length(box.centre()) > kFarAway * side)
    return fmt::format("m ({}, placed like a map, {:.6g} from the origin)", why, length(box.centre()));
  if (side >= kSmallestInMetres && side < kSmallestInMillimetres) return fmt::format("m ({})", why);
  if (side >= kSmallestInMillimetres && side < kLargestInMillimetres) return fmt::format("mm ({})", why);
  return "";
}

/// Which shells the flips of orientation leave undecided: part of another's region, a hole or a region of its own?
void note_turned_shells(const Surface& surface, const SurfaceShells& shells, SurfaceReport& report) {
  const std::vector<bool> turn = find_triangles_to_turn(surface, shells);
  report.reoriented = std::size_t(std::count(turn.begin(), turn.end(), true));
  Finding undecided{"undecided_shells", Severity::warning, 0, "", "", {}};
  std::vector<bool> is_seen(shells.parent_shell.size(), false);
  for (std::size_t t = 0; t < turn.size(); ++t) {
    const std::uint32_t c = shells.component[t];
    if (!turn[t] || is_seen[c] || shells.parent_shell[c] == kNoShell) continue;
    is_seen[c] = true;
    ++undecided.count;
    add_place(undecided, surface.centroid(t), {face_id(surface, t)});
  }
  if (undecided.count == 0) return;
  undecided.message = fmt::format(
      "{} inside another mixed orientation, which leaves open whether it is a hole; it is taken "
      "as a region of its own (first at {})",
      count_of(undecided.count, "shell has", "shells have"), text_of(undecided.places[0].at));
  undecided.remedy = "turn its facets inwards for a hole, or choose regions with domain.keep";
  report.findings.push_back(std::move(undecided));
}

}  // namespace

SurfaceReport check_surface(const Model& model, Context& context) {
  StageTimer timer(context, "check");
  context.progress("check", 0, model.triangles.size(), "facets");
  const Surface surface(model);
  SurfaceReport report;
  measure_sizes(surface, report);
  report.likely_unit = guess_unit(report.box);
  find_bad_triangles(surface, report.findings);
  find_intersections(surface, report.findings, context);
  const bool is_plc = !has_errors(report.findings);
  SurfaceShells shells;
  if (is_plc) shells = find_shells(surface, context);
  const bool encloses = find_openings(surface, is_plc ? &shells : nullptr, report.findings);
  report.can_bound_volume = is_plc && encloses;
  find_junctions(surface, report.findings);
  measure_components(surface, is_plc ? &shells : nullptr, report);
  if (is_plc) {
    find_regions(surface, shells, report.findings);
    note_turned_shells(surface, shells, report);
  }
  find_curve_defects(surface, report.findings, context);
  report.can_bound_volume = report.can_bound_volume && !has_errors(report.findings);
  find_hard_places(surface, is_plc ? &shells : nullptr, report, context);
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return report;
}

std::size_t orient_shells(Model& model, Context& context) {
  const Surface surface(model);
  const std::vector<bool> turn = find_triangles_to_turn(surface, find_shells(surface, context));
  for (std::size_t t = 0; t < turn.size(); ++t)
    if (turn[t]) {
      std::swap(model.triangles[TriangleId(t)][1], model.triangles[TriangleId(t)][2]);
      if (t < model.sides.size()) std::swap(model.sides[TriangleId(t)][0], model.sides[TriangleId(t)][1]);
    }
  return std::size_t(std::count(turn.begin(), turn.end(), true));
}

}  // namespace delfront
