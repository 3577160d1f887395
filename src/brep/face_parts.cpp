// SPDX-License-Identifier: Apache-2.0
#include "brep/face_parts.hpp"

#include <algorithm>
#include <cmath>

#include "brep/edge_points.hpp"

namespace delfront {
namespace {

using Pole = Chart::Pole;

constexpr double kRoom = 0.7;  ///< between a cut and other loops, of two sides of the loop there

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

std::vector<PoleRun> find_runs(const SmoothSurface& surface, const FaceGrid& grid) {
  std::vector<PoleRun> runs;
  for (std::size_t l = 0; l < grid.loops.size(); ++l) {
    const auto& loop = grid.loops[l];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const FacePoint &a = grid.points[loop[i]], &b = grid.points[loop[(i + 1) % loop.size()]];
      if (a.is_pole && b.is_pole && a.vertex == b.vertex) runs.push_back({l, i, side_of(surface, a.uv, b.uv)});
    }
  }
  return runs;
}

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
  const auto sample = [&](double t) {
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
std::size_t find_level(const FaceGrid& grid, const std::vector<std::uint32_t>& way, Pole side, std::size_t loop) {
  std::vector<std::array<double, 2>> others;
  for (std::size_t l = 0; l < grid.loops.size(); ++l) {
    if (l == loop) continue;
    std::array<double, 2> range = {1e300, -1e300};
    for (const std::uint32_t p : grid.loops[l])
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

std::vector<FacePart> cut(const BrepFace& face, const WantedSize& size, FaceGrid& grid, const PoleRun& a,
                          const PoleRun& b) {
  const auto& loop = grid.loops[a.loop];
  const std::size_t n = loop.size();
  const std::vector<std::uint32_t> there = chain_of(loop, (a.first + 1) % n, b.first);
  const std::vector<std::uint32_t> back = chain_of(loop, (b.first + 1) % n, a.first);
  if (there.size() < 3 || back.size() < 3) {
    grid.fail("the way from pole to pole has no point between", grid.points[loop[a.first]].at);
    return {};
  }
  const std::size_t i = find_level(grid, there, a.side, a.loop);
  const double level = radial(grid, there[i], a.side);
  std::size_t j = 1;
  for (std::size_t k = 2; k + 1 < back.size(); ++k)
    if (std::abs(radial(grid, back[k], a.side) - level) < std::abs(radial(grid, back[j], a.side) - level)) j = k;
  const std::vector<std::uint32_t> middle = add_cut(face, size, grid, there[i], back[j]);
  FacePart at_a, at_b;
  at_a.pole = a.side;
  at_b.pole = b.side;
  // a: from the cut's end back to the pole, and on to the cut's beginning; then along the cut
  std::vector<std::uint32_t> outer(back.begin() + std::ptrdiff_t(j), back.end());
  outer.insert(outer.end(), there.begin(), there.begin() + std::ptrdiff_t(i) + 1);
  outer.insert(outer.end(), middle.begin(), middle.end());
  at_a.loops.push_back(std::move(outer));
  std::vector<std::uint32_t> other(there.begin() + std::ptrdiff_t(i), there.end());
  other.insert(other.end(), back.begin(), back.begin() + std::ptrdiff_t(j) + 1);
  other.insert(other.end(), middle.rbegin(), middle.rend());
  at_b.loops.push_back(std::move(other));
  for (std::size_t l = 0; l < grid.loops.size(); ++l) {
    if (l == a.loop) continue;
    const double here = radial(grid, grid.loops[l][0], a.side);
    const bool a_is_low = a.side == Pole::u_low || a.side == Pole::v_low;
    ((here < level) == a_is_low ? at_a : at_b).loops.push_back(grid.loops[l]);
  }
  return {std::move(at_a), std::move(at_b)};
}

}  // namespace

std::vector<FacePart> find_parts(const BrepFace& face, const WantedSize& size, FaceGrid& grid) {
  const std::vector<PoleRun> runs = find_runs(*face.surface, grid);
  if (runs.size() < 2) {
    FacePart whole;
    whole.loops = grid.loops;
    if (!runs.empty()) whole.pole = runs[0].side;
    return {std::move(whole)};
  }
  if (runs.size() == 2 && runs[0].loop == runs[1].loop && are_opposite(runs[0].side, runs[1].side))
    return cut(face, size, grid, runs[0], runs[1]);
  grid.fail("it has more poles than two that lie opposite each other", grid.points[grid.loops[0][0]].at);
  return {};
}

ParameterBox box_of(const FaceGrid& grid, const FacePart& part) {
  Box box;
  for (const auto& loop : part.loops)
    for (const std::uint32_t p : loop) box.add(Point{grid.points[p].uv.x, grid.points[p].uv.y, 0});
  return {{box.low.x, box.low.y}, {box.high.x, box.high.y}};
}

}  // namespace delfront
