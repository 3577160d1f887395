// SPDX-License-Identifier: Apache-2.0
// The Delaunay tetrahedrization of a set of points. Vertices are renumbered along a Hilbert curve for the time of the
// build, so that memory is met in order.
#include <algorithm>

#include "base/parallel.hpp"
#include "delaunay/delaunay.hpp"
#include "delaunay/territories.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = 1 << 14;

bool are_collinear(Point a, Point b, Point c) {
  auto flat = [&](int i, int j) {
    const double p[2] = {a[i], a[j]}, q[2] = {b[i], b[j]}, r[2] = {c[i], c[j]};
    return orient2d(p, q, r) == 0;
  };
  return flat(0, 1) && flat(1, 2) && flat(2, 0);
}

}  // namespace

std::array<VertexIndex, 4> find_first_tet(const TetComplex& complex) {
  const auto n = static_cast<VertexIndex>(complex.num_vertices());
  auto find = [&](VertexIndex from, auto&& fits) {
    while (from < n && !fits(complex.point(from))) ++from;
    return from;
  };
  if (n < 4) throw InputError("fewer than four points: nothing to tetrahedralize");
  const Point a = complex.point(0);
  const VertexIndex i = find(1, [&](Point p) { return !(p == a); });
  if (i == n) throw InputError("all points are at one place");
  const Point b = complex.point(i);
  const VertexIndex j = find(i + 1, [&](Point p) { return !are_collinear(a, b, p); });
  if (j == n) throw InputError("all points lie on one line");
  const Point c = complex.point(j);
  const VertexIndex k = find(j + 1, [&](Point p) { return orient3d(a, b, c, p) != 0; });
  if (k == n) throw InputError("all points lie in one plane: there is no volume to grid");
  return {0, i, j, k};
}

namespace {

class Builder {
 public:
  Builder(TetComplex& complex, Context& context) : c_(complex), context_(context) {}

  std::vector<std::pair<VertexIndex, VertexIndex>> run(KernelCounts& counts) {
    renumber_along_curve();
    const auto duplicates = find_duplicates();
    const auto [a, b, c, d] = find_first_tet(c_);
    DelaunayKernel kernel(c_);
    kernel.start(a, b, c, d);
    std::vector<VertexIndex> vertices;
    for (VertexIndex v = 0; v < original_.size(); ++v)
      if (!is_duplicate_[v] && c_.vertex_tet[v] == kNoIndex) vertices.push_back(v);
    insert_batch(c_, vertices, {}, kernel.last_tet, counts, context_);
    restore_numbers();
    return duplicates;
  }

 private:
  void renumber_along_curve() {
    original_ = hilbert_order(c_.places(), context_.threads);
    unsorted_.resize(original_.size());
    unsorted_.swap(c_.vertex);
    parallel_ranges(context_.threads, original_.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) c_.vertex[i] = unsorted_[original_[i]];
    });
    is_duplicate_.assign(original_.size(), 0);
  }

  /// Equal points are neighbours in the order, the lowest original number first.
  std::vector<std::pair<VertexIndex, VertexIndex>> find_duplicates() {
    std::vector<std::pair<VertexIndex, VertexIndex>> duplicates;
    for (std::size_t i = 1, first = 0; i < original_.size(); ++i) {
      if (!(c_.vertex[i].point() == c_.vertex[first].point())) {
        first = i;
        continue;
      }
      duplicates.push_back({original_[i], original_[first]});
      is_duplicate_[i] = 1;
    }
    std::sort(duplicates.begin(), duplicates.end());
    return duplicates;
  }

  void restore_numbers() {
    c_.vertex.swap(unsorted_);
    FlatArray<TetIndex> tets;
    tets.resize(original_.size());
    parallel_ranges(context_.threads, original_.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) tets[original_[i]] = c_.vertex_tet[i];
    });
    c_.vertex_tet.swap(tets);
    parallel_ranges(context_.threads, c_.node.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i)
        if (c_.node[i] < original_.size()) c_.node[i] = original_[c_.node[i]];
    });
  }

  TetComplex& c_;
  Context& context_;
  std::vector<VertexIndex> original_;  ///< by place along the curve
  FlatArray<TetVertex> unsorted_;
  std::vector<std::uint8_t> is_duplicate_;
};

}  // namespace

std::vector<std::pair<VertexIndex, VertexIndex>> build_delaunay(TetComplex& complex, Context& context,
                                                                KernelCounts* counts) {
  KernelCounts done;
  auto duplicates = Builder(complex, context).run(done);
  if (counts) *counts = done;
  return duplicates;
}

}  // namespace delfront
