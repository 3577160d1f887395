// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

#include "tetra/tet_complex.hpp"

namespace delfront {

using LinkFace = std::array<VertexIndex, 3>;

inline bool has(const LinkFace& face, VertexIndex v) { return face[0] == v || face[1] == v || face[2] == v; }

/// @brief The tets around v, and the faces of them opposite v, normals towards v.
/// @return false where a ghost or a constrained face is at v
bool find_link(const TetComplex& complex, VertexIndex v, std::vector<TetIndex>& star, std::vector<LinkFace>& link);

}  // namespace delfront
