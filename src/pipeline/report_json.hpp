// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "delfront/findings.hpp"
#include "delfront/grid_check.hpp"
#include "delfront/job.hpp"
#include "delfront/refine_grid.hpp"
#include "delfront/surface_check.hpp"

namespace delfront {

/// @brief Parts of the JSON reports; keys are those of the structs, angles in degrees, lengths in model units.
nlohmann::ordered_json to_json(const std::vector<Place>& places, std::size_t most = 100);
nlohmann::ordered_json to_json(const std::vector<Finding>& findings);
nlohmann::ordered_json to_json(const SurfaceReport& report);
nlohmann::ordered_json to_json(const QualityReport& report);
nlohmann::ordered_json to_json(const RefineGridReport& report);

/// @brief Named groups of one dimension with kind, number of cells, and their length, area or volume.
/// @param factor   from the mesh's units to model units
/// @param colours  RRGGBB by name
nlohmann::ordered_json groups_json(const Mesh& mesh, int dimension, double factor = 1,
                                   const std::map<std::string, std::string>& colours = {});
/// @brief The tree of a job file with these options.
nlohmann::ordered_json options_json(const Options& options);

/// @return "error", "warning", "note"
const char* severity_name(Severity severity);

/// @return "done", "bad_input", … as in ExitCode
const char* outcome_name(ExitCode code);

/// @brief Write a text file whole or not at all.
/// @throws IoError
void write_text_file(const std::string& path, const std::string& text);

}  // namespace delfront
