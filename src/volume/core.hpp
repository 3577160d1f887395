// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

#include "delaunay/delaunay.hpp"
#include "delfront/context.hpp"
#include "delfront/size_field.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief Put a body-centred cubic lattice wherever the size field has its largest value and the boundary is farther
/// than kClearance sizes (G4, a uniform core).
///
/// Its tets all have the same shape, with dihedral angles of 60 and 90 degrees, and cost no search for places. What is
/// between the core and the boundary is for refinement. Nothing is done where the field has no largest value.
/// @return points put in
/// @pre, @post complex.find_defect() is empty
/// @par Source  Sommerville (1923); Fuchs (1998)
std::size_t fill_core(TetComplex& complex, const SizeField& size, KernelCounts& counts, Context& context);

}  // namespace delfront
