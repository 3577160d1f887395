// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/brep.hpp"
#include "delfront/options.hpp"

namespace delfront {

/// @brief Faces that boundaries select by number or normal get the boundaries' names; the last one that selects wins.
/// @param file  for messages
/// @throws UsageError  a boundary selects a face that is not there, or none
void name_selected_faces(const std::vector<BoundaryOptions>& boundaries, const std::string& file, Brep& brep);

}  // namespace delfront
