// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

/// @brief Squared distance from p to a box; 0 inside.
double squared_distance(Point p, const Box& box);

/// @brief The point of a triangle that is nearest to p; a degenerate triangle is a segment or a point.
/// @par Source  Ericson, Real-Time Collision Detection (2005), 5.1.5
Point nearest_point_on_triangle(Point p, Point a, Point b, Point c);

/// @brief Where a ray meets a triangle, as a multiple of `direction`; rounded arithmetic, closed triangle.
/// @return nothing for a miss, a ray in the triangle's plane, or a hit behind the origin
/// @par Source  Möller & Trumbore (1997)
std::optional<double> ray_triangle(Point origin, Point direction, Point a, Point b, Point c);

/// @brief Bounding-volume hierarchy over boxes: which boxes meet a box, each other, a ray, or lie nearest.
///
/// Deterministic; queries are const and may run from several threads. Items are numbered as given. Items with an empty
/// box are never visited.
/// @par Cost  build O(n log n); 80 bytes an item
class Bvh {
 public:
  Bvh() = default;
  explicit Bvh(std::span<const Box> boxes);

  std::size_t num_items() const { return items_.size(); }
  const Box& box_of_all() const { return box_; }

  /// @brief Call visit(item) for each item whose box meets `box` (touching counts).
  template <class Visit>
  void for_each_overlap(const Box& box, Visit&& visit) const;

  /// @brief Call visit(i, j), i < j, once for each two items whose boxes meet (touching counts).
  template <class Visit>
  void for_each_pair(Visit&& visit) const;

  /// @brief Call visit(item) for each item whose box meets origin + t direction, 0 <= t <= t_max.
  ///
  /// Boxes are widened by a rounding allowance, so that an item hit within rounding is not missed.
  template <class Visit>
  void for_each_on_ray(Point origin, Point direction, double t_max, Visit&& visit) const;

  struct Nearest {
    std::uint32_t item = std::numeric_limits<std::uint32_t>::max();
    double squared_distance = std::numeric_limits<double>::infinity();
    bool found() const { return item != std::numeric_limits<std::uint32_t>::max(); }
  };
  /// @brief The item with the smallest squared_distance_to(item) below `limit`; of equals, the lowest number.
  /// @param squared_distance_to  exact distance of an item, never below that of its box
  template <class Distance>
  Nearest nearest(Point p, Distance&& squared_distance_to,
                  double limit = std::numeric_limits<double>::infinity()) const;

 private:
  static constexpr std::uint32_t kLeafSize = 4;
  static constexpr int kMaxDepth = 128;  // of a traversal stack; build() keeps the tree below half of that

  struct Node {
    Box box;
    std::uint32_t begin = 0;  // leaf: first item; inner: left child, the right one is next to it
    std::uint32_t count = 0;  // leaf: items, inner: 0
    bool is_leaf() const { return count > 0; }
  };
  struct Ray {
    Point origin, inverse;
    double t_max;
    double widen;
    bool meets(const Box& box) const;
  };

  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end, int depth);
  std::uint32_t split(std::uint32_t begin, std::uint32_t end, const Box& centres, int depth);
  Ray make_ray(Point origin, Point direction, double t_max) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;  // item numbers in leaf order
  std::vector<Box> boxes_;            // in leaf order
  Box box_;
};

/// @brief A Bvh over triangles, for nearest-triangle and ray queries in rounded arithmetic.
class TriangleTree {
 public:
  TriangleTree() = default;
  /// @param corners  three points a triangle
  explicit TriangleTree(std::vector<std::array<Point, 3>> corners);

  struct Hit {
    std::uint32_t triangle = std::numeric_limits<std::uint32_t>::max();
    Point at;
    double distance = std::numeric_limits<double>::infinity();
    bool found() const { return triangle != std::numeric_limits<std::uint32_t>::max(); }
  };
  /// @brief The triangle nearest to p; nothing found for an empty tree.
  Hit nearest(Point p) const;
  /// @brief As nearest, over those triangles that `accept` takes, closer than `limit`.
  template <class Accept>
  Hit nearest_if(Point p, Accept&& accept, double limit = std::numeric_limits<double>::infinity()) const;

  /// @brief First triangle that `accept` takes along origin + t direction, 0 <= t <= t_max; `distance` is t.
  template <class Accept>
  Hit first_on_ray(Point origin, Point direction, double t_max, Accept&& accept) const;

  const Bvh& bvh() const { return bvh_; }
  const std::array<Point, 3>& corners(std::uint32_t triangle) const { return corners_[triangle]; }

 private:
  std::vector<std::array<Point, 3>> corners_;
  Bvh bvh_;
};

// ---- templates ------------------------------------------------------------------------------------------------------

template <class Visit>
void Bvh::for_each_overlap(const Box& box, Visit&& visit) const {
  if (nodes_.empty()) return;
  std::uint32_t stack[kMaxDepth];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    if (!node.box.overlaps(box)) continue;
    if (!node.is_leaf()) {
      stack[top++] = node.begin + 1;
      stack[top++] = node.begin;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.begin + node.count; ++i)
      if (boxes_[i].overlaps(box)) visit(items_[i]);
  }
}

template <class Visit>
void Bvh::for_each_pair(Visit&& visit) const {
  if (nodes_.empty()) return;
  auto report = [&](std::uint32_t i, std::uint32_t j) {
    if (!boxes_[i].overlaps(boxes_[j])) return;
    const std::uint32_t a = items_[i], b = items_[j];
    a < b ? visit(a, b) : visit(b, a);
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack = {{0, 0}};
  while (!stack.empty()) {
    const auto [first, second] = stack.back();
    stack.pop_back();
    const Node &p = nodes_[first], &q = nodes_[second];
    if (first == second) {
      if (p.is_leaf()) {
        for (std::uint32_t i = p.begin; i < p.begin + p.count; ++i)
          for (std::uint32_t j = i + 1; j < p.begin + p.count; ++j) report(i, j);
      } else {
        stack.push_back({p.begin, p.begin + 1});
        stack.push_back({p.begin + 1, p.begin + 1});
        stack.push_back({p.begin, p.begin});
      }
      continue;
    }
    if (!p.box.overlaps(q.box)) continue;
    if (p.is_leaf() && q.is_leaf()) {
      for (std::uint32_t i = p.begin; i < p.begin + p.count; ++i)
        for (std::uint32_t j = q.begin; j < q.begin + q.count; ++j) report(i, j);
    } else if (q.is_leaf() || (!p.is_leaf() && p.box.diagonal() >= q.box.diagonal())) {
      stack.push_back({p.begin + 1, second});
      stack.push_back({p.begin, second});
    } else {
      stack.push_back({first, q.begin + 1});
      stack.push_back({first, q.begin});
    }
  }
}

template <class Visit>
void Bvh::for_each_on_ray(Point origin, Point direction, double t_max, Visit&& visit) const {
  if (nodes_.empty()) return;
  const Ray ray = make_ray(origin, direction, t_max);
  std::uint32_t stack[kMaxDepth];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    if (!ray.meets(node.box)) continue;
    if (!node.is_leaf()) {
      stack[top++] = node.begin + 1;
      stack[top++] = node.begin;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.begin + node.count; ++i)
      if (ray.meets(boxes_[i])) visit(items_[i]);
  }
}

template <class Distance>
Bvh::Nearest Bvh::nearest(Point p, Distance&& squared_distance_to, double limit) const {
  Nearest best;
  best.squared_distance = limit;
  if (nodes_.empty()) return best;
  std::pair<std::uint32_t, double> stack[kMaxDepth];
  int top = 0;
  stack[top++] = {0, delfront::squared_distance(p, nodes_[0].box)};
  while (top > 0) {
    const auto [index, near] = stack[--top];
    if (near > best.squared_distance) continue;
    const Node& node = nodes_[index];
    if (node.is_leaf()) {
      for (std::uint32_t i = node.begin; i < node.begin + node.count; ++i) {
        if (delfront::squared_distance(p, boxes_[i]) > best.squared_distance) continue;
        const double d = squared_distance_to(items_[i]);
        const bool is_better = d < best.squared_distance || (d == best.squared_distance && items_[i] < best.item);
        if (is_better && d < limit) best = {items_[i], d};
      }
      continue;
    }
    std::pair<std::uint32_t, double> left{node.begin, delfront::squared_distance(p, nodes_[node.begin].box)};
    std::pair<std::uint32_t, double> right{node.begin + 1, delfront::squared_distance(p, nodes_[node.begin + 1].box)};
    if (left.second > right.second) std::swap(left, right);
    stack[top++] = right;
    stack[top++] = left;
  }
  return best;
}

template <class Accept>
TriangleTree::Hit TriangleTree::nearest_if(Point p, Accept&& accept, double limit) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const Bvh::Nearest found = bvh_.nearest(
      p,
      [&](std::uint32_t t) {
        if (!accept(t)) return kFar;
        const auto& [a, b, c] = corners_[t];
        return squared_length(nearest_point_on_triangle(p, a, b, c) - p);
      },
      limit * limit);
  if (!found.found()) return {};
  const auto& [a, b, c] = corners_[found.item];
  return {found.item, nearest_point_on_triangle(p, a, b, c), std::sqrt(found.squared_distance)};
}

template <class Accept>
TriangleTree::Hit TriangleTree::first_on_ray(Point origin, Point direction, double t_max, Accept&& accept) const {
  Hit hit;
  hit.distance = t_max;
  bvh_.for_each_on_ray(origin, direction, t_max, [&](std::uint32_t t) {
    const auto& [a, b, c] = corners_[t];
    const std::optional<double> at = ray_triangle(origin, direction, a, b, c);
    if (!at || *at > hit.distance || (*at == hit.distance && t >= hit.triangle) || !accept(t)) return;
    hit = {t, origin + *at * direction, *at};
  });
  return hit;
}

}  // namespace delfront
