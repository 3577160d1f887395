// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "delfront/brep.hpp"
#include "delfront/cad.hpp"

namespace delfront {

/// @brief What smooth geometry consists of, as `info` says it: corners, edges and faces with names and tolerances, and
/// of a CAD file its unit, what was mended and what is suspicious.
/// @param cad       empty where it is no CAD file
/// @param is_quick  the grid is a coarse one
nlohmann::ordered_json geometry_json(const Brep& brep, const BrepGridReport& grid, const CadReport& cad);
/// @brief The same for people, a line each; at most 40 entities of a kind.
std::string geometry_text(const Brep& brep, const BrepGridReport& grid, const CadReport& cad, bool is_quick);

}  // namespace delfront
