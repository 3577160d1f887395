// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sizing/source_tree.hpp"

namespace delfront {

/// @brief An octree over a domain; each leaf lists the terms that may be the least somewhere in it, by what they ask
/// for there at least. Where lists stay long, and outside of the domain, the tree is asked. Exact.
/// @par Cost  to build at most about kVisitsPerTerm lower bounds a term; at most kBytesPerTerm bytes a term and
/// kLeastBytes
class SourceLists {
 public:
  static constexpr std::size_t kBytesPerTerm = 256, kLeastBytes = 1 << 18, kVisitsPerTerm = 32;
  static constexpr std::size_t kShort = 8;  // cells with no more are not split
  static constexpr std::size_t kMost = 24;  // cells with more, that are not split, ask the tree
  static constexpr unsigned kLevels = 20;

  SourceLists() = default;
  SourceLists(const SourceTree& tree, const Box& domain, Context& context);

  /// @brief Lower the given sizes to the least terms where these are less; `tree` is that of the constructor.
  void lower(const SourceTree& tree, std::span<const Point> at, std::span<double> size) const;

 private:
  static constexpr std::uint32_t kUseTree = 0xffffffffu;
  struct Cell {
    std::uint32_t first = kUseTree;  // of eight children, or of the list
    std::uint32_t count = 0;         // of the list; kIsSplit: it has children
  };
  static constexpr std::uint32_t kIsSplit = 0xffffffffu;
  using Key = std::array<std::uint32_t, 3>;
  struct Path {
    Key key{};
    unsigned level = 0;  // of the leaf that was found last
    bool is_set = false;
    std::array<std::uint32_t, kLevels + 1> cell{};
  };

  bool find_key(Point p, Key& key) const;
  const Cell& find_leaf(const Key& key, Path& path) const;
  Box box_of(const Key& corner, unsigned level) const;
  void build(const SourceTree& tree, Context& context);

  Point low_;
  double side_ = 0, per_side_ = 0;
  std::vector<Cell> cells_;
  std::vector<SourceTree::Candidate> lists_;
};

}  // namespace delfront
