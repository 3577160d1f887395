// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "brep_sizes/face_pieces.hpp"
#include "delfront/brep_sizes.hpp"

namespace delfront {

inline constexpr double kWedge = 0.26;     ///< radians, 15 degrees: between faces or edges that meet, over it is no gap
inline constexpr double kWedgeFloor = 4;   ///< times hmin, in sharper ones
inline constexpr double kEvenSizes = 1.3;  ///< sizes on a piece within this ratio count as one
inline constexpr double kEvenGaps = 1.5;   ///< gaps, as above

/// @brief Sizes from the curvature of faces and edges.
GeometrySources find_curvature(const Brep& brep, std::span<const FacePiece> pieces, const BrepSizes& wish,
                               Context& context);

/// @brief Sizes between lines that come close across a face.
GeometrySources find_lines(const Brep& brep, double extent, const BrepSizes& wish, Context& context);

/// @brief Sizes between faces.
GeometrySources find_gaps(const Brep& brep, const Model& grid, std::span<const FacePiece> pieces, double extent,
                          const BrepSizes& wish, Context& context);

}  // namespace delfront
