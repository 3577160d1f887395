// SPDX-License-Identifier: Apache-2.0
// Lists of candidates in the cells of an octree.
//
// A term can be the least in a cell only if the least it asks for there is not above what some term asks for there at
// most. Such terms are found by the tree, from the top down; a cell with few of them is a leaf. Cells are split breadth
// first, so that where memory ends it ends at much the same size of cells everywhere. A leaf's list stands in ascending
// order of the lower bounds over the leaf, and its search ends at the first bound that is not below the best value.
#include "sizing/source_lists.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace delfront {
namespace {

constexpr double kCells = static_cast<double>(1u << SourceLists::kLevels);

}  // namespace

SourceLists::SourceLists(const SourceTree& tree, const Box& domain, Context& context) {
  if (domain.is_empty() || tree.empty()) return;
  side_ = domain.longest_side() * (1 + 1e-9);
  if (!(side_ > 0) || !std::isfinite(side_)) return;
  per_side_ = kCells / side_;
  const Point half{0.5 * side_, 0.5 * side_, 0.5 * side_};
  low_ = domain.centre() - half;
  build(tree, context);
}

/// A little wider than the cell, for the rounding of keys.
Box SourceLists::box_of(const Key& corner, unsigned level) const {
  const double unit = side_ / kCells, width = std::ldexp(side_, -static_cast<int>(level));
  const double margin = 1e-6 * unit + 8 * std::numeric_limits<double>::epsilon() *
                                          (std::abs(low_.x) + std::abs(low_.y) + std::abs(low_.z) + side_);
  Box box;
  for (int k = 0; k < 3; ++k) {
    const double at = low_[k] + unit * static_cast<double>(corner[static_cast<std::size_t>(k)]);
    box.low[k] = at - margin;
    box.high[k] = at + width + margin;
  }
  return box;
}

void SourceLists::build(const SourceTree& tree, Context& context) {
  struct Open {
    std::uint32_t cell;
    Key corner;
  };
  const std::size_t limit = kLeastBytes + kBytesPerTerm * tree.size();
  const auto bytes = [&] { return cells_.size() * sizeof(Cell) + lists_.size() * sizeof(SourceTree::Candidate); };
  const std::size_t most_visits = kVisitsPerTerm * (tree.size() + 100);
  std::size_t visited = 0;
  cells_.emplace_back();
  std::vector<Open> open = {{0, {0, 0, 0}}}, finer;
  std::vector<SourceTree::Candidate> found;
  SourceTree::Hint hint;
  for (unsigned level = 0; !open.empty(); ++level) {
    finer.clear();
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (i % 1024 == 0) context.check_limits();
      const auto [cell, corner] = open[i];
      const bool is_whole = tree.candidates(box_of(corner, level), kMost, hint, found, visited);
      const bool is_full = bytes() + 8 * sizeof(Cell) > limit || visited > most_visits || level == kLevels;
      if ((is_whole && found.size() <= kShort) || is_full) {
        if (!is_whole) continue;  // asks the tree
        cells_[cell] = {static_cast<std::uint32_t>(lists_.size()), static_cast<std::uint32_t>(found.size())};
        lists_.insert(lists_.end(), found.begin(), found.end());
        continue;
      }
      const auto first = static_cast<std::uint32_t>(cells_.size());
      cells_[cell] = {first, kIsSplit};
      cells_.resize(cells_.size() + 8);
      const std::uint32_t half = 1u << (kLevels - level - 1);
      for (std::uint32_t octant = 0; octant < 8; ++octant) {
        Key of_child = corner;
        for (std::size_t k = 0; k < 3; ++k) of_child[k] += (octant >> k & 1) * half;
        finer.push_back({first + octant, of_child});
      }
    }
    open.swap(finer);
  }
  cells_.shrink_to_fit();
  lists_.shrink_to_fit();
}

bool SourceLists::find_key(Point p, Key& key) const {
  for (int k = 0; k < 3; ++k) {
    const double at = (p[k] - low_[k]) * per_side_;
    if (!(at >= 0 && at < kCells)) return false;
    key[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(at);
  }
  return true;
}

/// From the deepest cell that holds the place before too.
const SourceLists::Cell& SourceLists::find_leaf(const Key& key, Path& path) const {
  unsigned level = 0;
  if (path.is_set) {
    const std::uint32_t differ = (key[0] ^ path.key[0]) | (key[1] ^ path.key[1]) | (key[2] ^ path.key[2]);
    level = std::min(path.level, kLevels - static_cast<unsigned>(std::bit_width(differ)));
  }
  path.key = key;
  path.is_set = true;
  std::uint32_t cell = path.cell[level];
  while (cells_[cell].count == kIsSplit) {
    const unsigned shift = kLevels - ++level;
    cell = cells_[cell].first + ((key[0] >> shift & 1) | (key[1] >> shift & 1) << 1 | (key[2] >> shift & 1) << 2);
    path.cell[level] = cell;
  }
  path.level = level;
  return cells_[cell];
}

void SourceLists::lower(const SourceTree& tree, std::span<const Point> at, std::span<double> size) const {
  if (cells_.empty()) return tree.lower(at, size);  // a domain without extent
  Path path;
  Key key;
  std::size_t run = 0;  // places up to here are done; those from here to i ask the tree
  const auto ask_tree = [&](std::size_t end) {
    if (run < end) tree.lower(at.subspan(run, end - run), size.subspan(run, end - run));
    run = end;
  };
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!find_key(at[i], key)) continue;
    const Cell& leaf = find_leaf(key, path);
    if (leaf.first == kUseTree) continue;
    ask_tree(i);
    double best = size[i];
    for (std::uint32_t j = leaf.first; j < leaf.first + leaf.count; ++j) {
      if (!(static_cast<double>(lists_[j].floor) < best)) break;
      best = std::min(best, tree.term(lists_[j].term)(at[i]));
    }
    size[i] = best;
    run = i + 1;
  }
  ask_tree(at.size());
}

}  // namespace delfront
