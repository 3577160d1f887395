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

/// @brief Points of three doubles each, which may stand in larger records.
class PointView {
 public:
  PointView(std::span<const Point> points) : PointView(points.empty() ? nullptr : &points[0].x, 3, points.size()) {}
  PointView(const std::vector<Point>& points) : PointView(std::span(points)) {}
  /// @param stride  doubles from one point to the next
  PointView(const double* first, std::size_t stride, std::size_t size) : first_(first), stride_(stride), size_(size) {}
  std::size_t size() const { return size_; }
  Point operator[](std::size_t i) const {
    const double* const p = first_ + i * stride_;
    return {p[0], p[1], p[2]};
  }

 private:
  const double* first_;
  std::size_t stride_, size_;
};

/// @brief Indices of `points` in Hilbert order; where a cell of the finest level holds many points, in the order of a
/// finer curve through them. Equal points are neighbours, by index. Deterministic.
/// @par Cost  O(n), radix sort
std::vector<std::uint32_t> hilbert_order(PointView points, int threads = 1);

/// @brief Sort (key, value) pairs by key, stable. @par Cost O(n)
void radix_sort(std::vector<std::pair<std::uint64_t, std::uint32_t>>& items, int threads = 1);

}  // namespace delfront
