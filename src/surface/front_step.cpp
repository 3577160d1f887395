// SPDX-License-Identifier: Apache-2.0
// One side of the front: the ideal point, candidates, what crosses (F7).
#include <algorithm>
#include <cmath>

#include "surface/front.hpp"

namespace delfront {
namespace {

constexpr SurfaceFrontSettings kSettings[] = {
    {1.2, 0.55, 0.35, 0.6, 0.7, true},   // as one would like it
    {1.5, 0.25, 0.2, 0.45, 0.5, true},   // what the first left
    {2.5, 0.05, 0.08, 0.35, 0.4, true},  //
    {5, 0.005, 0.01, 0.3, 0.2, false},   // no new points: loops close
    {20, 1e-5, 1e-6, 0.3, 0.1, false},   // anything that fits
};
constexpr std::size_t kMostCandidates = 40;  ///< tested for crossings
constexpr double kTaken = 0.6;               ///< existing points nearer to the ideal one are taken instead
constexpr double kNewShare = 0.7;            ///< existing points need this share of the ideal quality
constexpr double kFlat = 1e-9;               ///< of the side: heights in the plane that are none

double cross2(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Squared distance from p to the segment a b.
double squared_distance_to(const std::array<double, 2>& p, const std::array<double, 2>& a,
                           const std::array<double, 2>& b) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], px = p[0] - a[0], py = p[1] - a[1];
  const double t = std::clamp((px * dx + py * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  const double ex = px - t * dx, ey = py - t * dy;
  return ex * ex + ey * ey;
}

}  // namespace

/// F7: candidates in the order of their scores, the first that crosses nothing.
bool SurfaceFront::advance(std::uint32_t s) {
  const FrontSide& side = sides_[s];
  set_ = &kSettings[side.tries];
  a_ = points_[side.node[0]].at;
  b_ = points_[side.node[1]].at;
  half_ = 0.5 * distance(a_, b_);
  const Point u = (b_ - a_) / (2 * half_);
  Point n = side.normal - dot(side.normal, u) * u;
  const double size = length(n);
  if (!(size > 0)) return false;
  n = n / size;
  plane_ = {0.5 * (a_ + b_), u, cross(n, u), n};
  // F7.1: the side is as far from the place as the sizes at its ends ask, within what the side itself allows
  const double h = 0.5 * (points_[side.node[0]].h + points_[side.node[1]].h);
  wanted_ = std::clamp(h, 1.1 * half_, 4 * half_);
  ideal_ = plane_.origin + std::sqrt(wanted_ * wanted_ - half_ * half_) * plane_.v;
  candidates_.clear();
  look_round(s, set_->radius * wanted_);
  add_candidates(s);
  if (set_->makes_points) add_new_points(s);
  const std::size_t most = std::min(kMostCandidates, candidates_.size());
  std::partial_sort(
      candidates_.begin(), candidates_.begin() + std::ptrdiff_t(most), candidates_.end(),
      [](const Candidate& p, const Candidate& q) { return p.score != q.score ? p.score > q.score : p.near < q.near; });
  candidates_.resize(most);
  for (const Candidate& candidate : candidates_) {
    if (!is_free(s, candidate)) continue;
    std::uint32_t c;
    if (candidate.near == kNone) {
      c = add_point(candidate.foot.at, candidate.foot.normal, size_.size(candidate.foot.at), candidate.foot.triangle,
                    false);
    } else {
      c = near_points_[candidate.near].point;
    }
    add_triangle(s, c);
    return true;
  }
  return false;
}

std::uint32_t SurfaceFront::near_point(std::uint32_t point) {
  if (near_stamp_[point] != stamp_) {
    near_stamp_[point] = stamp_;
    near_index_[point] = static_cast<std::uint32_t>(near_points_.size());
    const auto [x, y] = plane_.flat(points_[point].at);
    near_points_.push_back({point, x, y});
  }
  return near_index_[point];
}

/// Sides near the triangle to come, whose normals say that they lie on the same sheet.
void SurfaceFront::look_round(std::uint32_t s, double radius) {
  ++stamp_;
  near_points_.clear();
  near_sides_.clear();
  near_point(sides_[s].node[0]);
  near_point(sides_[s].node[1]);
  Box box;
  for (const Point p : {a_, b_}) box.add(p);
  box.add(ideal_ - Point{radius, radius, radius});
  box.add(ideal_ + Point{radius, radius, radius});
  const double largest_height = 0.8 * radius + half_;
  tree_.for_each_overlap(box, [&](std::uint32_t t) {
    const FrontSide& side = sides_[t];
    if (!side.is_alive || t == s || dot(side.normal, plane_.n) < 0.2) return;
    const Point p = points_[side.node[0]].at, q = points_[side.node[1]].at;
    const double low = plane_.height(p), high = plane_.height(q);
    if (std::min(std::abs(low), std::abs(high)) > largest_height) return;
    const std::uint32_t i = near_point(side.node[0]), j = near_point(side.node[1]);
    near_sides_.push_back({i, j});
  });
}

double SurfaceFront::quality(Point c) const {
  const double sum = squared_length(b_ - a_) + squared_length(c - a_) + squared_length(c - b_);
  return 2 * std::sqrt(3.0) * length(cross(b_ - a_, c - a_)) / sum;
}

/// Whether the triangle to a place faces as the surface does, at the side and at the place.
bool SurfaceFront::agrees(const Candidate& candidate) const {
  const Point twice = cross(b_ - a_, candidate.at - a_);
  const double size = length(twice);
  if (!(dot(twice, plane_.n) > set_->agreement * size)) return false;
  if (candidate.near == kNone) return dot(twice, candidate.foot.normal) > set_->agreement * size;
  const FrontPoint& point = points_[near_points_[candidate.near].point];
  return point.is_vague || dot(twice, point.normal) > set_->agreement * size;
}

/// F7.2: points of the front, in front of the side.
void SurfaceFront::add_candidates(std::uint32_t s) {
  const double radius = set_->radius * wanted_;
  for (std::uint32_t i = 2; i < near_points_.size(); ++i) {
    const NearPoint& near = near_points_[i];
    if (!(near.y > kFlat * half_)) continue;
    Candidate candidate;
    candidate.near = i;
    candidate.at = points_[near.point].at;
    candidate.flat = {near.x, near.y};
    const double away = distance(candidate.at, ideal_);
    const bool closes =
        find_side(sides_[s].node[1], near.point) != kNone || find_side(near.point, sides_[s].node[0]) != kNone;
    if (away > radius && !closes) continue;
    const double q = quality(candidate.at);
    if (q < set_->quality || !agrees(candidate)) continue;
    const double longest = std::sqrt(std::max(squared_length(candidate.at - a_), squared_length(candidate.at - b_)));
    candidate.score = q * std::min(1.0, 1.5 * wanted_ / longest);
    if (away < kTaken * wanted_) candidate.score += 0.5 * (1 - away / wanted_);
    candidates_.push_back(candidate);
  }
}

void SurfaceFront::add_new_points(std::uint32_t s) {
  const double height = std::sqrt(wanted_ * wanted_ - half_ * half_);
  add_new_point(s, height, 1);
  if (sides_[s].tries > 0) {
    add_new_point(s, 0.7 * height, 0.9);
    add_new_point(s, 0.45 * height, 0.8);
  }
}

/// The place in the tangent plane, put on the surface; no point may be near it already.
void SurfaceFront::add_new_point(std::uint32_t s, double height, double bonus) {
  Candidate candidate;
  candidate.near = kNone;
  const Point place = plane_.origin + height * plane_.v;
  const std::uint32_t hint = points_[sides_[s].node[0]].foot;
  candidate.foot = support_.project(place, plane_.n, hint, wanted_);
  if (!candidate.foot.found()) return;
  candidate.at = candidate.foot.at;
  candidate.flat = plane_.flat(candidate.at);
  if (!(candidate.flat[1] > 0.3 * height)) return;
  const double room = set_->to_points * wanted_ * std::min(1.0, height / half_);
  for (std::uint32_t i = 0; i < near_points_.size(); ++i)
    if (squared_length(points_[near_points_[i].point].at - candidate.at) < room * room) return;
  for (const NearSide& side : near_sides_) {
    const NearPoint &p = near_points_[side.a], &q = near_points_[side.b];
    if (squared_distance_to(candidate.flat, {p.x, p.y}, {q.x, q.y}) < 0.5 * room * room) return;
  }
  const double q = quality(candidate.at);
  if (q < set_->quality || !agrees(candidate)) return;
  candidate.score = kNewShare * q * bonus;
  candidates_.push_back(candidate);
}

/// F7.3: no side may cross the triangle's, no point lie in it or too close to its new sides.
bool SurfaceFront::is_free(std::uint32_t s, const Candidate& candidate) const {
  const std::array<double, 2> a = {-half_, 0}, b = {half_, 0}, c = candidate.flat;
  const std::uint32_t third = candidate.near == kNone ? kNone : near_points_[candidate.near].point;
  const std::uint32_t na = sides_[s].node[0], nb = sides_[s].node[1];
  bool is_new_bc = true, is_new_ca = true;
  if (third != kNone) {
    is_new_bc = find_side(nb, third) == kNone;
    is_new_ca = find_side(third, na) == kNone;
    if (is_new_bc && find_side(third, nb) != kNone) return false;
    if (is_new_ca && find_side(na, third) != kNone) return false;
  }
  // a point near a corner may be as near to its sides as a narrow angle there allows
  const auto is_near = [&](const std::array<double, 2>& p, const std::array<double, 2>& from) {
    const auto squared = [&](const std::array<double, 2>& q) {
      return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
    };
    const double reach = std::min({squared(from), squared(c), wanted_ * wanted_});
    return squared_distance_to(p, from, c) <= set_->clearance * set_->clearance * reach;
  };
  for (std::uint32_t i = 2; i < near_points_.size(); ++i) {
    if (i == candidate.near) continue;
    const std::array<double, 2> p = {near_points_[i].x, near_points_[i].y};
    if (cross2(a, b, p) >= 0 && cross2(b, c, p) >= 0 && cross2(c, a, p) >= 0) return false;
    if ((is_new_bc && is_near(p, b)) || (is_new_ca && is_near(p, a))) return false;
  }
  for (const NearSide& side : near_sides_) {
    const std::array<double, 2> p = {near_points_[side.a].x, near_points_[side.a].y};
    const std::array<double, 2> q = {near_points_[side.b].x, near_points_[side.b].y};
    const auto crosses = [&](const std::array<double, 2>& e, const std::array<double, 2>& f) {
      return cross2(p, q, e) * cross2(p, q, f) < 0 && cross2(e, f, p) * cross2(e, f, q) < 0;
    };
    const bool has_a = side.a == 0 || side.b == 0, has_b = side.a == 1 || side.b == 1;
    const bool has_c = candidate.near != kNone && (side.a == candidate.near || side.b == candidate.near);
    if (is_new_bc && !has_b && !has_c && crosses(b, c)) return false;
    if (is_new_ca && !has_a && !has_c && crosses(c, a)) return false;
  }
  return true;
}

/// The normal of a new side: between those at its ends, where these say something.
Point SurfaceFront::normal_between(std::uint32_t a, std::uint32_t b, Point fallback) const {
  Point sum = 0.5 * fallback;
  for (const std::uint32_t p : {a, b})
    if (!points_[p].is_vague) sum = sum + points_[p].normal;
  const double size = length(sum);
  return size > 0.5 ? sum / size : fallback;
}

}  // namespace delfront
