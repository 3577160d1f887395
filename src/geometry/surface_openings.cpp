// SPDX-License-Identifier: Apache-2.0
// Open edges, the loops they form, and whether a region is enclosed all the same.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/surface_findings.hpp"
#include "spatial/bvh.hpp"

namespace delfront {
namespace {

struct Loop {
  std::vector<std::uint32_t> edges;
  double perimeter = 0;
  Point centre;  ///< mean of its edges' middles
};

/// Edges with one facet, without later copies of facets if asked.
std::vector<std::uint32_t> open_edges(const Surface& surface, bool with_copies) {
  std::vector<std::uint32_t> open;
  for (std::uint32_t e = 0; e < surface.edges.size(); ++e) {
    const auto half_edges = surface.edges.half_edges(e);
    const auto counts = [&](std::uint32_t h) { return with_copies || surface.is_first(h / 3); };
    if (std::count_if(half_edges.begin(), half_edges.end(), counts) == 1) open.push_back(e);
  }
  return open;
}

/// Connected sets of open edges, the longest first.
std::vector<Loop> find_loops(const Surface& surface, const std::vector<std::uint32_t>& open) {
  DisjointSets sets(surface.points.size());
  for (std::uint32_t e : open) sets.join(surface.edges.ends(e)[0].value, surface.edges.ends(e)[1].value);
  std::vector<std::uint32_t> loop_of_root(surface.points.size(), kNoTriangle);
  std::vector<Loop> loops;
  for (std::uint32_t e : open) {
    const auto [a, b] = surface.edges.ends(e);
    std::uint32_t& index = loop_of_root[sets.find(a.value)];
    if (index == kNoTriangle) {
      index = static_cast<std::uint32_t>(loops.size());
      loops.emplace_back();
    }
    const Point p = surface.model.points[a], q = surface.model.points[b];
    loops[index].edges.push_back(e);
    loops[index].perimeter += distance(p, q);
    loops[index].centre = loops[index].centre + 0.5 * (p + q);
  }
  for (Loop& loop : loops) loop.centre = loop.centre / double(loop.edges.size());
  std::stable_sort(loops.begin(), loops.end(),
                   [](const Loop& a, const Loop& b) { return a.edges.size() > b.edges.size(); });
  return loops;
}

/// How far most open vertices are from an open edge that is not theirs, where that is little beside their edges: then
/// the holes are seams whose two sides do not match. 0: they are not.
double seam_width(const Surface& surface, const std::vector<std::uint32_t>& open, double mean_edge) {
  std::vector<std::array<Point, 3>> segments;
  for (std::uint32_t e : open) {
    const auto [a, b] = surface.edges.ends(e);
    segments.push_back({surface.model.points[a], surface.model.points[b], surface.model.points[b]});
  }
  const TriangleTree tree(std::move(segments));
  std::vector<double> gaps;
  std::vector<bool> seen(surface.points.size(), false);
  for (std::uint32_t e : open) {
    for (VertexId v : surface.edges.ends(e)) {
      if (seen[v.index()]) continue;
      seen[v.index()] = true;
      const auto is_other = [&](std::uint32_t i) {
        const auto [a, b] = surface.edges.ends(open[i]);
        return a != v && b != v;
      };
      gaps.push_back(tree.nearest_if(surface.model.points[v], is_other).distance);
    }
  }
  const auto most = gaps.begin() + std::ptrdiff_t(gaps.size() * 3 / 4);
  std::nth_element(gaps.begin(), most, gaps.end());
  return *most < 0.02 * mean_edge ? *most : 0;
}

Finding describe(const Surface& surface, const std::vector<std::uint32_t>& open, bool encloses, bool is_plc) {
  Finding finding{"open_edges", encloses ? Severity::warning : Severity::error, open.size(), "", "", {}};
  const std::vector<Loop> loops = find_loops(surface, open);
  double total = 0;
  for (const Loop& loop : loops) {
    std::vector<std::uint32_t> faces;
    for (std::uint32_t e : loop.edges)
      if (faces.size() < kMaxPlaces) faces.push_back(face_id(surface, surface.edges.half_edges(e)[0] / 3));
    add_place(finding, loop.centre, std::move(faces));
    for (std::uint32_t e : loop.edges) add_edge_outline(finding, surface, e);
    total += loop.perimeter;
  }
  constexpr std::size_t kNamed = 3;
  std::string where;
  for (std::size_t i = 0; i < std::min(kNamed, loops.size()); ++i)
    where += fmt::format("{}{} of length {:.6g} around {}", i > 0 ? ", " : "", count_of(loops[i].edges.size(), "edge"),
                         loops[i].perimeter, text_of(loops[i].centre));
  finding.message = fmt::format("{} in {}: {}{}; {}", count_of(open.size(), "open edge"),
                                count_of(loops.size(), "loop"), where, loops.size() > kNamed ? ", …" : "",
                                !encloses ? "the surface bounds no volume"
                                : is_plc  ? "a region is enclosed all the same, the facets there are taken as sheets"
                                          : "other parts of the surface are closed");
  if (encloses) {
    finding.remedy = "nothing, if these are baffles; else close the holes";
  } else if (const double seam = seam_width(surface, open, total / double(open.size())); seam > 0) {
    finding.remedy = fmt::format(
        "most open edges lie within {:.2g} of each other: merge the points along these seams, "
        "with a tolerance a little above that, in the CAD or mesh tool",
        seam);
  } else {
    finding.remedy =
        "close the holes in the CAD or mesh tool (for flow around an open sheet: give the outer boundary as "
        "part of the surface)";
  }
  return finding;
}

}  // namespace

bool find_openings(const Surface& surface, const SurfaceShells* shells, std::vector<Finding>& findings) {
  bool encloses = false;
  if (shells) {
    encloses = !shells->regions().empty();
  } else {
    const std::vector<bool> is_peeled = peel_open_triangles(surface);
    encloses = std::find(is_peeled.begin(), is_peeled.end(), false) != is_peeled.end();
  }
  std::vector<std::uint32_t> open = open_edges(surface, true);
  if (open.empty() && !encloses) open = open_edges(surface, false);  // a sheet, doubled facet for facet
  if (!open.empty()) findings.push_back(describe(surface, open, encloses, shells != nullptr));
  if (open.empty() && !encloses)
    findings.push_back({"encloses_nothing",
                        Severity::error,
                        1,
                        "the surface has no open edge, yet both sides of every facet see the same part of space: it "
                        "bounds no volume",
                        "add the facets that close it off",
                        {}});
  return encloses;
}

}  // namespace delfront
