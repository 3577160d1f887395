// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <string>
#include <vector>

#include "delfront/background.hpp"
#include "delfront/context.hpp"
#include "delfront/mesh.hpp"
#include "delfront/metric.hpp"

namespace delfront {

/// @brief How derivatives are made from values on nodes.
enum class Recovery : std::uint8_t {
  /// Gradients of the cells averaged by volume, then the same of those: smooths; of first order on the boundary.
  projection,
  /// A quadratic by least squares through the neighbours of a node (their neighbours too where they are too few): exact
  /// for quadratics.
  fit,
};

/// @brief First and second derivatives on the nodes; `hessian` is any symmetric tensor. Zero at nodes without cells.
struct NodeDerivatives {
  std::vector<Point> gradient;
  std::vector<Metric> hessian;
};

/// @param values  one a point of the mesh, finite where a cell uses the point
/// @throws InputError  a value that is not finite, a grid that does not fill space, too few nodes to fit a quadratic
/// @par Source  projection: Alauzet, Loseille (2009), 3.2; fit: Zhang, Naga (2005), polynomial recovery
NodeDerivatives recover_derivatives(const Mesh& mesh, const std::vector<double>& values, Recovery recovery,
                                    Context& context);

enum class Indicator : std::uint8_t {
  hessian,  ///< equal interpolation error in a norm, for a wanted complexity
  error,    ///< Löhner's dimensionless indicator: a wanted error, limits on the change in one step
};

/// @brief How a grid with a solution asks for the next one (S12).
struct SolutionOptions {
  /// Node fields; of several components the length is taken, or with ":k" behind the name component k, from 0.
  std::vector<std::string> sensors;
  Indicator indicator = Indicator::hessian;
  Recovery recovery = Recovery::fit;

  double norm = 2;        ///< p of L^p, 1 … infinity
  double complexity = 0;  ///< wanted integral of sqrt(det M); needed for `hessian`, 0 leaves sizes of `error` alone

  double wanted_error = 0.1;  ///< `error`: of the indicator, which lies between 0 and 1
  double noise = 0.2;         ///< `error`: filter c_n; more of it ignores smaller ripples
  double max_refinement = 4;  ///< `error`: no size falls by more than this factor in one step
  double max_coarsening = 2;  ///< `error`: nor rises

  bool is_stretched = true;  ///< sizes of their own along the principal directions; else one size, by the worst of them

  double hmin = 0, hmax = std::numeric_limits<double>::infinity();
  double max_aspect = 1000;                                ///< of the sizes at one place
  double hgrad = std::numeric_limits<double>::infinity();  ///< growth along edges, as BackgroundOptions::growth
};

/// @brief Metrics on the nodes of the grid.
///
/// A grid of regular cells of that metric has 6 sqrt(2) = 8.5 tetrahedra and about 1.5 vertices a unit of complexity,
/// in the plane 4/sqrt(3) = 2.3 triangles and 1.2 vertices; real grids have up to a half more.
struct SolutionMetric {
  std::vector<Metric> metric;    ///< one a point; of no meaning where no cell uses the point
  double complexity = 0;         ///< before the gradation: the wanted one
  double graded_complexity = 0;  ///< after it
};

/// @throws InputError, UsageError  no such sensor (which there are), values not finite (node and place), a sensor
/// without
///                                 curvature, options out of range, a complexity that the limits do not allow
/// @par Cost    O(n log n)
/// @par Source  Alauzet, Loseille (2009), multi-scale metrics; Löhner (2008), chapter 14
SolutionMetric build_solution_metric(const Mesh& mesh, const std::string& name, const SolutionOptions& options,
                                     Context& context);

/// @brief The same as a background grid: the mesh with the metrics as its node field "metric" (6 components), or,
/// where they are not stretched, with the sizes as its node field "size".
BackgroundGrid background_from_solution(Mesh mesh, const std::string& name, const SolutionOptions& options,
                                        Context& context);

/// @return the sum over nodes of sqrt(det M) times the node's share of volume (area)
double complexity_of(const Mesh& mesh, const std::vector<Metric>& metric, Context& context);

}  // namespace delfront
