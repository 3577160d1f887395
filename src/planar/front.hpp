// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>

#include "delfront/size_field.hpp"
#include "planar/constrain.hpp"

namespace delfront {

/// @brief Told of each triangle before the front takes it, for tests.
class FrontWatcher {
 public:
  virtual ~FrontWatcher() = default;
  /// @param sides  the front as it stands: ends of the oriented sides, what is to be gridded on their left
  /// @param corners  of the triangle; the last may be a point that is new
  virtual void before_triangle(const TriComplex& complex, std::span<const std::array<VertexIndex, 2>> sides,
                               const std::array<VertexIndex, 3>& corners) = 0;
};

/// @brief Fill the kept regions by an advancing front (F5 to F11, F17).
///
/// The triangles of kept regions are taken away and put in anew, side by side from the boundary and the embedded lines
/// and points, which all stay. Lengths, angles and quality are those of the field's metric at the side; whether a
/// triangle may be is decided exactly, so that the front is a valid closed set of oriented sides at all times. Where no
/// triangle above the floor of quality fits, the side waits for the next sweep; what is left after the last is closed
/// by constrained Delaunay triangulation, which always works.
/// @pre complex.h holds the sizes of the vertices; triangles that are not gridded have the colour kOutside
/// @post complex.find_defect() is empty; complex.h has the new points' sizes; vertex_tri is to be made anew
/// @param watcher  if not null: told of each triangle, at a cost of the whole front each
/// @par Cost    O(sides) searches of a grid that holds the front alone
/// @par Source  Löhner (2008), chapter 3
FrontReport fill_by_front(PlanarGrid& grid, const SizeField& size, Context& context, FrontWatcher* watcher = nullptr);

/// @brief A side of the front that no triangle was found for.
struct LeftSide {
  VertexIndex from, to;
  EdgeRef behind;  ///< the edge on its right, from there; kNoTri where that is open too (an embedded line)
  std::uint32_t region;
  bool is_constrained;
};

/// @brief Close what a front has left: constrained Delaunay triangulation of the parts on the left of the sides (F17).
/// @param loose  points in those parts that no side uses
/// @pre the sides form closed loops and do not cross
/// @return triangles made and parts closed, in the report's fields
void close_by_delaunay(TriComplex& complex, std::span<const LeftSide> sides, std::span<const VertexIndex> loose,
                       FrontReport& report, Context& context);

}  // namespace delfront
