// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "delfront/point.hpp"

namespace delfront {

/// @brief A point with a weight: a sphere of squared radius `weight` around it, where that is positive.
struct WeightedPoint {
  Point at;
  double weight = 0;
};

/// @brief The power test, exactly: +1 where e, lifted to |e|^2 - weight, lies below the hyperplane through the lifted
/// corners of the positive tetrahedron (a, b, c, d), that is, where e's power distance to the sphere orthogonal to the
/// corners' spheres is below 0. 0 on it. With equal weights: insphere.
///
/// Coordinates must be finite and |x| <= 2^100, weights |w| <= 2^200; there is no smallest difference.
/// @par Source  Edelsbrunner & Shah (1996), "Incremental topological flipping works for regular triangulations"
int power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
               const WeightedPoint& e);

/// @brief As power_test, never 0 for a tetrahedron that is not flat: ties are decided as insphere_perturbed does.
///
/// The perturbation raises the lifted points (lowers the weights) by infinitesimals that only the order of the points'
/// coordinates tells apart. It is one perturbation of all points, so the tests are those of a regular triangulation in
/// general position; and of positions nothing is perturbed, so that orient3d stays what it is. Of points at one place
/// at most one may take part.
int power_test_perturbed(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                         const WeightedPoint& e);

namespace detail {

/// @brief The plain determinant with what its error bound needs; `lift` is the largest |p - e|^2 and the largest
/// |difference of weights| together.
struct PowerEvaluation {
  double det, x, y, z, lift;
};
PowerEvaluation evaluate_power(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c,
                               const WeightedPoint& d, const WeightedPoint& e);
int power_exact(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                const WeightedPoint& e);

/// Of the determinant, relative to x y z lift; derived in power.cpp.
inline constexpr double kPowerBound = 402 * 0x1p-53;

}  // namespace detail

}  // namespace delfront
