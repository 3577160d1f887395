// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/model.hpp"
#include "delfront/options.hpp"

namespace delfront {

/// @brief Give the model's patches the names and kinds that [boundaries.NAME] asks for.
///
/// Patches that one boundary selects become one patch of its name; patches that nobody selects stay. Where two
/// boundaries select the same patch, the later one in the job file gets it.
/// @param far_field  a far field made around the input, or invalid: only its exact name selects it, as a pattern such
///                   as "*" means the patches of the input
/// @return the far field's patch in the new list; invalid where there is none
/// @throws UsageError  a selector that matches no patch (the names there are); patches of the input that would get the
///                     far field's name
PatchId apply_boundaries(const std::vector<BoundaryOptions>& boundaries, Model& model, PatchId far_field = {});

/// @return options.boundaries without those of the far field: for looking at the input before there is one
std::vector<BoundaryOptions> boundaries_of_input(const Options& options);

/// @brief The model as a surface mesh: its points, its triangles in order, its patches as groups.
Mesh surface_mesh(const Model& model);

}  // namespace delfront
