// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/model.hpp"
#include "tetra/tet_complex.hpp"
#include "volume/edge_flips.hpp"
#include "volume/regions.hpp"
#include "volume/segments.hpp"

namespace delfront {

/// @brief Make every triangle of the model a union of constrained faces, all of its edges being there already.
///
/// The tets that a missing triangle cuts are taken out; what is above and what is below it is filled again by gift
/// wrapping, each as its constrained Delaunay tetrahedrization. Required edges stay, other ones may go.
/// @param[out] subfaces  the faces that make up the triangles
/// @return the triangles for which that did not succeed (rounding never matters; only a neighbour recovered earlier
/// can)
/// @par Source  Si & Gärtner (2005); Shewchuk (2000) for the existence; Diazzi et al. (2023)
std::vector<TriangleId> recover_facets(TetComplex& complex, const Model& model, const Segments& segments,
                                       const EdgeSet& required, std::vector<Subface>& subfaces,
                                       std::size_t& num_missing, Context& context);

/// @brief Fill a closed polyhedron with its constrained Delaunay tetrahedra, no new points.
///
/// @param[in] points   its vertices, exactly
/// @param[in] faces    triples of indices into points, normals into the polyhedron; a face inside of it stands there
/// twice,
///                     once each way
/// @param[out] tets    positive quadruples whose faces are just the given ones, once each, and inner ones twice
/// @return false where the search found no way
/// @par Cost  O(faces * points)
bool fill_polyhedron(const std::vector<ExactPoint>& points, const std::vector<std::array<std::uint32_t, 3>>& faces,
                     std::vector<std::array<std::uint32_t, 4>>& tets);

}  // namespace delfront
