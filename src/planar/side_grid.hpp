// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "planar/tri_complex.hpp"

namespace delfront {

/// @brief A side of a front where it is searched for: its ends with their places. A point that no side uses has from ==
/// to.
struct FrontSide {
  Point2 a, b;
  VertexIndex from, to;
  std::uint32_t id;
};

/// @brief Sides of a front in the plane, found by box: a hierarchical hash grid whose size is that of the front (F13).
///
/// A side stands in the cell of its middle, on the level whose cells are two to four times its extent, so it reaches no
/// further than a quarter of a cell out of it. A query looks up a few cells as large as its box, those of coarser
/// levels that hold sides, and follows marks of occupied children downwards. What goes leaves nothing behind, so that
/// the grid of a front of ten thousand sides stays in the cache however many triangles it has left (F16).
/// Coordinates become integers once, with 2^28 steps over the root cell; a query misses no side that overlaps its box.
/// @par Cost  O(1) to put in and take out; a query O(levels in use + hits)
class SideGrid {
 public:
  /// @brief Empty, for sides in a box.
  void clear(Point2 low, Point2 high) {
    low_ = low;
    const double extent = std::max({high.x - low.x, high.y - low.y, 0x1p-500});
    edge_ = 2 * std::exp2(std::ceil(std::log2(extent)));
    to_steps_ = kSteps / edge_;
    cells_.assign(kFirstTable, Cell{});
    num_cells_ = 0;
    chunks_.clear();
    free_chunks_.clear();
    std::fill(std::begin(sides_on_level_), std::end(sides_on_level_), 0);
  }

  void insert(const FrontSide& side) {
    const Place place = place_of(side);
    ++sides_on_level_[place.level];
    const std::size_t slot = find_or_add(place);
    std::uint32_t& first = cells_[slot].chunk;
    if (first == kNone || chunks_[first].count == kCapacity) {
      const std::uint32_t made = new_chunk();
      chunks_[made].next = first;
      first = made;
    }
    Chunk& chunk = chunks_[first];
    chunk.side[chunk.count++] = side;
  }

  /// @pre it is there, with the same places
  void remove(const FrontSide& side) {
    const Place place = place_of(side);
    --sides_on_level_[place.level];
    Cell& cell = cells_[find(place.key)];
    Chunk& first = chunks_[cell.chunk];
    for (std::uint32_t c = cell.chunk; c != kNone; c = chunks_[c].next)
      for (std::uint32_t i = 0; i < chunks_[c].count; ++i)
        if (chunks_[c].side[i].id == side.id) {
          chunks_[c].side[i] = first.side[--first.count];
          if (first.count == 0) {
            const std::uint32_t gone = cell.chunk;
            cell.chunk = first.next;
            free_chunks_.push_back(gone);
            if (cell.chunk == kNone && cell.children == 0) erase(place);
          }
          return;
        }
  }

  /// @brief visit(side) for every side whose box overlaps the given one.
  template <class Visit>
  void for_each_near(Point2 low, Point2 high, Visit&& visit) const {
    const Query query{
        low, high, steps(low.x - low_.x), steps(low.y - low_.y), steps(high.x - low_.x), steps(high.y - low_.y)};
    const std::uint32_t extent = static_cast<std::uint32_t>(std::max(query.x1 - query.x0, query.y1 - query.y0)) | 1;
    const int own = std::clamp(kTopBit - static_cast<int>(std::bit_width(extent)), 0, kDeepest);
    for (int level = 0; level <= own; ++level)
      if (level == own || sides_on_level_[level] > 0) visit_level(query, level, level == own, visit);
  }

 private:
  static constexpr int kTopBit = 28;
  static constexpr double kSteps = 1 << kTopBit;
  static constexpr int kDeepest = 26;  ///< a quarter of a cell there is one step
  static constexpr std::uint32_t kCapacity = 6;
  static constexpr std::size_t kFirstTable = 1024;
  static constexpr std::uint32_t kNone = 0xffffffffu;

  struct Chunk {
    FrontSide side[kCapacity];
    std::uint32_t count = 0, next = kNone;
  };
  struct Cell {
    std::uint64_t key = 0;  ///< 0: none
    std::uint32_t chunk = kNone;
    std::uint32_t children = 0;  ///< bit i: child i holds something
  };
  struct Place {
    std::uint64_t key;
    std::int32_t x, y;
    int level;
  };
  struct Query {
    Point2 low, high;
    std::int32_t x0, y0, x1, y1;
  };

  std::int32_t steps(double from_low) const {
    return static_cast<std::int32_t>(std::clamp(from_low * to_steps_, 0.0, kSteps - 1));
  }
  static std::uint64_t key_of(int level, std::int32_t x, std::int32_t y) {
    return std::uint64_t(level + 1) << 58 | std::uint64_t(x) << 29 | std::uint64_t(y);
  }
  std::size_t hash(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> 32) & (cells_.size() - 1);
  }
  static int shift_of(int level) { return kTopBit - level; }

  Place place_of(const FrontSide& side) const {
    const double extent = std::max(std::fabs(side.a.x - side.b.x), std::fabs(side.a.y - side.b.y));
    const auto cells = static_cast<std::uint64_t>(std::min(edge_ / std::max(extent, 0x1p-600), 0x1p40));
    const int level = std::clamp(static_cast<int>(std::bit_width(cells)) - 2, 0, kDeepest);
    const std::int32_t x = steps(0.5 * (side.a.x + side.b.x) - low_.x) >> shift_of(level);
    const std::int32_t y = steps(0.5 * (side.a.y + side.b.y) - low_.y) >> shift_of(level);
    return {key_of(level, x, y), x, y, level};
  }

  static Place parent_of(const Place& p) {
    return {key_of(p.level - 1, p.x >> 1, p.y >> 1), p.x >> 1, p.y >> 1, p.level - 1};
  }
  static std::uint32_t child_bit(const Place& p) { return 1u << ((p.x & 1) | (p.y & 1) << 1); }

  /// Where a cell stands in the table, or the free place where it would.
  std::size_t find(std::uint64_t key) const {
    std::size_t slot = hash(key);
    while (cells_[slot].key != key && cells_[slot].key != 0) slot = (slot + 1) & (cells_.size() - 1);
    return slot;
  }

  std::size_t find_or_add(const Place& place) {
    const std::size_t slot = find(place.key);
    if (cells_[slot].key != 0) return slot;
    add(place.key);
    for (Place child = place; child.level > 0;) {  // marks upwards, as far as cells are new
      const Place above = parent_of(child);
      const bool is_new = cells_[find(above.key)].key == 0;
      if (is_new) add(above.key);
      cells_[find(above.key)].children |= child_bit(child);
      if (!is_new) break;
      child = above;
    }
    return find(place.key);
  }

  void add(std::uint64_t key) {
    const std::size_t slot = find(key);
    if (cells_[slot].key != 0) return;
    cells_[slot] = {key, kNone, 0};
    if (++num_cells_ * 2 > cells_.size()) grow();
  }

  void grow() {
    std::vector<Cell> old(2 * cells_.size());
    old.swap(cells_);
    for (const Cell& cell : old)
      if (cell.key != 0) cells_[find(cell.key)] = cell;
  }

  /// Take out a cell that holds nothing, and those above it that held nothing else. What stood behind it in the table
  /// because of it moves up.
  void erase(Place place) {
    for (;;) {
      const std::size_t mask = cells_.size() - 1;
      std::size_t hole = find(place.key);
      for (std::size_t next = (hole + 1) & mask; cells_[next].key != 0; next = (next + 1) & mask) {
        const std::size_t home = hash(cells_[next].key);
        if (((next - home) & mask) >= ((next - hole) & mask)) {
          cells_[hole] = cells_[next];
          hole = next;
        }
      }
      cells_[hole] = Cell{};
      --num_cells_;
      if (place.level == 0) return;
      const std::uint32_t bit = child_bit(place);
      place = parent_of(place);
      Cell& parent = cells_[find(place.key)];
      parent.children &= ~bit;
      if (parent.children != 0 || parent.chunk != kNone) return;
    }
  }

  std::uint32_t new_chunk() {
    if (free_chunks_.empty()) {
      chunks_.emplace_back();
      return static_cast<std::uint32_t>(chunks_.size() - 1);
    }
    const std::uint32_t c = free_chunks_.back();
    free_chunks_.pop_back();
    chunks_[c].count = 0;
    return c;
  }

  template <class Visit>
  void visit_level(const Query& query, int level, bool descends, Visit&& visit) const {
    const int shift = shift_of(level);
    const std::int32_t margin = (1 << shift) / 4 + 1;
    const std::int32_t x0 = std::max(query.x0 - margin, 0) >> shift, x1 = (query.x1 + margin) >> shift;
    const std::int32_t y0 = std::max(query.y0 - margin, 0) >> shift, y1 = (query.y1 + margin) >> shift;
    for (std::int32_t x = x0; x <= x1; ++x)
      for (std::int32_t y = y0; y <= y1; ++y) {
        const Cell& cell = cells_[find(key_of(level, x, y))];
        if (cell.key == 0) continue;
        visit_cell(query, cell, visit);
        if (descends && cell.children != 0) visit_children(query, cell.children, level, x, y, visit);
      }
  }

  template <class Visit>
  void visit_children(const Query& query, std::uint32_t children, int level, std::int32_t x, std::int32_t y,
                      Visit&& visit) const {
    const int shift = shift_of(level + 1);
    const std::int32_t margin = (1 << shift) / 4 + 1;
    for (; children != 0; children &= children - 1) {
      const int i = std::countr_zero(children);
      const std::int32_t cx = 2 * x + (i & 1), cy = 2 * y + (i >> 1);
      const std::int32_t low_x = cx << shift, low_y = cy << shift;
      if (low_x - margin > query.x1 || low_x + (1 << shift) + margin < query.x0 || low_y - margin > query.y1 ||
          low_y + (1 << shift) + margin < query.y0)
        continue;
      const Cell& cell = cells_[find(key_of(level + 1, cx, cy))];
      visit_cell(query, cell, visit);
      if (cell.children != 0) visit_children(query, cell.children, level + 1, cx, cy, visit);
    }
  }

  template <class Visit>
  void visit_cell(const Query& query, const Cell& cell, Visit&& visit) const {
    for (std::uint32_t c = cell.chunk; c != kNone; c = chunks_[c].next)
      for (std::uint32_t i = 0; i < chunks_[c].count; ++i) {
        const FrontSide& s = chunks_[c].side[i];
        if (std::max(s.a.x, s.b.x) < query.low.x || std::min(s.a.x, s.b.x) > query.high.x ||
            std::max(s.a.y, s.b.y) < query.low.y || std::min(s.a.y, s.b.y) > query.high.y)
          continue;
        visit(s);
      }
  }

  Point2 low_;
  double edge_ = 1, to_steps_ = 1;
  std::vector<Cell> cells_;
  std::size_t num_cells_ = 0;
  std::vector<Chunk> chunks_;
  std::vector<std::uint32_t> free_chunks_;
  std::uint32_t sides_on_level_[kDeepest + 1] = {};
};

}  // namespace delfront
