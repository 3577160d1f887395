// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <set>
#include <vector>

#include "brep/wanted_size.hpp"
#include "delfront/brep.hpp"

namespace delfront {

/// @brief Where the border of a face goes from one edge to another at a small angle, inside.
struct SharpCorner {
  CornerId corner;
  Point at;
  double angle;      ///< radians
  BrepUse from, to;  ///< of the face's loop
};

/// @brief All of them, in the order of the faces; edges that are a point have no part in it, nor
/// have seams that turn round.
/// @param below  radians
std::vector<SharpCorner> find_sharp_corners(const Brep& brep, double below);

/// @brief What is left of the edges' ranges to be divided by size: without the first sides in sharp corners.
///
/// Where two edges meet at 6.5 to 25 degrees in a face, sides as short as wanted make needles: with sides of length
/// h at 11 degrees the face is 0.2 h wide after the first one. There the first side of both goes on until the face is
/// as wide as sides are to be, so that one triangle is sharp, as the corner is, and no other.
/// @param corners  where that is done
/// @return one an edge; its whole range where neither end is such a corner, or it is too short or bent for such a side
/// @par Cost  O(uses of edges); a few evaluations in each sharp corner
Array<EdgeId, std::array<double, 2>> ranges_between_sharp_corners(const Brep& brep, const WantedSize& size,
                                                                  const std::set<CornerId>& corners);

/// @brief Sharp corners where a grid has needles beside the triangle in the corner itself: where sides were short, and
/// nothing was bridged.
/// @param needle_deg  smallest angle below which a triangle is one
/// @param entity      by point of the model
std::vector<CornerId> find_needles_in_corners(const Brep& brep, const Model& model,
                                              const std::vector<VertexEntity>& entity, double needle_deg);

}  // namespace delfront
