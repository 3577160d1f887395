// SPDX-License-Identifier: Apache-2.0
#include "geometry/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/hilbert.hpp"
#include "predicates/predicates.hpp"

namespace delfront {
namespace {

/// A power of two that brings coordinates into the predicates' range; 1 for all usual models.
double scale_for(const Array<VertexId, Point>& points) {
  double largest = 0;
  for (const Point& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  if (largest == 0 || (largest >= std::ldexp(1.0, -20) && largest <= std::ldexp(1.0, 60))) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1020, 1020));
}

bool has_no_area(Point a, Point b, Point c) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double p[2] = {a[i], a[j]}, q[2] = {b[i], b[j]}, r[2] = {c[i], c[j]};
    if (orient2d(p, q, r) != 0) return false;
  }
  return true;
}

/// The first triangle with the same corners, for each.
std::vector<std::uint32_t> find_twins(const Array<TriangleId, std::array<VertexId, 3>>& triangles) {
  const std::size_t n = triangles.size();
  std::vector<std::array<VertexId, 3>> sorted(triangles.begin(), triangles.end());
  for (auto& corners : sorted) std::sort(corners.begin(), corners.end());
  // Two stable passes order by all three corners: the third, then the first two.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(n);
  for (std::uint32_t t = 0; t < n; ++t) order[t] = {sorted[t][2].value, t};
  radix_sort(order);
  for (auto& [key, t] : order) key = std::uint64_t(sorted[t][0].value) << 32 | sorted[t][1].value;
  radix_sort(order);
  std::vector<std::uint32_t> twin(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t t = order[i].second;
    const bool is_copy = i > 0 && sorted[order[i - 1].second] == sorted[t];
    twin[t] = is_copy ? twin[order[i - 1].second] : t;
  }
  return twin;
}

}  // namespace

SurfaceEdges::SurfaceEdges(const Array<TriangleId, std::array<VertexId, 3>>& triangles,
                           const std::vector<bool>& is_used) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> items;
  items.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!is_used[t]) continue;
    const auto& corners = triangles[TriangleId(t)];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corners[k].value, corners[(k + 1) % 3].value);
      items.push_back({std::uint64_t(low) << 32 | high, static_cast<std::uint32_t>(3 * t + k)});
    }
  }
  radix_sort(items);
  edge_of_.assign(3 * triangles.size(), kNoTriangle);
  half_edges_.reserve(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto [key, half_edge] = items[i];
    if (i == 0 || key != items[i - 1].first) {
      offsets_.push_back(static_cast<std::uint32_t>(i));
      ends_.push_back({VertexId(key >> 32), VertexId(key & 0xffffffffu)});
    }
    half_edges_.push_back(half_edge);
    edge_of_[half_edge] = static_cast<std::uint32_t>(ends_.size() - 1);
  }
  offsets_.push_back(static_cast<std::uint32_t>(items.size()));
}

Surface::Surface(const Model& given) : model(given), scale(scale_for(given.points)), points(given.points) {
  if (scale != 1)
    for (Point& p : points) p = scale * p;
  const std::size_t n = num_triangles();
  has_edges.resize(n);
  is_degenerate.resize(n);
  for (std::size_t t = 0; t < n; ++t) {
    const auto& [a, b, c] = corners(t);
    has_edges[t] = a != b && b != c && c != a;
    is_degenerate[t] = !has_edges[t] || has_no_area(points[a], points[b], points[c]);
  }
  twin = find_twins(model.triangles);
  edges = SurfaceEdges(model.triangles, has_edges);
}

Point Surface::centroid(std::size_t t) const {
  Point sum;
  for (VertexId v : corners(t)) sum = sum + model.points[v] / 3;
  return sum;
}

Box Surface::box(std::size_t t) const {
  Box box;
  for (VertexId v : corners(t)) box.add(points[v]);
  return box;
}

DisjointSets::DisjointSets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }

std::uint32_t DisjointSets::find(std::uint32_t i) {
  while (parent_[i] != i) {
    parent_[i] = parent_[parent_[i]];
    i = parent_[i];
  }
  return i;
}

void DisjointSets::join(std::uint32_t i, std::uint32_t j) {
  i = find(i);
  j = find(j);
  if (i != j) parent_[std::max(i, j)] = std::min(i, j);
}

std::vector<std::uint32_t> DisjointSets::number(std::uint32_t& num_groups) {
  std::vector<std::uint32_t> group(parent_.size());
  num_groups = 0;
  for (std::uint32_t i = 0; i < parent_.size(); ++i) {
    const std::uint32_t root = find(i);  // never above i, so numbered before
    group[i] = root == i ? num_groups++ : group[root];
  }
  return group;
}

std::vector<bool> peel_open_triangles(const Surface& surface) {
  const std::size_t n = surface.num_triangles();
  std::vector<bool> is_peeled(n, false);
  std::vector<std::uint32_t> uses(surface.edges.size());
  for (std::size_t e = 0; e < uses.size(); ++e)
    uses[e] = static_cast<std::uint32_t>(surface.edges.half_edges(e).size());
  std::vector<std::uint32_t> queue;
  auto peel = [&](std::size_t t) {
    if (is_peeled[t]) return;
    is_peeled[t] = true;
    queue.push_back(static_cast<std::uint32_t>(t));
  };
  for (std::size_t t = 0; t < n; ++t)
    if (!surface.has_edges[t] || !surface.is_first(t)) peel(t);
  for (std::size_t e = 0; e < uses.size(); ++e)
    if (uses[e] == 1) peel(surface.edges.half_edges(e)[0] / 3);
  while (!queue.empty()) {
    const std::uint32_t t = queue.back();
    queue.pop_back();
    if (!surface.has_edges[t]) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t e = surface.edges.edge_of(3 * t + k);
      if (--uses[e] != 1) continue;
      for (std::uint32_t h : surface.edges.half_edges(e)) peel(h / 3);
    }
  }
  return is_peeled;
}

}  // namespace delfront
