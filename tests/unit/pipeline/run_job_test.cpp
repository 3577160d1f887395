// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "delfront/io.hpp"
#include "delfront/job.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

namespace fs = std::filesystem;

/// A job that grids the unit cube, in a folder of its own.
class RunJob : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fixtures::scratch_folder();
    write_surface(fixtures::cube_surface());
    options_.output.files = {path("cube.vtu")};
    options_.output.report = path("report.json");
  }
  void write_surface(const Mesh& mesh) {
    Context context;
    write_mesh(mesh, path("cube.obj"), context);
    options_.input.files = {path("cube.obj")};
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  JobResult run() { return run_job(options_, context_, "the command"); }
  nlohmann::json report() const { return nlohmann::json::parse(std::ifstream(path("report.json"))); }

  fs::path folder_;
  Options options_;
  Context context_;
};

TEST_F(RunJob, writes_the_grid_and_the_report) {
  const JobResult result = run();
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.error;
  EXPECT_EQ(result.files_written, options_.output.files);
  EXPECT_NEAR(result.report.quality.volume, 1, 1e-12);
  EXPECT_TRUE(fs::exists(path("cube.vtu")));
  const nlohmann::json json = report();
  EXPECT_EQ(json["outcome"], "done");
  EXPECT_EQ(json["command"], "the command");
  EXPECT_EQ(json["inputs"][0]["num_cells"], 12);
  EXPECT_EQ(json["boundaries"].size(), 6u);
}

TEST_F(RunJob, a_failed_gate_leaves_the_grid) {
  options_.output.require = "min_dihedral > 89.9";
  const JobResult result = run();
  EXPECT_EQ(result.exit_code, ExitCode::gate_not_met);
  EXPECT_EQ(result.failed_gates.size(), 1u);
  EXPECT_TRUE(fs::exists(path("cube.vtu")));
  EXPECT_EQ(report()["exit_code"], 5);
}

TEST(ReportJson, says_why_points_were_left_on_the_surface) {
  JobResult result;
  result.report.recovery.steiner_left = 2;
  result.report.recovery.left = {{{1, 2, 3}, {7}}, {{4, 5, 6}, {8}}};
  result.report.recovery.left_why = {"a sheet ends here", "too thin"};
  const Options options;
  const auto json = nlohmann::json::parse(report_json(result, options, ""));
  const auto& left = json["recovery"]["left"];
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0]["why"], "a sheet ends here");
  EXPECT_EQ(left[1]["why"], "too thin");
  EXPECT_EQ(left[1]["at"], (nlohmann::json{4.0, 5.0, 6.0}));
}

TEST_F(RunJob, an_hmax_that_no_far_field_can_hold_is_refused_before_there_is_one) {
  options_.domain.enclose.shape = "sphere";
  options_.domain.enclose.size = Length{1000, ""};
  options_.size.hmax = Length{0.5, ""};  // some 29 million triangles on the far field alone
  const JobResult result = run();
  EXPECT_EQ(result.exit_code, ExitCode::limit_reached);
  EXPECT_NE(result.error.find("hmax"), std::string::npos) << result.error;
  EXPECT_LT(result.peak_memory, std::uint64_t{1} << 30);
}

TEST_F(RunJob, a_max_of_cells_counts_for_an_hmax_too) {
  options_.domain.enclose.shape = "box";
  options_.domain.enclose.size = Length{10, ""};
  options_.size.hmax = Length{2, ""};  // 8 500 cells
  context_.max_cells = 2'000;
  EXPECT_EQ(run().exit_code, ExitCode::limit_reached);
  context_.max_cells = 200'000;
  EXPECT_EQ(run().exit_code, ExitCode::done);
}

TEST_F(RunJob, limits_hold_while_lines_and_surfaces_are_divided) {
  options_.surface.method = "front";
  options_.size.hmax = Length{1e-3, ""};  // 14 million triangles
  context_.max_cells = 5000;
  EXPECT_EQ(run().exit_code, ExitCode::limit_reached);
  std::ofstream(path("square.poly")) << "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n4 0\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n0\n";
  options_.input.files = {path("square.poly")};
  options_.planar.boundary = "split";
  options_.size.hmax = Length{1e-8, ""};  // 100 million pieces a side
  EXPECT_EQ(run().exit_code, ExitCode::limit_reached);
}

TEST_F(RunJob, limits_hold_while_curves_of_the_job_are_divided) {
  PlanarCurveOptions curve;
  curve.name = "o";
  curve.at = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  curve.closed = true;
  options_.input.files = {};
  for (const char* type : {"spline", "line"}) {
    SCOPED_TRACE(type);
    curve.type = type;
    curve.h = Length{1e-9, ""};  // 3 billion pieces
    options_.planar.curves = {curve};
    context_.max_cells = 10'000;
    JobResult result = run();
    EXPECT_EQ(result.exit_code, ExitCode::limit_reached);
    EXPECT_NE(result.error.find("planar.curve[0]"), std::string::npos) << result.error;
    context_.max_cells = 0;
    EXPECT_EQ(run().exit_code, ExitCode::limit_reached) << "more than fit";
    options_.planar.curves[0].h = Length{2e-8, ""};  // 170 million: 4 gigabytes
    context_.memory_limit = resident_memory() + (std::uint64_t{100} << 20);
    result = run();
    EXPECT_EQ(result.exit_code, ExitCode::limit_reached);
    EXPECT_LT(result.peak_memory, context_.memory_limit + (std::uint64_t{300} << 20));
    context_.memory_limit = 0;
  }
}

TEST_F(RunJob, the_memory_limit_holds_while_lines_of_surfaces_are_divided) {
  options_.surface.method = "front";
  options_.size.hmax = Length{2e-8, ""};  // 50 million sides an edge
  context_.memory_limit = resident_memory() + (std::uint64_t{100} << 20);
  const JobResult result = run();
  EXPECT_EQ(result.exit_code, ExitCode::limit_reached);
  EXPECT_LT(result.peak_memory, context_.memory_limit + (std::uint64_t{300} << 20));
}

TEST_F(RunJob, warnings_of_the_plane_are_told_as_they_come_and_once) {
  std::ofstream(path("square.poly")) << "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n4 0\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n0\n";
  options_.input.files = {path("square.poly")};
  options_.size.hmax = Length{0.1, ""};
  std::vector<std::string> told;
  context_.on_log = [&](LogLevel level, const std::string& message) {
    if (level == LogLevel::warning) told.push_back(message);
  };
  const JobResult result = run();
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.error;
  EXPECT_EQ(told, result.warnings);
  EXPECT_EQ(std::count_if(told.begin(), told.end(),
                          [](const std::string& w) { return w.find("--boundary split") != std::string::npos; }),
            1);
}

TEST(StageTimer, a_stage_within_another_counts_as_part_of_that) {
  Context context;
  {
    const StageTimer outer(context, "outer");
    const StageTimer inner(context, "inner");
  }
  { const StageTimer next(context, "next"); }
  ASSERT_EQ(context.stage_times.size(), 2u);
  EXPECT_EQ(context.stage_times[0].stage, "outer");
  EXPECT_EQ(context.stage_times[1].stage, "next");
}

TEST_F(RunJob, an_open_surface_is_refused_with_its_places) {
  Mesh open = fixtures::cube_surface();
  CellBlock& triangles = open.block(CellType::triangle);
  triangles.vertices.resize(triangles.vertices.size() - 3);
  triangles.group.pop_back();
  write_surface(open);
  const JobResult result = run();
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_TRUE(has_errors(result.report.surface.findings));
  EXPECT_EQ(result.defects_file, path("cube_defects.vtp"));
  EXPECT_TRUE(fs::exists(path("cube_defects.vtp")));
  EXPECT_FALSE(fs::exists(path("cube.vtu")));
  EXPECT_EQ(report()["outcome"], "bad_input");
}

TEST_F(RunJob, nothing_is_written_over_an_input_or_another_output) {
  std::ostringstream before;
  before << std::ifstream(path("cube.obj")).rdbuf();
  const auto expect_refused = [&](const std::string& output, const std::string& report, const std::string& defects) {
    SCOPED_TRACE(output + " " + report + " " + defects);
    options_.output.files = {path("cube.vtu"), path(output)};
    options_.output.report = path(report);
    options_.output.defects = path(defects);
    const JobResult result = run();
    EXPECT_EQ(result.exit_code, ExitCode::usage);
    EXPECT_NE(result.error.find("would be written over"), std::string::npos) << result.error;
    EXPECT_FALSE(fs::exists(path("cube.vtu")));
    std::ostringstream after;
    after << std::ifstream(path("cube.obj")).rdbuf();
    EXPECT_EQ(before.str(), after.str());
  };
  expect_refused("cube.vtu", "r.json", "d.vtp");
  expect_refused("./cube.vtu", "r.json", "d.vtp");
  expect_refused("b.vtu", "cube.obj", "d.vtp");
  expect_refused("b.vtu", "cube.vtu", "d.vtp");
  expect_refused("b.vtu", "r.json", "b.vtu");
  expect_refused("b.vtu", "r.json", "r.json");
}

TEST_F(RunJob, a_grid_is_not_written_as_a_surface) {
  for (const char* name : {"grid.stl", "grid.obj", "grid.ply", "grid.off", "grid.vtp"}) {
    options_.stop_after = "write";
    options_.output.files = {path(name)};
    const JobResult result = run();
    EXPECT_EQ(result.exit_code, ExitCode::usage) << name;
    EXPECT_FALSE(fs::exists(path(name)));
    options_.stop_after = "surface";
    EXPECT_EQ(run().exit_code, ExitCode::done) << name;
    EXPECT_TRUE(fs::exists(path(name)));
  }
}

TEST_F(RunJob, boundaries_name_the_far_field_and_give_it_a_kind) {
  options_.domain.enclose.shape = "box";
  options_.domain.enclose.size = Length{3, ""};
  const auto kinds = [](const JobResult& result) {
    std::map<std::string, std::string> found;
    for (const Group& group : result.mesh.groups)
      if (group.dimension == 2) found[group.name] = group.kind;
    return found;
  };
  options_.boundaries = {{"body", {"*"}, ""}, {"farfield", {}, "inlet"}};
  const JobResult kept = run();
  ASSERT_EQ(kept.exit_code, ExitCode::done) << kept.error;
  EXPECT_NEAR(kept.report.quality.volume, 6 * 6 * 6 - 1, 1e-9) << "the outside alone";
  EXPECT_EQ(kinds(kept), (std::map<std::string, std::string>{{"body", "wall"}, {"farfield", "inlet"}}));
  options_.boundaries = {{"body", {"*"}, "patch"}, {"tunnel", {"farfield"}, ""}};
  const JobResult renamed = run();
  ASSERT_EQ(renamed.exit_code, ExitCode::done) << renamed.error;
  EXPECT_EQ(kinds(renamed), (std::map<std::string, std::string>{{"body", "patch"}, {"tunnel", "farfield"}}));
  options_.boundaries = {{"farfield", {"*"}, "wall"}};
  EXPECT_EQ(run().exit_code, ExitCode::usage) << "two patches of one name";
  options_.boundaries = {{"farfield", {}, "inlet"}};
  options_.stop_after = "geometry";
  EXPECT_EQ(run().exit_code, ExitCode::done);
}

TEST_F(RunJob, hmax_holds_on_the_far_field) {
  options_.domain.enclose.shape = "box";
  options_.domain.enclose.size = Length{3, ""};
  options_.stop_after = "surface";
  const auto count_triangles = [this] {
    const JobResult result = run();
    EXPECT_EQ(result.exit_code, ExitCode::done) << result.error;
    return result.mesh.find_block(CellType::triangle)->size() - 12;
  };
  EXPECT_EQ(count_triangles(), 6u * 10 * 10 * 2) << "a fifth of the half side";
  options_.size.hmax = Length{2, ""};
  EXPECT_EQ(count_triangles(), 6u * 10 * 10 * 2);
  options_.size.hmax = Length{0.5, ""};
  EXPECT_EQ(count_triangles(), 6u * 12 * 12 * 2);
  options_.domain.enclose.h = Length{1, ""};
  EXPECT_EQ(count_triangles(), 6u * 6 * 6 * 2) << "said outright";
}

TEST_F(RunJob, cancelling_writes_nothing) {
  std::atomic<bool> cancel{true};
  context_.cancel = &cancel;
  const JobResult result = run();
  EXPECT_EQ(result.exit_code, ExitCode::interrupted);
  EXPECT_TRUE(result.files_written.empty());
  EXPECT_FALSE(fs::exists(path("cube.vtu")));
  EXPECT_EQ(report()["exit_code"], 130);
}

TEST_F(RunJob, an_output_that_cannot_be_written_is_said_before_any_work) {
  options_.output.files.push_back(path("nofolder/cube.vtu"));
  const JobResult result = run();
  EXPECT_EQ(result.exit_code, ExitCode::cannot_write);
  EXPECT_TRUE(result.stage.empty()) << result.stage;
  EXPECT_FALSE(fs::exists(path("cube.vtu")));
}

TEST_F(RunJob, lengths_are_resolved_by_the_input_and_units_by_the_output) {
  options_.input.units = "m";
  options_.output.units = "mm";
  options_.size.hmax = Length{500, "mm"};
  const JobResult result = run();
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.error;
  EXPECT_NEAR(result.scale.diagonal, std::sqrt(3.0), 1e-15);
  EXPECT_EQ(result.mesh.bounding_box().high, (Point{1000, 1000, 1000}));
}

TEST_F(RunJob, callbacks_of_the_context_are_given_back) {
  int calls = 0;
  context_.on_progress = [&calls](const Progress&) { ++calls; };
  run();
  const int during = calls;
  EXPECT_GT(during, 0);
  context_.progress("after", 0, 0, "");
  EXPECT_EQ(calls, during + 1);
}

}  // namespace
}  // namespace delfront
