// SPDX-License-Identifier: Apache-2.0
// The front of a region: its store, its queue, its rounds. One step stands in front_step.cpp.
#include "surface/front.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "delfront/context.hpp"

namespace delfront {
namespace {

constexpr std::size_t kBinsPerTry = 64, kTries = 5;
constexpr double kBinsPerOctave = 4;
constexpr std::size_t kMostSteps = 8;  ///< a triangle: 1.1 to 2 are usual
constexpr double kMostArea = 1.3;      ///< of the support
constexpr std::size_t kCheckEvery = 4096;

Point unit(Point p) { return p / length(p); }

}  // namespace

RegionGrid SurfaceFront::grid(const RegionBorder& border, const Context& context) {
  begin(border);
  if (sides_.empty()) seed();
  run(context);
  return finish();
}

/// F5: the border is the first front.
void SurfaceFront::begin(const RegionBorder& border) {
  bins_.assign(kBinsPerTry * kTries, {});
  bin_begin_.assign(bins_.size(), 0);
  rebuild_tree();
  shortest_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < border.point.size(); ++i)
    add_point(border.at[i], border.normal[i], size_.size(border.at[i]), kNoTriangle, border.is_vague[i]);
  result_.num_border = border.point.size();
  for (const auto& [a, b] : border.side) shortest_ = std::min(shortest_, distance(points_[a].at, points_[b].at));
  for (const auto& side : border.side) {
    const auto [low, high] = std::minmax(side[0], side[1]);
    result_.border_sides.push_back(std::uint64_t(low) << 32 | high);
  }
  std::sort(result_.border_sides.begin(), result_.border_sides.end());
  for (std::size_t i = 0; i < border.side.size(); ++i)
    add_side(border.side[i][0], border.side[i][1], border.side_normal[i]);
  rebuild_tree();
}

/// A closed region has no border: a first triangle of the wanted size, somewhere, is its first front.
void SurfaceFront::seed() {
  const auto& given = support_.corners(0);
  const Point at = (given[0] + given[1] + given[2]) / 3.0;
  const SurfaceSupport::Foot foot = support_.project(at, support_.normal(0));
  const double h = std::min(size_.size(at), 0.35 * std::sqrt(support_.area()));
  shortest_ = 0.5 * h;
  const Point along = unit(given[1] - given[0]), n = foot.normal;
  const Point u = unit(along - dot(along, n) * n), v = cross(n, u);
  std::uint32_t node[3];
  Point corner[3] = {foot.at, foot.at + h * u, foot.at + 0.5 * h * u + 0.8660254 * h * v};
  for (int k = 0; k < 3; ++k) {
    const SurfaceSupport::Foot on = support_.project(corner[k], n);
    if (!on.found()) return;
    node[k] = add_point(on.at, on.normal, size_.size(on.at), on.triangle, false);
  }
  result_.triangles.push_back({node[0], node[1], node[2]});
  for (int k = 0; k < 3; ++k) add_side(node[(k + 1) % 3], node[k], n);
  rebuild_tree();
}

std::uint32_t SurfaceFront::add_point(Point at, Point normal, double h, std::uint32_t foot, bool is_vague) {
  FrontPoint point;
  point.at = at;
  point.normal = normal;
  point.h = h;
  point.foot = foot;
  point.is_vague = is_vague;
  points_.push_back(point);
  near_index_.push_back(0);
  near_stamp_.push_back(0);
  return static_cast<std::uint32_t>(points_.size() - 1);
}

void SurfaceFront::add_side(std::uint32_t a, std::uint32_t b, Point normal) {
  const auto s = static_cast<std::uint32_t>(sides_.size());
  FrontSide side;
  side.node[0] = a;
  side.node[1] = b;
  side.normal = normal;
  side.length = static_cast<float>(distance(points_[a].at, points_[b].at));
  for (std::uint32_t k = 0; k < 2; ++k) {
    FrontPoint& point = points_[side.node[k]];
    side.next[k] = point.first;
    point.first = 2 * s + k;
  }
  sides_.push_back(side);
  ++num_alive_;
  queue(s);
  add_to_tree(s);
}

void SurfaceFront::remove_side(std::uint32_t s) {
  FrontSide& side = sides_[s];
  side.is_alive = false;
  --num_alive_;
  for (std::uint32_t k = 0; k < 2; ++k) {
    std::uint32_t* link = &points_[side.node[k]].first;
    while (*link != 2 * s + k) link = &sides_[*link >> 1].next[*link & 1];
    *link = side.next[k];
  }
}

std::uint32_t SurfaceFront::find_side(std::uint32_t a, std::uint32_t b) const {
  for (std::uint32_t e = points_[a].first; e != kNone; e = sides_[e >> 1].next[e & 1])
    if ((e & 1) == 0 && sides_[e >> 1].node[1] == b) return e >> 1;
  return kNone;
}

/// F6: by length, so that small triangles come before larger ones can stand in their way; then by tries.
void SurfaceFront::queue(std::uint32_t s) {
  const double octaves = std::log2(std::max(1.0, double(sides_[s].length) / shortest_));
  const auto bin = std::min<std::size_t>(std::size_t(kBinsPerOctave * octaves), kBinsPerTry - 1);
  const std::size_t at = kBinsPerTry * sides_[s].tries + bin;
  bins_[at].push_back(s);
  lowest_bin_ = std::min(lowest_bin_, at);
}

std::uint32_t SurfaceFront::next_side() {
  for (; lowest_bin_ < bins_.size(); ++lowest_bin_) {
    auto& bin = bins_[lowest_bin_];
    std::size_t& begin = bin_begin_[lowest_bin_];
    while (begin < bin.size()) {
      const std::uint32_t s = bin[begin++];
      if (sides_[s].is_alive) return s;
    }
    bin.clear();
    begin = 0;
  }
  return kNone;
}

void SurfaceFront::add_to_tree(std::uint32_t s) {
  Box box;
  for (const std::uint32_t node : sides_[s].node) box.add(points_[node].at);
  tree_.insert(s, box);
  ++num_in_tree_;
}

/// Sides that are gone stay in the tree until they are as many as those that are not (F16).
void SurfaceFront::rebuild_tree() {
  Box box;
  for (const FrontSide& side : sides_)
    if (side.is_alive)
      for (const std::uint32_t node : side.node) box.add(points_[node].at);
  if (box.is_empty()) box.add(Point{});
  tree_.clear(box);
  num_in_tree_ = 0;
  for (std::uint32_t s = 0; s < sides_.size(); ++s)
    if (sides_[s].is_alive) add_to_tree(s);
}

/// F8-F10: the triangle comes; sides that it closes go, others take their place.
void SurfaceFront::add_triangle(std::uint32_t s, std::uint32_t c) {
  const std::uint32_t a = sides_[s].node[0], b = sides_[s].node[1];
  const Point normal = sides_[s].normal;
  result_.triangles.push_back({a, b, c});
  area_ += 0.5 * length(cross(points_[b].at - points_[a].at, points_[c].at - points_[a].at));
  remove_side(s);
  const std::uint32_t ends[2][2] = {{b, c}, {c, a}};
  for (const auto& [from, to] : ends) {
    const std::uint32_t closed = find_side(from, to);
    if (closed != kNone)
      remove_side(closed);
    else
      add_side(to, from, normal_between(to, from, normal));
  }
}

/// F11: until the front is empty, or every side was tried with all settings since the last triangle.
void SurfaceFront::run(const Context& context) {
  std::size_t made_at_reset = result_.triangles.size();
  const std::size_t num_begun = num_alive_ + 100;
  while (num_alive_ > 0) {
    const std::uint32_t s = next_side();
    if (s == kNone) {
      if (result_.triangles.size() == made_at_reset) return;
      made_at_reset = result_.triangles.size();
      for (std::uint32_t i = 0; i < sides_.size(); ++i) {
        if (!sides_[i].is_alive) continue;
        sides_[i].tries = 1;
        queue(i);
      }
      continue;
    }
    if (++result_.steps % kCheckEvery == 0) {
      context.check_limits();
      context.check_cells(result_.triangles.size() / 4);  // no tetrahedron has more
    }
    if (num_in_tree_ > 3 * num_alive_ + 1000) rebuild_tree();
    if (area_ > kMostArea * support_.area()) return;  // it runs over what it has gridded
    if (result_.steps > kMostSteps * (result_.triangles.size() + num_begun)) return;  // it goes round in circles
    if (advance(s)) continue;
    if (++sides_[s].tries < kTries) queue(s);
  }
}

RegionGrid SurfaceFront::finish() {
  if (num_alive_ > 0 || result_.triangles.empty()) {
    result_.gave_up = result_.triangles.empty() ? "no first triangle fits"
                                                : fmt::format("{} sides of the front are left", num_alive_);
    for (const FrontSide& side : sides_)
      if (side.is_alive) result_.gave_up_at = points_[side.node[0]].at;
  }
  result_.points.clear();
  for (const FrontPoint& point : points_) {
    result_.points.push_back(point.at);
    result_.triangle_of_point.push_back(point.foot);
  }
  return std::move(result_);
}

}  // namespace delfront
