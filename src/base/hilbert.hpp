// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

/// @brief Maps points in a box to a 63-bit key along the Hilbert curve (21 bits an axis).
class HilbertCurve {
 public:
  explicit HilbertCurve(const Box& box);
  std::uint64_t key(Point p) const;

 private:
  Point low_;
  double scale_[3];
};

/// @brief Indices of `points` in Hilbert order; where a cell of the finest level holds many points, in the order of a
/// finer curve through them. Equal points are neighbours, by index. Deterministic.
/// @par Cost  O(n), radix sort
std::vector<std::uint32_t> hilbert_order(std::span<const Point> points, int threads = 1);

/// @brief Sort (key, value) pairs by key, stable. @par Cost O(n)
void radix_sort(std::vector<std::pair<std::uint64_t, std::uint32_t>>& items, int threads = 1);

}  // namespace delfront
