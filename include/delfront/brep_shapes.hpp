// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <memory>

#include "delfront/brep.hpp"

namespace delfront {

/// @brief A right-handed frame in space.
struct SpaceFrame {
  Point origin;
  Point x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< orthonormal

  Point to_space(Point local) const { return origin + local.x * x + local.y * y + local.z * z; }
  Point turn(Point local) const { return local.x * x + local.y * y + local.z * z; }
};

using CurvePointer = std::shared_ptr<const SmoothCurve>;
using SurfacePointer = std::shared_ptr<const SmoothSurface>;
using ParameterCurvePointer = std::shared_ptr<const ParameterCurve>;

// Curves. Lengths in model units, angles in radians.

/// @brief from at t = 0, to at t = 1.
CurvePointer make_line(Point from, Point to);
/// @brief (a cos t, b sin t) in the frame's plane, t in [0, 2 pi]; a circle where a = b.
CurvePointer make_ellipse(const SpaceFrame& frame, double a, double b);
/// @brief Cubic by Bezier points, t in [0, 1].
CurvePointer make_cubic(const std::array<Point, 4>& control);
/// @brief What a parameter curve is in space.
CurvePointer make_curve_on(SurfacePointer surface, ParameterCurvePointer curve, std::array<double, 2> range,
                           bool is_closed = false);

/// @brief From a place at range[0] to one at range[1], evenly.
ParameterCurvePointer make_parameter_line(Point2 from, Point2 to, std::array<double, 2> range = {0, 1});
/// @brief centre + (a cos t, b sin t).
ParameterCurvePointer make_parameter_ellipse(Point2 centre, double a, double b);

// Surfaces; normals point outwards, those of planes along z.

/// @brief (u, v, 0) in the frame.
SurfacePointer make_plane_surface(const SpaceFrame& frame);
/// @brief Round z: u the angle, v along z.
SurfacePointer make_cylinder_surface(const SpaceFrame& frame, double radius);
/// @brief Round z: u the angle, v the distance from the tip, which is the origin; z grows with v.
/// @param half_angle  between the axis and the surface, in (0, pi / 2)
SurfacePointer make_cone_surface(const SpaceFrame& frame, double half_angle);
/// @brief u the longitude, v the latitude in [-pi/2, pi/2]: poles at both ends.
SurfacePointer make_sphere_surface(const SpaceFrame& frame, double radius);
/// @brief u the angle round z, v round the tube, from the outer side upwards.
SurfacePointer make_torus_surface(const SpaceFrame& frame, double radius, double tube);
/// @brief Bezier points of a bicubic patch, control[i][j] with i along u; u and v in [0, 1].
SurfacePointer make_bicubic_surface(const std::array<std::array<Point, 4>, 4>& control);

// Whole shapes. Closed ones have their normals outwards.

/// @brief One face with a seam and two poles.
Brep make_sphere(Point centre, double radius);
/// @brief One face with two seams, round the frame's z.
Brep make_torus(const SpaceFrame& frame, double radius, double tube);
/// @brief Faces "side", "bottom" (at the origin) and "top".
Brep make_cylinder(const SpaceFrame& frame, double radius, double height);
/// @brief Faces "side" and "base"; the tip is a corner at the origin, the base at z = height.
Brep make_cone(const SpaceFrame& frame, double half_angle, double height);
/// @brief One open face with four edges.
Brep make_bicubic(const std::array<std::array<Point, 4>, 4>& control);

/// @brief An open face: the part of a surface inside a rectangle of the parameter plane, degenerate where the surface
/// is, with a seam where the rectangle is a period wide.
/// @throws InputError  a rectangle without area, or wider than a period
Brep make_rectangle_on(SurfacePointer surface, ParameterBox rectangle);
/// @brief Take a hole out of a face: an ellipse in its parameter plane, one closed edge. The face must hold it.
void cut_hole(Brep& brep, FaceId face, Point2 centre, double a, double b);

}  // namespace delfront
