// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delaunay/delaunay.hpp"
#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief Put points into the regions until edges are as long as the size field asks (T3).
///
/// Rounds without a global queue: every fresh tet proposes at most one point, proposals are filtered, sorted along
/// the Hilbert curve and inserted with the proposing tet as hint. Boundary faces and vertices stay. Points stand over
/// the faces of a front; with options.method "delaunay" they are the circumcentres of tets that are too large.
/// @pre, @post complex.find_defect() is empty
RefineReport refine_complex(TetComplex& complex, const SizeField& size, const VolumeOptions& options, Context& context);

}  // namespace delfront
