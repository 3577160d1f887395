// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "delfront/mesh.hpp"
#include "io/names.hpp"
#include "io/vtk_grid.hpp"

namespace delfront {

// What the writers of VTK's data model (VTU, VTP, VTKHDF, XDMF) share.

using Blocks = std::vector<const CellBlock*>;

/// @brief Blocks with cells of the wanted dimensions, low dimension first (the order of VTP).
Blocks blocks_of(const Mesh& mesh, int low, int high);
std::size_t num_cells(const Blocks& blocks);

/// @brief Vertex ids as plain numbers, without a copy.
std::span<const std::uint32_t> raw_ids(const std::vector<VertexId>& vertices);
/// @brief Coordinates as plain numbers, three a point, without a copy.
std::span<const double> raw_coordinates(const Mesh& mesh);

/// @brief An array of whole numbers on all cells of the blocks.
struct IdArray {
  std::string name;
  std::vector<std::int32_t> values;  ///< number of the group among those of its dimension; -1: none
};
/// @brief region_id, patch_id and, where there are such groups, curve_id and point_id (vtk_names.hpp).
std::vector<IdArray> id_arrays(const Mesh& mesh, const Blocks& blocks);

/// @brief The names of all groups as these files have them; sentences where `rule` changes one.
std::vector<VtkName> group_names(const Mesh& mesh, NameRule rule, const char* format, std::vector<std::string>& notes);

/// @brief Name and components of each field on cells; some blocks may lack it.
std::vector<std::pair<std::string, int>> cell_field_names(const Mesh& mesh);
/// @brief A field on cells over all blocks; NaN for those that lack it.
std::vector<double> cell_field(const Mesh& mesh, const Blocks& blocks, const std::string& name, int components);

/// @brief Throws InputError where there are more points than readers that count in 32 bits can take.
void check_size(const Mesh& mesh, const char* format);

}  // namespace delfront
