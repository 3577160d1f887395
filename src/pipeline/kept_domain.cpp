// SPDX-License-Identifier: Apache-2.0
#include "pipeline/kept_domain.hpp"

#include <array>
#include <vector>

namespace delfront {

KeptDomain::KeptDomain(const Prepared& prepared) {
  const TetComplex& c = prepared.grid.complex;
  std::vector<std::array<Point, 3>> border;
  for (TetIndex t = 0; t < c.num_slots(); ++t) {
    if (c.is_dead(t) || c.is_ghost(t)) continue;
    for (FaceRef ref = 4 * t; ref < 4 * t + 4; ++ref) {
      if (!c.is_ghost(c.neigh[ref] >> 2)) continue;
      const auto n = c.face_nodes(ref);
      border.push_back({c.point(n[0]), c.point(n[1]), c.point(n[2])});
    }
  }
  surface_ = std::make_unique<FacetSurface>(std::move(border), true);
}

KeptDomain::KeptDomain(const PlanarPrepared& prepared) {
  const TriComplex& c = prepared.grid.complex;
  std::vector<Box> boxes;
  for (const PlanarPiece& piece : prepared.grid.pieces) {
    const EdgeRef ref = c.find_edge(piece.a, piece.b);
    if ((c.tri[ref >> 2].region == kOutside) == (c.tri[c.across(ref) >> 2].region == kOutside)) continue;
    const Point2 a = c.point[piece.a], b = c.point[piece.b];
    segments_.push_back({Point{a.x, a.y, 0}, Point{b.x, b.y, 0}});
    Box& box = boxes.emplace_back();
    for (const Point& p : segments_.back()) box.add(p);
  }
  segment_tree_ = Bvh(boxes);
}

bool KeptDomain::is_crossed(const Box& box) const {
  bool found = false;
  tree().for_each_overlap(box, [&](std::uint32_t) { found = true; });
  return found;
}

bool KeptDomain::is_inside(Point p) const {
  if (surface_) return surface_->is_inside(p);
  bool inside = false;
  const Point end{box().high.x, p.y, p.z};
  if (!(p.x <= end.x)) return false;
  tree().for_each_overlap({p, end}, [&](std::uint32_t i) {
    const auto& [a, b] = segments_[i];
    if ((a.y > p.y) == (b.y > p.y)) return;
    inside ^= a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x;
  });
  return inside;
}

}  // namespace delfront
