// SPDX-License-Identifier: Apache-2.0
#include "brep/vague_normals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace delfront {
namespace {

constexpr double kReach = 0.4;  ///< of the sides at a point
constexpr double kNear = 0.02;  ///< of them: places nearer than that say nothing
constexpr int kDirections = 8, kTries = 12;
constexpr double kLeastFactor = 0.1;
constexpr double kTurnedRound = -0.9;  ///< cosine: closed edges of three sides turn by -0.5

/// A place on the surface about that far from one, in a direction of the parameters.
Point2 place_off(const SmoothSurface& surface, const SurfaceTangents& from, Point2 uv, double angle, double reach) {
  const ParameterBox box = surface.box();
  const std::array<double, 2> period = surface.period();
  double step = reach;
  Point2 to = uv;
  for (int k = 0; k < kTries; ++k) {
    to = {uv.x + step * std::cos(angle) / std::max(length(from.u), 1e-300),
          uv.y + step * std::sin(angle) / std::max(length(from.v), 1e-300)};
    if (period[0] == 0) to.x = std::clamp(to.x, box.low.x, box.high.x);
    if (period[1] == 0) to.y = std::clamp(to.y, box.low.y, box.high.y);
    const double away = distance(surface.at(to), from.at);
    if (away <= 1.5 * reach) break;
    step *= std::clamp(reach / away, kLeastFactor, 0.7);
  }
  return to;
}

}  // namespace

void mark_vague_normals(const SmoothSurface& surface, FaceGrid& border) {
  for (const auto& loop : border.loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      FacePoint& p = border.points[loop[i]];
      const Point before = border.points[loop[(i + loop.size() - 1) % loop.size()]].at,
                  after = border.points[loop[(i + 1) % loop.size()]].at;
      const double reach = kReach * std::max(distance(p.at, before), distance(p.at, after));
      const SurfaceTangents here = surface.tangents(p.uv);
      const Point normal = surface.normal(p.uv);
      int against = 0, with = 0;
      for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * std::numbers::pi * (k + 0.5) / kDirections;
        const Point2 uv = place_off(surface, here, p.uv, angle, reach);
        const SurfaceTangents there = surface.tangents(uv);
        if (distance(there.at, here.at) < kNear * reach) continue;
        ++(dot(cross(there.u, there.v), normal) < 0 ? against : with);
      }
      p.is_vague = against >= with && against > 0;
    }
}

bool turns_round(const SmoothSurface& surface, const FaceGrid& border) {
  for (const auto& loop : border.loops) {
    Point last;
    for (std::size_t i = 0; i <= loop.size(); ++i) {
      const FacePoint& p = border.points[loop[i % loop.size()]];
      const Point normal = p.is_pole ? Point{} : surface.normal(p.uv);
      if (dot(normal, last) < kTurnedRound) return true;
      last = normal;
    }
  }
  return false;
}

}  // namespace delfront
