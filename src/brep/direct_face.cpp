// SPDX-License-Identifier: Apache-2.0
// A face directly in space: the front on a fine triangulation of it (Löhner 1996), new points put on the surface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "brep/face_support.hpp"
#include "delfront/errors.hpp"
#include "surface/region_check.hpp"
#include "surface/region_fit.hpp"
#include "surface/region_mesh.hpp"
#include "surface/working_size.hpp"

namespace delfront {
namespace {

constexpr double kShortShare = 0.8;  ///< of the size: sides of the border that lower sizes round them
constexpr double kGrowth = 1.4;      ///< of sizes round those
constexpr double kSmoothPole = 0.8;  ///< least cosine between normals at a pole that say something

/// The loops as the front's border: copies of a seam's points are one, a seam is run both ways.
class BorderMaker {
 public:
  BorderMaker(const SmoothSurface& surface, const FaceGrid& grid) : surface_(surface), grid_(grid) {}

  RegionBorder run() {
    for (const auto& loop : grid_.loops)
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const FacePoint &a = grid_.points[loop[i]], &b = grid_.points[loop[(i + 1) % loop.size()]];
        const std::uint32_t from = number(a), to = number(b);
        if (from == to) continue;
        border_.side.push_back({from, to});
        border_.side_normal.push_back(surface_.normal({0.5 * (a.uv.x + b.uv.x), 0.5 * (a.uv.y + b.uv.y)}));
      }
    return std::move(border_);
  }

  const std::vector<FacePoint>& points() const { return points_; }

 private:
  std::uint32_t number(const FacePoint& p) {
    const Point normal = surface_.normal(p.uv);
    const auto [it, is_new] = local_.try_emplace(p.vertex, static_cast<std::uint32_t>(points_.size()));
    if (is_new) {
      points_.push_back(p);
      border_.point.push_back(p.vertex);
      border_.at.push_back(p.at);
      border_.normal.push_back(normal);
      border_.is_vague.push_back(p.is_vague || (p.is_pole && is_tip(p)));
    }
    return it->second;
  }

  /// Whether normals go round a cone at a pole.
  bool is_tip(const FacePoint& pole) const {
    const Point first = surface_.normal(pole.uv);
    for (const FacePoint& p : grid_.points) {
      if (p.is_pole) continue;
      const ParameterBox box = surface_.box();
      const bool by_v = pole.uv.y <= box.low.y || pole.uv.y >= box.high.y;
      const Point2 there = by_v ? Point2{p.uv.x, pole.uv.y} : Point2{pole.uv.x, p.uv.y};
      if (dot(first, surface_.normal(there)) < kSmoothPole) return true;
    }
    return false;
  }

  const SmoothSurface& surface_;
  const FaceGrid& grid_;
  RegionBorder border_;
  std::vector<FacePoint> points_;
  std::unordered_map<std::uint32_t, std::uint32_t> local_;
};

/// Bends that edges were divided for are not all known to the front's sizes: they grow from the border's.
void lower_near_short_sides(const FaceGrid& grid, WorkingSize& size, Context& context) {
  BoundarySizes sizes;
  sizes.growth = kGrowth;
  for (const auto& loop : grid.loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const FacePoint &a = grid.points[loop[i]], &b = grid.points[loop[(i + 1) % loop.size()]];
      const double side = distance(a.at, b.at);
      const Point middle = 0.5 * (a.at + b.at);
      if (a.vertex == b.vertex || !(side < kShortShare * size.size(middle))) continue;
      sizes.points.push_back(middle);
      sizes.size.push_back(side);
    }
  if (!sizes.points.empty()) size.lower(sizes, context);
}

Point2 uv_on_support(const FaceSupport& support, std::uint32_t t, Point p) {
  const auto& v = support.model.triangles[TriangleId(std::size_t(t))];
  const Point a = support.model.points[v[0]], b = support.model.points[v[1]], c = support.model.points[v[2]];
  const Point n = cross(b - a, c - a);
  const double area = squared_length(n);
  const double fb = dot(cross(p - a, c - a), n) / area, fc = dot(cross(b - a, p - a), n) / area, fa = 1 - fb - fc;
  const auto& uv = support.corner_uv[t];
  return {fa * uv[0].x + fb * uv[1].x + fc * uv[2].x, fa * uv[0].y + fb * uv[1].y + fc * uv[2].y};
}

void take(const SmoothSurface& surface, const FaceSupport& support, const RegionGrid& made,
          std::vector<FacePoint> points, FaceGrid& grid) {
  for (std::size_t i = made.num_border; i < made.points.size(); ++i) {
    const std::uint32_t t = made.triangle_of_point[i];
    const Point2 uv = surface.closest(made.points[i], uv_on_support(support, t, made.points[i]));
    points.push_back({surface.at(uv), uv, kNoVertex, false});
  }
  grid.points = std::move(points);
  grid.triangles = made.triangles;
}

}  // namespace

void grid_directly(const Brep& brep, const BrepFace& face, const Array<EdgeId, EdgePoints>& edges,
                   const WantedSize& size, FaceGrid& grid, Context& context) {
  grid.gave_up.clear();
  Context quiet = context.for_a_piece();
  quiet.threads = 1;
  try {
    const FaceSupport fine = make_face_support(brep, face, edges, quiet);
    WorkingSize working(size.asked(), build_bend_guard(fine.model, size.asked(), quiet));
    lower_near_short_sides(grid, working, quiet);
    const SurfaceParts parts(fine.model, working, quiet);
    if (parts.regions.size() != 1)
      return grid.fail(fmt::format("its loops bound {} parts", parts.regions.size()), grid.points[0].at);
    const SurfaceSupport support(parts, parts.regions[0]);
    BorderMaker maker(*face.surface, grid);
    const RegionBorder border = maker.run();
    RegionGrid made = SurfaceFront(support, working).grid(border, context);
    if (made.gave_up.empty()) {
      RegionMesh mesh(support, std::move(made));
      improve_region(mesh, support, working, false);
      made = mesh.take();
    }
    check_region(support, border, made);
    if (!made.gave_up.empty()) return grid.fail(made.gave_up, made.gave_up_at);
    take(*face.surface, fine, made, maker.points(), grid);
  } catch (const InputError& e) {
    grid.fail(fmt::format("its border in the parameter plane: {}", e.what()), grid.points[0].at);
  }
}

}  // namespace delfront
