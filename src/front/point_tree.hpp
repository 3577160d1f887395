// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace delfront {

/// @brief Points with a reach, found by box: a quadtree (kDim = 2) or octree (kDim = 3) that grows by insertion (F13).
///
/// The reach of a point is how far what hangs on it (sides of a front) may stick out from it: a query meets every point
/// whose cube of that half width overlaps the box, so that no side that overlaps the box is missed, however large.
/// Coordinates are held in single precision relative to the root's centre; a slack pays for the rounding, so a query
/// may give points that lie a little beyond, but misses none. Points are not taken out: what is gone is passed over by
/// the caller, and the tree is made anew for each round of a front.
/// @par Cost  O(log n) an insertion, O(log n + hits) a query where reaches are like the distances between points
template <int kDim>
class PointTree {
 public:
  using Place = std::array<double, kDim>;

  /// @brief Empty, for points in a box (others are taken too, at a cost).
  void clear(const Place& low, const Place& high) {
    nodes_.clear();
    buckets_.clear();
    free_buckets_.clear();
    half_ = 0;
    for (int i = 0; i < kDim; ++i) {
      centre_[i] = 0.5 * (low[i] + high[i]);
      half_ = std::max(half_, 0.5 * (high[i] - low[i]));
    }
    slack_ = static_cast<float>(kSlack * half_);
    Node root;
    root.half = static_cast<float>(half_);
    root.bucket = new_bucket();
    nodes_.push_back(root);
  }

  void insert(std::uint32_t id, const Place& at, double reach) {
    Place half;
    half.fill(reach);
    insert(id, at, half);
  }
  /// @brief The same with a reach along each axis.
  void insert(std::uint32_t id, const Place& at, const Place& reach) {
    Entry entry;
    entry.id = id;
    entry.largest = 0;
    for (int i = 0; i < kDim; ++i) {
      entry.at[i] = static_cast<float>(at[i] - centre_[i]);
      entry.reach[i] = static_cast<float>(reach[i]) * kRoundUp;
      entry.largest = std::max(entry.largest, entry.reach[i]);
    }
    insert(entry);
  }

  /// @brief visit(id) for every point whose reach touches the box.
  template <class Visit>
  void for_each_near(const Place& low, const Place& high, Visit&& visit) const {
    std::array<float, kDim> middle, half;
    for (int i = 0; i < kDim; ++i) {
      middle[i] = static_cast<float>(0.5 * (low[i] + high[i]) - centre_[i]);
      half[i] = static_cast<float>(0.5 * (high[i] - low[i])) * kRoundUp + slack_;
    }
    const auto is_apart = [&](const std::array<float, kDim>& at, float extent) {
      bool apart = false;
      for (int i = 0; i < kDim; ++i) apart |= std::fabs(at[i] - middle[i]) > half[i] + extent;
      return apart;
    };
    const auto is_entry_apart = [&](const Entry& e) {
      bool apart = false;
      for (int i = 0; i < kDim; ++i) apart |= std::fabs(e.at[i] - middle[i]) > half[i] + e.reach[i];
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
          if (child.reach >= 0 && !is_apart(child.centre, child.half + child.reach)) stack[top++] = c;
        }
        continue;
      }
      for (std::uint32_t b = node.bucket; b != kNone; b = buckets_[b].next) {
        const Bucket& bucket = buckets_[b];
        for (std::uint32_t k = 0; k < bucket.count; ++k)
          if (!is_entry_apart(bucket.entry[k])) visit(bucket.entry[k].id);
      }
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::uint32_t kChildren = 1u << kDim;
  static constexpr std::uint32_t kCapacity = 8;
  static constexpr std::size_t kMaxDepth = 24;  ///< where single precision ends; there buckets are chained
  static constexpr double kSlack = 0x1p-20;     ///< of the root's half side: four roundings of coordinates up to that
  static constexpr float kRoundUp = 1 + 0x1p-20f;

  struct Entry {
    std::array<float, kDim> at, reach;
    float largest;  ///< of the reaches
    std::uint32_t id;
  };
  struct Bucket {
    std::array<Entry, kCapacity> entry;
    std::uint32_t count = 0, next = kNone;
  };
  struct Node {
    std::array<float, kDim> centre{};
    float half = 0;
    float reach = -1;               ///< the largest of the points below; negative: none
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
    for (int i = 0; i < kDim; ++i) o |= static_cast<std::uint32_t>(entry.at[i] > node.centre[i]) << i;
    return o;
  }

  /// Points outside of the root's box count as if they reached that far, so that the leaf they end in is looked at.
  float reach_out_of(const Node& node, const Entry& entry) const {
    float out = 0;
    for (int i = 0; i < kDim; ++i) out = std::max(out, std::fabs(entry.at[i] - node.centre[i]) - node.half);
    return entry.largest + out;
  }

  void insert(const Entry& entry) {
    std::uint32_t n = 0;
    std::size_t depth = 0;
    for (;;) {
      nodes_[n].reach = std::max(nodes_[n].reach, reach_out_of(nodes_[n], entry));
      if (nodes_[n].first_child == 0) break;
      n = nodes_[n].first_child + octant(nodes_[n], entry);
      ++depth;
    }
    const std::uint32_t b = nodes_[n].bucket;
    if (buckets_[b].count < kCapacity) {
      buckets_[b].entry[buckets_[b].count++] = entry;
    } else if (depth + 1 >= kMaxDepth) {
      const std::uint32_t more = new_bucket();
      buckets_[more].next = b;
      buckets_[more].entry[buckets_[more].count++] = entry;
      nodes_[n].bucket = more;
    } else {
      split(n);
      insert_below(n, entry, depth);
    }
  }

  void insert_below(std::uint32_t n, const Entry& entry, std::size_t depth) {
    while (true) {
      const std::uint32_t child = nodes_[n].first_child + octant(nodes_[n], entry);
      nodes_[child].reach = std::max(nodes_[child].reach, reach_out_of(nodes_[child], entry));
      ++depth;
      Bucket& bucket = buckets_[nodes_[child].bucket];
      if (bucket.count < kCapacity) {
        bucket.entry[bucket.count++] = entry;
        return;
      }
      if (depth + 1 >= kMaxDepth) {
        const std::uint32_t b = nodes_[child].bucket, more = new_bucket();
        buckets_[more].next = b;
        buckets_[more].entry[buckets_[more].count++] = entry;
        nodes_[child].bucket = more;
        return;
      }
      split(child);
      n = child;
    }
  }

  void split(std::uint32_t n) {
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    const Node parent = nodes_[n];
    for (std::uint32_t o = 0; o < kChildren; ++o) {
      Node child;
      child.half = 0.5f * parent.half;
      for (int i = 0; i < kDim; ++i) child.centre[i] = parent.centre[i] + ((o >> i & 1) ? child.half : -child.half);
      child.bucket = new_bucket();
      nodes_.push_back(child);
    }
    nodes_[n].first_child = first;
    const Bucket old = buckets_[parent.bucket];
    for (std::uint32_t k = 0; k < old.count; ++k) {
      Node& child = nodes_[first + octant(parent, old.entry[k])];
      child.reach = std::max(child.reach, reach_out_of(child, old.entry[k]));
      Bucket& bucket = buckets_[child.bucket];
      bucket.entry[bucket.count++] = old.entry[k];
    }
    free_buckets_.push_back(parent.bucket);
    nodes_[n].bucket = kNone;
  }

  Place centre_{};
  double half_ = 0;
  float slack_ = 0;
  std::vector<Node> nodes_;
  std::vector<Bucket> buckets_;
  std::vector<std::uint32_t> free_buckets_;
};

}  // namespace delfront
