// SPDX-License-Identifier: Apache-2.0
#include "sizing/refined_grid.hpp"

#include <bit>
#include <span>

namespace delfront {

namespace {

constexpr std::uint32_t kNone = SimplexGrid::kNone;
constexpr std::size_t kTetEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
constexpr std::size_t kTriangleEdges[3][2] = {{0, 1}, {0, 2}, {1, 2}};
// A tetrahedron's vertices in even order with the edge, or the face, first.
constexpr std::size_t kEdgeFirst[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                          {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
constexpr std::size_t kFaceFirst[4][4] = {{1, 3, 2, 0}, {0, 2, 3, 1}, {0, 3, 1, 2}, {0, 1, 2, 3}};
constexpr unsigned kFaceEdges[4] = {0b111000, 0b100110, 0b010101, 0b001011};

std::span<const std::size_t[2]> edges(int dimension) {
  if (dimension == 3) return kTetEdges;
  return kTriangleEdges;
}

}  // namespace

RefinedGrid::RefinedGrid(int dimension, std::vector<Point> points, std::vector<double> size, std::vector<Cell> cells)
    : dimension_(dimension), points_(std::move(points)), size_(std::move(size)), cells_(std::move(cells)) {}

std::uint32_t RefinedGrid::middle(std::uint32_t a, std::uint32_t b) const {
  const auto found = middle_of_.find(key_of(a, b));
  return found == middle_of_.end() ? kNone : found->second;
}

std::uint32_t RefinedGrid::split_edge(std::uint32_t a, std::uint32_t b) {
  const auto [found, is_new] = middle_of_.try_emplace(key_of(a, b), static_cast<std::uint32_t>(points_.size()));
  if (is_new) {
    points_.push_back(0.5 * (points_[a] + points_[b]));
    size_.push_back(0.5 * (size_[a] + size_[b]));
  }
  return found->second;
}

unsigned RefinedGrid::split_edges(const Cell& cell, bool& is_deep) const {
  unsigned marks = 0;
  std::array<std::uint32_t, 6> at{};
  const auto all = edges(dimension_);
  for (std::size_t e = 0; e < all.size(); ++e) {
    const std::uint32_t a = cell[all[e][0]], b = cell[all[e][1]];
    at[e] = middle(a, b);
    if (at[e] == kNone) continue;
    marks |= 1u << e;
    is_deep = is_deep || middle(a, at[e]) != kNone || middle(at[e], b) != kNone;
  }
  if (dimension_ == 3)
    for (unsigned face : kFaceEdges) {
      if ((marks & face) != face) continue;
      std::array<std::uint32_t, 3> inner{};
      std::size_t n = 0;
      for (std::size_t e = 0; e < 6; ++e)
        if (face >> e & 1u) inner[n++] = at[e];
      for (std::size_t k = 0; k < 3; ++k) is_deep = is_deep || middle(inner[k], inner[(k + 1) % 3]) != kNone;
    }
  return marks;
}

/// Whether the closure must split this cell; two split edges of one face get the third.
bool RefinedGrid::needs_split(const Cell& cell, bool& has_changed) {
  bool is_deep = false;
  const unsigned marks = split_edges(cell, is_deep);
  if (is_deep) return true;
  const int count = std::popcount(marks);
  if (count <= 1) return false;
  if (dimension_ == 2) return true;
  for (unsigned face : kFaceEdges) {
    if ((marks & ~face) != 0) continue;
    for (std::size_t e = 0; e < 6; ++e)
      if ((face & ~marks) >> e & 1u) {
        split_edge(cell[kTetEdges[e][0]], cell[kTetEdges[e][1]]);
        has_changed = true;
      }
    return false;
  }
  return true;
}

/// The octahedron in the middle is cut along its shortest diagonal.
void RefinedGrid::split_tet(const Cell& v, std::vector<Cell>& into) {
  std::array<std::uint32_t, 6> m{};
  for (std::size_t e = 0; e < 6; ++e) m[e] = split_edge(v[kTetEdges[e][0]], v[kTetEdges[e][1]]);
  const auto [m01, m02, m03, m12, m13, m23] = m;
  into.push_back({v[0], m01, m02, m03});
  into.push_back({m01, v[1], m12, m13});
  into.push_back({m02, m12, v[2], m23});
  into.push_back({m03, m13, m23, v[3]});
  // A diagonal, and the other four middles around it, right-handed.
  const std::array<std::array<std::uint32_t, 6>, 3> diagonals = {
      {{m01, m23, m02, m12, m13, m03}, {m02, m13, m01, m03, m23, m12}, {m03, m12, m01, m13, m23, m02}}};
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const double l = squared_length(points_[diagonals[k][0]] - points_[diagonals[k][1]]);
    if (l < least * (1 - 1e-9)) {
      least = l;
      best = k;
    }
  }
  const auto& d = diagonals[best];
  for (std::size_t k = 0; k < 4; ++k) {
    const std::uint32_t p = d[2 + k], q = d[2 + (k + 1) % 4];
    const Point a = points_[d[0]];
    const double volume = dot(points_[d[1]] - a, cross(points_[p] - a, points_[q] - a));
    into.push_back(volume > 0 ? Cell{d[0], d[1], p, q} : Cell{d[0], d[1], q, p});
  }
}

void RefinedGrid::split(const Cell& v, std::vector<Cell>& into) {
  if (dimension_ == 3) return split_tet(v, into);
  const std::uint32_t m01 = split_edge(v[0], v[1]), m02 = split_edge(v[0], v[2]), m12 = split_edge(v[1], v[2]);
  into.push_back({v[0], m01, m02, kNone});
  into.push_back({m01, v[1], m12, kNone});
  into.push_back({m02, m12, v[2], kNone});
  into.push_back({m01, m12, m02, kNone});
}

RefinedGrid::Refinement RefinedGrid::refine(std::vector<char> is_marked) {
  Refinement result;
  for (std::size_t i = 0; i < cells_.size(); ++i) result.parent_of.push_back(static_cast<std::uint32_t>(i));
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    std::vector<Cell> next;
    std::vector<std::uint32_t> parent;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const Cell cell = cells_[i];
      const bool is_split = is_marked[i] != 0 || needs_split(cell, has_changed);
      if (is_split) {
        split(cell, next);
        ++result.refined;
        has_changed = true;
      } else {
        next.push_back(cell);
      }
      parent.resize(next.size(), result.parent_of[i]);
    }
    cells_ = std::move(next);
    result.parent_of = std::move(parent);
    is_marked.assign(cells_.size(), 0);
  }
  return result;
}

void RefinedGrid::pieces(std::size_t index, std::vector<Cell>& into) const {
  const Cell& v = cells_[index];
  bool is_deep = false;
  const unsigned marks = split_edges(v, is_deep);
  if (marks == 0) {
    into.push_back(v);
  } else if (dimension_ == 2) {
    const auto e = static_cast<std::size_t>(std::countr_zero(marks));
    const std::size_t a = kTriangleEdges[e][0], b = kTriangleEdges[e][1];
    const std::uint32_t m = middle(v[a], v[b]);
    Cell first = v, second = v;
    first[b] = m;
    second[a] = m;
    into.push_back(first);
    into.push_back(second);
  } else if (std::popcount(marks) == 1) {
    const auto& at = kEdgeFirst[std::countr_zero(marks)];
    const std::uint32_t a = v[at[0]], b = v[at[1]], m = middle(a, b);
    into.push_back({a, m, v[at[2]], v[at[3]]});
    into.push_back({m, b, v[at[2]], v[at[3]]});
  } else {
    std::size_t face = 0;
    while (kFaceEdges[face] != marks) ++face;
    const auto& at = kFaceFirst[face];
    const std::uint32_t a = v[at[0]], b = v[at[1]], c = v[at[2]], d = v[at[3]];
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    into.push_back({a, ab, ca, d});
    into.push_back({ab, b, bc, d});
    into.push_back({ca, bc, c, d});
    into.push_back({ab, bc, ca, d});
  }
}

}  // namespace delfront
