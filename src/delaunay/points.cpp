// SPDX-License-Identifier: Apache-2.0
// The public calls on point sets: check what comes in, build, number what goes out without ghosts and dead slots.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/hilbert.hpp"
#include "base/parallel.hpp"
#include "delaunay/regular.hpp"
#include "delfront/delaunay.hpp"
#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = 1 << 14;
constexpr double kLargest = 0x1p100, kLargestWeight = 0x1p200;  ///< as the predicates want
constexpr std::size_t kTetsPerPoint = 7;                        ///< 6.77 in a uniform set
constexpr std::size_t kMostTets = std::size_t{1} << 30;
constexpr std::size_t kPointsPerCancelCheck = 1024;

bool is_in_range(Point p) {
  return std::fabs(p.x) <= kLargest && std::fabs(p.y) <= kLargest && std::fabs(p.z) <= kLargest;
}

void check_points(std::span<const Point> points, Context& context) {
  check_floating_point_mode();
  if (points.size() < 4)
    throw InputError(fmt::format("{} points: a tetrahedrization needs at least four", points.size()));
  if (points.size() > kMostTets / kTetsPerPoint)
    throw LimitError(
        fmt::format("{} points make about {:.2g} tetrahedra, and one tetrahedrization holds 2^30 (1.07e9); "
                    "divide the points into parts of at most {}",
                    points.size(), static_cast<double>(points.size() * kTetsPerPoint), kMostTets / kTetsPerPoint));
  parallel_ranges(context.threads, points.size(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      if (!is_in_range(points[i]))
        throw InputError(fmt::format("point {} at ({:g}, {:g}, {:g}) is not finite, or over 2^100", i, points[i].x,
                                     points[i].y, points[i].z),
                         {{points[i], {static_cast<std::uint32_t>(i)}}});
  });
}

void check_weights(std::span<const Point> points, std::span<const double> weights) {
  if (weights.size() != points.size())
    throw InputError(fmt::format("{} weights for {} points: give one a point", weights.size(), points.size()));
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!(std::fabs(weights[i]) <= kLargestWeight))
      throw InputError(fmt::format("weight {} of point {} is not finite, or over 2^200", weights[i], i),
                       {{points[i], {static_cast<std::uint32_t>(i)}}});
}

/// A power of two that brings small coordinates near 1, where the filters of the predicates decide most: exact. Weights
/// take its square and stay in range.
double scale_of(std::span<const Point> points, std::span<const double> weights) {
  double largest = 0;
  for (const Point& p : points) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  for (const double weight : weights) largest = std::max(largest, std::sqrt(std::fabs(weight)));
  return largest > 0 && largest < 0x1p-20 ? std::ldexp(1.0, std::min(-std::ilogb(largest), 1000)) : 1;
}

/// @param weights  none, or one a point
TetComplex complex_of(std::span<const Point> points, std::span<const double> weights, Context& context) {
  const double scale = scale_of(points, weights);
  TetComplex complex;
  complex.vertex.resize(points.size());
  complex.vertex_tet.resize(points.size(), kNoIndex);
  complex.on_boundary.resize(points.size(), 0);
  parallel_ranges(context.threads, points.size(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      complex.vertex[i] = {scale * points[i].x, scale * points[i].y, scale * points[i].z,
                           weights.empty() ? 0 : scale * (scale * weights[i])};
  });
  return complex;
}

/// Live tets before each range of kGrain slots, real ones and ghosts apart.
struct Numbers {
  std::vector<std::uint32_t> tets, ghosts;
};

Numbers count_live(const TetComplex& c, Context& context) {
  const std::size_t ranges = (c.num_slots() + kGrain - 1) / kGrain;
  Numbers before{std::vector<std::uint32_t>(ranges + 1, 0), std::vector<std::uint32_t>(ranges + 1, 0)};
  parallel_ranges(context.threads, c.num_slots(), kGrain, [&](std::size_t first, std::size_t last) {
    std::uint32_t tets = 0, ghosts = 0;
    for (std::size_t t = first; t < last; ++t) {
      if (c.is_dead(static_cast<TetIndex>(t))) continue;
      ++(c.is_ghost(static_cast<TetIndex>(t)) ? ghosts : tets);
    }
    before.tets[first / kGrain + 1] = tets;
    before.ghosts[first / kGrain + 1] = ghosts;
  });
  std::partial_sum(before.tets.begin(), before.tets.end(), before.tets.begin());
  std::partial_sum(before.ghosts.begin(), before.ghosts.end(), before.ghosts.begin());
  return before;
}

/// Tets, neighbours and hull out of the complex, whose tets are given back as soon as they have been copied.
void export_tets(TetComplex& c, Tetrahedrization& result, Context& context) {
  const Numbers before = count_live(c, context);
  context.check_cells(before.tets.back());
  std::vector<std::uint32_t> number(c.num_slots(), Tetrahedrization::kNone);
  result.tets.resize(before.tets.back());
  result.hull.resize(before.ghosts.back());
  parallel_ranges(context.threads, c.num_slots(), kGrain, [&](std::size_t first, std::size_t last) {
    std::uint32_t next = before.tets[first / kGrain], next_ghost = before.ghosts[first / kGrain];
    for (std::size_t t = first; t < last; ++t) {
      if (c.is_dead(static_cast<TetIndex>(t))) continue;
      const std::uint32_t* n = &c.node[4 * t];
      if (n[3] == kGhost) {
        result.hull[next_ghost++] = {n[0], n[1], n[2]};
      } else {
        number[t] = next;
        result.tets[next++] = {n[0], n[1], n[2], n[3]};
      }
    }
  });
  c.node.release();
  result.neighbours.resize(result.tets.size());
  parallel_ranges(context.threads, number.size(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) {
      if (number[t] == Tetrahedrization::kNone) continue;
      for (std::size_t f = 0; f < 4; ++f) result.neighbours[number[t]][f] = number[c.neigh[4 * t + f] >> 2];
    }
  });
}

/// Points of one place: all but the heaviest (the lowest of these) are duplicates. `order` has them side by side.
/// @return by point, the one that is used in its place
std::vector<std::uint32_t> find_duplicates(std::span<const Point> points, std::span<const double> weights,
                                           const std::vector<std::uint32_t>& order, Tetrahedrization& result) {
  std::vector<std::uint32_t> used(points.size());
  for (std::size_t i = 0, j = 0; i < order.size(); i = j) {
    std::uint32_t heaviest = order[i];
    for (j = i + 1; j < order.size() && points[order[j]] == points[order[i]]; ++j)
      if (weights[order[j]] > weights[heaviest]) heaviest = order[j];
    for (std::size_t k = i; k < j; ++k) {
      used[order[k]] = heaviest;
      if (order[k] != heaviest) result.duplicates.push_back({order[k], heaviest});
    }
  }
  std::sort(result.duplicates.begin(), result.duplicates.end());
  return used;
}

/// Biased random insertion order: rounds that grow by eight, each along the curve. The round comes from a hash of the
/// place along the curve, so it is the same for the points in any order.
std::vector<std::uint32_t> insertion_order(const std::vector<std::uint32_t>& curve_order) {
  const int last = static_cast<int>(std::bit_width(curve_order.size() >> 10)) / 3;
  std::vector<std::vector<std::uint32_t>> rounds(static_cast<std::size_t>(last) + 1);
  for (std::size_t i = 0; i < curve_order.size(); ++i) {
    std::uint64_t hash = (i + 1) * 0x9e3779b97f4a7c15ull;  // the finalizer of splitmix64
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ull;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebull;
    hash ^= hash >> 31;
    rounds[static_cast<std::size_t>(std::min(std::countr_zero(hash) / 3, last))].push_back(curve_order[i]);
  }
  std::vector<std::uint32_t> order;
  for (std::size_t r = rounds.size(); r-- > 0;) order.insert(order.end(), rounds[r].begin(), rounds[r].end());
  return order;
}

}  // namespace

Tetrahedrization delaunay(std::span<const Point> points, Context& context) {
  check_points(points, context);
  TetComplex complex = complex_of(points, {}, context);
  Tetrahedrization result;
  result.duplicates = build_delaunay(complex, context, &result.counts);
  export_tets(complex, result, context);
  return result;
}

Tetrahedrization regular(std::span<const Point> points, std::span<const double> weights, Context& context) {
  check_points(points, context);
  check_weights(points, weights);
  TetComplex complex = complex_of(points, weights, context);
  const std::vector<std::uint32_t> curve_order = hilbert_order(points, context.threads);
  Tetrahedrization result;
  const std::vector<std::uint32_t> used = find_duplicates(points, weights, curve_order, result);
  RegularKernel kernel(complex);
  std::array<VertexIndex, 4> first = find_first_tet(complex);
  for (VertexIndex& v : first) v = used[v];
  kernel.start(first[0], first[1], first[2], first[3]);
  std::uint64_t done = 0;
  for (const std::uint32_t v : insertion_order(curve_order)) {
    if (done++ % kPointsPerCancelCheck == 0) context.progress("tetrahedralize", done - 1, points.size(), "points");
    if (used[v] == v && std::find(first.begin(), first.end(), v) == first.end()) kernel.insert(v);
  }
  for (VertexIndex v = 0; v < points.size(); ++v)
    if (used[v] == v && complex.vertex_tet[v] == kNoIndex) result.hidden.push_back(v);
  result.counts = kernel.counts();
  export_tets(complex, result, context);
  return result;
}

}  // namespace delfront
