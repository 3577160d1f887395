// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/model.hpp"
#include "delfront/options.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief A triangle of the model that stayed subdivided, with all vertices on its outline.
struct SplitTriangle {
  TriangleId triangle;
  std::vector<VertexIndex> outline;
};

/// @brief An edge of the grid that is a model curve's edge, or a part of one; runs as the curve does.
struct CurvePiece {
  VertexIndex a, b;
};

/// @brief Tets that fill the kept regions; what is not as the model has it stands in `split`.
struct BoundaryGrid {
  TetComplex complex;
  std::vector<SplitTriangle> split;
  std::vector<std::vector<CurvePiece>> curve_pieces;  ///< by curve of the model; none for what lies outside
  std::vector<std::string> regions;                   ///< names, by colour
};

/// @brief How long recovery goes on. Each round starts over, with a point more on every edge that resisted.
struct RecoveryEffort {
  /// Where edges that resist have got half as many points as there are triangles, and 500, or would all have to be
  /// made Delaunay: for those who have a way out.
  bool gives_up = false;
};

/// @brief A tetrahedrization whose faces include every given triangle, vertex for vertex, with regions coloured (T2).
///
/// Vertices 0 … n-1 are the model's points, in order, with the mean length of their edges as size. Every triangle of
/// the model that bounds a kept region is a face flagged constrained (those in `split`: a union of such faces). Only
/// tets of kept regions remain, coloured 0, 1, …; ghosts stand on their border. Vertices may be in no tet. Every edge
/// of a curve of the model in a kept region is an edge, or a chain of collinear ones, all in complex.kept_edges unless
/// faces hold them; corners of the model are vertices.
/// @param[in] is_far_field  one a patch of the model
/// @pre check_surface(model) finds no error
/// @throws MeshingError with the places; InputError where no region is kept
/// @par Source  Si & Gärtner (2005), Diazzi et al. (2023), George et al. (2003)
BoundaryGrid tetrahedralize_boundary(const Model& model, const DomainOptions& domain,
                                     const std::vector<bool>& is_far_field, RecoveryReport& report, Context& context,
                                     const RecoveryEffort& effort = {});

}  // namespace delfront
