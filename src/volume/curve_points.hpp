// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/model.hpp"
#include "tetra/tet_complex.hpp"
#include "volume/recover.hpp"
#include "volume/segments.hpp"

namespace delfront {

/// @brief Note the pieces of curves that lie inside of what is gridded in complex.kept_edges.
/// @pre strip_outside was called
void keep_curve_edges(TetComplex& complex, const Segments& segments);

/// @brief Take a Steiner point off a curve: its neighbours p and q on it become the ends of one kept edge.
///
/// s is pulled into p or q where that sees all of the star; else it is moved off the edge, and (p, q) recovered by
/// switches. `may_add_points`: also by free points beside it, where tets that are switched cannot be filled without.
/// @return false where neither will do: then nothing has changed
bool remove_curve_point(TetComplex& complex, VertexIndex s, VertexIndex p, VertexIndex q, bool may_add_points);

/// @brief The edges of the complex that the curves became, in order along them; what lies outside is counted by curve.
/// @param[in,out] report  counts of curves' edges and of embedded points
/// @return by curve
std::vector<std::vector<CurvePiece>> find_curve_pieces(const TetComplex& complex, const Model& model,
                                                       const Segments& segments, RecoveryReport& report,
                                                       Context& context);

}  // namespace delfront
