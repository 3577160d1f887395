// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "brep/chart.hpp"
#include "brep/face_grid.hpp"

namespace delfront {

/// @brief A part of a face that one chart can map: at most one pole.
struct FacePart {
  std::vector<std::vector<std::uint32_t>> loops;  ///< points of the grid
  Chart::Pole pole = Chart::Pole::none;
};

/// @brief A face is one part, or two where it has two poles: cut from one side to the other half way between them.
/// Points of the cut are added to the grid.
/// @param cuts_slender  off its one pole, too, where it is far longer than wide
/// @return empty where the face has other poles than these; grid.gave_up says so
std::vector<FacePart> find_parts(const BrepFace& face, const WantedSize& size, bool cuts_slender, FaceGrid& grid);

/// @brief The parameters that a part covers.
ParameterBox box_of(const FaceGrid& grid, const FacePart& part);

}  // namespace delfront
