// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "delfront/mesh.hpp"
#include "report/html.hpp"

namespace delfront {

// Parts of the page, each a whole element or nothing where the report has nothing of the kind. `r` is the report.

/// @brief How it ended, in one sentence, with a colour and a sign.
std::string verdict_section(const Json& r);
/// @brief The figures that are looked at first.
std::string tiles_section(const Json& r);
/// @brief A picture of the whole grid, with the colours of the boundaries.
std::string overview_section(const Mesh& mesh);
/// @brief Where the run failed: the error's places, and errors found in the surface or the grid.
std::string problems_section(const Json& r);
/// @brief Warnings, and what was changed on the way: names, turned facets, divided boundary, bridges.
std::string warnings_section(const Json& r);
/// @return whether a gate on this measure is not met
bool misses_gate(const Json& r, const std::string& measure);
/// @brief The measure that cells are judged by: min_dihedral, in the plane min_angle; empty: there is no grid.
std::string main_measure(const Json& r);
/// @brief The ten worst cells, drawn; those of measures whose gate is not met too.
std::string worst_section(const Json& r, const Mesh& mesh);
/// @brief Histograms of all measures, and of sides over wanted sizes.
std::string quality_section(const Json& r);
/// @brief Boundaries, regions, curves, points by name.
std::string groups_section(const Json& r);
/// @brief The surface that was gridded, and how well it follows smooth geometry.
std::string surface_section(const Json& r);
/// @brief Stages with bars, memory.
std::string times_section(const Json& r);
/// @brief What was asked: the command, files, options.
std::string options_section(const Json& r, const Json& defaults);

}  // namespace delfront
