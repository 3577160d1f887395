// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/background.hpp"
#include "sizing/simplex_grid.hpp"

namespace delfront {

/// @brief What the nodes of a grid want: sizes, or metrics where `metric` is not empty; one a node, of no meaning where
/// no cell uses the node.
struct NodeSizes {
  std::vector<double> size;
  std::vector<Metric> metric;
};

/// @brief Node fields looked up by name, checked and put together; factor and limits are in.
/// @throws InputError, UsageError  as build_background_size_field
NodeSizes read_node_sizes(const BackgroundGrid& grid, const SimplexGrid& cells, const BackgroundOptions& options);

/// @brief The node field of that name.
/// @throws UsageError  there is none; says which there are and the nearest name
const Field& find_node_field(const Mesh& mesh, const std::string& grid_name, const std::string& field,
                             const char* what);

/// @brief Which vertices the cells use.
std::vector<char> used_vertices(const SimplexGrid& grid);

/// @brief In the plane: no size across it, zz that of the least size within it.
Metric plane_metric(const Metric& metric);

/// @return whether all eigenvalues are positive and finite
bool is_positive_definite(const Metric& metric);

}  // namespace delfront
