// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/point.hpp"

namespace delfront {

/// @brief What the Delaunay kernel did. The floor for random points in space, a point: 5.6 walk steps, 48 in-sphere
/// tests (four for each of 21 tets deleted, less those of faces between them), 28 tets created.
struct KernelCounts {
  std::uint64_t points = 0;
  std::uint64_t walk_steps = 0;
  std::uint64_t insphere_tests = 0;  ///< lanes of the filtered test: four a tet of the cavity
  std::uint64_t exact_tests = 0;     ///< of these, tests that the filter left to exact arithmetic
  std::uint64_t tets_deleted = 0;
  std::uint64_t tets_created = 0;
};

/// @brief A tetrahedrization of a point set: it fills the convex hull. Numbers are places in the given points.
struct Tetrahedrization {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<std::array<std::uint32_t, 4>> tets;        ///< (num_tets, 4) points, det[b - a, c - a, d - a] > 0
  std::vector<std::array<std::uint32_t, 4>> neighbours;  ///< neighbours[t][i] lies opposite tets[t][i]; kNone: hull
  std::vector<std::array<std::uint32_t, 3>> hull;        ///< triangles, their normals outwards
  /// (point, the one at the same place that is used), by point: the lowest; with weights the lowest of the heaviest.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  std::vector<std::uint32_t> hidden;  ///< with weights: points that are in no tet since heavier ones hide them, rising
  KernelCounts counts;
};

/// @brief Delaunay tetrahedrization of any set of points in space (T4). Exact: no point lies in a tet's sphere.
///
/// Cospherical points are decided by a symbolic perturbation that depends on coordinates alone, so that the set of tets
/// is the same for the points in any order.
/// @throws InputError  fewer than four points, all in one plane, a coordinate not finite or over 2^100
/// @throws LimitError  over 1.5e8 points: their tets (7 a point) would not fit 32-bit references; limits of the context
/// @par Threads  context.threads; the same result, bit for bit, for any number
/// @par Cost     O(n log n) for points in any order, about 2 microseconds a point on one core; sets that have a
///               quadratic number of tets (points on two skew lines) take as long
/// @par Source   Bowyer (1981), Watson (1981); ties: Devillers & Teillaud (2011)
Tetrahedrization delaunay(std::span<const Point> points, Context& context);

/// @brief Regular (power, weighted Delaunay) tetrahedrization: the lower hull of the points lifted to |p|^2 - weight.
///
/// A point is hidden where the sphere of every point around covers it so far that it lies above that hull; equal
/// weights give the Delaunay tetrahedrization. Exact, ties decided as in delaunay(): independent of the points' order.
/// @param weights  one a point, in square units: a sphere's squared radius, say; |weight| <= 2^200
/// @throws InputError  as delaunay(); not as many weights as points
/// @throws LimitError  as delaunay()
/// @par Threads  one
/// @par Cost     O(n log n), about 4 microseconds a point
/// @par Source   Edelsbrunner & Shah (1996), by cavities as Bowyer and Watson
Tetrahedrization regular(std::span<const Point> points, std::span<const double> weights, Context& context);

}  // namespace delfront
