// SPDX-License-Identifier: Apache-2.0
#include "delfront/solution_metric.hpp"

#include <gtest/gtest.h>

#include "background_grids.hpp"
#include "delfront/errors.hpp"
#include "support/errors.hpp"

namespace delfront {
namespace {

using namespace fixtures;

template <class Error>
std::string message_of_building(const Mesh& mesh, const SolutionOptions& options) {
  Context context;
  return message_of<Error>([&] { build_solution_metric(mesh, "flow.vtu", options, context); });
}

double largest_difference(const Metric& a, const Metric& b) {
  return std::max({std::abs(a.xx - b.xx), std::abs(a.xy - b.xy), std::abs(a.xz - b.xz), std::abs(a.yy - b.yy),
                   std::abs(a.yz - b.yz), std::abs(a.zz - b.zz)});
}

const Metric kHessian{2, -1, 0.5, 3, 0.25, -4};
double quadratic(Point p) {
  const Metric& h = kHessian;
  return 1 + 2 * p.x - p.y + 0.5 * p.z + 0.5 * (h.xx * p.x * p.x + h.yy * p.y * p.y + h.zz * p.z * p.z) +
         h.xy * p.x * p.y + h.xz * p.x * p.z + h.yz * p.y * p.z;
}
Point gradient_of_quadratic(Point p) {
  const Metric& h = kHessian;
  return {2 + h.xx * p.x + h.xy * p.y + h.xz * p.z, -1 + h.xy * p.x + h.yy * p.y + h.yz * p.z,
          0.5 + h.xz * p.x + h.yz * p.y + h.zz * p.z};
}

std::vector<double> values_of(const Mesh& mesh, const std::function<double(Point)>& u) {
  std::vector<double> values;
  for (const Point& p : mesh.points) values.push_back(u(p));
  return values;
}

TEST(SolutionMetric, S12_fit_is_exact_for_quadratics_also_on_the_boundary) {
  Context context;
  Mesh stretched = kuhn_box(5, 0.2);
  for (Point& p : stretched.points) p.z *= 1e-3;
  for (const Mesh& mesh : {kuhn_box(5, 0.2), stretched}) {
    const NodeDerivatives got = recover_derivatives(mesh, values_of(mesh, quadratic), Recovery::fit, context);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      const double unit = mesh.points.back().z;  // rounding grows with the stretching squared
      ASSERT_LT(largest_difference(got.hessian[i], kHessian), 1e-10 / (unit * unit));
      ASSERT_LT(distance(got.gradient[i], gradient_of_quadratic(mesh.points[VertexId(i)])), 1e-10 / unit);
    }
  }
}

TEST(SolutionMetric, S12_fit_is_exact_in_the_plane) {
  Context context;
  const Mesh mesh = square_grid(6, 0.25);
  const NodeDerivatives got = recover_derivatives(mesh, values_of(mesh, quadratic), Recovery::fit, context);
  for (const Metric& h : got.hessian)
    ASSERT_LT(largest_difference(h, {kHessian.xx, kHessian.xy, 0, kHessian.yy, 0, 0}), 1e-10);
}

TEST(SolutionMetric, S12_projection_is_exact_for_quadratics_inside_regular_grids) {
  Context context;
  const Mesh mesh = kuhn_box(6);
  const NodeDerivatives got = recover_derivatives(mesh, values_of(mesh, quadratic), Recovery::projection, context);
  int tested = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Point p = mesh.points[VertexId(i)];
    if (std::min({p.x, p.y, p.z}) < 0.3 || std::max({p.x, p.y, p.z}) > 0.7) continue;
    ASSERT_LT(largest_difference(got.hessian[i], kHessian), 1e-10);
    ++tested;
  }
  EXPECT_EQ(tested, 27);
}

double bump(Point p) { return std::exp(-10 * squared_length(p - Point{0.4, 0.5, 0.6})) + 0.1 * p.x; }

TEST(SolutionMetric, S12_complexity_is_the_wanted_one) {
  Context context;
  for (Mesh mesh : {kuhn_box(8, 0.2), square_grid(12, 0.2)}) {
    add_node_field(mesh, "u", bump);
    add_node_field(mesh, "v", [](Point p) { return std::sin(5 * p.y); });
    for (const double norm : {1.0, 2.0, 4.0, std::numeric_limits<double>::infinity()}) {
      for (const std::vector<std::string>& sensors : {std::vector<std::string>{"u"}, {"u", "v"}}) {
        SolutionOptions options{.sensors = sensors};
        options.norm = norm;
        options.complexity = 5000;
        for (const double hmax : {0.3, 1e300}) {
          options.hmax = hmax;
          options.hmin = hmax < 1 ? 0.005 : 0;
          const SolutionMetric got = build_solution_metric(mesh, "flow", options, context);
          EXPECT_NEAR(got.complexity / 5000, 1, 1e-9);
          EXPECT_NEAR(complexity_of(mesh, got.metric, context) / 5000, 1, 1e-9);
          EXPECT_EQ(got.complexity, got.graded_complexity);
          for (const Metric& m : got.metric) {
            ASSERT_GE(least_size(m), options.hmin * (1 - 1e-9));
            ASSERT_LE(greatest_size(m), options.hmax * (1 + 1e-9));
          }
        }
      }
    }
  }
}

TEST(SolutionMetric, S12_norm_infinity_is_the_hessian_itself) {
  // u = x^2 + 4 y^2 + 16 z^2 has |H| = diag(2, 8, 32): sizes in proportion 1, 1/2, 1/4 of which the product is fixed.
  Context context;
  Mesh mesh = kuhn_box(5, 0.2);
  add_node_field(mesh, "u", [](Point p) { return p.x * p.x + 4 * p.y * p.y - 16 * p.z * p.z; });
  for (const double norm : {2.0, std::numeric_limits<double>::infinity()}) {
    SolutionOptions options{.sensors = {"u"}};
    options.norm = norm;
    options.complexity = 1000;
    const SolutionMetric got = build_solution_metric(mesh, "flow", options, context);
    // 1000 = 1 / (h h/2 h/4): h = (8 / 1000)^(1/3) = 0.2
    for (const Metric& m : got.metric) {
      ASSERT_NEAR(m.xx, 25, 1e-7);
      ASSERT_NEAR(m.yy, 100, 1e-7);
      ASSERT_NEAR(m.zz, 400, 1e-7);
    }
  }
}

TEST(SolutionMetric, S12_a_steep_profile_is_stretched_along_its_front) {
  Context context;
  const double angle = 0.4;
  const Point across{std::cos(angle), std::sin(angle), 0}, along{-across.y, across.x, 0};
  Mesh mesh = square_grid(60, 0.1);
  add_node_field(mesh, "u", [&](Point p) { return std::tanh(20 * dot(p - Point{0.5, 0.5, 0}, across)); });
  for (const Indicator indicator : {Indicator::hessian, Indicator::error}) {
    SolutionOptions options{.sensors = {"u"}};
    options.indicator = indicator;
    options.complexity = indicator == Indicator::hessian ? 2000 : 0;
    options.max_aspect = 20;
    options.hmax = 0.5;
    options.wanted_error = 0.05;
    const SolutionMetric got = build_solution_metric(mesh, "flow", options, context);
    int tested = 0;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      const Point p = mesh.points[VertexId(i)];
      const double at = dot(p - Point{0.5, 0.5, 0}, across);
      if (std::min({p.x, p.y, 1 - p.x, 1 - p.y}) < 0.1 || std::abs(std::abs(at) - 0.033) > 0.01) continue;
      ++tested;
      const Metric& m = got.metric[i];
      const double h_across = 1 / length_in(m, across), h_along = 1 / length_in(m, along);
      // The metric's least direction is across the front to within a few degrees.
      ASSERT_LT(h_across, 1.1 * 1 / std::sqrt(m.zz)) << "indicator " << int(indicator);
      ASSERT_GT(h_along / h_across, indicator == Indicator::hessian ? 3 : 1.5);
      ASSERT_LE(greatest_size(m) / least_size(m), 20 * (1 + 1e-9));
    }
    EXPECT_GT(tested, 100);
  }
}

TEST(SolutionMetric, S12_units_turns_and_scales_do_not_matter) {
  Context context;
  Mesh mesh = kuhn_box(5, 0.2);
  add_node_field(mesh, "u", bump);
  const double a = 0.8;
  const auto turn = [&](Point p) {
    return Point{std::cos(a) * p.x - std::sin(a) * p.z, p.y, std::sin(a) * p.x + std::cos(a) * p.z};
  };
  for (const Indicator indicator : {Indicator::hessian, Indicator::error}) {
    SolutionOptions options{.sensors = {"u"}};
    options.indicator = indicator;
    options.complexity = indicator == Indicator::hessian ? 500 : 0;
    options.max_aspect = 1e3;
    const SolutionMetric plain = build_solution_metric(mesh, "flow", options, context);
    for (const double s : {1e-6, 1.0, 1e6}) {
      Mesh other = mesh;
      for (Point& p : other.points) p = s * turn(p);
      for (double& u : other.fields[0].values) u = -1e3 * u;
      const SolutionMetric got = build_solution_metric(other, "flow", options, context);
      for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const double least = 1 / least_size(plain.metric[i]);
        for (const Point d : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}, Point{0.6, 0, 0.8}})
          ASSERT_NEAR(length_in(got.metric[i], s * turn(d)), length_in(plain.metric[i], d), 1e-6 * least);
      }
    }
  }
}

TEST(SolutionMetric, S12_error_indicator_limits_its_steps) {
  // Kinked at x = 0.5, flat elsewhere: the kink is refined by the most there is, the rest coarsened by the most.
  Context context;
  Mesh mesh = square_grid(20);
  add_node_field(mesh, "u", [](Point p) { return 10 + std::abs(p.x - 0.5); });
  SolutionOptions options{.sensors = {"u"}};
  options.indicator = Indicator::error;
  options.is_stretched = false;
  options.noise = 1e-4;
  const SolutionMetric got = build_solution_metric(mesh, "flow", options, context);
  double size = 0;  // of a regular inner node: four edges of 0.05, two diagonals
  size = (4 * 0.05 + 2 * 0.05 * std::sqrt(2.0)) / 6;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Point p = mesh.points[VertexId(i)];
    if (std::min({p.x, p.y, 1 - p.x, 1 - p.y}) < 0.04) continue;
    const double h = least_size(got.metric[i]);
    if (std::abs(p.x - 0.5) > 0.04)
      ASSERT_NEAR(h, 2 * size, 1e-9);
    else
      ASSERT_NEAR(h, size / 4, 1e-9);
  }
}

TEST(SolutionMetric, S12_gradation_holds_and_the_field_can_be_asked) {
  Context context;
  Mesh mesh = square_grid(20, 0.1);
  add_node_field(mesh, "u", [](Point p) { return std::tanh(30 * (p.x - 0.5)); });
  SolutionOptions options{.sensors = {"u"}};
  options.complexity = 1000;
  options.hgrad = 1.3;
  const SolutionMetric got = build_solution_metric(mesh, "flow", options, context);
  EXPECT_GT(got.graded_complexity, got.complexity);
  const CellBlock& cells = mesh.blocks[0];
  for (std::size_t cell = 0; cell < cells.size(); ++cell)
    for (VertexId a : cells[cell])
      for (VertexId b : cells[cell]) {
        const double l = distance(mesh.points[a], mesh.points[b]), k = 0.3 / 1.3;
        ASSERT_LE(least_size(got.metric[b.index()]), (least_size(got.metric[a.index()]) + k * l) * (1 + 1e-5));
      }
  const BackgroundGrid grid = background_from_solution(mesh, "flow", options, context);
  const auto field = build_background_size_field(grid, {}, context);
  EXPECT_FALSE(field->is_isotropic());
  const std::size_t node = 200;
  EXPECT_NEAR(field->size(mesh.points[VertexId(node)]), least_size(got.metric[node]), 1e-9);
}

TEST(SolutionMetric, S12_vectors_and_their_components) {
  Context context;
  Mesh mesh = square_grid(10, 0.1);
  const auto wave = [](Point p) { return std::sin(4 * p.x) + 2; };
  add_node_field(mesh, "u", wave);
  add_node_field(mesh, "V", [&](Point p) { return std::array{0.0, wave(p), 0.0}; });
  SolutionOptions options{.sensors = {"u"}};
  options.complexity = 500;
  const SolutionMetric plain = build_solution_metric(mesh, "flow", options, context);
  for (const std::string sensor : {"V", "V:1"}) {
    options.sensors = {sensor};
    EXPECT_EQ(build_solution_metric(mesh, "flow", options, context).metric, plain.metric) << sensor;
  }
}

TEST(SolutionMetric, S12_bad_input_is_named) {
  Mesh mesh = square_grid(5, 0.1);
  add_node_field(mesh, "Mach", bump);
  add_node_field(mesh, "flat", [](Point p) { return 1 + p.x - 2 * p.y; });
  SolutionOptions good{.sensors = {"Mach"}};
  good.complexity = 100;
  SolutionOptions options = good;
  options.sensors = {"mash"};
  expect_mentions(message_of_building<UsageError>(mesh, options), {"flow.vtu", "'mash'", "did you mean 'Mach'"});
  options.sensors = {};
  expect_mentions(message_of_building<UsageError>(mesh, options), {"no sensor"});
  options.sensors = {"Mach:2"};
  expect_mentions(message_of_building<UsageError>(mesh, options), {"1 components", "no 2"});
  options.sensors = {"flat"};
  expect_mentions(message_of_building<InputError>(mesh, options), {"'flat'", "linear"});
  options = good;
  options.complexity = 0;
  expect_mentions(message_of_building<UsageError>(mesh, options), {"complexity is 0"});
  options = good;
  options.norm = 0.5;
  expect_mentions(message_of_building<UsageError>(mesh, options), {"norm is 0.5"});
  options = good;
  options.hmin = 0.2;
  expect_mentions(message_of_building<UsageError>(mesh, options), {"complexity 100 is out of reach", "hmin = 0.2"});
  Mesh broken = mesh;
  broken.fields[0].values[7] = std::nan("");
  expect_mentions(message_of_building<InputError>(broken, good), {"node 7", "'Mach'", "finite"});
}

}  // namespace
}  // namespace delfront
