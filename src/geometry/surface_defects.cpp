// SPDX-License-Identifier: Apache-2.0
// What makes a surface no PLC: facets without area, doubled, crossing, overlapping or touching outside of common
// corners and edges. Everything is decided by exact predicates.
#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.hpp"
#include "geometry/surface_findings.hpp"
#include "predicates/predicates.hpp"
#include "spatial/box_pairs.hpp"

namespace delfront {
namespace {

struct Pair {
  std::uint32_t first, second;
  Point where;
};

constexpr std::size_t kGroupsOfPart = 256, kPartsAtOnce = 64;

/// What was found in a part of the surface.
struct FoundPairs {
  std::vector<Pair> crossing, overlapping, touching;

  void look_at(const Surface& surface, std::uint32_t i, std::uint32_t j) {
    Point p[3], q[3], where;
    unsigned p_id[3], q_id[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = surface.corner(i, k);
      q[k] = surface.corner(j, k);
      p_id[k] = surface.corners(i)[std::size_t(k)].value;
      q_id[k] = surface.corners(j)[std::size_t(k)].value;
    }
    switch (classify_triangles(p, p_id, q, q_id, &where)) {
      case Crossing::none:
        return;
      case Crossing::crosses:
        crossing.push_back({i, j, where});
        return;
      case Crossing::overlaps:
        overlapping.push_back({i, j, where});
        return;
      case Crossing::touches:
        touching.push_back({i, j, where});
        return;
    }
  }
};

void append_pairs(const Surface& surface, std::vector<Pair>& pairs, const char* kind, const char* what,
                  const char* remedy, std::vector<Finding>& findings) {
  if (pairs.empty()) return;
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& a, const Pair& b) { return a.first != b.first ? a.first < b.first : a.second < b.second; });
  Finding finding{kind, Severity::error, pairs.size(), "", remedy, {}};
  for (const Pair& pair : pairs) {
    if (finding.places.size() >= kMaxPlaces) break;
    add_place(finding, pair.where / surface.scale, {face_id(surface, pair.first), face_id(surface, pair.second)});
    for (const std::uint32_t t : {pair.first, pair.second}) add_triangle_outline(finding, surface, t);
  }
  const Place& first = finding.places[0];
  finding.message = fmt::format("{} {}, the first are facets {} and {} at {}",
                                count_of(pairs.size(), "pair of facets", "pairs of facets"), what, first.ids[0],
                                first.ids[1], text_of(first.at));
  findings.push_back(std::move(finding));
}

}  // namespace

std::string text_of(Point p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

std::string count_of(std::size_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many.empty() ? one + "s" : many);
}

void add_place(Finding& finding, Point at, std::vector<std::uint32_t> ids) {
  if (finding.places.size() < kMaxPlaces) finding.places.push_back({at, std::move(ids)});
}

void add_edge_outline(Finding& finding, const Surface& surface, std::size_t edge) {
  if (finding.outlines.size() >= kMaxOutlines) return;
  const auto [a, b] = surface.edges.ends(edge);
  const std::uint32_t face = face_id(surface, surface.edges.half_edges(edge)[0] / 3);
  finding.outlines.push_back({face, {surface.model.points[a], surface.model.points[b]}});
}

void add_triangle_outline(Finding& finding, const Surface& surface, std::size_t t) {
  if (finding.outlines.size() >= kMaxOutlines) return;
  const auto [a, b, c] = surface.corners(t);
  const Array<VertexId, Point>& points = surface.model.points;
  finding.outlines.push_back({face_id(surface, t), {points[a], points[b], points[c]}});
}

void find_bad_triangles(const Surface& surface, std::vector<Finding>& findings) {
  Finding flat{"degenerate_triangles", Severity::error, 0, "", "remove them where the surface was made", {}};
  Finding twins{"duplicate_triangles", Severity::error, 0, "", "keep one facet of each set", {}};
  for (std::size_t t = 0; t < surface.num_triangles(); ++t) {
    if (surface.is_degenerate[t]) {
      ++flat.count;
      add_place(flat, surface.centroid(t), {face_id(surface, t)});
      add_triangle_outline(flat, surface, t);
    } else if (!surface.is_first(t)) {
      ++twins.count;
      add_place(twins, surface.centroid(t), {face_id(surface, surface.twin[t]), face_id(surface, t)});
      add_triangle_outline(twins, surface, t);
    }
  }
  if (flat.count > 0) {
    const Place& first = flat.places[0];
    flat.message = fmt::format("{} no area, the first is facet {} at {}",
                               count_of(flat.count, "triangle has", "triangles have"), first.ids[0], text_of(first.at));
    findings.push_back(std::move(flat));
  }
  if (twins.count > 0) {
    const Place& first = twins.places[0];
    twins.message = fmt::format("{} an earlier one, the first is facet {}, a copy of facet {} at {}",
                                count_of(twins.count, "triangle repeats", "triangles repeat"), first.ids[1],
                                first.ids[0], text_of(first.at));
    findings.push_back(std::move(twins));
  }
}

void find_intersections(const Surface& surface, std::vector<Finding>& findings, Context& context) {
  std::vector<Box> boxes(surface.num_triangles());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    if (surface.is_sound(t)) boxes[t] = surface.box(t);
  const BoxPairs pairs(boxes, context.threads);
  const std::size_t num_parts = (pairs.num_groups() + kGroupsOfPart - 1) / kGroupsOfPart;
  std::vector<FoundPairs> found(num_parts);
  for (std::size_t begin = 0; begin < num_parts; begin += kPartsAtOnce) {
    context.progress("check", begin, num_parts, "parts of the surface");
    parallel_for(context.threads, std::min(kPartsAtOnce, num_parts - begin), [&](std::size_t part) {
      const std::size_t first = (begin + part) * kGroupsOfPart;
      for (std::size_t g = first; g < std::min(first + kGroupsOfPart, pairs.num_groups()); ++g)
        pairs.for_each_pair(g, [&](std::uint32_t i, std::uint32_t j) { found[begin + part].look_at(surface, i, j); });
    });
  }
  std::vector<Pair> crossing, overlapping, touching;
  for (const FoundPairs& part : found) {
    crossing.insert(crossing.end(), part.crossing.begin(), part.crossing.end());
    overlapping.insert(overlapping.end(), part.overlapping.begin(), part.overlapping.end());
    touching.insert(touching.end(), part.touching.begin(), part.touching.end());
  }
  append_pairs(surface, crossing, "self_intersection", crossing.size() == 1 ? "crosses" : "cross",
               "cut the parts at each other (a boolean union) in the CAD tool", findings);
  append_pairs(surface, overlapping, "overlapping_triangles",
               overlapping.size() == 1 ? "overlaps in one plane" : "overlap in one plane",
               "unite the parts, or remove the doubled faces, in the CAD tool", findings);
  append_pairs(surface, touching, "t_junctions",
               touching.size() == 1 ? "touches outside of common corners and edges"
                                    : "touch outside of common corners and edges",
               "split the facets where vertices of others lie on them, so that neighbours share whole edges", findings);
}

}  // namespace delfront
