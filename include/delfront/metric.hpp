// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <limits>

#include "delfront/point.hpp"

namespace delfront {

/// @brief A symmetric positive definite tensor M: an edge e of one wanted length has e . M e = 1.
///
/// In the plane zz is that of the size along x and y that is least; it is not used there.
struct Metric {
  double xx = 1, xy = 0, xz = 0, yy = 1, yz = 0, zz = 1;
  friend bool operator==(const Metric&, const Metric&) = default;
};

/// @brief Stretchings S1, S2 along orthonormal directions: wanted lengths are delta S1 along first, delta S2 along
/// second, delta along first x second.
struct Stretching {
  double s1 = 1, s2 = 1;  ///< > 0
  Point first{1, 0, 0}, second{0, 1, 0};
  friend bool operator==(const Stretching&, const Stretching&) = default;
};

/// @brief Eigenvalues, ascending, and a right-handed frame of eigenvectors.
struct MetricAxes {
  std::array<double, 3> value;
  std::array<Point, 3> direction;
};

/// @return delta^-2 times the identity
Metric isotropic_metric(double delta);
/// @return the sum of (delta S_i)^-2 s_i s_i^T
/// @throws UsageError  delta or a stretching not finite and positive, directions not orthonormal within 1e-6
/// @par Source  Löhner (2008), 3.2.1
Metric stretched_metric(double delta, const Stretching& stretching);

MetricAxes metric_axes(const Metric& metric);
Metric metric_from_axes(const MetricAxes& axes);

/// @brief The least and the greatest wanted length over all directions.
double least_size(const Metric& metric);
double greatest_size(const Metric& metric);

/// @return length of the edge in the metric: sqrt(e . M e)
double length_in(const Metric& metric, Point edge);

/// @brief The largest metric unit ball inside both: the smaller size in each direction of a common basis.
/// Commutative to rounding; the intersection of a metric with itself is that metric.
/// @par Source  Alauzet, Frey (2003), simultaneous reduction
Metric intersection(const Metric& a, const Metric& b);

/// @brief Wanted lengths clamped to [hmin, hmax] along the axes of the metric.
Metric clamped(const Metric& metric, double hmin, double hmax);

/// @brief exp(sum w_i log M_i): the mean that neither shrinks nor swells volumes.
/// @par Source  Arsigny et al. (2006), log-Euclidean mean
Metric log_of(const Metric& metric);
Metric exp_of(const Metric& log_metric);

}  // namespace delfront
