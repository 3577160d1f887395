// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/context.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief Pull a free vertex into that neighbour which leaves the best worst tet; all new tets are positive, exactly.
/// @param to_better  only where that worst tet is no worse than the worst before
/// @return false where v is not free (given, on an edge, or next to another region) or no neighbour will do
/// @par Cost  O(neighbours * tets) around v
bool contract_free_vertex(TetComplex& complex, VertexIndex v, bool to_better);

/// @brief Contract free vertices as long as that leaves no worse tets. After boundary recovery, which puts points
/// wherever there is room, however little, most of them are not needed any more.
/// @return vertices taken away
std::size_t thin_out(TetComplex& complex, Context& context);

}  // namespace delfront
