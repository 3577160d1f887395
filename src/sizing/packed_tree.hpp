// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "delfront/point.hpp"
#include "spatial/bvh.hpp"

namespace delfront {

/// @brief A tree over boxes that stand in curve order, each with a value: what meets a box, the least value there, and
/// the least of any function that has a lower bound over a box and a value.
///
/// Eight neighbours make a node, and so on up. Deterministic; queries are const and may run from several threads.
/// @par Cost  O(n) to build; 64 bytes an item
class PackedTree {
 public:
  struct Node {
    Box box;
    double least = std::numeric_limits<double>::infinity();
  };
  struct Best {
    std::uint32_t item = std::numeric_limits<std::uint32_t>::max();
    double value = std::numeric_limits<double>::infinity();
    bool found() const { return item != std::numeric_limits<std::uint32_t>::max(); }
  };

  PackedTree() = default;
  /// @param least  one an item, or none: infinity
  explicit PackedTree(std::span<const Box> boxes, std::span<const double> least = {}) {
    if (boxes.empty()) return;
    levels_.emplace_back(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      levels_[0][i].box = boxes[i];
      if (!least.empty()) levels_[0][i].least = least[i];
    }
    while (levels_.back().size() > 1) {
      const std::vector<Node>& below = levels_.back();
      std::vector<Node> level((below.size() + kFan - 1) / kFan);
      for (std::size_t i = 0; i < below.size(); ++i) {
        level[i / kFan].box.add(below[i].box);
        level[i / kFan].least = std::min(level[i / kFan].least, below[i].least);
      }
      levels_.push_back(std::move(level));
    }
  }

  bool is_empty() const { return levels_.empty(); }
  Box box() const { return is_empty() ? Box{} : levels_.back()[0].box; }

  /// @brief Call visit(item) for each item whose box meets `box` (touching counts), in ascending order.
  template <class Visit>
  void for_each_overlap(const Box& box, Visit&& visit) const {
    descend([&](const Node& node) { return node.box.overlaps(box); }, visit);
  }

  /// @brief The least value of all items whose box meets `box`, at most `start`.
  double least_over(const Box& box, double start = std::numeric_limits<double>::infinity()) const {
    double best = start;
    descend([&](const Node& node) { return node.least < best && node.box.overlaps(box); },
            [&](std::uint32_t item) { best = std::min(best, levels_[0][item].least); });
    return best;
  }

  /// @brief The least bound_of(node) of all items, at most `start`; that of a node is no more than those within it.
  template <class Bound>
  double least_bound(Bound&& bound_of, double start) const {
    double best = start;
    descend([&](const Node& node) { return bound_of(node) < best; },
            [&](std::uint32_t item) { best = std::min(best, bound_of(levels_[0][item])); });
    return best;
  }

  /// @brief The item with the least value_of(item) at most `start.value`; of equals the lowest number.
  /// @param bound_of  bound_of(node): no value of an item in it is lower
  template <class Bound, class Value>
  Best minimize(Bound&& bound_of, Value&& value_of, Best start) const {
    Best best = start;
    if (is_empty()) return best;
    Entry stack[kMaxStack];
    std::size_t top = 0;
    stack[top++] = {bound_of(levels_.back()[0]), levels_.size() - 1, 0};
    while (top > 0) {
      const Entry entry = stack[--top];
      if (entry.bound > best.value) continue;
      if (entry.level == 0) {
        const auto item = static_cast<std::uint32_t>(entry.index);
        const double value = value_of(item);
        if (value < best.value || (value == best.value && item < best.item)) best = {item, value};
        continue;
      }
      const std::vector<Node>& below = levels_[entry.level - 1];
      const std::size_t bottom = top, end = std::min(below.size(), (entry.index + 1) * kFan);
      for (std::size_t i = entry.index * kFan; i < end; ++i) {
        const double bound = bound_of(below[i]);
        if (bound > best.value) continue;
        std::size_t place = top++;  // the lowest on top
        for (; place > bottom && stack[place - 1].bound < bound; --place) stack[place] = stack[place - 1];
        stack[place] = {bound, entry.level - 1, i};
      }
    }
    return best;
  }
  template <class Bound, class Value>
  Best minimize(Bound&& bound_of, Value&& value_of) const {
    return minimize(bound_of, value_of, Best{});
  }

  /// @brief The item nearest to p by `squared_distance_to`, which is never below that of its box.
  template <class Distance>
  Best nearest(Point p, Distance&& squared_distance_to) const {
    return minimize([&](const Node& node) { return squared_distance(p, node.box); }, squared_distance_to);
  }

 private:
  static constexpr std::size_t kFan = 8;
  static constexpr std::size_t kMaxStack = 128;  // 11 levels hold 2^32 items; seven are left a level
  struct Entry {
    double bound;
    std::size_t level, index;
  };

  template <class Enter, class Visit>
  void descend(Enter&& enter, Visit&& visit) const {
    if (is_empty()) return;
    std::pair<std::size_t, std::size_t> stack[kMaxStack];
    std::size_t top = 0;
    stack[top++] = {levels_.size() - 1, 0};
    while (top > 0) {
      const auto [level, index] = stack[--top];
      if (!enter(levels_[level][index])) continue;
      if (level == 0) {
        visit(static_cast<std::uint32_t>(index));
        continue;
      }
      for (std::size_t i = std::min(levels_[level - 1].size(), (index + 1) * kFan); i-- > index * kFan;)
        stack[top++] = {level - 1, i};
    }
  }

  std::vector<std::vector<Node>> levels_;  // the items first, the root last
};

}  // namespace delfront
