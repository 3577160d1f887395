// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief A type of cells in XDMF: its name, its number in mixed topologies (which follow it by the number of corners
/// where that is not fixed), its number in VTK, which has the same order of corners.
struct XdmfType {
  const char* name;
  int number;
  int vtk_number;
  int num_corners;  ///< 0: any
};
inline constexpr std::array<XdmfType, 10> kXdmfTypes = {{{"Polyvertex", 1, 2, 0},
                                                         {"Polyline", 2, 4, 0},
                                                         {"Polygon", 3, 7, 0},
                                                         {"Triangle", 4, 5, 3},
                                                         {"Quadrilateral", 5, 9, 4},
                                                         {"Tetrahedron", 6, 10, 4},
                                                         {"Pyramid", 7, 14, 5},
                                                         {"Wedge", 8, 13, 6},
                                                         {"Hexahedron", 9, 12, 8},
                                                         {"Polyhedron", 16, 42, 0}}};

}  // namespace delfront
