// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/flat_array.hpp"
#include "base/parallel.hpp"

namespace delfront {

/// @brief Numbers sorted into bins, each bin's in ascending order.
struct Bins {
  FlatArray<std::uint32_t> items;
  std::vector<std::size_t> offsets;  ///< num_bins + 1 entries into `items`

  std::size_t size() const { return offsets.empty() ? 0 : offsets.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t bin) const {
    return {items.data() + offsets[bin], offsets[bin + 1] - offsets[bin]};
  }
};

/// @brief Keys 0 … num_keys - 1 in bins of a power of two each: few enough to count, small enough for a cache.
struct BinWidth {
  unsigned shift = 0;
  std::size_t num_bins = 0;

  explicit BinWidth(std::size_t num_keys) {
    constexpr std::size_t kLeastWidth = 512, kMaxBins = 16384;
    shift = static_cast<unsigned>(std::bit_width(std::max(kLeastWidth, num_keys / kMaxBins) - 1));
    num_bins = ((num_keys + (std::size_t{1} << shift) - 1) >> shift);
  }
  std::size_t bin_of(std::size_t key) const { return key >> shift; }
  std::size_t begin_of(std::size_t bin) const { return bin << shift; }
  std::size_t width() const { return std::size_t{1} << shift; }
};

/// @brief Sort items 0 … num_items - 1 into bins; an item may go to any number of bins.
///
/// @param[in] for_each  for_each(first, last, visit) calls visit(item, bin) for the items of that range in ascending
/// order, the same each time; from several threads at once
/// @par Cost  two calls over everything, 4 bytes an entry; the result depends on the items alone
template <class ForEach>
Bins sort_into_bins(std::size_t num_items, std::size_t num_bins, int threads, const ForEach& for_each) {
  constexpr std::size_t kLeastGrain = std::size_t{1} << 15, kMaxChunks = 256;
  const std::size_t grain = std::max(kLeastGrain, num_items / kMaxChunks + 1);
  const std::size_t num_chunks = (num_items + grain - 1) / grain;
  std::vector<std::uint32_t> counts(num_chunks * num_bins, 0);
  parallel_ranges(threads, num_items, grain, [&](std::size_t first, std::size_t last) {
    std::uint32_t* const count = counts.data() + first / grain * num_bins;
    for_each(first, last, [count](std::size_t, std::size_t bin) { ++count[bin]; });
  });
  Bins bins;
  bins.offsets.assign(num_bins + 1, 0);
  for (std::size_t bin = 0; bin < num_bins; ++bin) {
    std::uint32_t before = 0;  // entries of earlier chunks in this bin
    for (std::size_t chunk = 0; chunk < num_chunks; ++chunk) {
      std::uint32_t& count = counts[chunk * num_bins + bin];
      before += count;
      count = before - count;
    }
    bins.offsets[bin + 1] = bins.offsets[bin] + before;
  }
  bins.items.resize(bins.offsets.back());
  parallel_ranges(threads, num_items, grain, [&](std::size_t first, std::size_t last) {
    std::uint32_t* const next = counts.data() + first / grain * num_bins;
    for_each(first, last, [&](std::size_t item, std::size_t bin) {
      bins.items[bins.offsets[bin] + next[bin]++] = static_cast<std::uint32_t>(item);
    });
  });
  return bins;
}

}  // namespace delfront
