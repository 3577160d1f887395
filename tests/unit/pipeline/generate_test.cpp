// SPDX-License-Identifier: Apache-2.0
// The whole run in memory: what the report says is what the grid has; every stage can be stopped.
#include "delfront/generate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "delfront/errors.hpp"
#include "geometry/enclose.hpp"
#include "support/plc_fixtures.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

Model sphere_model(int levels) {
  Context context;
  return build_model({{fixtures::sphere_surface(levels), "sphere"}}, context);
}

Model cube_model() {
  Context context;
  return build_model({{fixtures::cube_surface(), "cube"}}, context);
}

Options defaults() {
  Options options;
  return options;
}

Options sized(double hmax) {
  Options options = defaults();
  options.size.hmax = Length{hmax, ""};
  return options;
}

void expect_valid(const Outcome& outcome) {
  for (const Finding& f : check(outcome.mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
}

class StretchedAlongX : public SizeField {
 public:
  StretchedAlongX(double h, double s1) : h_(h), metric_(stretched_metric(h, {s1, 1})) {}
  void sizes(std::span<const Point>, std::span<double> size) const override { std::fill(size.begin(), size.end(), h_); }
  void metrics(std::span<const Point>, std::span<Metric> metric) const override {
    std::fill(metric.begin(), metric.end(), metric_);
  }
  bool is_isotropic() const override { return false; }
  double lower_bound(const Box&) const override { return h_; }

 private:
  double h_;
  Metric metric_;
};

TEST(Generate, the_report_counts_what_the_grid_has) {
  Context context;
  const Model model = sphere_model(2);
  const Outcome outcome = generate(model, defaults(), context);
  expect_valid(outcome);
  const Report& report = outcome.report;
  EXPECT_EQ(report.quality.num_points, outcome.mesh.points.size());
  EXPECT_EQ(report.quality.num_cells, outcome.mesh.num_cells(CellType::tetrahedron));
  EXPECT_EQ(report.quality.num_boundary_faces, model.triangles.size());
  EXPECT_EQ(outcome.mesh.num_cells(CellType::triangle), model.triangles.size());
  EXPECT_NEAR(report.quality.volume, report.surface.volume, 1e-12);
  EXPECT_EQ(report.surface.num_triangles, model.triangles.size());
  EXPECT_EQ(report.recovery.steiner_left, 0u);
  EXPECT_TRUE(report.recovery.left.empty());
  EXPECT_EQ(outcome.mesh.points.size(), model.points.size() + report.recovery.steiner_moved +
                                            report.refine.points_inserted + report.improve.points_added -
                                            report.improve.points_removed);
  EXPECT_GE(report.improve.min_dihedral_after_deg, report.improve.min_dihedral_before_deg);
  EXPECT_NEAR(report.quality.find("min_dihedral")->min, report.improve.min_dihedral_after_deg, 1e-6);
  EXPECT_GT(report.quality.find("min_dihedral")->min, 5);
  for (std::size_t v = 0; v < model.points.size(); ++v)
    EXPECT_EQ(outcome.mesh.points[VertexId(v)], model.points[VertexId(v)]);
}

TEST(Generate, patches_keep_names_and_areas) {
  Context context;
  const Outcome outcome = generate(cube_model(), sized(0.3), context);
  expect_valid(outcome);
  const CellBlock& faces = *outcome.mesh.find_block(CellType::triangle);
  for (const char* name : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}) {
    const GroupId group = outcome.mesh.find_group(2, name);
    ASSERT_TRUE(group.is_valid()) << name;
    EXPECT_FALSE(outcome.mesh.groups[group].two_sided);
    EXPECT_EQ(std::count(faces.group.begin(), faces.group.end(), group), 2) << name;
  }
}

TEST(Generate, stage_times_are_told_for_every_stage) {
  Context context;
  std::set<std::string> timed;
  generate(sphere_model(2), defaults(), context);
  for (const StageTime& t : context.stage_times) {
    EXPECT_GE(t.seconds, 0);
    timed.insert(t.stage);
  }
  for (const char* stage : {"check", "recover", "refine", "improve", "measure"})
    EXPECT_TRUE(timed.contains(stage)) << stage;
}

TEST(Generate, sizes_stay_within_their_limits_and_growth) {
  Context context;
  Options options = sized(0.2);
  options.size.growth = 1.3;
  const Outcome fine = generate(sphere_model(3), options, context);
  expect_valid(fine);
  EXPECT_LE(fine.report.quality.find("edge_length")->max, 2 * 0.2);
  options.size.hmax = Length{0.1, ""};
  const Outcome finer = generate(sphere_model(3), options, context);
  expect_valid(finer);
  EXPECT_GT(finer.report.quality.num_cells, 2 * fine.report.quality.num_cells);
}

TEST(Generate, a_far_field_keeps_the_outside_only) {
  Context context;
  Model model = cube_model();
  const Box box = model.bounding_box();
  EncloseOptions enclose;
  enclose.shape = "sphere";
  enclose.size = {4, ""};
  enclose.h = Length{1, ""};
  const PatchId far = add_far_field(model, enclose, {box.diagonal(), box.longest_side(), 0}, context);
  ASSERT_TRUE(far.is_valid());
  const std::size_t triangles = model.triangles.size();
  const Outcome outcome = generate(std::move(model), defaults(), context);
  expect_valid(outcome);
  EXPECT_EQ(outcome.mesh.num_cells(CellType::triangle), triangles);
  const double ball = 4.0 / 3 * std::numbers::pi * 64;
  EXPECT_LT(outcome.report.quality.volume, ball - 1);
  EXPECT_GT(outcome.report.quality.volume, 0.85 * ball - 1);
  const CellBlock& tets = *outcome.mesh.find_block(CellType::tetrahedron);
  for (std::size_t i = 0; i < tets.size(); ++i) {
    Point centre;
    for (const VertexId v : tets[i]) centre = centre + 0.25 * outcome.mesh.points[v];
    EXPECT_FALSE(std::min({centre.x, centre.y, centre.z}) > 0 && std::max({centre.x, centre.y, centre.z}) < 1)
        << "a cell inside of the body";
  }
  EXPECT_EQ(outcome.mesh.groups[outcome.mesh.find_group(2, "farfield")].kind, "farfield");
}

TEST(Generate, an_inside_out_surface_is_turned_and_reported) {
  Context context;
  fixtures::Facets box = fixtures::box_facets({0, 0, 0}, {1, 1, 1});
  std::reverse(box.faces[0].begin(), box.faces[0].end());  // one side only
  const Outcome outcome = generate(fixtures::to_model(box), defaults(), context);
  expect_valid(outcome);
  EXPECT_GT(outcome.report.surface.reoriented, 0u);
  EXPECT_NEAR(outcome.report.quality.volume, 1, 1e-12);
}

TEST(Generate, an_open_surface_is_refused_with_places) {
  Context context;
  fixtures::Facets box = fixtures::box_facets({0, 0, 0}, {1, 1, 1});
  box.faces.pop_back();
  try {
    generate(fixtures::to_model(box), defaults(), context);
    FAIL() << "an open box was gridded";
  } catch (const InputError& e) {
    EXPECT_FALSE(e.places.empty());
    EXPECT_NE(std::string(e.what()).find("cannot be gridded"), std::string::npos);
  }
}

/// The names of the stages that report progress in a run.
std::set<std::string> stages_of(const Model& model, const Options& options) {
  std::set<std::string> seen;
  Context context;
  context.on_progress = [&](const Progress& p) { seen.insert(p.stage); };
  generate(model, options, context);
  return seen;
}

TEST(Generate, a_cancel_in_any_stage_stops_the_run) {
  const Model model = sphere_model(4);
  const Options options = sized(0.08);
  const std::set<std::string> stages = stages_of(model, options);
  for (const char* stage : {"recover", "refine", "improve"}) EXPECT_TRUE(stages.contains(stage)) << stage;
  for (const std::string& stage : stages) {
    SCOPED_TRACE(stage);
    std::atomic<bool> cancel = false;
    Context context;
    context.cancel = &cancel;
    context.on_progress = [&](const Progress& p) { cancel = cancel || p.stage == stage; };
    EXPECT_THROW(generate(model, options, context), Cancelled);
  }
}

TEST(Generate, limits_of_cells_and_time_end_the_run) {
  Context few;
  few.max_cells = 1000;
  EXPECT_THROW(generate(sphere_model(3), sized(0.08), few), LimitError);
  Context hasty;
  hasty.time_limit = 1e-9;
  EXPECT_THROW(generate(sphere_model(3), sized(0.08), hasty), LimitError);
}

TEST(Generate, sizes_are_met_around_a_long_edge_of_a_curve) {
  fixtures::Facets body = fixtures::box_facets({0, 0, 0}, {1, 1, 1});
  const std::size_t from = body.add_point({0.02, 0.02, 0.02}), to = body.add_point({0.98, 0.97, 0.96});
  body.curves.push_back({from, to});
  Context context;
  const Outcome outcome = generate(fixtures::to_model(body), sized(0.1), context);
  EXPECT_EQ(outcome.mesh.num_cells(CellType::line), 1u);
  for (const Finding& f : check(outcome.mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
  EXPECT_GT(outcome.mesh.num_cells(CellType::tetrahedron), 5000u);  // 17 where points beside the edge are refused
}

TEST(Generate, a_size_far_too_small_ends_before_memory_does) {
  for (const double size : {3e-4, 1e-4, 1e-5}) {
    SCOPED_TRACE(size);
    Context context;
    EXPECT_THROW(generate(sphere_model(3), sized(size), context), LimitError);
  }
}

/// Only the front stretches its cells, and improvement would undo that. The others take the least size.
TEST(Generate, stretched_sizes_give_stretched_cells_by_the_front) {
  const Model model = fixtures::to_model(fixtures::gridded_cube(12));
  std::size_t cells = 0;
  for (const char* method : {"front", "front-delaunay"}) {
    SCOPED_TRACE(method);
    Options options;
    options.volume.method = method;
    options.size.growth = 1.5;
    Context context;
    std::vector<std::string> warnings;
    context.on_log = [&](LogLevel level, const std::string& message) {
      if (level == LogLevel::warning) warnings.push_back(message);
    };
    const bool is_front = options.volume.method == "front";
    const Outcome outcome = generate(model, options, context, std::make_shared<StretchedAlongX>(1.0 / 12, 8));
    for (const Finding& f : check(outcome.mesh)) EXPECT_NE(f.severity, Severity::error) << f.message;
    EXPECT_EQ(outcome.report.improve.passes == 0, is_front);
    EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(),
                            [](const std::string& w) { return w.find("improvement") != std::string::npos; }),
              is_front ? 1 : 0);
    if (is_front)
      cells = outcome.report.quality.num_cells;
    else
      EXPECT_LT(1.3 * static_cast<double>(cells), static_cast<double>(outcome.report.quality.num_cells));
  }
}

TEST(Generate, two_runs_and_any_number_of_threads_give_the_same_grid) {
  auto run = [](int threads) {
    Context context;
    context.threads = threads;
    return generate(sphere_model(2), defaults(), context).mesh;
  };
  const Mesh first = run(1);
  for (const int threads : {1, 2, 4}) {
    const Mesh again = run(threads);
    EXPECT_TRUE(first.points == again.points);
    EXPECT_TRUE(first.find_block(CellType::tetrahedron)->vertices == again.find_block(CellType::tetrahedron)->vertices);
  }
}

/// Large enough for several territories in the core and in refinement.
TEST(Generate, any_number_of_threads_gives_the_same_grid) {
  auto grid_of = [](int threads) {
    Context context;
    context.threads = threads;
    return generate(sphere_model(4), sized(0.034), context);
  };
  const Outcome expected = grid_of(1), found = grid_of(3);
  expect_valid(expected);
  ASSERT_GT(expected.mesh.points.size(), 132000u);
  EXPECT_GT(expected.report.refine.points_in_core, 16384u);
  EXPECT_EQ(found.mesh.points, expected.mesh.points);
  EXPECT_EQ(found.mesh.find_block(CellType::tetrahedron)->vertices,
            expected.mesh.find_block(CellType::tetrahedron)->vertices);
}

}  // namespace
}  // namespace delfront
