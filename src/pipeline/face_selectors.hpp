// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/cad.hpp"
#include "delfront/options.hpp"
#include "pipeline/geometry_job.hpp"

namespace delfront {

/// @brief Faces that boundaries select, other than by name, get the boundaries' names; the last one that selects wins.
///
/// What lies in a box, nearest to a place, or where a formula is true is found on the points of the first grid.
/// @param file  for messages
/// @param cad  what its faces were in the file; empty where it is no CAD file
/// @param[in,out] input  brep: the names of faces; look: the patches of its grid
/// @throws UsageError  a boundary selects a face that is not there, or none (what there is); a place is as near to two
/// @par Cost  O(points of the first grid) a boundary
void name_selected_faces(const std::vector<BoundaryOptions>& boundaries, const std::string& file, const CadReport& cad,
                         GeometryInput& input);

}  // namespace delfront
