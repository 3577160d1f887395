// SPDX-License-Identifier: Apache-2.0
#include "brep/sharp_corners.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>

#include "brep/face_grid.hpp"
#include "geometry/angles.hpp"

namespace delfront {
namespace {

constexpr double kSharp = 25 * kDegree;  ///< angles of faces below it get longer first sides
constexpr double kCusp = 6.5 * kDegree;  ///< below that sides would be so long that fronts put points beside them
constexpr double kWideEnough = 0.8;      ///< of the wanted size, from one edge to the other
constexpr double kStep = 0.125;          ///< of the wanted size, along both edges
constexpr double kLongest = 7.5;         ///< wanted sizes: a side that goes on
constexpr double kWorthIt = 1.25;        ///< wanted sizes: shorter sides are as well made by size
constexpr double kShareOfEdge = 0.6;     ///< of its range: no side takes more
constexpr double kLeastShare = 0.1;      ///< of its range, that is left between two such sides
constexpr double kMostTurn = 0.3;        ///< radians that an edge may turn along such a side
constexpr double kBeside = 1e-3;         ///< of an edge's range: normals at poles are none

/// A way along an edge from one of its ends.
class Way {
 public:
  Way(const BrepEdge& edge, bool from_end)
      : edge_(&edge), sign_(from_end ? -1 : 1), t_(edge.range[from_end]), first_(edge.curve->derivatives(t_)) {
    at_ = first_.at;
  }

  Point at() const { return at_; }
  double t() const { return t_; }
  Point direction() const { return sign_ * first_.first; }

  /// @return whether the edge is still there, and about straight
  bool go(double step) {
    const double speed = length(edge_->curve->derivatives(t_).first);
    if (!(speed > 0)) return false;
    t_ += sign_ * step / speed;
    const auto [low, high] = edge_->range;
    if (!(std::abs(t_ - (sign_ > 0 ? low : high)) < kShareOfEdge * (high - low))) return false;
    const CurveDerivatives there = edge_->curve->derivatives(t_);
    at_ = there.at;
    return angle_between(there.first, first_.first) < kMostTurn;
  }

 private:
  const BrepEdge* edge_;
  double sign_;
  double t_;
  CurveDerivatives first_;
  Point at_;
};

/// How far the first sides go on, as parameters of the two edges; none: no farther than sizes say.
std::optional<std::array<double, 2>> first_sides(Way one, Way other, const WantedSize& size) {
  double wanted = size.asked().size(one.at()), gone = 0;
  for (double sides = 0; sides < kLongest; sides += kStep) {
    const double step = kStep * wanted;
    if (!one.go(step) || !other.go(step)) return std::nullopt;
    gone += step;
    wanted = size.asked().size(0.5 * (one.at() + other.at()));
    if (distance(one.at(), other.at()) < kWideEnough * wanted) continue;
    if (gone < kWorthIt * wanted) return std::nullopt;
    return std::array<double, 2>{one.t(), other.t()};
  }
  return std::nullopt;
}

}  // namespace

std::vector<SharpCorner> find_sharp_corners(const Brep& brep, double below) {
  std::vector<SharpCorner> found;
  for (const BrepFace& face : brep.faces)
    for (const auto& loop : face.loops) {
      std::vector<BrepUse> uses;
      std::copy_if(loop.begin(), loop.end(), std::back_inserter(uses),
                   [&](const BrepUse& use) { return !brep.edges[use.edge].is_degenerate(); });
      for (std::size_t i = 0; i < uses.size(); ++i) {
        const BrepUse &from = uses[i], &to = uses[(i + 1) % uses.size()];
        if (from.edge == to.edge) continue;  // a seam that turns round in a pole
        const BrepEdge& after = brep.edges[to.edge];
        const Way back(brep.edges[from.edge], !from.is_reversed), ahead(after, to.is_reversed);
        const double angle = angle_between(ahead.direction(), back.direction());
        if (!(angle < below)) continue;
        const double share = to.is_reversed ? 1 - kBeside : kBeside;
        const double t = (1 - share) * after.range[0] + share * after.range[1];
        // the face lies left of the way round it: between what goes on and what goes back
        const bool is_outside =
            dot(cross(ahead.direction(), back.direction()), face.surface->normal(to.curve->at(t))) < 0;
        if (!is_outside) found.push_back({after.corners[to.is_reversed], ahead.at(), angle, from, to});
      }
    }
  return found;
}

Array<EdgeId, std::array<double, 2>> ranges_between_sharp_corners(const Brep& brep, const WantedSize& size,
                                                                  const std::set<CornerId>& corners) {
  Array<EdgeId, std::array<double, 2>> ranges;
  for (const BrepEdge& edge : brep.edges) ranges.push_back(edge.range);
  const auto cut = [&](EdgeId edge, bool at_end, double t) {
    double& limit = ranges[edge][at_end];
    limit = at_end ? std::min(limit, t) : std::max(limit, t);
  };
  if (corners.empty()) return ranges;
  for (const SharpCorner& corner : find_sharp_corners(brep, kSharp)) {
    const BrepUse &from = corner.from, &to = corner.to;
    if (corner.angle < kCusp || !corners.contains(corner.corner)) continue;
    const auto sides =
        first_sides({brep.edges[from.edge], !from.is_reversed}, {brep.edges[to.edge], to.is_reversed}, size);
    if (!sides) continue;
    cut(from.edge, !from.is_reversed, (*sides)[0]);
    cut(to.edge, to.is_reversed, (*sides)[1]);
  }
  for (std::size_t e = 0; e < ranges.size(); ++e) {
    const auto& whole = brep.edges[EdgeId(e)].range;
    auto& left = ranges[EdgeId(e)];
    if (left[1] - left[0] < kLeastShare * (whole[1] - whole[0])) left = whole;
  }
  return ranges;
}

std::vector<CornerId> find_needles_in_corners(const Brep& brep, const Model& model,
                                              const std::vector<VertexEntity>& entity, double needle_deg) {
  std::set<std::uint32_t> sharp, found;
  for (const SharpCorner& corner : find_sharp_corners(brep, kSharp))
    if (corner.corner.is_valid()) sharp.insert(corner.corner.value);
  if (sharp.empty()) return {};
  const auto corner_of = [&](VertexId v) {
    const VertexEntity& e = entity[v.index()];
    return e.dimension == 0 && sharp.contains(e.id) ? e.id : kNoVertex;
  };
  std::multimap<VertexId, std::uint32_t> beside;  // points of triangles in sharp corners: those
  for (const auto& t : model.triangles)
    for (const VertexId v : t)
      if (const std::uint32_t corner = corner_of(v); corner != kNoVertex)
        for (const VertexId w : t) beside.emplace(w, corner);
  for (const auto& t : model.triangles) {
    if (smallest_angle_deg(model.points[t[0]], model.points[t[1]], model.points[t[2]]) > needle_deg) continue;
    if (std::any_of(t.begin(), t.end(), [&](VertexId v) { return corner_of(v) != kNoVertex; })) continue;
    for (const VertexId v : t)
      for (auto [it, last] = beside.equal_range(v); it != last; ++it) found.insert(it->second);
  }
  std::vector<CornerId> corners;
  for (const std::uint32_t c : found) corners.push_back(CornerId(std::size_t(c)));
  return corners;
}

}  // namespace delfront
