// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cad/cad_data.hpp"

namespace delfront::cad {

/// @brief Curves and surfaces from a module's data, with the parameters of the file.
/// @throws InputError  data of a spline that are none
CurvePointer make_curve(const CurveData& data);
ParameterCurvePointer make_parameter_curve(const ParameterCurveData& data);
/// @param used  parameters of the face's loops
SurfacePointer make_surface(const SurfaceData& data, const ParameterBox& used);

}  // namespace delfront::cad
