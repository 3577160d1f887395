// SPDX-License-Identifier: Apache-2.0
#include "brep/wanted_size.hpp"

namespace delfront {
namespace {

constexpr int kSamples = 24;             ///< each way
constexpr double kFloorShare = 1e-3;     ///< of the diagonal
constexpr double kMostLowering = 0.05;   ///< of the least size that is asked for, where that gives less
constexpr double kCoarseLowering = 0.5;  ///< the same, where grids with that cross themselves
constexpr double kTipReach = 0.2;     ///< of a face's extent from its tip: sizes there are not lowered below about that
constexpr double kSmoothPole = 0.99;  ///< least cosine between normals round a pole that is no tip

/// How far a face's border goes from a place.
double reach_of(const Brep& brep, const BrepFace& face, Point from) {
  double reach = 0;
  for (const auto& loop : face.loops)
    for (const BrepUse& use : loop) {
      const auto& range = brep.edges[use.edge].range;
      for (int i = 0; i <= kSamples; ++i) {
        const Point2 uv = use.curve->at(range[0] + (range[1] - range[0]) * i / kSamples);
        reach = std::max(reach, distance(from, face.surface->at(uv)));
      }
    }
  return reach;
}

}  // namespace

void WantedSize::look_at(const Brep& brep) {
  Box box;
  std::vector<Point> at;
  for (const BrepEdge& edge : brep.edges)
    for (int i = 0; i <= kSamples && !edge.is_degenerate(); ++i) {
      at.push_back(edge.curve->at(edge.range[0] + (edge.range[1] - edge.range[0]) * i / kSamples));
      box.add(at.back());
    }
  std::vector<double> asked(at.size());
  asked_.sizes(at, asked);
  double floor = kFloorShare * box.diagonal();
  coarse_least_ = floor;
  for (const double h : asked) {
    floor = std::min(floor, kMostLowering * h);
    coarse_least_ = std::min(coarse_least_, kCoarseLowering * h);
  }
  least_ = std::max(least_, floor);
  find_tips(brep);
}

void WantedSize::find_tips(const Brep& brep) {
  for (const BrepFace& face : brep.faces)
    for (const auto& loop : face.loops)
      for (const BrepUse& use : loop) {
        const BrepEdge& edge = brep.edges[use.edge];
        if (!edge.is_degenerate()) continue;
        const Point first = face.surface->normal(use.curve->at(edge.range[0]));
        for (int i = 1; i <= kSamples; ++i) {
          const double t = edge.range[0] + (edge.range[1] - edge.range[0]) * i / kSamples;
          if (dot(first, face.surface->normal(use.curve->at(t))) > kSmoothPole) continue;
          const Point at = brep.corners[edge.corners[0]].at;
          tips_.push_back({at, kTipReach * reach_of(brep, face, at)});
          break;
        }
      }
}

bool WantedSize::is_lowered_on(const SmoothSurface& surface, const ParameterBox& box) const {
  for (int i = 0; i < kSamples; ++i) {
    std::vector<Point> at;
    std::vector<double> bend;
    for (int j = 0; j < kSamples; ++j) {
      const double x = (i + 0.5) / kSamples, y = (j + 0.5) / kSamples;
      const SurfaceDerivatives s =
          surface.derivatives({box.low.x + x * (box.high.x - box.low.x), box.low.y + y * (box.high.y - box.low.y)});
      at.push_back(s.at);
      bend.push_back(largest_curvature(s));
    }
    std::vector<double> asked(at.size());
    asked_.sizes(at, asked);
    for (std::size_t j = 0; j < at.size(); ++j)
      if (lowered(asked[j], bend[j], at[j]) < asked[j]) return true;
  }
  return false;
}

}  // namespace delfront
