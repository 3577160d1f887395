// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief Fluent's zones by number, as sections 13 and 45 say them, and what they are here.
struct FluentZone {
  int number;
  const char* type;
  const char* kind;
};
inline constexpr FluentZone kFluentZones[] = {{2, "interior", ""},
                                              {3, "wall", "wall"},
                                              {4, "pressure-inlet", "inlet"},
                                              {5, "pressure-outlet", "outlet"},
                                              {7, "symmetry", "symmetry"},
                                              {9, "pressure-far-field", "farfield"},
                                              {10, "velocity-inlet", "inlet"},
                                              {12, "periodic", "cyclic"},
                                              {8, "periodic-shadow", "cyclic"},
                                              {14, "fan", ""},
                                              {20, "mass-flow-inlet", "inlet"},
                                              {24, "interface", "interface"},
                                              {36, "outflow", "outlet"},
                                              {37, "axis", "symmetry"}};
inline constexpr int kFluentInterior = 2;

/// @brief Fluent's numbers of cell shapes: triangular, tetrahedral, quadrilateral, hexahedral, pyramidal, wedge.
inline int fluent_number(CellType type) {
  switch (type) {
    case CellType::triangle:
      return 1;
    case CellType::tetrahedron:
      return 2;
    case CellType::quad:
      return 3;
    case CellType::hexahedron:
      return 4;
    case CellType::pyramid:
      return 5;
    case CellType::prism:
      return 6;
    default:
      return 7;
  }
}

}  // namespace delfront
