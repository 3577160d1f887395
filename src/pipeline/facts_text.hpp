// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "base/with_commas.hpp"
#include "delfront/findings.hpp"
#include "delfront/grid_check.hpp"
#include "delfront/job.hpp"
#include "delfront/mesh.hpp"
#include "delfront/surface_check.hpp"

namespace delfront {

// What front ends show to people: tables as text, lines that end in '\n'.

/// @brief Findings as a table: severity, count, what, first places, what to try.
std::string findings_text(const std::vector<Finding>& findings, std::size_t places_shown = 3);
/// @brief Quality as a table: min, mean, max of each measure; with the worst cells and their places.
std::string quality_text(const QualityReport& report, std::size_t worst_shown);
/// @brief Counts by cell type, groups by dimension, box.
std::string mesh_facts_text(const Mesh& mesh);
/// @brief Whether it is closed, its area, edges, angles, components.
std::string surface_facts_text(const SurfaceReport& report);
/// @brief Cells, points, sizes, memory and time. @param max_cells  the limit of the job; 0: none
std::string estimate_text(const Estimate& estimate, std::uint64_t max_cells);

}  // namespace delfront
