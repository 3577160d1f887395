// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>

#include "io/local_faces.hpp"

namespace delfront {

/// @brief Sides 1, 2, … of Exodus's elements: faces seen from outside, or edges of those in the plane; -1 ends.
/// (Elements of surfaces in space have their two faces first; these stand for the element itself.)
inline std::span<const std::array<int, 4>> exodus_sides(CellType type) {
  static constexpr std::array<int, 4> kTet[] = {{0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}, {0, 2, 1, -1}};
  static constexpr std::array<int, 4> kPyramid[] = {
      {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {0, 4, 3, -1}, {0, 3, 2, 1}};
  static constexpr std::array<int, 4> kPrism[] = {
      {0, 1, 4, 3}, {1, 2, 5, 4}, {0, 3, 5, 2}, {0, 2, 1, -1}, {3, 4, 5, -1}};
  static constexpr std::array<int, 4> kHex[] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6},
                                                {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}};
  return LocalFaces{kTet, kPyramid, kPrism, kHex}.of(type);
}

/// Attribute of the file: lines as name_line() makes them, numbers are ids of blocks and side sets.
inline constexpr const char* kExodusGroups = "delfront_groups";
/// Side set of faces that have no patch.
inline constexpr const char* kExodusNoPatch = "faces_without_a_patch";

}  // namespace delfront
