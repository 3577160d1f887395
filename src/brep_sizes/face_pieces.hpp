// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delfront/brep.hpp"

namespace delfront {

/// @brief A triangle of a face by the parameters of its corners; what lies between them is on the true surface.
struct FacePiece {
  const SmoothSurface* surface = nullptr;
  std::uint32_t face = 0;
  bool is_reversed = false;  ///< the grid's normal is against the surface's
  std::array<Point2, 3> uv;  ///< unwrapped: of one period
  std::array<Point, 3> at;
  std::array<std::uint8_t, 3> pole{0, 0, 0};  ///< 1: u says nothing there, 2: v says nothing, 0: both do

  Point2 middle() const;
  Point2 middle_of_side(std::size_t k) const;  ///< from corner k to the next
  double longest_side() const;
  std::array<FacePiece, 4> quarters() const;
  Point normal(Point2 where) const;
};

/// @brief The triangles of a grid that was made with BrepOptions::keeps_parameters.
std::vector<FacePiece> pieces_of(const Brep& brep, const Model& grid, const BrepGridReport& report);

}  // namespace delfront
