// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"
#include "volume/recover.hpp"

namespace delfront {

/// @brief Fill the regions by an advancing front (F1-F17): the pure front, whose tets never change once they stand.
///
/// The front is the boundary's faces; each in turn, those of the smallest elements first, gets a tet with a point of
/// the front or a new one at the ideal place, and no tet stands that crosses the front or is bad. What cannot be filled
/// so is tried again with less strict settings; what then remains is a set of small closed cavities, filled by stars of
/// one point or several, or emptied a little wider and tried again. What even then remains is filled by constrained
/// Delaunay with points inside alone. So a valid boundary ends in a valid grid. Where it is not, or cannot be
/// (`gave_up` says why), the complex is left as it was.
/// Edges of embedded curves and embedded points are obstacles until tets have them (FrontObstacles). Where the field
/// has directions, all that is measured is measured in its metric at the face (FrontFrame); vertices then have the mean
/// over the directions as size.
/// @pre, @post grid.complex.find_defect() is empty; boundary faces and vertices and kept edges stay
/// @par Source  Löhner & Parikh (1988); Löhner (2008), section 3.6
/// @par Threads the same grid for any number
FrontReport fill_by_front(BoundaryGrid& grid, const SizeField& size, Context& context);

}  // namespace delfront
