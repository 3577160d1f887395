// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/model.hpp"
#include "tetra/tet_complex.hpp"
#include "volume/segments.hpp"

namespace delfront {

/// @brief Take the Steiner points off the surface again, so that its triangles are as they were given.
///
/// A point s on an edge is taken out of every facet that meets there; each region around the edge gets a point of its
/// own instead, moved inside until it sees everything around it. Where all is exact such a place always exists, near
/// enough to s, unless a facet ends at the edge (both of its sides in one region): those points stay and are reported.
/// @pre strip_outside was called
/// @post complex.segment_points is empty: what stayed is rounded, all tets still positive
/// @throws MeshingError where a point that stays cannot be rounded
/// @par Source  George, Borouchaki & Saltel (2003)
void unsplit_boundary(TetComplex& complex, Segments& segments, RecoveryReport& report, Context& context);

}  // namespace delfront
