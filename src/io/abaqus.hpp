// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>

#include "io/local_faces.hpp"

namespace delfront {

/// @brief Faces S1, S2, … of Abaqus's cells (sides of those in the plane), corners as the manual lists them; -1 ends.
inline std::span<const std::array<int, 4>> abaqus_faces(CellType type) {
  static constexpr std::array<int, 4> kTet[] = {{0, 1, 2, -1}, {0, 3, 1, -1}, {1, 3, 2, -1}, {2, 3, 0, -1}};
  static constexpr std::array<int, 4> kPyramid[] = {
      {0, 1, 2, 3}, {0, 4, 1, -1}, {1, 4, 2, -1}, {2, 4, 3, -1}, {3, 4, 0, -1}};
  static constexpr std::array<int, 4> kPrism[] = {
      {0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}};
  static constexpr std::array<int, 4> kHex[] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1},
                                                {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
  return LocalFaces{kTet, kPyramid, kPrism, kHex}.of(type);
}

}  // namespace delfront
