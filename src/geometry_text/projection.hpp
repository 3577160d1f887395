// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "delfront/brep_shapes.hpp"

namespace delfront {

/// @brief Where an edge lies in the parameter plane of a surface, by the nearest places along it, unwrapped.
struct Projection {
  ParameterCurvePointer curve;
  double farthest = 0;  ///< that a sample of the edge lies off the surface
  Point farthest_at;
};

/// @param reach  a length that no place of the geometry is farther away than from any other
Projection project_edge(const SurfacePointer& surface, const CurvePointer& edge, std::array<double, 2> range,
                        double reach);

/// @brief A curve of the parameter plane moved.
ParameterCurvePointer move_parameter_curve(ParameterCurvePointer curve, Point2 by);

/// @brief The part of a surface's box that a geometry of that reach can lie in: finite.
ParameterBox finite_box(const SmoothSurface& surface, double reach);

}  // namespace delfront
