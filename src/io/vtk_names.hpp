// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "delfront/mesh.hpp"
#include "io/cells.hpp"

namespace delfront {

// How names and ids of groups stand in our VTK files: cell arrays region_id, patch_id (curve_id, point_id where there
// are any), -1 where a cell has none, and one small field-data array a group, called "patch:<name>", "region:<name>"…,
// that holds [id, dimension]. VTK, ParaView and meshio show these names as they are (meshio keeps its own names in the
// same way: field_data[name] = [id, dimension]); string arrays would make meshio fail.

/// @brief "region_id", "patch_id", "curve_id" or "point_id" for cells of this dimension.
inline std::string vtk_id_array(const Mesh& mesh, int cell_dimension) {
  return std::string(role_name(mesh, cell_dimension)) + "_id";
}

inline bool is_vtk_role(std::string_view role) {
  return role == "region" || role == "patch" || role == "curve" || role == "point";
}

}  // namespace delfront
