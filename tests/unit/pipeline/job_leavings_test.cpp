// SPDX-License-Identifier: Apache-2.0
#include "pipeline/job_leavings.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "delfront/io.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

namespace fs = std::filesystem;

/// A run that ended somehow; its output would have been grid.vtu in a folder of its own.
class JobLeavings : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fixtures::scratch_folder();
    run_.options.input.files = {path("body.stl")};
    run_.options.output.files = {path("grid.vtu")};
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
  Context context_;
  JobResult result_;
  delfront::Run run_{{}, context_, result_, {}, {}, {}, {}, {}};
};

TEST_F(JobLeavings, a_failed_gridding_leaves_what_there_is_beside_the_asked_name) {
  result_.partial = std::make_shared<Mesh>(fixtures::cube_surface());
  result_.exit_code = ExitCode::meshing_failed;
  leave_partial_grid(run_);
  EXPECT_EQ(result_.partial_file, path("grid_partial.vtu"));
  EXPECT_EQ(read_mesh(path("grid_partial.vtu"), context_).num_cells(CellType::triangle), 12u);
  EXPECT_FALSE(fs::exists(path("grid.vtu")));
}

TEST_F(JobLeavings, no_partial_grid_without_cells_or_after_other_ends) {
  result_.exit_code = ExitCode::meshing_failed;
  leave_partial_grid(run_);
  result_.partial = std::make_shared<Mesh>(fixtures::cube_surface());
  result_.exit_code = ExitCode::bad_input;
  leave_partial_grid(run_);
  EXPECT_TRUE(result_.partial_file.empty());
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(JobLeavings, a_partial_grid_never_destroys_an_input) {
  run_.options.input.files = {path("grid_partial.vtu")};
  std::ofstream(path("grid_partial.vtu")) << "precious";
  result_.partial = std::make_shared<Mesh>(fixtures::cube_surface());
  result_.exit_code = ExitCode::meshing_failed;
  leave_partial_grid(run_);
  EXPECT_TRUE(result_.partial_file.empty());
  EXPECT_EQ(result_.warnings.size(), 1u);
  EXPECT_EQ(fs::file_size(path("grid_partial.vtu")), 8u);
}

TEST_F(JobLeavings, a_partial_grid_of_an_earlier_run_goes) {
  Mesh unfinished = fixtures::cube_surface();
  unfinished.add_group(3, "unfinished");
  write_mesh(unfinished, path("grid_partial.vtu"), context_);
  result_.exit_code = ExitCode::limit_reached;
  leave_partial_grid(run_);
  EXPECT_TRUE(fs::exists(path("grid_partial.vtu")));
  result_.exit_code = ExitCode::done;
  leave_partial_grid(run_);
  EXPECT_FALSE(fs::exists(path("grid_partial.vtu")));
  write_mesh(fixtures::cube_surface(), path("grid_partial.vtu"), context_);
  leave_partial_grid(run_);
  EXPECT_TRUE(fs::exists(path("grid_partial.vtu"))) << "not ours";
}

TEST_F(JobLeavings, gate_failures_are_shown_in_the_units_of_the_grid) {
  run_.options.input.units = std::string("m");
  run_.options.output.units = std::string("mm");
  Finding failure{"gate_min_dihedral", Severity::error, 1, "", "", {{{1, 2, 3}, {0}}}};
  failure.outlines = {{0, {{1, 0, 0}, {0, 1, 0}}}};
  result_.gate_failures = {failure};
  result_.exit_code = ExitCode::gate_not_met;
  leave_defects(run_);
  ASSERT_EQ(result_.defects_file, path("grid_defects.vtp"));
  const Mesh shown = read_mesh(result_.defects_file, context_);
  EXPECT_EQ(shown.points[VertexId(0)], (Point{1000, 2000, 3000}));
  EXPECT_EQ(shown.num_cells(CellType::line), 1u);
}

TEST_F(JobLeavings, defects_of_an_earlier_run_go_only_where_this_run_looked) {
  const auto put_stale = [this] {
    write_defects({{"open_edges", Severity::error, 1, "", "", {{{0, 0, 0}, {}}}}}, path("grid_defects.vtp"), context_);
  };
  for (const ExitCode code :
       {ExitCode::interrupted, ExitCode::limit_reached, ExitCode::usage, ExitCode::cannot_write}) {
    put_stale();
    result_.exit_code = code;
    leave_defects(run_);
    EXPECT_TRUE(fs::exists(path("grid_defects.vtp"))) << static_cast<int>(code);
  }
  result_.exit_code = ExitCode::done;
  leave_defects(run_);
  EXPECT_FALSE(fs::exists(path("grid_defects.vtp")));
  put_stale();
  run_.options.input.files = {path("grid_defects.vtp")};
  leave_defects(run_);
  EXPECT_TRUE(fs::exists(path("grid_defects.vtp"))) << "an input";
}

}  // namespace
}  // namespace delfront
