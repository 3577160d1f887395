// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "delaunay/delaunay.hpp"
#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/model.hpp"
#include "tetra/tet_complex.hpp"

namespace delfront {

/// @brief The edges of a model's triangles, then those of its curves that are no edges of triangles, each with the
/// Steiner points that split it, in order.
///
/// A Steiner point is held exactly, as a + t (b - a) with a, b the edge's ends.
struct Segments {
  struct Steiner {
    double t;  ///< in (0, 1), from the edge's first end
    VertexIndex vertex;
  };
  std::vector<std::array<VertexIndex, 2>> ends;           ///< one an edge, lower index first
  std::vector<std::vector<Steiner>> chain;                ///< one an edge, by rising t
  std::vector<std::array<std::uint32_t, 3>> of_triangle;  ///< edge k runs from corner k to corner k + 1
  std::vector<std::vector<std::uint32_t>> of_curve;       ///< by curve and step along it
  std::size_t num_surface_edges = 0;                      ///< those of triangles, which come first
  std::vector<std::uint32_t> vertex_offset, vertex_edge;  ///< edges of each model vertex: offsets and values
  std::vector<std::uint32_t> steiner_edge;                ///< edge of Steiner vertex first_steiner + i
  std::size_t num_model_vertices = 0;
  std::size_t first_steiner = 0;  ///< between the two: the corners of the brick around the model
  std::size_t most_steiner = 0;   ///< more of them, and recovery fails

  /// @brief The vertices from one end to the other, Steiner points included.
  void vertices_along(std::uint32_t edge, bool backwards, std::vector<VertexIndex>& out) const;
  /// @brief The neighbours of a vertex along all the edges it lies on.
  void neighbours(VertexIndex v, std::vector<VertexIndex>& out) const;
};

Segments build_segments(const Model& model);

/// @brief The pieces of all edges of the model, or of its triangles alone: what flips and refilled cavities must keep.
EdgeSet pieces_of_edges(const Segments& segments, bool of_triangles_only = false);

/// @brief Put the vertices of the chains into the complex again, after it was built anew from the model's vertices.
void insert_chains(TetComplex& complex, DelaunayKernel& kernel, const Model& model, Segments& segments);

/// @brief Split edges until every piece of every one is an edge of the (everywhere Delaunay) complex.
///
/// An edge that is missing is split at a power-of-two distance from an end that is a model vertex, so that edges that
/// meet there at a small angle are split alike, and halved after that.
/// @par Source  protecting shells: Ruppert (1995); in space: Si & Gärtner (2005), Diazzi et al. (2023)
/// @throws MeshingError where an edge cannot be split any more
void recover_segments(TetComplex& complex, DelaunayKernel& kernel, const Model& model, Segments& segments,
                      Context& context);

/// @brief A piece of an edge, by its two ends.
struct Piece {
  std::uint32_t edge;
  VertexIndex low, high;
};

/// @brief The pieces that are no edges of the complex; all of them, or those at the vertices `at` only.
std::vector<Piece> find_missing_pieces(const TetComplex& complex, const Segments& segments,
                                       const std::vector<VertexIndex>* at, Context& context);

/// @brief Add a point to the chain that splits this piece, to be inserted when the complex is built anew.
void plan_split(const Model& model, Segments& segments, const Piece& piece);

/// @brief The same for the longest piece of an edge.
void plan_split_of_longest(const Model& model, Segments& segments, std::uint32_t edge);

}  // namespace delfront
