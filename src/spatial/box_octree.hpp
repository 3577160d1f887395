// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

/// @brief Boxes, found by box: an octree that grows by insertion (F13). Each box stands once, in the leaf of its
/// centre; a node knows how far the boxes below it reach along each axis, so that none is missed, however long.
///
/// Coordinates are held in single precision relative to the root's centre; a slack pays for the rounding, so a query
/// may give boxes that lie a little beyond, but misses none. Boxes are not taken out: what is gone is passed over by
/// the caller, who makes the tree anew when that is much.
/// @par Cost  O(log n) an insertion, O(log n + hits) a query where boxes are about as large as far apart
class BoxOctree {
 public:
  /// @brief Empty, for boxes in `box` (others are taken too, at a cost).
  void clear(const Box& box) {
    nodes_.clear();
    buckets_.clear();
    free_buckets_.clear();
    centre_ = box.centre();
    const double half = 0.5 * box.longest_side();
    slack_ = static_cast<float>(kSlack * half);
    Node root;
    root.half = static_cast<float>(half);
    root.bucket = new_bucket();
    nodes_.push_back(root);
  }

  void insert(std::uint32_t id, const Box& box) {
    const Point middle = box.centre(), half = 0.5 * (box.high - box.low);
    Entry entry;
    entry.id = id;
    for (int i = 0; i < 3; ++i) {
      entry.at[i] = static_cast<float>(middle[i] - centre_[i]);
      entry.reach[i] = static_cast<float>(half[i]) * kRoundUp;
    }
    insert(entry);
  }

  /// @brief visit(id) for every box that touches this one.
  template <class Visit>
  void for_each_overlap(const Box& box, Visit&& visit) const {
    const Point centre = box.centre(), extent = 0.5 * (box.high - box.low);
    Triple middle, half;
    for (int i = 0; i < 3; ++i) {
      middle[i] = static_cast<float>(centre[i] - centre_[i]);
      half[i] = static_cast<float>(extent[i]) * kRoundUp + slack_;
    }
    const auto is_apart = [&](const Triple& at, const Triple& reach) {
      bool apart = false;
      for (int i = 0; i < 3; ++i) apart |= std::fabs(at[i] - middle[i]) > half[i] + reach[i];
      return apart;
    };
    std::array<std::uint32_t, (kChildren - 1) * kMaxDepth + 1> stack;
    std::size_t top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const Node& node = nodes_[stack[--top]];
      if (node.first_child != 0) {
        for (std::uint32_t c = node.first_child; c < node.first_child + kChildren; ++c) {
          const Node& child = nodes_[c];
          if (child.reach[0] >= 0 && !is_apart(child.centre, child.reach)) stack[top++] = c;
        }
        continue;
      }
      for (std::uint32_t b = node.bucket; b != kNone; b = buckets_[b].next) {
        const Bucket& bucket = buckets_[b];
        for (std::uint32_t k = 0; k < bucket.count; ++k)
          if (!is_apart(bucket.entry[k].at, bucket.entry[k].reach)) visit(bucket.entry[k].id);
      }
    }
  }

 private:
  using Triple = std::array<float, 3>;
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::uint32_t kChildren = 8;
  static constexpr std::uint32_t kCapacity = 8;
  static constexpr std::size_t kMaxDepth = 24;  ///< where single precision ends; there buckets are chained
  static constexpr double kSlack = 0x1p-20;     ///< of the root's half side: four roundings of coordinates up to that
  static constexpr float kRoundUp = 1 + 0x1p-20f;

  struct Entry {
    Triple at, reach;
    std::uint32_t id;
  };
  struct Bucket {
    std::array<Entry, kCapacity> entry;
    std::uint32_t count = 0, next = kNone;
  };
  struct Node {
    Triple centre{};
    float half = 0;
    Triple reach{-1, -1, -1};       ///< of the boxes below, from the centre, axis by axis; negative: none
    std::uint32_t first_child = 0;  ///< 0: a leaf
    std::uint32_t bucket = kNone;
  };

  std::uint32_t new_bucket() {
    if (free_buckets_.empty()) {
      buckets_.emplace_back();
      return static_cast<std::uint32_t>(buckets_.size() - 1);
    }
    const std::uint32_t b = free_buckets_.back();
    free_buckets_.pop_back();
    buckets_[b].count = 0;
    buckets_[b].next = kNone;
    return b;
  }

  static std::uint32_t octant(const Node& node, const Entry& entry) {
    std::uint32_t o = 0;
    for (int i = 0; i < 3; ++i) o |= static_cast<std::uint32_t>(entry.at[i] > node.centre[i]) << i;
    return o;
  }

  static void reach_to(Node& node, const Entry& entry) {
    for (int i = 0; i < 3; ++i)
      node.reach[i] = std::max(node.reach[i], std::fabs(entry.at[i] - node.centre[i]) + entry.reach[i]);
  }

  void insert(const Entry& entry) {
    std::uint32_t n = 0;
    for (std::size_t depth = 0;; ++depth) {
      reach_to(nodes_[n], entry);
      if (nodes_[n].first_child == 0) {
        const std::uint32_t b = nodes_[n].bucket;
        if (buckets_[b].count < kCapacity) {
          add(b, entry);
          return;
        }
        if (depth + 1 >= kMaxDepth) {
          nodes_[n].bucket = new_bucket();
          buckets_[nodes_[n].bucket].next = b;
          add(nodes_[n].bucket, entry);
          return;
        }
        split(n);
      }
      n = nodes_[n].first_child + octant(nodes_[n], entry);
    }
  }

  void add(std::uint32_t b, const Entry& entry) { buckets_[b].entry[buckets_[b].count++] = entry; }

  void split(std::uint32_t n) {
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    const Node parent = nodes_[n];
    for (std::uint32_t o = 0; o < kChildren; ++o) {
      Node child;
      child.half = 0.5f * parent.half;
      for (int i = 0; i < 3; ++i) child.centre[i] = parent.centre[i] + ((o >> i & 1) ? child.half : -child.half);
      child.bucket = new_bucket();
      nodes_.push_back(child);
    }
    nodes_[n].first_child = first;
    const Bucket old = buckets_[parent.bucket];
    for (std::uint32_t k = 0; k < old.count; ++k) {
      Node& child = nodes_[first + octant(parent, old.entry[k])];
      reach_to(child, old.entry[k]);
      add(child.bucket, old.entry[k]);
    }
    free_buckets_.push_back(parent.bucket);
    nodes_[n].bucket = kNone;
  }

  Point centre_;
  float slack_ = 0;
  std::vector<Node> nodes_;
  std::vector<Bucket> buckets_;
  std::vector<std::uint32_t> free_buckets_;
};

}  // namespace delfront
