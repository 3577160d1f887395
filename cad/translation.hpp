// SPDX-License-Identifier: Apache-2.0
// A part as plain data before its faces are named, and what joining needs to know of it.
#pragma once
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Face.hxx>
#include <array>
#include <utility>
#include <vector>

#include "part.hpp"

namespace delfront::cad {

inline constexpr int kEdgeSamples = 7;  ///< places within an edge, evenly in its parameter

/// @brief Solids, then shells of no solid, then faces of no shell: what touches, is joined or is cut by each other.
TopTools_IndexedMapOfShape pieces_of(const TopoDS_Shape& shape);

/// @brief Corners, edges and faces by number; the rest by the same numbers.
struct Translation {
  /// What a face belongs to.
  struct Owners {
    std::vector<int> pieces;            ///< by their place in pieces_of, from 0
    std::array<int, 2> solids{-1, -1};  ///< the one behind the face, whose normal points out of it, and the one ahead
  };

  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
  std::vector<Face> faces;
  std::vector<std::array<Point, kEdgeSamples>> samples;  ///< of edges
  std::vector<TopoDS_Face> shapes;                       ///< of faces
  std::vector<Owners> owners;                            ///< of faces
  std::vector<bool> is_closed;                           ///< of pieces: a solid, or a shell without free edges
  std::vector<CadNote> suspicious;
  std::size_t internal_edges = 0;
};

Translation translate(const Part& part, const Say& say);

/// @brief What pieces have in common is there once: corners, edges and faces that coincide within their tolerances.
/// Edges must run alike in their parameters, too.
/// @return faces that went, as another piece has them
std::size_t merge_common(Translation& data, double diagonal);

/// @brief Pieces that touch or cross each other elsewhere than in corners, edges and faces that they share; for all
/// that can be told by boxes, and for flat faces with straight edges: those that may.
/// @return groups of pieces, each in ascending order
std::vector<std::vector<int>> find_contacts(const Translation& data);

/// @brief Names for faces and regions, counts for the report.
void finish(Part& part, Translation data, Result& result);

/// @brief Whether two faces with the same edges are the same surface between them.
bool is_same_surface(const TopoDS_Face& a, const TopoDS_Face& b, double tolerance);
/// @brief Whether the normals of two such faces, out of their solids, point the same way.
bool looks_the_same_way(const TopoDS_Face& a, const TopoDS_Face& b);

}  // namespace delfront::cad
