// SPDX-License-Identifier: Apache-2.0
// Hilbert keys by Skilling's transposed form ("Programming the Hilbert curve", AIP Conf. Proc. 707, 2004): Gray decode
// from the top bit down, then interleave the three 21-bit words. Sorting is least-significant-digit radix, 11 bits a
// pass, with passes skipped where all keys share the digit.
#include "base/hilbert.hpp"

#include <array>
#include <cmath>

namespace delfront {
namespace {

constexpr int kBits = 21;
constexpr std::uint32_t kCells = 1u << kBits;

/// Spread the low 21 bits of x to every third bit.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}

/// Cell of a coordinate along one axis, clamped to the box; not a number goes to 0.
std::uint32_t cell_of(double offset, double scale) {
  const double cell = offset * scale;
  if (!(cell > 0)) return 0;
  return cell >= double(kCells) ? kCells - 1 : static_cast<std::uint32_t>(cell);
}

}  // namespace

HilbertCurve::HilbertCurve(const Box& box) : low_(box.is_empty() ? Point{} : box.low) {
  // One scale for all axes keeps the curve's locality in slender boxes.
  const double side = box.longest_side();
  const double scale = side > 0 && std::isfinite(side) ? double(kCells) / side : 0;
  for (double& s : scale_) s = std::isfinite(scale) ? scale : 0;
}

std::uint64_t HilbertCurve::key(Point p) const {
  std::uint32_t x[3] = {cell_of(p.x - low_.x, scale_[0]), cell_of(p.y - low_.y, scale_[1]),
                        cell_of(p.z - low_.z, scale_[2])};
  for (std::uint32_t q = kCells >> 1; q > 1; q >>= 1) {
    const std::uint32_t below = q - 1;
    for (std::uint32_t& axis : x) {
      if (axis & q) {
        x[0] ^= below;
      } else {
        const std::uint32_t t = (x[0] ^ axis) & below;
        x[0] ^= t;
        axis ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t gray = 0;
  for (std::uint32_t q = kCells >> 1; q > 1; q >>= 1)
    if (x[2] & q) gray ^= q - 1;
  for (std::uint32_t& axis : x) axis ^= gray;
  return spread_bits(x[0]) << 2 | spread_bits(x[1]) << 1 | spread_bits(x[2]);
}

void radix_sort(std::vector<std::pair<std::uint64_t, std::uint32_t>>& items) {
  constexpr int kDigitBits = 11, kPasses = 6;
  constexpr std::size_t kDigits = std::size_t(1) << kDigitBits;
  if (items.size() < 2) return;
  std::vector<std::array<std::size_t, kDigits>> counts(kPasses);
  for (const auto& item : items)
    for (int pass = 0; pass < kPasses; ++pass)
      ++counts[std::size_t(pass)][item.first >> (pass * kDigitBits) & (kDigits - 1)];
  std::vector<std::pair<std::uint64_t, std::uint32_t>> other(items.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    std::array<std::size_t, kDigits>& count = counts[std::size_t(pass)];
    if (count[items[0].first >> (pass * kDigitBits) & (kDigits - 1)] == items.size()) continue;
    std::size_t begin = 0;
    for (std::size_t& c : count) {
      const std::size_t here = c;
      c = begin;
      begin += here;
    }
    for (const auto& item : items) other[count[item.first >> (pass * kDigitBits) & (kDigits - 1)]++] = item;
    items.swap(other);
  }
}

std::vector<std::uint32_t> hilbert_order(std::span<const Point> points) {
  Box box;
  for (const Point& p : points) box.add(p);
  const HilbertCurve curve(box);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> items(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) items[i] = {curve.key(points[i]), static_cast<std::uint32_t>(i)};
  radix_sort(items);
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < items.size(); ++i) order[i] = items[i].second;
  return order;
}

}  // namespace delfront
