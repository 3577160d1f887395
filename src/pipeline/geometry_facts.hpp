// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "delfront/brep.hpp"
#include "delfront/cad.hpp"
#include "delfront/model.hpp"

namespace delfront {

/// @brief Where a face is and which way it looks, by its triangles: what boundaries can select it by.
struct FacePlace {
  double area = 0;
  Box box;
  Point at;                     ///< on the face, near its middle
  std::optional<Point> normal;  ///< of length 1; where the face looks that way all over, within 5 degrees
};

/// @param grid  grid_brep() of as many faces
std::vector<FacePlace> places_of_faces(const Model& grid, std::size_t num_faces);

/// @brief What smooth geometry consists of, as `info` says it: corners, edges and faces with names and tolerances, and
/// of a CAD file its unit, what was mended and what is suspicious.
/// @param cad       empty where it is no CAD file
/// @param is_quick  the grid is a coarse one
nlohmann::ordered_json geometry_json(const Brep& brep, const std::vector<FacePlace>& places, const BrepGridReport& grid,
                                     const CadReport& cad);
/// @brief The same for people, a line each; at most 40 entities of a kind.
std::string geometry_text(const Brep& brep, const std::vector<FacePlace>& places, const BrepGridReport& grid,
                          const CadReport& cad, bool is_quick);

}  // namespace delfront
