// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "delfront/model.hpp"
#include "delfront/refine_grid.hpp"

namespace delfront {

// What `delfront refine` does beside refine_grid(): what goes in is looked at before, what comes out after.

/// @brief That options are in range. @param levels, feature_angle  how the caller calls them
/// @throws UsageError
void check_refine_options(const RefineGridOptions& options, const std::string& levels,
                          const std::string& feature_angle);

/// @throws InputError  no cells, or no valid grid; places of the first finding
void check_grid_to_refine(const Mesh& mesh, const std::string& name, Context& context);

/// @brief The geometry on which new boundary points belong: facets in space, lines in the plane.
/// @param name  of the geometry, for messages and lines without a group
/// @throws InputError  no lines where the grid lies in the plane
Model geometry_to_refine_on(const Mesh& grid, Mesh geometry, const std::string& name, Context& context);

/// @brief refine_grid(); never a bad grid.
/// @throws MeshingError  the new grid is not valid
Mesh refine_and_check(const Mesh& coarse, const RefineGridOptions& options, RefineGridReport& report, Context& context);

}  // namespace delfront
