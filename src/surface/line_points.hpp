// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "delfront/size_field.hpp"
#include "surface/parts.hpp"

namespace delfront {

/// @brief A new point on a line: on which of its edges, how far along.
struct LinePoint {
  std::uint32_t edge = 0;  ///< index into SurfaceLine::edges
  double t = 0;            ///< 0: at vertices[edge]
};

/// @brief The points of all lines: corners first, then those within lines (F3).
struct LinePoints {
  std::vector<Point> points;
  std::vector<VertexId> given;                    ///< one a point: the given vertex it is, or none
  std::vector<std::vector<std::uint32_t>> chain;  ///< by line: its points in order; a loop ends with its first
};

/// @brief Where lines are divided: by line, the places of its points from its first vertex to its last.
using LineDivision = std::vector<std::vector<LinePoint>>;

/// @brief Divide lines so that each side is as long as the sizes there: the integral of 1 / h along the line, rounded,
/// in equal parts; no two lines get the same single side.
/// @param is_due    by line: is divided anew, others stay
/// @param is_kept   by line: keeps its given points
/// @throws LimitError, Cancelled
/// @par Source  Löhner (2008), 2.6: sides along curves
void divide_lines(const SurfaceParts& parts, const SizeField& size, const std::vector<bool>& is_due,
                  const std::vector<bool>& is_kept, LineDivision& division, Context& context);

LinePoints make_line_points(const SurfaceParts& parts, const LineDivision& division, const Context& context);

}  // namespace delfront
