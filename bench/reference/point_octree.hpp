// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delfront/point.hpp"

namespace delfront::reference {

/// @brief The octree of the literature: up to eight points a leaf, which come and go; it is never made anew.
/// @par Source  Löhner (2008), 2.5.3, 3.6 (F13)
/// @par Cost    O(log n) an insertion or removal of points that are spread evenly
class PointOctree {
 public:
  explicit PointOctree(const Box& box) : box_(box), nodes_(1) {}

  void insert(std::uint32_t id, const Point& at) {
    Cell cell{box_.low, box_.high};
    std::uint32_t n = 0;
    for (;;) {
      if (nodes_[n].first_child != 0) {
        n = nodes_[n].first_child + cell.enter(at);
      } else if (nodes_[n].count < kCapacity) {
        nodes_[n].id[nodes_[n].count] = id;
        nodes_[n].at[nodes_[n].count++] = at;
        return;
      } else {
        split(n, cell);
      }
    }
  }

  void remove(std::uint32_t id, const Point& at) {
    Cell cell{box_.low, box_.high};
    std::uint32_t n = 0;
    while (nodes_[n].first_child != 0) n = nodes_[n].first_child + cell.enter(at);
    Node& node = nodes_[n];
    for (std::uint32_t k = 0; k < node.count; ++k) {
      if (node.id[k] != id) continue;
      node.id[k] = node.id[node.count - 1];
      node.at[k] = node.at[--node.count];
      return;
    }
  }

  template <class Visit>
  void for_each_in(const Box& box, Visit&& visit) const {
    look(0, {box_.low, box_.high}, box, visit);
  }

 private:
  static constexpr std::uint32_t kCapacity = 8;

  struct Cell {
    Point low, high;
    /// Go on to the eighth that holds the point. @return its number
    std::uint32_t enter(const Point& at) {
      std::uint32_t octant = 0;
      for (int i = 0; i < 3; ++i) octant |= static_cast<std::uint32_t>(at[i] > 0.5 * (low[i] + high[i])) << i;
      *this = child(octant);
      return octant;
    }
    Cell child(std::uint32_t octant) const {
      Cell c = *this;
      for (int i = 0; i < 3; ++i) ((octant >> i & 1) ? c.low : c.high)[i] = 0.5 * (low[i] + high[i]);
      return c;
    }
  };
  struct Node {
    std::uint32_t first_child = 0, count = 0;  ///< no child: a leaf
    std::array<std::uint32_t, kCapacity> id;
    std::array<Point, kCapacity> at;
  };

  void split(std::uint32_t n, const Cell& cell) {
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 8);
    Node& node = nodes_[n];
    for (std::uint32_t k = 0; k < node.count; ++k) {
      Cell of_point = cell;
      Node& child = nodes_[first + of_point.enter(node.at[k])];
      child.id[child.count] = node.id[k];
      child.at[child.count++] = node.at[k];
    }
    node.first_child = first;
    node.count = 0;
  }

  template <class Visit>
  void look(std::uint32_t n, const Cell& cell, const Box& box, Visit&& visit) const {
    for (int i = 0; i < 3; ++i)
      if (cell.high[i] < box.low[i] || cell.low[i] > box.high[i]) return;
    const Node& node = nodes_[n];
    if (node.first_child != 0)
      for (std::uint32_t o = 0; o < 8; ++o) look(node.first_child + o, cell.child(o), box, visit);
    for (std::uint32_t k = 0; k < node.count; ++k)
      if (box.overlaps({node.at[k], node.at[k]})) visit(node.id[k]);
  }

  Box box_;
  std::vector<Node> nodes_;
};

}  // namespace delfront::reference
