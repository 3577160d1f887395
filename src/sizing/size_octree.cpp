// SPDX-License-Identifier: Apache-2.0
// Level by level, so that the number of leaves is known before they are made. Cells of a level stand in Morton order.
#include "sizing/size_octree.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr std::size_t kGrain = 1 << 8;
constexpr double kFlat = 1e-9;    ///< of the longest side: less is the plane
constexpr int kLevelToTrust = 3;  ///< corners of larger leaves tell too little of what is between them

}  // namespace

SizeOctree::SizeOctree(const SizeField& size, const Box& domain, const SizeOctreeOptions& options, Context& context)
    : domain_(domain), side_(domain.longest_side()), largest_(size.largest()), options_(options) {
  DELFRONT_CHECK(!domain.is_empty() && side_ > 0);
  dimension_ = domain.high.z - domain.low.z > kFlat * side_ ? 3 : 2;
  std::vector<OctreeLeaf> cells(1);
  for (int level = 0; !cells.empty(); ++level) {
    context.progress("sizes", leaves_.size() + cells.size(), 0, "octants");
    set_bounds(cells, size, context);
    add_corners(cells, size, context);
    raise_bounds(cells);
    std::vector<OctreeLeaf> finer;
    const bool is_last = level == kMaxLevel;
    std::vector<std::uint8_t> fine(cells.size());
    parallel_ranges(context.threads, cells.size(), kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) fine[i] = is_fine(cells[i], size);
    });
    const auto num_split = static_cast<std::size_t>(std::count(fine.begin(), fine.end(), 0));
    const bool is_too_much =
        leaves_.size() + cells.size() - num_split + (num_split << dimension_) > options_.max_leaves;
    is_cut_short_ |= num_split > 0 && (is_too_much || is_last);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (is_cut_short_ || fine[i])
        leaves_.push_back(cells[i]);
      else
        for (const OctreeLeaf& half : halves(cells[i])) finer.push_back(half);
    }
    cells = std::move(finer);
  }
}

double SizeOctree::side(const OctreeLeaf& leaf) const { return std::ldexp(side_, -leaf.level); }

Box SizeOctree::box(const OctreeLeaf& leaf) const {
  Box box{domain_.low, domain_.low};
  for (int k = 0; k < dimension_; ++k) {
    const double at = leaf.at[static_cast<std::size_t>(k)];
    box.low[k] = domain_.low[k] + std::ldexp(side_ * at, -leaf.level);
    box.high[k] = std::min(domain_.low[k] + std::ldexp(side_ * (at + 1), -leaf.level), domain_.high[k]);
  }
  return box;
}

void SizeOctree::set_bounds(std::vector<OctreeLeaf>& cells, const SizeField& size, Context& context) const {
  parallel_ranges(context.threads, cells.size(), kGrain, [&](std::size_t first, std::size_t last) {
    context.check_limits();
    for (std::size_t i = first; i < last; ++i) cells[i].low = size.lower_bound(box(cells[i]));
  });
}

/// Its place in units of the finest level, 21 bits an axis.
std::uint64_t SizeOctree::corner_key(const OctreeLeaf& leaf, int corner) const {
  std::uint64_t key = 0;
  for (int k = 0; k < dimension_; ++k) {
    const std::uint64_t at = leaf.at[static_cast<std::size_t>(k)] + static_cast<std::uint64_t>(corner >> k & 1);
    key |= (at << (kMaxLevel - leaf.level)) << (21 * k);
  }
  return key;
}

void SizeOctree::add_corners(std::vector<OctreeLeaf>& cells, const SizeField& size, Context& context) {
  std::vector<std::uint64_t> keys;
  for (const OctreeLeaf& leaf : cells)
    for (int c = 0; c < num_corners(); ++c) keys.push_back(corner_key(leaf, c));
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  auto place_of = [this](std::uint64_t key) {
    return std::lower_bound(corner_of_key_.begin(), corner_of_key_.end(), std::pair(key, std::uint32_t{0}));
  };
  const std::size_t first_new = corners_.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> added;
  for (const std::uint64_t key : keys) {
    if (const auto it = place_of(key); it != corner_of_key_.end() && it->first == key) continue;
    added.emplace_back(key, static_cast<std::uint32_t>(corners_.size()));
    Point at = domain_.low;
    for (int k = 0; k < dimension_; ++k) {  // a formula need not have a value beyond the domain
      at[k] += std::ldexp(side_ * static_cast<double>(key >> (21 * k) & ((1u << 21) - 1)), -kMaxLevel);
      at[k] = std::min(at[k], domain_.high[k]);
    }
    corners_.push_back(at);
  }
  const auto middle = static_cast<std::ptrdiff_t>(corner_of_key_.size());
  corner_of_key_.insert(corner_of_key_.end(), added.begin(), added.end());
  std::inplace_merge(corner_of_key_.begin(), corner_of_key_.begin() + middle, corner_of_key_.end());
  corner_sizes_.resize(corners_.size());
  const std::size_t num_new = corners_.size() - first_new;
  evaluate_sizes(size, {corners_.data() + first_new, num_new}, {corner_sizes_.data() + first_new, num_new}, context);
  for (OctreeLeaf& leaf : cells)
    for (int c = 0; c < num_corners(); ++c)
      leaf.corner[static_cast<std::size_t>(c)] = place_of(corner_key(leaf, c))->second;
}

/// No place is farther from the nearest corner than half a diagonal.
void SizeOctree::raise_bounds(std::vector<OctreeLeaf>& cells) const {
  if (!std::isfinite(options_.rises_at_most)) return;
  for (OctreeLeaf& leaf : cells) {
    double least = std::numeric_limits<double>::infinity();
    for (int c = 0; c < num_corners(); ++c)
      least = std::min(least, corner_sizes_[leaf.corner[static_cast<std::size_t>(c)]]);
    leaf.low = std::max(leaf.low, least - 0.5 * options_.rises_at_most * box(leaf).diagonal());
  }
}

bool SizeOctree::is_steep(const OctreeLeaf& leaf) const {
  const double whole_rise = options_.slope * box(leaf).diagonal();
  for (int a = 0; a < num_corners(); ++a) {
    const double high = corner_sizes_[leaf.corner[static_cast<std::size_t>(a)]];
    if (high > leaf.low + whole_rise) return true;
    for (int b = 0; b < num_corners(); ++b) {
      const double low = corner_sizes_[leaf.corner[static_cast<std::size_t>(b)]];
      const double away = distance(corners_[leaf.corner[static_cast<std::size_t>(a)]],
                                   corners_[leaf.corner[static_cast<std::size_t>(b)]]);
      if (high > low + options_.slope * away * (1 + 1e-9)) return true;
    }
  }
  return false;
}

/// Corners alone may all stand where the size is least, with larger ones between them: the centre is looked at too.
bool SizeOctree::is_flat(const OctreeLeaf& leaf, const SizeField& size) const {
  double greatest = 0;
  for (int c = 0; c < num_corners(); ++c)
    greatest = std::max(greatest, corner_sizes_[leaf.corner[static_cast<std::size_t>(c)]]);
  const double limit = options_.flat * leaf.low;
  if (greatest > limit) return false;
  return largest_ <= limit || (leaf.level >= kLevelToTrust && size.size(box(leaf).centre()) <= limit);
}

bool SizeOctree::is_fine(const OctreeLeaf& leaf, const SizeField& size) const {
  if (is_flat(leaf, size)) return true;
  const double s = side(leaf);
  if (s > options_.sizes_per_leaf * leaf.low) return false;
  return s <= options_.sizes_per_steep_leaf * leaf.low || !is_steep(leaf);
}

std::vector<OctreeLeaf> SizeOctree::halves(const OctreeLeaf& leaf) const {
  std::vector<OctreeLeaf> result;
  for (int octant = 0; octant < num_corners(); ++octant) {
    OctreeLeaf half;
    half.level = leaf.level + 1;
    bool is_within = true;
    for (int k = 0; k < dimension_; ++k) {
      const auto i = static_cast<std::size_t>(k);
      half.at[i] = 2 * leaf.at[i] + static_cast<std::uint32_t>(octant >> k & 1);
      is_within = is_within && domain_.low[k] + std::ldexp(side_ * half.at[i], -half.level) < domain_.high[k];
    }
    if (is_within) result.push_back(half);
  }
  return result;
}

}  // namespace delfront
