// SPDX-License-Identifier: Apache-2.0
// Biased randomized insertion order: rounds that grow by kRoundGrowth, each along a Hilbert curve, so that a walk is
// short and memory is met in order, while no adversary's order makes cavities large.
#include <algorithm>

#include "base/hilbert.hpp"
#include "delaunay/delaunay.hpp"

namespace delfront {

namespace {

constexpr double kRoundGrowth = 7.5;
constexpr std::size_t kFirstRound = 2048;
constexpr std::size_t kPointsPerCancelCheck = 4096;

std::vector<VertexIndex> insertion_order(const TetComplex& complex) {
  const std::size_t n = complex.num_vertices();
  std::vector<VertexIndex> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<VertexIndex>(i);
  std::uint64_t state = 88172645463325252ull;  // xorshift64: a fixed seed, so the same order in every run
  for (std::size_t i = n; i > 1; --i) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    std::swap(order[i - 1], order[state % i]);
  }
  Box box;
  for (const TetVertex& v : complex.vertex) box.add(v.point());
  const HilbertCurve curve(box);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed;
  std::size_t last = n;
  while (last > 0) {  // rounds from the last, largest one back to the first
    std::size_t first = static_cast<std::size_t>(static_cast<double>(last) / kRoundGrowth);
    if (first < kFirstRound) first = 0;
    keyed.clear();
    for (std::size_t i = first; i < last; ++i) keyed.push_back({curve.key(complex.point(order[i])), order[i]});
    radix_sort(keyed);
    for (std::size_t i = first; i < last; ++i) order[i] = keyed[i - first].second;
    last = first;
  }
  return order;
}

bool are_collinear(Point a, Point b, Point c) {
  auto flat = [&](int i, int j) {
    const double p[2] = {a[i], a[j]}, q[2] = {b[i], b[j]}, r[2] = {c[i], c[j]};
    return orient2d(p, q, r) == 0;
  };
  return flat(0, 1) && flat(1, 2) && flat(2, 0);
}

/// Moves four vertices that span a volume to the front of the order.
void find_first_tet(const TetComplex& complex, std::vector<VertexIndex>& order) {
  auto bring = [&](std::size_t to, auto&& fits) {
    for (std::size_t i = to; i < order.size(); ++i)
      if (fits(complex.point(order[i]))) {
        std::rotate(order.begin() + static_cast<std::ptrdiff_t>(to), order.begin() + static_cast<std::ptrdiff_t>(i),
                    order.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        return true;
      }
    return false;
  };
  if (order.size() < 4) throw InputError("fewer than four points: nothing to tetrahedralize");
  const Point a = complex.point(order[0]);
  if (!bring(1, [&](Point p) { return !(p == a); })) throw InputError("all points are at one place");
  const Point b = complex.point(order[1]);
  if (!bring(2, [&](Point p) { return !are_collinear(a, b, p); })) throw InputError("all points lie on one line");
  const Point c = complex.point(order[2]);
  if (!bring(3, [&](Point p) { return orient3d(a, b, c, p) != 0; }))
    throw InputError("all points lie in one plane: there is no volume to grid");
}

}  // namespace

std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TetComplex& complex, DelaunayKernel& kernel,
                                                                Context& context) {
  std::vector<VertexIndex> order = insertion_order(complex);
  find_first_tet(complex, order);
  kernel.start(order[0], order[1], order[2], order[3]);
  std::vector<std::pair<VertexIndex, VertexIndex>> duplicates;
  for (std::size_t i = 4; i < order.size(); ++i) {
    if (kernel.insert(order[i], kernel.last_tet) == DelaunayKernel::Insert::duplicate)
      duplicates.push_back({order[i], kernel.duplicate_of});
    if (i % kPointsPerCancelCheck == 0) context.progress("tetrahedralize", i, order.size(), "points");
  }
  std::sort(duplicates.begin(), duplicates.end());
  return duplicates;
}

std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TetComplex& complex, Context& context) {
  DelaunayKernel kernel(complex);
  return build_delaunay(complex, kernel, context);
}

}  // namespace delfront
