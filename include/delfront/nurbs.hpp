// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "delfront/brep_shapes.hpp"

namespace delfront {

/// Splines, B-splines and NURBS (D1). Data are plain structs; make_…() checks them and gives what a Brep is made of.
/// Methods: Piegl and Tiller, The NURBS Book (1997): A2.2, 2.3, 3.6, 4.4, 5.1, chapters 7 to 10; de Boor, A Practical
/// Guide to Splines (1978). Where a curve or surface bends at a repeated knot, derivatives are those after the knot.

inline constexpr int kMostDegree = 25;

/// @brief A (rational) B-spline curve; of one in a parameter plane z is not used.
///
/// Places are those of t in [knots[degree], knots[points.size()]]: clamped knots begin and end degree + 1 times the
/// same and the curve begins and ends in its end points; periodic ones go on evenly, with `degree` points repeated.
struct NurbsCurveData {
  int degree = 3;
  std::vector<double> knots;  ///< ascending, points.size() + degree + 1 of them
  std::vector<Point> points;
  std::vector<double> weights;  ///< > 0, one a point; empty: all 1

  std::array<double, 2> range() const { return {knots[std::size_t(degree)], knots[points.size()]}; }
  friend bool operator==(const NurbsCurveData&, const NurbsCurveData&) = default;
};

/// @brief A (rational) B-spline surface: as the curve in u and in v.
struct NurbsSurfaceData {
  std::array<int, 2> degree{3, 3};
  std::array<std::vector<double>, 2> knots;
  std::array<std::size_t, 2> count{0, 0};  ///< of points along u and v
  std::vector<Point> points;               ///< place (i, j) at i * count[1] + j, i along u
  std::vector<double> weights;             ///< as points; empty: all 1

  friend bool operator==(const NurbsSurfaceData&, const NurbsSurfaceData&) = default;
};

/// @brief Knots from 0 to 1, clamped, evenly spaced between.
std::vector<double> even_knots(std::size_t points, int degree);

/// @throws InputError  degree, number of knots, points or weights, order of knots, weights <= 0, not finite
void check_nurbs(const NurbsCurveData& data);
void check_nurbs(const NurbsSurfaceData& data);

/// Evaluation allocates nothing. A curve is closed, a surface has a period, where ends and first derivatives there
/// agree; sides are degenerate whose control points are all the same.
/// @throws InputError  as check_nurbs
CurvePointer make_nurbs_curve(const NurbsCurveData& data);
ParameterCurvePointer make_nurbs_parameter_curve(const NurbsCurveData& data);
SurfacePointer make_nurbs_surface(const NurbsSurfaceData& data);

// Other data for the same curve or surface.

/// @brief One more knot at t, so many times, within the range.
/// @throws InputError  t outside of the range, or more often than the degree
NurbsCurveData insert_knot(const NurbsCurveData& data, double t, int times = 1);
/// @brief Degree raised by one: distinct knots within the range are there once more each. Clamped first.
NurbsCurveData raise_degree(const NurbsCurveData& data);
/// @brief The same of a surface; along 0: u, 1: v.
NurbsSurfaceData insert_knot(const NurbsSurfaceData& data, std::size_t along, double t, int times = 1);
NurbsSurfaceData raise_degree(const NurbsSurfaceData& data, std::size_t along);
/// @brief Ends degree + 1 times the same: beginning and ending in control points.
NurbsCurveData clamp_ends(const NurbsCurveData& data);

// Through points.

/// @brief A C2 cubic through points (of lower degree through fewer than four), parameters by chord length from 0 to 1.
/// @param is_closed  from the last point on to the first, smooth there too; the first is not given twice
/// @throws InputError  fewer than 2 points (closed: 3), two of the same one after the other
/// @par Source  de Boor (1978), XIII: without a knot at the second and the last but one point
NurbsCurveData interpolate_points(std::span<const Point> points, bool is_closed = false);

/// @brief A surface through section curves given by equally many points each; u runs along sections, v across them.
/// @param degree_across  at most that and one less than there are sections; 1: straight from section to section
/// @throws InputError  fewer than 2 sections, unequal counts, as interpolate_points
NurbsSurfaceData interpolate_sections(const std::vector<std::vector<Point>>& sections, bool is_closed = false,
                                      int degree_across = 3);

/// @brief The same through section curves that are splines: raised to one degree and refined to common knots first.
NurbsSurfaceData loft(std::vector<NurbsCurveData> sections, int degree_across = 3);

// Exactly round.

/// @brief A full circle in the frame's plane, t in [0, 1], from the frame's x axis.
NurbsCurveData nurbs_circle(const SpaceFrame& frame, double radius);
/// @brief An arc of it from one angle to another (radians, less than 2 pi further on).
NurbsCurveData nurbs_arc(const SpaceFrame& frame, double radius, double from, double to);
/// @brief A curve turned once round the frame's z axis: u the turn in [0, 1], v along the curve.
NurbsSurfaceData revolve(const NurbsCurveData& curve, const SpaceFrame& frame);
/// @brief As make_sphere_surface and its fellows, u and v in [0, 1].
NurbsSurfaceData nurbs_sphere(const SpaceFrame& frame, double radius);
NurbsSurfaceData nurbs_cylinder(const SpaceFrame& frame, double radius, double height);
NurbsSurfaceData nurbs_torus(const SpaceFrame& frame, double radius, double tube);

/// @brief The nearest place on a whole surface with a finite box: from a net of places, Newton's method from each that
/// is nearer than those round it.
class SurfaceSearch {
 public:
  /// @param samples  of the net, along u and v
  explicit SurfaceSearch(SurfacePointer surface, std::array<std::size_t, 2> samples = {33, 33});
  SurfaceSearch(SurfacePointer surface, const ParameterBox& box, std::array<std::size_t, 2> samples);

  struct Found {
    Point2 uv;
    Point at;
    double distance = 0;
  };
  Found closest(Point p) const;

 private:
  SurfacePointer surface_;
  ParameterBox box_;
  std::array<std::size_t, 2> samples_;
  std::vector<Point> net_;
};

/// @brief The same for a curve.
struct NearestOnCurve {
  double t = 0;
  Point at;
  double distance = 0;
};
NearestOnCurve closest_on_curve(const SmoothCurve& curve, std::array<double, 2> range, Point p,
                                std::size_t samples = 65);

}  // namespace delfront
