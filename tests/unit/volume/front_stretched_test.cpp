// SPDX-License-Identifier: Apache-2.0
// The pure front where sizes have directions: lengths of edges in the metric, and the same whole grids as ever.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <set>

#include "delfront/grid_check.hpp"
#include "delfront/size_field.hpp"
#include "delfront/size_sources.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"
#include "support/tet_fixtures.hpp"
#include "volume/front.hpp"
#include "volume/front_frame.hpp"
#include "volume/to_mesh.hpp"

namespace delfront {
namespace {

using namespace fixtures;

Stretching stretching_at_30_degrees(double s1) {
  const double angle = std::numbers::pi / 6, c = std::cos(angle), s = std::sin(angle);
  return {s1, 1, {c, s, 0}, {-s, c, 0}};
}

/// Stretched at 30 degrees in x-y, by a factor that may depend on the place.
class Stretched : public SizeField {
 public:
  Stretched(double h, std::function<double(Point)> s1) : h_(h), s1_(std::move(s1)) {}
  void sizes(std::span<const Point>, std::span<double> size) const override { std::fill(size.begin(), size.end(), h_); }
  void metrics(std::span<const Point> at, std::span<Metric> metric) const override {
    for (std::size_t i = 0; i < at.size(); ++i) metric[i] = stretched_metric(h_, stretching_at_30_degrees(s1_(at[i])));
  }
  bool is_isotropic() const override { return false; }
  double lower_bound(const Box&) const override { return h_; }

 private:
  double h_;
  std::function<double(Point)> s1_;
};

/// The unit cube, n squares a side, made s1 times as long and turned by 30 degrees: its triangles suit the stretch.
Facets stretched_cube(int n, double s1) {
  Facets body = gridded_cube(n);
  const Stretching s = stretching_at_30_degrees(s1);
  for (Point& p : body.points) p = s1 * p.x * s.first + p.y * s.second + p.z * cross(s.first, s.second);
  return body;
}

struct Lengths {
  std::size_t edges = 0, good = 0;  ///< that do not touch the boundary; of these, within [0.5, 2] in the metric
  double mean = 0;
  double share() const { return static_cast<double>(good) / static_cast<double>(edges); }
};

Lengths measure_inner_edges(const TetComplex& c, const SizeField& field) {
  std::set<std::array<VertexIndex, 2>> edges;
  for (TetIndex t = 0; t < c.num_slots(); ++t)
    for (const auto& e : kEdgeNodes) {
      if (c.is_dead(t) || c.is_ghost(t)) break;
      const VertexIndex a = c.node[4 * t + e[0]], b = c.node[4 * t + e[1]];
      if (!c.on_boundary[a] && !c.on_boundary[b]) edges.insert({std::min(a, b), std::max(a, b)});
    }
  Lengths lengths;
  for (const auto& [a, b] : edges) {
    const Point at = 0.5 * (c.point(a) + c.point(b));
    Metric metric;
    field.metrics({&at, 1}, {&metric, 1});
    const double length = length_in(metric, c.point(b) - c.point(a));
    lengths.good += length >= 0.5 && length <= 2;
    lengths.mean += length / static_cast<double>(edges.size());
  }
  lengths.edges = edges.size();
  return lengths;
}

struct Filled {
  BoundaryGrid grid;
  FrontReport report;
  Lengths lengths;
};

Filled expect_filled(const Facets& body, const SizeField& field, int threads = 1) {
  const Model model = to_model(body);
  Context context;
  context.threads = threads;
  RecoveryReport recovery;
  Filled r;
  r.grid = tetrahedralize_boundary(model, {}, std::vector<bool>(model.patches.size(), false), recovery, context);
  const double volume = total_volume(r.grid.complex);
  r.report = fill_by_front(r.grid, field, context);
  EXPECT_EQ(r.report.gave_up, "");
  EXPECT_EQ(r.grid.complex.find_defect(), "");
  EXPECT_NEAR(total_volume(r.grid.complex), volume, 1e-11 * volume);
  for (const Finding& f : check(to_mesh(r.grid, model))) EXPECT_NE(f.severity, Severity::error) << f.message;
  r.lengths = measure_inner_edges(r.grid.complex, field);
  return r;
}

TEST(FrontFrame, maps_wanted_lengths_to_one_length_and_back) {
  const Stretching s = stretching_at_30_degrees(50);
  const FrontFrame frame({1, 2, 3}, root_of(stretched_metric(0.2, s)));
  const double wanted = 0.2 * std::cbrt(50.0);
  const Point third = cross(s.first, s.second);
  for (const Point& edge : {10.0 * s.first, 0.2 * s.second, 0.2 * third}) {
    EXPECT_NEAR(length(frame.along(edge)), wanted, 1e-12 * wanted);
    EXPECT_NEAR(distance(frame.from_frame(frame.to_frame({4, 5, 6})), {4, 5, 6}), 0, 1e-12);
  }
  const Point reach = frame.reach();
  EXPECT_NEAR(reach.x, std::hypot(50 * s.first.x, s.second.x) / std::cbrt(50.0), 1e-10);
  EXPECT_NEAR(reach.z, 1 / std::cbrt(50.0), 1e-12);
}

/// Spec E3: a constant stretch at 30 degrees.
TEST(FrontStretched, edges_have_their_lengths_in_the_metric) {
  for (const double s1 : {10.0, 100.0}) {
    const Stretched field(1.0 / 12, [s1](Point) { return s1; });
    const Filled r = expect_filled(stretched_cube(12, s1), field);
    EXPECT_GT(r.lengths.edges, 2000u);
    EXPECT_GE(r.lengths.share(), 0.99);
    EXPECT_NEAR(r.lengths.mean, 1.1, 0.1);
  }
}

/// As in a run: growth leads from the sizes of the boundary to those that are asked for.
std::unique_ptr<SizeField> with_boundary(const Facets& body, double h, double growth,
                                         std::shared_ptr<const SizeField> asked) {
  BoundarySizes boundary;
  boundary.growth = growth;
  boundary.points = body.points;
  boundary.size.assign(body.points.size(), h);
  Context context;
  return combine_size_fields({build_boundary_size_field(boundary, context), std::move(asked)}, 0, 1e300);
}

/// The boundary's triangles are as long as wide.
TEST(FrontStretched, leaves_a_boundary_of_regular_triangles) {
  const int n = 24;
  const Facets body = gridded_cube(n);
  const auto asked = std::make_shared<Stretched>(1.0 / n, [](Point) { return 100.0; });
  const Filled r = expect_filled(body, *with_boundary(body, 1.0 / n, 1.5, asked));
  EXPECT_GE(r.lengths.share(), 0.98);
  EXPECT_LT(r.report.cells, 100000u);
}

/// A source of stretched cells, in the middle of a cube, whose sizes and stretches fade with the distance.
TEST(FrontStretched, follows_a_source) {
  const int n = 20;
  Facets body = gridded_cube(n);
  SizeSource source;
  source.shape = SolidSphere{{0.5, 0.5, 0.5}, 0.1};
  source.law.delta0 = 0.4 / n;
  source.law.r1 = 0.3;
  source.stretching = stretching_at_30_degrees(5);
  Context context;
  SourceFieldOptions options;
  options.growth = 1.4;
  const std::shared_ptr<const SizeField> stretched = build_source_size_field({source}, options, context);
  const auto field = with_boundary(body, 1.0 / n, 1.4, stretched);
  const Filled r = expect_filled(body, *field);
  EXPECT_GE(r.lengths.share(), 0.98);
}

TEST(FrontStretched, follows_a_stretch_that_rises) {
  const int n = 16;
  const Facets body = gridded_cube(n);
  const auto s1 = [](Point p) { return 1 + 9 * std::clamp(p.z, 0.0, 1.0); };
  const auto field = with_boundary(body, 1.0 / n, 1.5, std::make_shared<Stretched>(0.5 / n, s1));
  const Filled r = expect_filled(body, *field);
  EXPECT_GE(r.lengths.share(), 0.98);
}

TEST(FrontStretched, the_same_grid_for_any_number_of_threads) {
  const Stretched field(1.0 / 16, [](Point) { return 8.0; });
  const Facets body = stretched_cube(16, 8);
  const Filled first = expect_filled(body, field);
  for (const int threads : {2, 3}) {
    const Filled other = expect_filled(body, field, threads);
    EXPECT_EQ(first.grid.complex.node, other.grid.complex.node);
    EXPECT_EQ(first.grid.complex.neigh, other.grid.complex.neigh);
  }
}

/// A frame at random, and lengths along its axes.
class Skewed : public SizeField {
 public:
  Skewed(const MetricAxes& axes) : metric_(metric_from_axes(axes)) {}
  void sizes(std::span<const Point>, std::span<double> size) const override {
    std::fill(size.begin(), size.end(), least_size(metric_));
  }
  void metrics(std::span<const Point>, std::span<Metric> metric) const override {
    std::fill(metric.begin(), metric.end(), metric_);
  }
  bool is_isotropic() const override { return false; }
  double lower_bound(const Box&) const override { return least_size(metric_); }

 private:
  Metric metric_;
};

/// Boundaries that do not suit the stretches at all.
TEST(FrontStretched, random_rooms_with_any_stretches) {
  const unsigned first = setting("DELFRONT_RANDOM_SEED", 1), cases = setting("DELFRONT_RANDOM_CASES", 60);
  unsigned given_up = 0;
  for (unsigned seed = first; seed < first + cases; ++seed) {
    SCOPED_TRACE("DELFRONT_RANDOM_SEED=" + std::to_string(seed) + " DELFRONT_RANDOM_CASES=1");
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    Facets body = gridded_cube(1 + static_cast<int>(random() % 4));
    Facets hole = box_facets({0.3, 0.2, 0.4}, {0.6, 0.7, 0.8});
    hole.turn();
    if (random() % 2 == 0) body.add(hole);
    const Model model = to_model(body);
    Point u{unit(random), unit(random), unit(random)}, v{unit(random), unit(random), unit(random)};
    u = u / length(u);
    v = v - dot(u, v) * u;
    v = v / length(v);
    MetricAxes axes{{}, {u, v, cross(u, v)}};
    for (double& value : axes.value) value = std::pow(10.0, 2.2 + 0.8 * unit(random));  // lengths from 0.03 to 0.2
    if (seed % 4 == 0) axes.value[2] *= 1e-4;
    Context context;
    RecoveryReport recovery;
    BoundaryGrid grid =
        tetrahedralize_boundary(model, {}, std::vector<bool>(model.patches.size(), false), recovery, context);
    const double volume = total_volume(grid.complex);
    given_up += !fill_by_front(grid, Skewed(axes), context).gave_up.empty();
    ASSERT_EQ(grid.complex.find_defect(), "");
    ASSERT_NEAR(total_volume(grid.complex), volume, 1e-11);
  }
  EXPECT_LE(given_up, cases / 20);
}

}  // namespace
}  // namespace delfront
