// SPDX-License-Identifier: Apache-2.0
// Each sensor gives a metric on the nodes; they are intersected, scaled as a whole so that with the limits of size and
// aspect in force the complexity is the wanted one, and graded along the edges.
#include "delfront/solution_metric.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "delfront/errors.hpp"
#include "sizing/background_growth.hpp"
#include "sizing/background_values.hpp"
#include "sizing/simplex_grid.hpp"
#include "sizing/solution_derivatives.hpp"

namespace delfront {

namespace {

constexpr double kLeastCurvature = 1e-12;  // of the largest: a Hessian's eigenvalues are taken no smaller
constexpr double kNoCurvature = 1e-10;     // of a sensor's range: change over the grid by second derivatives
constexpr int kBisections = 200;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What all steps need.
struct Problem {
  const Mesh& mesh;
  const std::string& name;
  const SolutionOptions& options;
  SimplexGrid grid;
  std::vector<char> used;
  std::vector<double> volume;
};

void check_options(const SolutionOptions& o) {
  if (o.sensors.empty())
    throw UsageError("sizes from a solution: no sensor; name node fields, e.g. sensor = [\"Mach\"]");
  if (!(o.norm >= 1)) throw UsageError(fmt::format("norm is {}; it must be at least 1 (infinity too)", o.norm));
  if (!(o.complexity >= 0 && std::isfinite(o.complexity)) || (o.indicator == Indicator::hessian && o.complexity == 0))
    throw UsageError(
        fmt::format("complexity is {}; it must be a positive number, about an eighth of the wanted number of "
                    "tetrahedra or, in the plane, 0.4 of that of triangles",
                    o.complexity));
  if (!(o.hmin >= 0 && o.hmax > 0 && o.hmin <= o.hmax))
    throw UsageError(fmt::format("hmin = {} and hmax = {}: need 0 <= hmin <= hmax and hmax > 0", o.hmin, o.hmax));
  if (!(o.max_aspect >= 1)) throw UsageError(fmt::format("max_aspect is {}; it must be at least 1", o.max_aspect));
  if (!(o.hgrad > 1)) throw UsageError(fmt::format("hgrad is {}; it must be greater than 1, e.g. 1.5", o.hgrad));
  if (!(o.wanted_error > 0)) throw UsageError(fmt::format("wanted_error is {}; it must be positive", o.wanted_error));
  if (!(o.noise > 0)) throw UsageError(fmt::format("noise is {}; it must be positive, e.g. 0.2", o.noise));
  if (!(o.max_refinement >= 1 && o.max_coarsening >= 1))
    throw UsageError(fmt::format("max_refinement = {} and max_coarsening = {}: both must be at least 1",
                                 o.max_refinement, o.max_coarsening));
}

/// A field's values, lengths, or one component, by "name" or "name:k".
std::vector<double> sensor_values(const Problem& problem, const std::string& sensor) {
  std::string name = sensor;
  int component = -1;
  const std::size_t colon = sensor.rfind(':');
  if (colon != std::string::npos) {
    const char *begin = sensor.data() + colon + 1, *end = sensor.data() + sensor.size();
    const auto [stop, error] = std::from_chars(begin, end, component);
    if (error == std::errc() && stop == end && component >= 0)
      name = sensor.substr(0, colon);
    else
      component = -1;
  }
  const Field& field = find_node_field(problem.mesh, problem.name, name, "sensor");
  if (component >= field.components)
    throw UsageError(fmt::format("{}: the field '{}' has {} components, counted from 0; there is no {}", problem.name,
                                 name, field.components, component));
  const auto n = static_cast<std::size_t>(field.components);
  if (field.values.size() != n * problem.grid.points.size())
    throw InputError(fmt::format("{}: the field '{}' has {} numbers for {} nodes of {} components", problem.name, name,
                                 field.values.size(), problem.grid.points.size(), n));
  std::vector<double> values;
  for (std::size_t node = 0; node < problem.grid.points.size(); ++node) {
    const double* v = field.values.data() + node * n;
    double value = component >= 0 ? v[component] : v[0];
    if (component < 0 && n > 1) {
      value = 0;
      for (std::size_t k = 0; k < n; ++k) value = std::hypot(value, v[k]);
    }
    const Point p = problem.grid.points[node];
    if (problem.used[node] && !std::isfinite(value))
      throw InputError(
          fmt::format("{}: node {} at ({:g}, {:g}, {:g}): the field '{}' has the value {}; a sensor must be "
                      "finite",
                      problem.name, node, p.x, p.y, p.z, name, value),
          {{p, {static_cast<std::uint32_t>(node)}}});
    values.push_back(problem.used[node] ? value : 0);
  }
  return values;
}

double determinant(const Metric& m, int dimension) {
  if (dimension == 2) return m.xx * m.yy - m.xy * m.xy;
  const Principal axes = principal_axes(m, 3);
  return axes.value[0] * axes.value[1] * axes.value[2];
}

Metric scaled(const Metric& m, double w) { return {w * m.xx, w * m.xy, w * m.xz, w * m.yy, w * m.yz, w * m.zz}; }

/// det(|H|)^(-1/(2p+d)) |H|, in units in which the largest eigenvalue of all is 1.
std::vector<Metric> hessian_metric(const Problem& problem, const std::string& sensor, Context& context) {
  const std::vector<double> values = sensor_values(problem, sensor);
  const NodeDerivatives derivatives = recover_derivatives(problem.grid, values, problem.options.recovery, context);
  const int d = problem.grid.dimension;
  std::vector<Principal> axes(values.size());
  double most = 0, low = kInfinity, high = -kInfinity;
  Box box;
  for (std::size_t node = 0; node < values.size(); ++node) {
    if (!problem.used[node]) continue;
    axes[node] = principal_axes(derivatives.hessian[node], d);
    for (double value : axes[node].value) most = std::max(most, std::abs(value));
    low = std::min(low, values[node]);
    high = std::max(high, values[node]);
    box.add(problem.grid.points[node]);
  }
  const double l = box.diagonal();
  if (!(most * l * l > kNoCurvature * std::max({high - low, std::abs(low), std::abs(high)})))
    throw InputError(
        fmt::format("{}: the sensor '{}' is constant or linear over the grid (values {:g} to {:g}): it has "
                    "no curvature that sizes could follow; take another field",
                    problem.name, sensor, low, high));
  const double p = problem.options.norm;
  const double power = std::isfinite(p) ? -1 / (2 * p + d) : 0;
  std::vector<Metric> metric(values.size());
  for (std::size_t node = 0; node < values.size(); ++node) {
    if (!problem.used[node]) continue;
    double det = 1, greatest = 0;
    for (double value : axes[node].value) greatest = std::max(greatest, std::abs(value));
    for (std::size_t k = 0; k < static_cast<std::size_t>(d); ++k) {
      double& value = axes[node].value[k];
      value = std::max((problem.options.is_stretched ? std::abs(value) : greatest) / most, kLeastCurvature);
      det *= value;
    }
    for (double& value : axes[node].value) value *= std::pow(det, power);
    metric[node] = tensor_of(axes[node], d);
  }
  return metric;
}

// ---- error indicator ------------------------------------------------------------------------------------------------

/// What the change of size by a factor 1 / xi must be so that the indicator s / (a + n), whose parts go with the
/// second, first and zeroth power of the size, becomes `wanted`: s / xi^2 = wanted (a / xi + n).
double refinement(double s, double a, double n, double wanted) {
  const double b = wanted * a, c = wanted * n;
  if (!(c > 0)) return b > 0 ? s / b : 1;
  return s > 0 ? 2 * s / (b + std::sqrt(b * b + 4 * c * s)) : 0;
}

/// The parts below the line of Löhner's indicator at a node, with lengths in place of sums over coordinates.
struct Parts {
  double a = 0, n = 0;
};

class ErrorIndicator {
 public:
  ErrorIndicator(const Problem& problem, std::vector<double> values)
      : problem_(problem),
        grid_(problem.grid),
        values_(std::move(values)),
        cells_(vertex_to_cells(grid_)),
        neighbours_(grid_) {}

  Metric metric_at(std::uint32_t node) const {
    const SolutionOptions& o = problem_.options;
    const int d = grid_.dimension;
    Metric second{0, 0, 0, 0, 0, 0};
    for (std::uint32_t cell : cells_[node]) add_second(node, cell, second);
    Principal axes = principal_axes(second, d);
    const auto limited = [&](double xi) { return std::clamp(xi, 1 / o.max_coarsening, o.max_refinement); };
    if (!o.is_stretched) {
      double s = 0;
      for (double value : axes.value) s = std::hypot(s, value);
      const Parts parts = sum_parts(node, nullptr);
      const double h = old_size(node, nullptr) / limited(refinement(s, parts.a, parts.n, o.wanted_error));
      return isotropic_metric(h);
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(d); ++k) {
      const Parts parts = sum_parts(node, &axes.direction[k]);
      const double xi = limited(refinement(std::abs(axes.value[k]), parts.a, parts.n, o.wanted_error));
      const double h = old_size(node, &axes.direction[k]) / xi;
      axes.value[k] = 1 / (h * h);
    }
    return tensor_of(axes, d);
  }

 private:
  Point rise(std::uint32_t cell, const std::array<Point, 4>& g) const {
    const std::span<const std::uint32_t> v = grid_.corners(cell);
    Point sum;
    for (std::size_t k = 1; k < v.size(); ++k) sum = sum + (values_[v[k]] - values_[v[0]]) * g[k];
    return sum;
  }
  Point own_gradient(std::uint32_t node, std::uint32_t cell, const std::array<Point, 4>& g) const {
    const std::span<const std::uint32_t> v = grid_.corners(cell);
    return g[static_cast<std::size_t>(std::find(v.begin(), v.end(), node) - v.begin())];
  }

  void add_second(std::uint32_t node, std::uint32_t cell, Metric& m) const {
    const std::array<Point, 4> g = grid_.gradients(cell);
    const Point own = own_gradient(node, cell, g), u = rise(cell, g);
    const double w = grid_.measure(cell);
    m = {m.xx + w * own.x * u.x,
         m.xy + 0.5 * w * (own.x * u.y + own.y * u.x),
         m.xz + 0.5 * w * (own.x * u.z + own.z * u.x),
         m.yy + w * own.y * u.y,
         m.yz + 0.5 * w * (own.y * u.z + own.z * u.y),
         m.zz + w * own.z * u.z};
  }

  Parts sum_parts(std::uint32_t node, const Point* along) const {
    const auto size_of = [&](Point p) { return along ? std::abs(dot(p, *along)) : length(p); };
    Parts parts;
    for (std::uint32_t cell : cells_[node]) {
      const std::array<Point, 4> g = grid_.gradients(cell);
      const double w = grid_.measure(cell) * size_of(own_gradient(node, cell, g));
      parts.a += w * size_of(rise(cell, g));
      const std::span<const std::uint32_t> v = grid_.corners(cell);
      for (std::size_t k = 0; k < v.size(); ++k)
        parts.n += problem_.options.noise * w * size_of(g[k]) * std::abs(values_[v[k]]);
    }
    return parts;
  }

  /// Mean length of the node's edges; along a direction, scaled so that edges of all directions alike give the same.
  double old_size(std::uint32_t node, const Point* along) const {
    const double mean_cosine = grid_.dimension == 2 ? 0.63661977236758134 : 0.5;  // 2 / pi in the plane
    double sum = 0;
    for (std::uint32_t other : neighbours_[node]) {
      const Point edge = grid_.points[other] - grid_.points[node];
      sum += along ? std::abs(dot(edge, *along)) / mean_cosine : length(edge);
    }
    return sum / static_cast<double>(neighbours_[node].size());
  }

  const Problem& problem_;
  const SimplexGrid& grid_;
  std::vector<double> values_;
  VertexCells cells_;
  VertexNeighbours neighbours_;
};

std::vector<Metric> error_metric(const Problem& problem, const std::string& sensor) {
  const ErrorIndicator indicator(problem, sensor_values(problem, sensor));
  std::vector<Metric> metric(problem.grid.points.size());
  for (std::uint32_t node = 0; node < metric.size(); ++node)
    if (problem.used[node]) metric[node] = indicator.metric_at(node);
  return metric;
}

// ---- putting together -----------------------------------------------------------------------------------------------

double complexity_of(const Problem& problem, const std::vector<Metric>& metric) {
  double sum = 0;
  for (std::size_t node = 0; node < metric.size(); ++node)
    if (problem.used[node])
      sum += problem.volume[node] * std::sqrt(std::max(0.0, determinant(metric[node], problem.grid.dimension)));
  return sum;
}

/// Eigenvalues times `weight`, then the limits.
void limit(Principal& axes, double weight, const SolutionOptions& o, int dimension) {
  double most = 0;
  const double upper = o.hmin > 0 ? 1 / (o.hmin * o.hmin) : kInfinity, lower = 1 / (o.hmax * o.hmax);
  const auto values = std::span(axes.value).first(static_cast<std::size_t>(dimension));
  for (double& value : values) {
    value = std::clamp(weight * value, lower, upper);
    most = std::max(most, value);
  }
  for (double& value : values) value = std::max(value, most / (o.max_aspect * o.max_aspect));
}

/// Scales by one factor so that the complexity, with the limits, is the wanted one.
std::vector<Metric> scale_to_complexity(const Problem& problem, const std::vector<Metric>& metric) {
  const SolutionOptions& o = problem.options;
  const int d = problem.grid.dimension;
  std::vector<Principal> axes(metric.size());
  for (std::size_t node = 0; node < metric.size(); ++node)
    if (problem.used[node]) axes[node] = principal_axes(metric[node], d);
  const auto complexity = [&](double weight) {
    double sum = 0;
    for (std::size_t node = 0; node < metric.size(); ++node) {
      if (!problem.used[node]) continue;
      Principal some = axes[node];
      limit(some, weight, o, d);
      double det = 1;
      for (std::size_t k = 0; k < static_cast<std::size_t>(d); ++k) det *= some.value[k];
      sum += problem.volume[node] * std::sqrt(det);
    }
    return sum;
  };
  double weight = 1;
  if (o.complexity > 0) {
    double low = 1, high = 1;
    const auto has_reached = [&](double w) { return complexity(w) >= o.complexity; };
    while (has_reached(low) && low > 1e-200) low /= 16;
    while (!has_reached(high) && high < 1e200) high *= 16;
    const double least = complexity(low), most = complexity(high);
    if (!(least <= o.complexity && o.complexity <= most))
      throw UsageError(
          fmt::format("complexity {:g} is out of reach with hmin = {:g} and hmax = {:g}: they allow {:g} to "
                      "{:g}",
                      o.complexity, o.hmin, o.hmax, least, most));
    for (int i = 0; i < kBisections && high / low > 1 + 1e-15; ++i) {
      const double middle = std::sqrt(low) * std::sqrt(high);
      (has_reached(middle) ? high : low) = middle;
    }
    weight = high;
  }
  std::vector<Metric> result(metric.size());
  for (std::size_t node = 0; node < metric.size(); ++node) {
    if (!problem.used[node]) continue;
    limit(axes[node], weight, o, d);
    result[node] = tensor_of(axes[node], d);
  }
  return result;
}

}  // namespace

NodeDerivatives recover_derivatives(const Mesh& mesh, const std::vector<double>& values, Recovery recovery,
                                    Context& context) {
  const SimplexGrid grid = build_simplex_grid(mesh, "grid of the solution", context);
  if (values.size() != grid.points.size())
    throw InputError(fmt::format("{} values for {} points", values.size(), grid.points.size()));
  const std::vector<char> used = used_vertices(grid);
  for (std::size_t node = 0; node < values.size(); ++node)
    if (used[node] && !std::isfinite(values[node]))
      throw InputError(fmt::format("the value {} of node {} is not finite", values[node], node));
  return recover_derivatives(grid, values, recovery, context);
}

double complexity_of(const Mesh& mesh, const std::vector<Metric>& metric, Context& context) {
  const std::string name = "grid of the solution";
  const SolutionOptions options;
  Problem problem{mesh, name, options, build_simplex_grid(mesh, name, context), {}, {}};
  problem.used = used_vertices(problem.grid);
  problem.volume = lumped_volumes(problem.grid);
  return complexity_of(problem, metric);
}

SolutionMetric build_solution_metric(const Mesh& mesh, const std::string& name, const SolutionOptions& options,
                                     Context& context) {
  check_options(options);
  Problem problem{mesh, name, options, build_simplex_grid(mesh, name, context), {}, {}};
  problem.used = used_vertices(problem.grid);
  problem.volume = lumped_volumes(problem.grid);
  std::vector<Metric> metric;
  for (const std::string& sensor : options.sensors) {
    context.check_limits();
    std::vector<Metric> some = options.indicator == Indicator::hessian ? hessian_metric(problem, sensor, context)
                                                                       : error_metric(problem, sensor);
    if (options.indicator == Indicator::hessian) {  // each with the same complexity, so that units do not matter
      const double unit = std::pow(complexity_of(problem, some), -2.0 / problem.grid.dimension);
      for (Metric& m : some) m = scaled(m, unit);
    }
    if (metric.empty()) {
      metric = std::move(some);
      continue;
    }
    for (std::size_t node = 0; node < metric.size(); ++node)
      if (problem.used[node]) metric[node] = intersection(metric[node], some[node]);
  }
  SolutionMetric result;
  result.metric = scale_to_complexity(problem, metric);
  result.complexity = complexity_of(problem, result.metric);
  if (std::isfinite(options.hgrad)) limit_metric_growth(problem.grid, slope_of(options.hgrad), result.metric, context);
  result.graded_complexity = complexity_of(problem, result.metric);
  return result;
}

BackgroundGrid background_from_solution(Mesh mesh, const std::string& name, const SolutionOptions& options,
                                        Context& context) {
  const SolutionMetric made = build_solution_metric(mesh, name, options, context);
  BackgroundGrid grid;
  grid.name = name;
  std::string& of_grid = options.is_stretched ? grid.metric : grid.size;
  of_grid = options.is_stretched ? "metric" : "size";
  Field field{of_grid, Field::On::vertices, CellType::vertex, options.is_stretched ? 6 : 1, {}};
  for (const Metric& m : made.metric)
    if (options.is_stretched)
      field.values.insert(field.values.end(), {m.xx, m.yy, m.zz, m.xy, m.yz, m.xz});
    else
      field.values.push_back(least_size(m));
  std::erase_if(mesh.fields, [&](const Field& f) { return f.name == of_grid && f.on == Field::On::vertices; });
  mesh.fields.push_back(std::move(field));
  grid.mesh = std::move(mesh);
  return grid;
}

}  // namespace delfront
