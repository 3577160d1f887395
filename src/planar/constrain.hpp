// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "planar/tri_complex.hpp"

namespace delfront {

/// @brief A constrained edge: a given segment, or the part of one between two vertices on it.
struct PlanarPiece {
  VertexIndex a, b;     ///< runs as the segment was given
  std::uint32_t curve;  ///< index into PlanarDomain::curves
};

/// @brief A triangulation on its way to a grid, with what has to stay in it.
struct PlanarGrid {
  TriComplex complex;
  std::vector<PlanarPiece> pieces;
  std::vector<std::string> region_names;  ///< by colour
  std::vector<double> region_h;           ///< by colour: no side wanted above it
  std::vector<std::string> warnings;
};

/// @brief Put all segments of a domain into the Delaunay triangulation of its points: constrained Delaunay (T2).
///
/// A segment that runs through a vertex is split there. The triangles that it cuts are replaced, on each side of it, by
/// the constrained Delaunay triangulation of the hollow. Colours are lost.
/// @param same_as  for each point of the domain the vertex that stands for it (itself but for duplicates)
/// @throws InputError  segments that cross, with the places
/// @par Source  Anglada (1997), "An improved incremental algorithm for constructing restricted Delaunay triangulations"
void insert_segments(const PlanarDomain& domain, const std::vector<VertexIndex>& same_as, PlanarGrid& grid,
                     Context& context);

/// @brief Colour the regions, drop what is not kept: its triangles get the colour kOutside.
///
/// Connected triangles (over unconstrained edges) are one region. Segments count the winding, from right to left of one
/// adds one: a part of winding 0 is a hole where loops tell (InnerLoops), seeds override.
/// @throws InputError  nothing is bounded; a seed outside of every region, or on a segment
void colour_regions(const PlanarDomain& domain, const DomainOptions& options, PlanarGrid& grid);

}  // namespace delfront
