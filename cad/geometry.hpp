// SPDX-License-Identifier: Apache-2.0
// Curves and surfaces of OpenCASCADE as plain data.
#pragma once
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>

#include "cad/cad_data.hpp"

namespace delfront::cad {

inline Point point_of(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }
inline Point point_of(const gp_Pnt& p) { return point_of(p.XYZ()); }
inline Point point_of(const gp_Vec& p) { return point_of(p.XYZ()); }
inline Point point_of(const gp_Dir& p) { return point_of(p.XYZ()); }

/// @param range  what an edge uses of it: beyond the knots of a spline the data are those of a wrapped evaluator
CurveData curve_data(const Handle(Geom_Curve) & curve, std::array<double, 2> range);
ParameterCurveData parameter_curve_data(const Handle(Geom2d_Curve) & curve, std::array<double, 2> range);
/// @param box  of the parameters that a face uses
SurfaceData surface_data(const Handle(Geom_Surface) & surface, const ParameterBox& box);

/// @brief What it evaluates itself, for anything.
CurveData other_curve(const Handle(Geom_Curve) & curve);
SurfaceData other_surface(const Handle(Geom_Surface) & surface);

}  // namespace delfront::cad
