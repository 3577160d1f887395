// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

/// @brief Convex cells by their faces, each stored once with the two cells beside it, kNone for the outside.
struct CellFaces {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<Point> vertices;
  std::vector<std::uint64_t> offsets = {0};         ///< num_faces + 1 places in `loops`
  std::vector<std::uint32_t> loops;                 ///< vertices round each face
  std::vector<std::array<std::uint32_t, 2>> cells;  ///< normal from the first, never kNone, to the second

  std::size_t size() const { return cells.size(); }
  std::span<const std::uint32_t> operator[](std::size_t f) const {
    return {loops.data() + offsets[f], loops.data() + offsets[f + 1]};
  }
  void add(std::span<const std::uint32_t> loop, std::array<std::uint32_t, 2> sides) {
    loops.insert(loops.end(), loop.begin(), loop.end());
    offsets.push_back(loops.size());
    cells.push_back(sides);
  }
};

/// @brief Keep what lies on one side of an axis-parallel plane, and close the cells that it cuts.
///
/// Which side a vertex lies on is asked once a vertex, and an edge that is cut gets one new vertex, so what was closed
/// and conforming stays so whatever rounding does. Cells from `num_closed` on are open: they are cut but not closed.
/// @param direction  +1: keep what is above `value` on `axis`, -1: below
/// @param tolerance  vertices nearer to the plane than this are moved onto it
void cut_cells(CellFaces& faces, std::uint32_t num_closed, int axis, int direction, double value, double tolerance);

}  // namespace delfront
