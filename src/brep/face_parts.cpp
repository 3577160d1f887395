// SPDX-License-Identifier: Apache-2.0
#include "brep/face_parts.hpp"

#include <algorithm>
#include <cmath>

#include "brep/edge_points.hpp"

namespace delfront {
namespace {

using Pole = Chart::Pole;

constexpr double kRoom = 0.7;  ///< between a cut and other loops, of two sides of the loop there

constexpr int kLevels = 64, kAround = 9;  ///< places to see how wide a part is
constexpr double kSlender = 2;            ///< of lengths from the pole, over what a cone's would be so wide

/// Two points of a loop, one after the other, that are one pole in space.
struct PoleRun {
  std::size_t loop, first;
  Pole side;
};

Pole side_of(const SmoothSurface& surface, Point2 a, Point2 b) {
  const ParameterBox box = surface.box();
  if (std::abs(a.x - b.x) > std::abs(a.y - b.y))
    return std::abs(a.y - box.low.y) <= std::abs(a.y - box.high.y) ? Pole::v_low : Pole::v_high;
  return std::abs(a.x - box.low.x) <= std::abs(a.x - box.high.x) ? Pole::u_low : Pole::u_high;
}

std::vector<PoleRun> find_runs(const SmoothSurface& surface, const FaceGrid& grid, const FacePart& part) {
  std::vector<PoleRun> runs;
  for (std::size_t l = 0; l < part.loops.size(); ++l) {
    const auto& loop = part.loops[l];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const FacePoint &a = grid.points[loop[i]], &b = grid.points[loop[(i + 1) % loop.size()]];
      if (a.is_pole && b.is_pole && a.vertex == b.vertex) runs.push_back({l, i, side_of(surface, a.uv, b.uv)});
    }
  }
  return runs;
}

bool is_low(Pole side) { return side == Pole::u_low || side == Pole::v_low; }

bool are_opposite(Pole a, Pole b) {
  const auto is = [&](Pole x, Pole y) { return (a == x && b == y) || (a == y && b == x); };
  return is(Pole::u_low, Pole::u_high) || is(Pole::v_low, Pole::v_high);
}

/// The points of a loop from one place in it to another, both among them.
std::vector<std::uint32_t> chain_of(const std::vector<std::uint32_t>& loop, std::size_t from, std::size_t to) {
  std::vector<std::uint32_t> chain;
  for (std::size_t i = from; i % loop.size() != to; ++i) chain.push_back(loop[i % loop.size()]);
  chain.push_back(loop[to]);
  return chain;
}

/// Points of the straight line in the parameter plane between two points of the grid, these left out.
std::vector<std::uint32_t> add_cut(const BrepFace& face, const WantedSize& size, FaceGrid& grid, std::uint32_t p,
                                   std::uint32_t q) {
  const Point2 from = grid.points[p].uv, to = grid.points[q].uv;
  const double du = to.x - from.x, dv = to.y - from.y;
  const auto place = [&](double t) { return Point2{from.x + t * du, from.y + t * dv}; };
  const auto sample = [&](double t, bool) {
    const SurfaceDerivatives s = face.surface->derivatives(place(t));
    return CurveSample{s.at, du * s.u + dv * s.v, largest_curvature(s)};
  };
  const bool is_closed = grid.points[p].vertex == grid.points[q].vertex;
  const std::vector<double> t = divide_curve(sample, {0, 1}, size, is_closed ? 3 : 1);
  std::vector<std::uint32_t> made;
  for (std::size_t i = 1; i + 1 < t.size(); ++i) {
    made.push_back(static_cast<std::uint32_t>(grid.points.size()));
    grid.points.push_back({face.surface->at(place(t[i])), place(t[i]), kNoVertex, false});
  }
  return made;
}

double radial(const FaceGrid& grid, std::uint32_t p, Pole side) {
  const Point2 uv = grid.points[p].uv;
  return side == Pole::v_low || side == Pole::v_high ? uv.y : uv.x;
}

/// The point of a way from pole to pole whose level is the nearest to the middle of those that meet no other loop.
std::size_t find_level(const FaceGrid& grid, const FacePart& part, const std::vector<std::uint32_t>& way, Pole side,
                       std::size_t loop) {
  std::vector<std::array<double, 2>> others;
  for (std::size_t l = 0; l < part.loops.size(); ++l) {
    if (l == loop) continue;
    std::array<double, 2> range = {1e300, -1e300};
    for (const std::uint32_t p : part.loops[l])
      range = {std::min(range[0], radial(grid, p, side)), std::max(range[1], radial(grid, p, side))};
    others.push_back(range);
  }
  const std::size_t middle = way.size() / 2;
  std::size_t best = middle;
  double best_merit = -1e300;
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    const double here = radial(grid, way[i], side);
    const double step = std::abs(radial(grid, way[i + 1], side) - radial(grid, way[i - 1], side));
    double room = kRoom * step;
    for (const auto& range : others) room = std::min(room, std::max(range[0] - here, here - range[1]));
    const double off = std::abs(double(i) - double(middle)) / double(way.size());
    const double merit = (room >= kRoom * step ? 1 : room / (kRoom * step)) - off;
    if (merit <= best_merit) continue;
    best_merit = merit;
    best = i;
  }
  return best;
}

/// A loop, from its pole round to the pole again, is divided by a cut from its i-th point to its j-th; other loops are
/// on the side of their first point.
std::vector<FacePart> cut(const BrepFace& face, const WantedSize& size, FaceGrid& grid, const FacePart& part,
                          const PoleRun& a, const std::vector<std::uint32_t>& whole, std::size_t i, std::size_t j) {
  const double level = radial(grid, whole[i], a.side);
  const std::vector<std::uint32_t> middle = add_cut(face, size, grid, whole[i], whole[j]);
  const auto at = [&](std::size_t k) { return whole.begin() + std::ptrdiff_t(k); };
  FacePart near, far;
  near.pole = a.side;
  std::vector<std::uint32_t> outer(at(j), whole.end());
  outer.insert(outer.end(), whole.begin(), at(i + 1));
  outer.insert(outer.end(), middle.begin(), middle.end());
  near.loops.push_back(std::move(outer));
  std::vector<std::uint32_t> other(at(i), at(j + 1));
  other.insert(other.end(), middle.rbegin(), middle.rend());
  far.loops.push_back(std::move(other));
  for (std::size_t l = 0; l < part.loops.size(); ++l) {
    if (l == a.loop) continue;
    const double here = radial(grid, part.loops[l][0], a.side);
    ((here < level) == is_low(a.side) ? near : far).loops.push_back(part.loops[l]);
  }
  return {std::move(near), std::move(far)};
}

std::vector<FacePart> cut_between_poles(const BrepFace& face, const WantedSize& size, FaceGrid& grid,
                                        const FacePart& part, const PoleRun& a, const PoleRun& b) {
  const auto& loop = part.loops[a.loop];
  const std::size_t n = loop.size();
  const std::vector<std::uint32_t> there = chain_of(loop, (a.first + 1) % n, b.first);
  const std::vector<std::uint32_t> whole = chain_of(loop, (a.first + 1) % n, a.first);
  if (there.size() < 3 || whole.size() < there.size() + 3) {
    grid.fail("the way from pole to pole has no point between", grid.points[loop[a.first]].at);
    return {};
  }
  const std::size_t i = find_level(grid, part, there, a.side, a.loop);
  const double level = radial(grid, there[i], a.side);
  std::size_t j = there.size() + 1;
  for (std::size_t k = j + 1; k + 1 < whole.size(); ++k)
    if (std::abs(radial(grid, whole[k], a.side) - level) < std::abs(radial(grid, whole[j], a.side) - level)) j = k;
  std::vector<FacePart> parts = cut(face, size, grid, part, a, whole, i, j);
  parts[1].pole = b.side;
  return parts;
}

/// How far from its pole, in parameters, a part is twice as long as it is wide round the pole; all of it where it is
/// nowhere.
double slender_from(const SmoothSurface& surface, const ParameterBox& box, Pole side) {
  const bool by_v = side == Pole::v_low || side == Pole::v_high;
  const double a0 = by_v ? box.low.x : box.low.y, a1 = by_v ? box.high.x : box.high.y;
  const double w0 = by_v ? box.low.y : box.low.x, w1 = by_v ? box.high.y : box.high.x;
  const double pole = is_low(side) ? w0 : w1, step = (is_low(side) ? 1 : -1) * (w1 - w0) / kLevels;
  double length_so_far = 0, first_slope = 0;
  for (int i = 1; i <= kLevels; ++i) {
    double along = 0, around = 0;
    for (int j = 0; j < kAround; ++j) {
      const double a = a0 + (a1 - a0) * (j + 0.5) / kAround, w = pole + step * (i - 0.5), next = pole + step * i;
      along += std::abs(step) / kAround * length(by_v ? surface.tangents({a, w}).v : surface.tangents({w, a}).u);
      around += (a1 - a0) / kAround * length(by_v ? surface.tangents({a, next}).u : surface.tangents({next, a}).v);
    }
    length_so_far += along;
    if (i == 1) first_slope = around / length_so_far;  // the angle round the pole: a plane's, a cone's, go on so
    if (around < first_slope * length_so_far / kSlender) return std::abs(step) * i;
  }
  return w1 - w0;
}

/// Off the pole where the part gets slender: there one chart round the pole would span many orders of magnitude.
std::vector<FacePart> cut_off_pole(const BrepFace& face, const WantedSize& size, FaceGrid& grid, const FacePart& part) {
  const std::vector<PoleRun> runs = find_runs(*face.surface, grid, part);
  if (runs.size() != 1) return {part};
  const PoleRun& a = runs[0];
  const std::vector<std::uint32_t>& loop = part.loops[a.loop];
  const ParameterBox box = box_of(grid, part);
  const double away = slender_from(*face.surface, box, a.side);
  const bool by_v = a.side == Pole::v_low || a.side == Pole::v_high;
  const double low = by_v ? box.low.y : box.low.x, high = by_v ? box.high.y : box.high.x;
  const double level = is_low(a.side) ? low + away : high - away;
  const auto is_beyond = [&](std::uint32_t p) { return (radial(grid, p, a.side) > level) == is_low(a.side); };
  for (std::size_t l = 0; l < part.loops.size(); ++l)  // a cut must not meet other loops
    if (l != a.loop && std::any_of(part.loops[l].begin(), part.loops[l].end(), is_beyond) !=
                           std::all_of(part.loops[l].begin(), part.loops[l].end(), is_beyond))
      return {part};
  const std::vector<std::uint32_t> whole = chain_of(loop, (a.first + 1) % loop.size(), a.first);
  const auto first = std::find_if(whole.begin(), whole.end(), is_beyond);
  const auto last = std::find_if(whole.rbegin(), whole.rend(), is_beyond).base();
  if (last - first < 3 || first == whole.begin() || last == whole.end()) return {part};
  if (!std::all_of(first, last, is_beyond)) return {part};
  return cut(face, size, grid, part, a, whole, std::size_t(first - whole.begin()),
             std::size_t(last - whole.begin()) - 1);
}

}  // namespace

std::vector<FacePart> find_parts(const BrepFace& face, const WantedSize& size, bool cuts_slender, FaceGrid& grid) {
  FacePart whole;
  whole.loops = grid.loops;
  const std::vector<PoleRun> runs = find_runs(*face.surface, grid, whole);
  std::vector<FacePart> parts;
  if (runs.size() < 2) {
    if (!runs.empty()) whole.pole = runs[0].side;
    parts.push_back(std::move(whole));
  } else if (runs.size() == 2 && runs[0].loop == runs[1].loop && are_opposite(runs[0].side, runs[1].side)) {
    parts = cut_between_poles(face, size, grid, whole, runs[0], runs[1]);
  } else {
    grid.fail("it has more poles than two that lie opposite each other", grid.points[grid.loops[0][0]].at);
  }
  if (!cuts_slender) return parts;
  std::vector<FacePart> shorter;
  for (const FacePart& part : parts)
    for (FacePart& piece : cut_off_pole(face, size, grid, part)) shorter.push_back(std::move(piece));
  return shorter;
}

ParameterBox box_of(const FaceGrid& grid, const FacePart& part) {
  Box box;
  for (const auto& loop : part.loops)
    for (const std::uint32_t p : loop) box.add(Point{grid.points[p].uv.x, grid.points[p].uv.y, 0});
  return {{box.low.x, box.low.y}, {box.high.x, box.high.y}};
}

}  // namespace delfront
