// SPDX-License-Identifier: Apache-2.0
// Biased randomized insertion order: rounds that grow by kRoundGrowth, each along a Hilbert curve, so that a walk is
// short and memory is met in order, while no adversary's order makes cavities large.
#include <algorithm>
#include <cmath>

#include "base/hilbert.hpp"
#include "planar/kernel.hpp"

namespace delfront {

namespace {

constexpr double kRoundGrowth = 7.5;
constexpr double kFirstRound = 2048;
constexpr std::size_t kPointsPerCancelCheck = 4096;
constexpr int kBits = 20;  ///< an axis: with four bits for the round, four passes of the radix sort
constexpr double kCells = 1048576.0;
constexpr int kMaxRounds = 15;

// The curve as a state machine: four orientations of a quadrant; by state and quadrant (x, y bits) the digit and the
// state below.
constexpr unsigned char kDigit[4][4] = {{0, 1, 3, 2}, {0, 3, 1, 2}, {2, 3, 1, 0}, {2, 1, 3, 0}};
constexpr unsigned char kBelow[4][4] = {{1, 0, 3, 0}, {0, 2, 1, 1}, {2, 1, 2, 3}, {3, 3, 0, 2}};

/// Two levels at a time: by state and the two bits of x and of y, four bits of the key and the state after them.
struct TwoLevels {
  unsigned char key[4][16], below[4][16];
};
constexpr TwoLevels make_two_levels() {
  TwoLevels t{};
  for (unsigned state = 0; state < 4; ++state)
    for (unsigned x = 0; x < 4; ++x)
      for (unsigned y = 0; y < 4; ++y) {
        const unsigned upper = (x >> 1) << 1 | y >> 1, lower = (x & 1) << 1 | (y & 1);
        const unsigned middle = kBelow[state][upper];
        t.key[state][x << 2 | y] = static_cast<unsigned char>(kDigit[state][upper] << 2 | kDigit[middle][lower]);
        t.below[state][x << 2 | y] = kBelow[middle][lower];
      }
  return t;
}
constexpr TwoLevels kTwoLevels = make_two_levels();

std::uint32_t cell_of(double offset, double scale) {
  const double cell = offset * scale;
  if (!(cell > 0)) return 0;
  return cell >= kCells ? (1u << kBits) - 1 : static_cast<std::uint32_t>(cell);
}

/// A number from 0 to 1 by index (splitmix64): the same in every run.
double by_chance(std::uint64_t i) {
  i = (i + 1) * 0x9e3779b97f4a7c15ull;
  i = (i ^ i >> 30) * 0xbf58476d1ce4e5b9ull;
  i = (i ^ i >> 27) * 0x94d049bb133111ebull;
  return static_cast<double>((i ^ i >> 31) >> 11) * 0x1p-53;
}

std::vector<VertexIndex> insertion_order(const TriComplex& complex) {
  const std::size_t n = complex.point.size();
  const HilbertCurve2 curve(complex.point);
  double limit[kMaxRounds];  // share of the points that go in before the last round, the last but one, …
  int rounds = 0;
  for (double share = 1 / kRoundGrowth; rounds < kMaxRounds && share * static_cast<double>(n) > kFirstRound;
       share /= kRoundGrowth)
    limit[rounds++] = share;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double chance = by_chance(i);
    int from_last = 0;
    while (from_last < rounds && chance < limit[from_last]) ++from_last;
    const auto round = static_cast<std::uint64_t>(rounds - from_last);
    keyed[i] = {round << 2 * kBits | curve.key(complex.point[i]), static_cast<std::uint32_t>(i)};
  }
  radix_sort(keyed);
  std::vector<VertexIndex> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = keyed[i].second;
  return order;
}

/// Moves three vertices that are not on one line to the front of the order.
void find_first_triangle(const TriComplex& complex, std::vector<VertexIndex>& order) {
  auto bring = [&](std::size_t to, auto&& fits) {
    for (std::size_t i = to; i < order.size(); ++i)
      if (fits(complex.point[order[i]])) {
        std::rotate(order.begin() + static_cast<std::ptrdiff_t>(to), order.begin() + static_cast<std::ptrdiff_t>(i),
                    order.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        return true;
      }
    return false;
  };
  if (order.size() < 3) throw InputError("fewer than three points: nothing to triangulate");
  const Point2 a = complex.point[order[0]];
  if (!bring(1, [&](Point2 p) { return p.x != a.x || p.y != a.y; })) throw InputError("all points are at one place");
  const Point2 b = complex.point[order[1]];
  if (!bring(2, [&](Point2 p) { return orient2d(a, b, p) != 0; })) throw InputError("all points lie on one line");
}

/// Of points at one place the one with the lowest number stays, whichever was inserted first.
void keep_the_first(TriComplex& complex, std::vector<std::pair<VertexIndex, VertexIndex>>& duplicates) {
  std::vector<VertexIndex> first(complex.point.size());
  for (VertexIndex v = 0; v < first.size(); ++v) first[v] = v;
  for (const auto& [v, in] : duplicates) first[in] = std::min(first[in], v);
  for (auto& [v, in] : duplicates)
    if (v == first[in])
      v = in, in = first[in];
    else
      in = first[in];
  for (Triangle& t : complex.tri)
    for (VertexIndex& v : t.node)
      if (v != kInfinity) v = first[v];
  std::sort(duplicates.begin(), duplicates.end());
}

}  // namespace

HilbertCurve2::HilbertCurve2(std::span<const Point2> points) {
  if (points.empty()) return;
  Point2 high = low_ = points[0];
  for (const Point2 p : points) {
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const double side = std::max(high.x - low_.x, high.y - low_.y);
  scale_ = side > 0 && std::isfinite(kCells / side) ? kCells / side : 0;
}

std::uint64_t HilbertCurve2::key(Point2 p) const {
  const std::uint32_t x = cell_of(p.x - low_.x, scale_), y = cell_of(p.y - low_.y, scale_);
  std::uint64_t key = 0;
  unsigned state = 0;
  for (int bit = kBits - 2; bit >= 0; bit -= 2) {
    const unsigned cell = (x >> bit & 3) << 2 | (y >> bit & 3);
    key = key << 4 | kTwoLevels.key[state][cell];
    state = kTwoLevels.below[state][cell];
  }
  return key;
}

std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TriComplex& complex, PlanarKernel& kernel,
                                                                Context& context) {
  std::vector<VertexIndex> order = insertion_order(complex);
  find_first_triangle(complex, order);
  // Points are numbered in the order they go in as long as that lasts: what lies together is read together.
  std::vector<Point2> in_order(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) in_order[i] = complex.point[order[i]];
  complex.point.swap(in_order);
  complex.tri.clear();
  complex.free_slots.clear();
  complex.tri.reserve(2 * order.size() + 16);
  kernel.start(0, 1, 2);
  std::vector<std::pair<VertexIndex, VertexIndex>> duplicates;
  for (VertexIndex i = 3; i < order.size(); ++i) {
    if (kernel.insert(i, kernel.last_tri) == PlanarKernel::Insert::duplicate)
      duplicates.push_back({order[i], order[kernel.duplicate_of]});
    if (i % kPointsPerCancelCheck == 0) context.progress("triangulate", i, order.size(), "points");
  }
  complex.point.swap(in_order);
  for (Triangle& t : complex.tri)
    for (VertexIndex& v : t.node)
      if (v != kInfinity) v = order[v];
  if (!duplicates.empty()) keep_the_first(complex, duplicates);
  return duplicates;
}

}  // namespace delfront
