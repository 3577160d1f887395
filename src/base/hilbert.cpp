// SPDX-License-Identifier: Apache-2.0
// Hilbert keys by the states of the curve in a cell, (entry corner, direction), after C. Hamilton ("Compact Hilbert
// indices", Dalhousie University CS-2006-07): 24 states, one table for two levels at a time. Sorting is
// least-significant-digit radix, 11 bits a pass, with passes skipped where all keys share the digit.
#include "base/hilbert.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.hpp"

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

constexpr unsigned kStates = 24;
using Steps = std::array<std::array<std::uint16_t, 64>, kStates>;

constexpr unsigned rotate_left(unsigned x, unsigned by) { return (x << by % 3 | x >> (3 - by % 3)) & 7; }
constexpr unsigned rotate_right(unsigned x, unsigned by) { return rotate_left(x, 3 - by % 3); }

/// One level: the child's place along the curve, and its state (3 * entry + direction).
constexpr std::pair<unsigned, unsigned> descend(unsigned state, unsigned corner) {
  const unsigned entry = state / 3, direction = state % 3;
  const unsigned gray = rotate_right(corner ^ entry, direction + 1);
  const unsigned place = gray ^ gray >> 1 ^ gray >> 2;
  const unsigned before = place == 0 ? 0 : (place - 1) / 2 * 2;
  const unsigned child_entry = before ^ before >> 1;
  const unsigned turning = place % 2 == 0 ? (place == 0 ? 0 : place - 1) : place;  // whose trailing ones turn the curve
  unsigned turn = 0;
  while (turn < 3 && turning >> turn & 1) ++turn;
  return {place, 3 * (entry ^ rotate_left(child_entry, direction + 1)) + (direction + turn + 1) % 3};
}

constexpr Steps make_steps() {
  Steps steps{};
  for (unsigned state = 0; state < kStates; ++state)
    for (unsigned corners = 0; corners < 64; ++corners) {
      const auto [upper, between] = descend(state, corners >> 3);
      const auto [lower, end] = descend(between, corners & 7);
      steps[state][corners] = static_cast<std::uint16_t>(end << 6 | upper << 3 | lower);
    }
  return steps;
}

constexpr Steps kSteps = make_steps();

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
  const std::uint64_t x = cell_of(p.x - low_.x, scale_[0]), y = cell_of(p.y - low_.y, scale_[1]),
                      z = cell_of(p.z - low_.z, scale_[2]);
  const std::uint64_t morton = spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;  // 63 bits
  std::uint64_t key = 0;
  unsigned state = 0;
  // An even number of levels of 64 bits, the topmost empty: two levels a step.
  for (int shift = 60; shift >= 0; shift -= 6) {
    const std::uint16_t step = kSteps[state][morton >> shift & 63];
    key = key << 6 | (step & 63u);
    state = step >> 6;
  }
  return key;
}

namespace {

constexpr int kDigitBits = 11, kPasses = 6;
constexpr std::size_t kDigits = std::size_t(1) << kDigitBits;
constexpr std::size_t kChunk = std::size_t(1) << 17;  ///< items that a thread counts and moves at a time
constexpr std::size_t kCrowd = 32;                    ///< points in one cell of the curve that call for a finer one

using Items = std::vector<std::pair<std::uint64_t, std::uint32_t>>;
using Counts = std::array<std::size_t, kDigits>;

std::size_t digit(std::uint64_t key, int pass) { return key >> (pass * kDigitBits) & (kDigits - 1); }

/// Turns counts by chunk and digit into where each chunk's items of a digit go.
/// @return false where all items have the same digit: nothing to do
bool counts_to_places(std::vector<Counts>& counts, std::size_t size) {
  std::size_t begin = 0;
  for (std::size_t d = 0; d < kDigits; ++d)
    for (Counts& count : counts) {
      const std::size_t here = count[d];
      if (here == size) return false;
      count[d] = begin;
      begin += here;
    }
  return true;
}

bool is_before(const Point& a, const Point& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

/// Items of one cell: along a curve of their own, or where those are few, by coordinates.
void sort_crowd(PointView points, std::span<std::pair<std::uint64_t, std::uint32_t>> items) {
  Box box;
  for (const auto& item : items) box.add(points[item.second]);
  if (items.size() <= kCrowd || !(box.longest_side() > 0)) {
    std::stable_sort(items.begin(), items.end(),
                     [&](const auto& a, const auto& b) { return is_before(points[a.second], points[b.second]); });
    return;
  }
  const HilbertCurve curve(box);
  for (auto& item : items) item.first = curve.key(points[item.second]);
  std::stable_sort(items.begin(), items.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0, j = 0; i < items.size(); i = j) {
    for (j = i + 1; j < items.size() && items[j].first == items[i].first;) ++j;
    if (j - i > 1) sort_crowd(points, items.subspan(i, j - i));
  }
}

}  // namespace

void radix_sort(Items& items, int threads) {
  if (items.size() < 2) return;
  const std::size_t num_chunks = (items.size() + kChunk - 1) / kChunk;
  std::vector<Counts> counts(num_chunks);
  Items other;
  for (int pass = 0; pass < kPasses; ++pass) {
    parallel_ranges(threads, items.size(), kChunk, [&](std::size_t first, std::size_t last) {
      Counts& count = counts[first / kChunk];
      count.fill(0);
      for (std::size_t i = first; i < last; ++i) ++count[digit(items[i].first, pass)];
    });
    if (!counts_to_places(counts, items.size())) continue;
    other.resize(items.size());
    parallel_ranges(threads, items.size(), kChunk, [&](std::size_t first, std::size_t last) {
      Counts& place = counts[first / kChunk];
      for (std::size_t i = first; i < last; ++i) other[place[digit(items[i].first, pass)]++] = items[i];
    });
    items.swap(other);
  }
}

std::vector<std::uint32_t> hilbert_order(PointView points, int threads) {
  constexpr std::size_t kGrain = 1 << 14;
  Box box;
  for (std::size_t i = 0; i < points.size(); ++i) box.add(points[i]);
  const HilbertCurve curve(box);
  Items items(points.size());
  parallel_ranges(threads, points.size(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) items[i] = {curve.key(points[i]), static_cast<std::uint32_t>(i)};
  });
  radix_sort(items, threads);
  for (std::size_t i = 0, j = 0; i < items.size(); i = j) {
    for (j = i + 1; j < items.size() && items[j].first == items[i].first;) ++j;
    if (j - i > 1) sort_crowd(points, std::span(items).subspan(i, j - i));
  }
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < items.size(); ++i) order[i] = items[i].second;
  return order;
}

}  // namespace delfront
