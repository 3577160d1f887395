// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_set>
#include <vector>

namespace delfront {

/// @brief Edges that must not vanish, by their two vertices in either order.
///
/// Between two vertices there is at most one edge, so no tet has to carry flags: whatever takes edges away asks here
/// first, and asks nothing while the set is empty. Safe to read from several threads.
class EdgeSet {
 public:
  bool empty() const { return edges_.empty(); }
  std::size_t size() const { return edges_.size(); }
  bool has(std::uint32_t a, std::uint32_t b) const { return edges_.contains(key(a, b)); }
  void insert(std::uint32_t a, std::uint32_t b) { edges_.insert(key(a, b)); }
  void erase(std::uint32_t a, std::uint32_t b) { edges_.erase(key(a, b)); }
  void reserve(std::size_t count) { edges_.reserve(count); }

  /// @brief All of them, the lower vertex first, in order.
  std::vector<std::array<std::uint32_t, 2>> sorted() const {
    std::vector<std::array<std::uint32_t, 2>> all;
    for (const std::uint64_t k : edges_)
      all.push_back({static_cast<std::uint32_t>(k >> 32), static_cast<std::uint32_t>(k & 0xffffffffu)});
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return static_cast<std::uint64_t>(a < b ? a : b) << 32 | (a < b ? b : a);
  }
  std::unordered_set<std::uint64_t> edges_;
};

}  // namespace delfront
