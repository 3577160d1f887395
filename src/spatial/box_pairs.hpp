// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>
#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "delfront/point.hpp"

namespace delfront {

/// @brief Which boxes meet which, all of them at once: for the exact test of a surface against itself.
///
/// Boxes stand in Hilbert order, eight a group; groups, and groups of groups, have boxes of their own in single
/// precision, rounded outwards, so that none is missed. To build it is a sort; Bvh, whose tree is better for rays and
/// for boxes of very unlike sizes, takes several times as long.
/// @par Cost  O(n) to build, but for the sort; O(n + pairs) where boxes are about as large as far apart
class BoxPairs {
 public:
  /// @param boxes  kept as a view; empty ones meet nothing
  explicit BoxPairs(std::span<const Box> boxes, int threads = 1);

  std::size_t num_groups() const { return levels_.empty() ? 0 : levels_[0].size(); }

  /// @brief visit(i, j), i < j, for pairs of boxes that meet (touching counts) of which one is in the group and the
  /// other in it or a later one: over all groups each pair once. From several threads at once.
  template <class Visit>
  void for_each_pair(std::size_t group, Visit&& visit) const {
    const std::uint32_t g = static_cast<std::uint32_t>(group);
    Lane own;
    widest(levels_[0][g], own);
    std::array<std::array<std::uint32_t, 2>, kMostStack> stack;  // level, node
    std::size_t top = 0;
    stack[top++] = {static_cast<std::uint32_t>(levels_.size() - 1), 0};
    while (top > 0) {
      const auto [level, n] = stack[--top];
      const Node& node = levels_[level][n];
      if (level == 0) {
        visit_groups(g, n, visit);
        continue;
      }
      for (unsigned mask = meeting(node, own); mask != 0; mask &= mask - 1) {
        const std::uint32_t child = kWidth * n + static_cast<std::uint32_t>(std::countr_zero(mask));
        const bool is_before = (std::uint64_t(child) + 1) << (3 * (level - 1)) <= g;
        if (!is_before) stack[top++] = {level - 1, child};
      }
    }
  }

 private:
  static constexpr std::uint32_t kWidth = 8;
  static constexpr std::size_t kMostStack = 8 * 12;  ///< levels for 2^32 boxes, and one more
  using Lanes = float __attribute__((vector_size(4 * kWidth)));
  struct alignas(32) Node {
    Lanes low[3], high[3];
  };
  struct Lane {
    float low[3], high[3];
  };

  static unsigned mask_of(const Lanes& low, const Lanes& high) {
#if defined(__AVX__)
    return static_cast<unsigned>(
        _mm256_movemask_ps(_mm256_cmp_ps(std::bit_cast<__m256>(low), std::bit_cast<__m256>(high), _CMP_LE_OQ)));
#else
    unsigned mask = 0;
    for (unsigned k = 0; k < kWidth; ++k) mask |= (low[k] <= high[k] ? 1u : 0u) << k;
    return mask;
#endif
  }
  static unsigned meeting(const Node& node, const Lane& box) {
    unsigned mask = (1u << kWidth) - 1;
    for (int k = 0; k < 3; ++k) {
      const Lanes zero = {};
      mask &= mask_of(node.low[k], box.high[k] + zero) & mask_of(box.low[k] + zero, node.high[k]);
    }
    return mask;
  }
  static void widest(const Node& node, Lane& box);

  template <class Visit>
  void visit_groups(std::uint32_t g, std::uint32_t h, Visit&& visit) const {
    const Node &first = levels_[0][g], &second = levels_[0][h];
    for (std::uint32_t a = 0; a < kWidth && kWidth * g + a < items_.size(); ++a) {
      Lane box;
      for (int k = 0; k < 3; ++k) box.low[k] = first.low[k][a], box.high[k] = first.high[k][a];
      unsigned mask = meeting(second, box);
      if (g == h) mask &= ~0u << (a + 1);
      for (; mask != 0; mask &= mask - 1) {
        const std::uint32_t i = items_[kWidth * g + a],
                            j = items_[kWidth * h + static_cast<std::uint32_t>(std::countr_zero(mask))];
        if (boxes_[i].overlaps(boxes_[j])) i < j ? visit(i, j) : visit(j, i);
      }
    }
  }

  std::span<const Box> boxes_;
  std::vector<std::uint32_t> items_;       ///< in Hilbert order
  std::vector<std::vector<Node>> levels_;  ///< groups of boxes first; the last has one node
};

}  // namespace delfront
