// SPDX-License-Identifier: Apache-2.0
#include "surface/support.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "geometry/angles.hpp"

namespace delfront {
namespace {

constexpr int kLongestWalk = 16;  ///< triangles; farther, the tree is quicker

Point unit(Point p) {
  const double size = length(p);
  return size > 0 ? p / size : p;
}

}  // namespace

SurfaceSupport::SurfaceSupport(const SurfaceParts& parts, const SurfaceRegion& region) {
  std::vector<std::array<Point, 3>> corners;
  std::unordered_map<std::uint32_t, Point> at_vertex;
  at_vertex.reserve(region.triangles.size());
  double sides = 0;
  const std::uint32_t own = parts.region_of_triangle[region.triangles[0]];
  const auto is_first_half = [&](std::uint32_t h) {
    for (const std::uint32_t other : parts.edges.half_edges(parts.edges.edge_of(h)))
      if (parts.region_of_triangle[other / 3] == own) return other == h;
    return true;
  };
  long edges = 0;
  for (const std::uint32_t t : region.triangles) {
    const std::array<Point, 3> p = {parts.corner(t, 0), parts.corner(t, 1), parts.corner(t, 2)};
    normal_.push_back(parts.normal[t]);
    area_ += 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      const Point u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      const double angle = angle_between(u, v);
      Point& sum = at_vertex[parts.model.triangles[TriangleId(t)][k].value];
      sum = sum + angle * parts.normal[t];
      sides += length(u);
      edges += is_first_half(static_cast<std::uint32_t>(3 * t + k));
    }
    corners.push_back(p);
  }
  mean_side_ = sides / double(3 * region.triangles.size());
  for (const std::uint32_t t : region.triangles) {
    std::array<Point, 3> n;
    for (std::size_t k = 0; k < 3; ++k) {
      n[k] = unit(at_vertex[parts.model.triangles[TriangleId(t)][k].value]);
      if (dot(n[k], parts.normal[t]) < kAgree) n[k] = parts.normal[t];  // a ridge that is no feature
    }
    corner_normal_.push_back(n);
  }
  euler_ = long(at_vertex.size()) - edges + long(region.triangles.size());
  tree_ = TriangleTree(std::move(corners));
  link(parts, region);
}

void SurfaceSupport::link(const SurfaceParts& parts, const SurfaceRegion& region) {
  const auto& all = region.triangles;  // in ascending order
  for (const std::uint32_t t : all) {
    std::array<std::uint32_t, 3> other = {kNoTriangle, kNoTriangle, kNoTriangle};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t e = parts.edges.edge_of(3 * t + k);
      if (parts.is_feature[e]) continue;
      const auto half = parts.edges.half_edges(e);
      const std::uint32_t neighbour = (half[0] / 3 == t ? half[1] : half[0]) / 3;
      other[k] = static_cast<std::uint32_t>(std::lower_bound(all.begin(), all.end(), neighbour) - all.begin());
    }
    neighbour_.push_back(other);
  }
}

/// The triangle that p lies above, or one beside the ridge that it lies above; kNoTriangle where the way leads over the
/// border, or is long.
std::uint32_t SurfaceSupport::walk(Point p, std::uint32_t from) const {
  std::uint32_t here = from, last = kNoTriangle;
  for (int step = 0; step < kLongestWalk; ++step) {
    const auto& corner = tree_.corners(here);
    double worst = 0;
    std::size_t way = 3;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point side = corner[(k + 1) % 3] - corner[k];
      const double inward = dot(cross(normal_[here], side), p - corner[k]);
      if (inward >= 0 || inward * inward <= worst * squared_length(side)) continue;
      worst = inward * inward / squared_length(side);
      way = k;
    }
    if (way == 3) return here;
    const std::uint32_t next = neighbour_[here][way];
    if (next == kNoTriangle || next == last) return next == kNoTriangle ? kNoTriangle : here;
    last = here;
    here = next;
  }
  return kNoTriangle;
}

SurfaceSupport::Foot SurfaceSupport::foot(std::uint32_t t, Point p) const {
  const auto& [a, b, c] = tree_.corners(t);
  Foot foot;
  foot.triangle = t;
  foot.at = nearest_point_on_triangle(p, a, b, c);
  foot.distance = delfront::distance(foot.at, p);
  const auto& [na, nb, nc] = corner_normal_[t];
  const Point n = cross(b - a, c - a);
  const double wa = std::abs(dot(cross(b - foot.at, c - foot.at), n));
  const double wb = std::abs(dot(cross(c - foot.at, a - foot.at), n));
  const double wc = std::abs(dot(cross(a - foot.at, b - foot.at), n));
  const Point mean = wa * na + wb * nb + wc * nc;
  foot.normal = squared_length(mean) > 0 ? unit(mean) : normal_[t];
  return foot;
}

SurfaceSupport::Foot SurfaceSupport::project(Point p, Point normal, double limit) const {
  const auto hit = tree_.nearest_if(
      p, [&](std::uint32_t t) { return dot(normal_[t], normal) > kAgree; }, limit);
  return hit.found() ? foot(hit.triangle, p) : Foot{};
}

SurfaceSupport::Foot SurfaceSupport::project(Point p, Point normal, std::uint32_t near, double limit) const {
  if (near == kNoTriangle || !(dot(normal_[near], normal) > kAgree)) return project(p, normal, limit);
  const std::uint32_t under = walk(p, near);
  if (under != kNoTriangle && dot(normal_[under], normal) > kAgree) {
    const Foot found = foot(under, p);
    return found.distance < limit ? found : Foot{};
  }
  const auto& [a, b, c] = tree_.corners(near);
  const double bound = delfront::distance(nearest_point_on_triangle(p, a, b, c), p);
  if (bound < limit) {
    const Foot nearer = project(p, normal, bound);
    return nearer.found() ? nearer : foot(near, p);
  }
  return project(p, normal, limit);
}

RegionBorder find_border(const SurfaceParts& parts, const SurfaceRegion& region, const LinePoints& lines,
                         const LineDivision& division) {
  RegionBorder border;
  std::unordered_map<std::uint32_t, std::uint32_t> local;
  const auto number = [&](std::uint32_t global) {
    const auto [it, is_new] = local.try_emplace(global, static_cast<std::uint32_t>(border.point.size()));
    if (is_new) {
      border.point.push_back(global);
      border.at.push_back(lines.points[global]);
    }
    return it->second;
  };
  std::vector<double> count;
  const auto add_normal = [&](std::uint32_t point, Point n) {
    border.normal.resize(border.point.size());
    count.resize(border.point.size());
    border.normal[point] = border.normal[point] + n;
    count[point] += 1;
  };
  for (const RegionSide& side : region.sides) {
    const auto& chain = lines.chain[side.line];
    const auto& place = division[side.line];
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      std::uint32_t a = number(chain[i]), b = number(chain[i + 1]);
      // the given triangles at both ends of the side and between
      Point sum;
      std::uint32_t last = place[i + 1].edge;
      if (place[i + 1].t <= 0 && last > place[i].edge) --last;
      for (std::uint32_t e = place[i].edge; e <= last; ++e) {
        const Point n = parts.normal[side.triangles[e]];
        const double low = e == place[i].edge ? place[i].t : 0, high = e == place[i + 1].edge ? place[i + 1].t : 1;
        const auto& v = parts.lines[side.line].vertices;
        sum = sum + (high - low + 1e-9) * distance(parts.model.points[v[e]], parts.model.points[v[e + 1]]) * n;
      }
      add_normal(a, parts.normal[side.triangles[place[i].edge]]);
      add_normal(b, parts.normal[side.triangles[last]]);
      if (side.is_backward) std::swap(a, b);
      border.side.push_back({a, b});
      border.side_normal.push_back(unit(sum));
    }
  }
  border.is_vague.resize(border.point.size());
  for (std::size_t i = 0; i < border.point.size(); ++i) {
    border.is_vague[i] = length(border.normal[i]) < 0.8 * count[i];
    border.normal[i] = unit(border.normal[i]);
  }
  return border;
}

}  // namespace delfront
