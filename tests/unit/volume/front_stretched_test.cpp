// SPDX-License-Identifier: Apache-2.0
// The pure front where sizes have directions: lengths of edges in the metric, and the same whole grids as ever.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "delfront/grid_check.hpp"
#include "delfront/size_field.hpp"
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
  void sizes(std::span<const Point>, std::span<double> size) const override {
    std::fill(size.begin(), size.end(), h_);
  }
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
  std::printf("cells %zu inner edges %zu good %.4f mean %.3f; sweeps %zu left %zu cavities %zu closed %zu\n", r.report.cells, r.lengths.edges,
  r.lengths.share(), r.lengths.mean, r.report.sweeps, r.report.sides_left, r.report.cavities, r.report.closed_by_delaunay);
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
    EXPECT_GE(r.lengths.share(), 0.95);
    EXPECT_NEAR(r.lengths.mean, 1.1, 0.1);
  }
}

/// The boundary's triangles are as long as wide. As in a run, growth leads from their sizes to the stretched ones.
TEST(FrontStretched, leaves_a_boundary_of_regular_triangles) {
  const int n = 24;
  Facets body = gridded_cube(n);
  BoundarySizes boundary;
  boundary.growth = 1.5;
  boundary.points = body.points;
  boundary.size.assign(body.points.size(), 1.0 / n);
  Context context;
  for (const double s1 : {10.0, 100.0}) {
    const auto field = combine_size_fields({build_boundary_size_field(boundary, context),
                                            std::make_shared<Stretched>(1.0 / n, [s1](Point) { return s1; })},
                                           0, 1e300);
    expect_filled(body, *field);
  }
}

TEST(FrontStretched, follows_a_stretch_that_rises) {
  const auto s1 = [](Point p) { return 1 + 9 * std::clamp(p.z, 0.0, 1.0); };
  Facets body = gridded_cube(16);
  for (Point& p : body.points) p = {4 * p.x, 4 * p.y, p.z};
  expect_filled(body, Stretched(0.0625, s1));
  Context context;
  BoundarySizes boundary;
  boundary.growth = 1.5;
  boundary.points = body.points;
  boundary.size.assign(body.points.size(), 0.25);
  const auto field = combine_size_fields({build_boundary_size_field(boundary, context),
                                            std::make_shared<Stretched>(0.0625, s1)},
                                           0, 1e300);
  expect_filled(body, *field);
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

}  // namespace
}  // namespace delfront
