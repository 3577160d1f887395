// SPDX-License-Identifier: Apache-2.0
// Junctions and orientation: nothing here is an error, all of it is worth knowing.
#include <fmt/format.h>

#include <algorithm>

#include "geometry/surface_findings.hpp"

namespace delfront {
namespace {

Point middle_of(const Surface& surface, std::size_t edge) {
  const auto [a, b] = surface.edges.ends(edge);
  return 0.5 * (surface.model.points[a] + surface.model.points[b]);
}

void find_non_manifold_edges(const Surface& surface, std::vector<Finding>& findings) {
  Finding finding{"non_manifold_edges", Severity::note, 0, "", "", {}};
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto half_edges = surface.edges.half_edges(e);
    if (half_edges.size() < 3) continue;
    ++finding.count;
    std::vector<std::uint32_t> faces;
    for (std::uint32_t h : half_edges) faces.push_back(face_id(surface, h / 3));
    add_place(finding, middle_of(surface, e), std::move(faces));
    add_edge_outline(finding, surface, e);
  }
  if (finding.count == 0) return;
  finding.message = fmt::format("{} more than two facets, the first at {}",
                                count_of(finding.count, "edge has", "edges have"), text_of(finding.places[0].at));
  findings.push_back(std::move(finding));
}

/// Vertices whose triangles fall into several fans when only shared edges hold them together.
void find_pinched_vertices(const Surface& surface, std::vector<Finding>& findings) {
  DisjointSets corners(3 * surface.num_triangles());
  auto corner_at = [&](std::uint32_t half_edge, VertexId v) {
    return surface.start(half_edge) == v ? half_edge : half_edge / 3 * 3 + (half_edge + 1) % 3;
  };
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto half_edges = surface.edges.half_edges(e);
    for (VertexId v : surface.edges.ends(e))
      for (std::uint32_t h : half_edges) corners.join(corner_at(half_edges[0], v), corner_at(h, v));
  }
  Finding finding{"pinched_vertices", Severity::note, 0, "", "", {}};
  std::vector<std::uint32_t> fan(surface.points.size(), kNoTriangle);
  std::vector<bool> is_pinched(surface.points.size(), false);
  for (std::uint32_t c = 0; c < 3 * surface.num_triangles(); ++c) {
    if (!surface.has_edges[c / 3]) continue;
    const VertexId v = surface.start(c);
    const std::uint32_t root = corners.find(c);
    if (fan[v.index()] == kNoTriangle) fan[v.index()] = root;
    if (fan[v.index()] == root || is_pinched[v.index()]) continue;
    is_pinched[v.index()] = true;
    ++finding.count;
    add_place(finding, surface.model.points[v], {face_id(surface, fan[v.index()] / 3), face_id(surface, c / 3)});
  }
  if (finding.count == 0) return;
  finding.message =
      fmt::format("{} parts of the surface that share no edge there, the first at {}",
                  count_of(finding.count, "vertex joins", "vertices join"), text_of(finding.places[0].at));
  findings.push_back(std::move(finding));
}

/// Flips over simple edges; patches on which no turning of triangles removes them.
void find_flips(const Surface& surface, std::vector<Finding>& findings) {
  const std::size_t n = surface.num_triangles();
  DisjointSets sheets(2 * n);  // 2 t: triangle t as it is, 2 t + 1: turned
  Finding flips{"inconsistent_orientation", Severity::note, 0, "", "", {}};
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    const auto h = surface.edges.half_edges(e);
    if (h.size() != 2) continue;
    const bool is_flip = runs_up(surface, h[0]) == runs_up(surface, h[1]);
    const std::uint32_t s = h[0] / 3, t = h[1] / 3;
    sheets.join(2 * s, 2 * t + is_flip);
    sheets.join(2 * s + 1, 2 * t + !is_flip);
    if (!is_flip) continue;
    ++flips.count;
    add_place(flips, middle_of(surface, e), {face_id(surface, s), face_id(surface, t)});
    add_edge_outline(flips, surface, e);
  }
  if (flips.count > 0) {
    flips.message = fmt::format("two neighbouring facets face opposite ways over {}, the first at {}",
                                count_of(flips.count, "edge"), text_of(flips.places[0].at));
    flips.remedy = "closed shells are turned consistently before gridding";
    findings.push_back(std::move(flips));
  }
  Finding one_sided{"non_orientable_shell", Severity::note, 0, "", "", {}};
  for (std::uint32_t t = 0; t < n; ++t) {
    if (sheets.find(2 * t) != 2 * t || sheets.find(2 * t + 1) != 2 * t) continue;
    ++one_sided.count;
    add_place(one_sided, surface.centroid(t), {face_id(surface, t)});
  }
  if (one_sided.count == 0) return;
  one_sided.message =
      fmt::format("{} one side only (like a Moebius strip or a Klein bottle), the first holds facet {} at {}",
                  count_of(one_sided.count, "part of the surface has", "parts of the surface have"),
                  one_sided.places[0].ids[0], text_of(one_sided.places[0].at));
  findings.push_back(std::move(one_sided));
}

}  // namespace

void find_junctions(const Surface& surface, std::vector<Finding>& findings) {
  find_non_manifold_edges(surface, findings);
  find_pinched_vertices(surface, findings);
  find_flips(surface, findings);
}

void find_regions(const Surface& surface, const SurfaceShells& shells, std::vector<Finding>& findings) {
  if (shells.parent_shell.size() > 1) {
    std::size_t inside = 0;
    for (std::uint32_t parent : shells.parent_shell) inside += parent != kNoShell;
    findings.push_back({"components",
                        Severity::note,
                        shells.parent_shell.size(),
                        fmt::format("{} that share no edge, {} of them inside another",
                                    count_of(shells.parent_shell.size(), "part"), inside),
                        "",
                        {}});
  }
  const std::vector<SurfaceShells::Region> regions = shells.regions();
  if (regions.size() > 1) {
    std::string volumes;
    for (std::size_t i = 0; i < std::min<std::size_t>(regions.size(), 5); ++i)
      volumes += fmt::format("{}{:.6g}", i > 0 ? ", " : "", regions[i].volume);
    findings.push_back({"regions",
                        Severity::note,
                        regions.size(),
                        fmt::format("{} enclosed, of volume {}{}", count_of(regions.size(), "region is", "regions are"),
                                    volumes, regions.size() > 5 ? ", …" : ""),
                        "",
                        {}});
  }
  Finding sheets{"dangling_sheets", Severity::note, 0, "", "", {}};
  for (std::size_t t = 0; t < surface.num_triangles(); ++t) {
    if (!shells.is_sheet(t)) continue;
    ++sheets.count;
    add_place(sheets, surface.centroid(t), {face_id(surface, t)});
    add_triangle_outline(sheets, surface, t);
  }
  if (sheets.count == 0 || regions.empty()) return;
  sheets.message = fmt::format("{} the same region on both sides, the first is facet {} at {}",
                               count_of(sheets.count, "facet has", "facets have"), sheets.places[0].ids[0],
                               text_of(sheets.places[0].at));
  findings.push_back(std::move(sheets));
}

}  // namespace delfront
