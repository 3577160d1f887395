// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief What the given boundary asks of the tets at each vertex: the squared sine of the smallest angle there.
///
/// Of the constrained faces that touch the vertex: their corners' angles (all three of each), and the dihedral angles
/// between two of them with nothing constrained between. 1 for vertices off the boundary. A tet whose quality is not
/// far below that of its vertices is as the boundary has it; one that is could be better.
/// @par Cost  O(boundary faces * tets around their edges)
std::vector<float> measure_sharpness(const TetComplex& complex);

}  // namespace delfront
