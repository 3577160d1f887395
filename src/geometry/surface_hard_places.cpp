// SPDX-License-Identifier: Apache-2.0
// Where a valid surface makes gridding hard: slivers, sharp edges, thin spots. Rounded arithmetic is enough here.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/angles.hpp"
#include "geometry/surface_findings.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

constexpr double kSliverAngleDeg = 1;
constexpr double kSmallDihedralDeg = 20;
constexpr double kThinGap = 0.5;  ///< of the facet's mean edge

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

struct Spot {
  double measure;  ///< the smaller the worse
  Point at;
  std::vector<std::uint32_t> triangles;
};

/// The worst first; the message gets the worst one's measure and place.
void append_spots(const Surface& surface, std::vector<Spot>& spots, Finding finding, const std::string& what,
                  std::vector<Finding>& findings) {
  if (spots.empty()) return;
  std::stable_sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) { return a.measure < b.measure; });
  finding.count = spots.size();
  finding.message = fmt::format("{}; the worst, {:.3g}, at {}", what, spots[0].measure, text_of(spots[0].at));
  if (spots.size() > kMaxPlaces) spots.resize(kMaxPlaces);
  for (const Spot& spot : spots) {
    std::vector<std::uint32_t> faces;
    for (const std::uint32_t t : spot.triangles) {
      faces.push_back(face_id(surface, t));
      add_triangle_outline(finding, surface, t);
    }
    add_place(finding, spot.at, std::move(faces));
  }
  findings.push_back(std::move(finding));
}

void find_slivers(const Surface& surface, SurfaceReport& report) {
  std::vector<Spot> spots;
  double smallest = 60;
  for (std::uint32_t t = 0; t < surface.num_triangles(); ++t) {
    const double angle = surface.is_degenerate[t]
                             ? 0
                             : smallest_angle_deg(surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2));
    smallest = std::min(smallest, angle);
    if (surface.is_sound(t) && angle < kSliverAngleDeg) spots.push_back({angle, surface.centroid(t), {t}});
  }
  report.min_angle_deg = surface.num_triangles() > 0 ? smallest : 0;
  append_spots(surface, spots,
               {"sliver_triangles", Severity::warning, 0, "", "re-mesh the surface for better cells there", {}},
               fmt::format("{} an angle under {:g} degree", count_of(spots.size(), "triangle has", "triangles have"),
                           kSliverAngleDeg),
               report.findings);
}

/// Angles of the wedges of space between the triangles about an edge; wedge i follows triangle order[i].
std::vector<double> wedge_angles(const Surface& surface, std::size_t edge, const std::vector<std::uint32_t>& order) {
  const auto [low, high] = surface.edges.ends(edge);
  const Point a = surface.points[low], axis = surface.points[high] - a;
  const Point unit = axis / length(axis);
  const Point zero = cross(unit, surface.points[surface.apex(order[0])] - a);  // a quarter turn past the first triangle
  std::vector<double> turned(order.size() + 1, 0.0);
  for (std::size_t i = 1; i < order.size(); ++i) {
    const Point at = cross(unit, surface.points[surface.apex(order[i])] - a);
    const double angle = std::atan2(dot(cross(zero, at), unit), dot(zero, at));
    turned[i] = std::max(turned[i - 1], angle < 0 ? angle + 2 * std::numbers::pi : angle);
  }
  turned.back() = std::max(turned[order.size() - 1], 2 * std::numbers::pi);
  std::vector<double> wedges(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) wedges[i] = turned[i + 1] - turned[i];
  return wedges;
}

void find_sharp_edges(const Surface& surface, const SurfaceShells* shells, SurfaceReport& report) {
  std::vector<Spot> spots;
  double smallest = 2 * std::numbers::pi;
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto half_edges = surface.edges.half_edges(e);
    const bool is_sound =
        std::all_of(half_edges.begin(), half_edges.end(), [&](std::uint32_t h) { return surface.is_sound(h / 3); });
    if (half_edges.size() < 2 || !is_sound) continue;
    const std::vector<std::uint32_t> order = sort_about_edge(surface, e);
    const std::vector<double> wedges = wedge_angles(surface, e, order);
    for (std::size_t i = 0; i < order.size(); ++i) {
      // The side that looks into wedge i; without shells either side may be the solid.
      const std::uint32_t t = order[i] / 3;
      const std::uint32_t shell = !shells ? kNoShell : runs_up(surface, order[i]) ? shells->front(t) : shells->back(t);
      const bool is_solid = !shells || !shells->shells[shell].is_outer ||
                            shells->parent_shell[shells->shells[shell].component] != kNoShell;
      if (is_solid) smallest = std::min(smallest, wedges[i]);
      if (degrees(wedges[i]) >= kSmallDihedralDeg) continue;
      const auto [a, b] = surface.edges.ends(e);
      spots.push_back({degrees(wedges[i]),
                       0.5 * (surface.model.points[a] + surface.model.points[b]),
                       {t, order[(i + 1) % order.size()] / 3}});
    }
  }
  report.min_dihedral_deg = smallest < 2 * std::numbers::pi ? degrees(smallest) : 0;
  append_spots(
      surface, spots,
      {"small_dihedral_angles", Severity::warning, 0, "", "cells along such edges cannot be better than these", {}},
      fmt::format("two facets meet at less than {:g} degrees at {}", kSmallDihedralDeg, count_of(spots.size(), "edge")),
      report.findings);
}

void find_thin_spots(const Surface& surface, SurfaceReport& report, Context& context) {
  const std::size_t n = surface.num_triangles();
  std::vector<std::array<Point, 3>> corners(n);
  for (std::size_t t = 0; t < n; ++t) corners[t] = {surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2)};
  const TriangleTree tree(std::move(corners));
  std::vector<Spot> spots;
  for (std::uint32_t t = 0; t < n; ++t) {
    if (t % 8192 == 0) context.progress("check", t, n, "facets");
    if (!surface.is_sound(t)) continue;
    const auto& [a, b, c] = tree.corners(t);
    const double edge = (distance(a, b) + distance(b, c) + distance(c, a)) / 3;
    const Point normal = cross(b - a, c - a);
    const Point reach = (kThinGap * edge / length(normal)) * normal;
    if (!is_finite(reach)) continue;
    const auto is_opposite = [&](std::uint32_t s) {
      if (!surface.is_sound(s)) return false;
      for (VertexId v : surface.corners(s))
        for (VertexId w : surface.corners(t))
          if (v == w) return false;
      return true;
    };
    for (const Point& way : {reach, -1.0 * reach}) {
      const TriangleTree::Hit hit = tree.first_on_ray((a + b + c) / 3, way, 1, is_opposite);
      if (hit.found()) spots.push_back({hit.distance * kThinGap, surface.centroid(t), {t, hit.triangle}});
    }
  }
  append_spots(surface, spots,
               {"thin_spots", Severity::warning, 0, "", "smaller triangles there give better cells in the gap", {}},
               fmt::format("{} an opposite facet nearer than half the own edge (gap over edge given)",
                           count_of(spots.size(), "facet has", "facets have")),
               report.findings);
}

}  // namespace

void find_hard_places(const Surface& surface, const SurfaceShells* shells, SurfaceReport& report, Context& context) {
  find_slivers(surface, report);
  find_sharp_edges(surface, shells, report);
  if (shells) find_thin_spots(surface, report, context);  // facets that cross would all be called thin
}

}  // namespace delfront
