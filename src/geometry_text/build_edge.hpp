// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

#include "delfront/geometry_text.hpp"

namespace delfront {

/// @brief The curve of an edge, and its part.
struct BuiltCurve {
  CurvePointer curve;
  std::array<double, 2> range{0, 1};
  bool is_closed = false;            ///< in space
  SurfacePointer surface;            ///< of an edge on a surface …
  ParameterCurvePointer on_surface;  ///< … and where it lies there
};

/// @param ends  places of its corners; null where it has none
/// @throws InputError  without the file's place
BuiltCurve build_curve(const TextEdge& edge, const Point* from, const Point* to,
                       const std::function<SurfacePointer(const std::string&)>& surface);

/// @throws InputError  without the file's place
SurfacePointer build_surface(const TextSurface& surface);

/// @brief A curve in a parameter plane through places: straight through two, smooth through more.
ParameterCurvePointer build_uv_curve(const std::vector<std::array<double, 2>>& uv, std::array<double, 2> range);

}  // namespace delfront
