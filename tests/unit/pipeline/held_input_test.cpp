// SPDX-License-Identifier: Apache-2.0
// Jobs of programs that hold their input in memory and take the grid from the result.
#include <gtest/gtest.h>

#include <filesystem>

#include "delfront/job.hpp"
#include "delfront/size_expression.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

JobExtras holding(const std::string& name, Mesh mesh) {
  JobExtras extras;
  HeldInput held;
  held.mesh = std::move(mesh);
  held.stem = name;
  extras.held[name] = std::make_shared<HeldInput>(std::move(held));
  extras.wants_result = true;
  return extras;
}

TEST(HeldInput, is_gridded_like_a_file_and_nothing_is_written) {
  Context context;
  Options options;
  options.input.files = {"held cube"};
  const auto before = std::distance(std::filesystem::directory_iterator("."), {});
  const JobResult result = run_job(options, context, "", JobKind::grid, holding("held cube", fixtures::cube_surface()));
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.error;
  EXPECT_GT(result.mesh.num_cells(CellType::tetrahedron), 0u);
  EXPECT_TRUE(result.files_written.empty());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator("."), {}), before);
}

TEST(HeldInput, a_refused_surface_leaves_findings_and_no_file) {
  Context context;
  Options options;
  options.input.files = {"open cube"};
  Mesh open = fixtures::cube_surface();
  CellBlock& triangles = open.block(CellType::triangle);
  triangles.vertices.resize(triangles.vertices.size() - 3);
  triangles.group.resize(triangles.group.size() - 1);
  const JobResult result = run_job(options, context, "", JobKind::grid, holding("open cube", open));
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_TRUE(has_errors(result.report.surface.findings));
  EXPECT_TRUE(result.defects_file.empty());
  EXPECT_FALSE(std::filesystem::exists("open cube_defects.vtp"));
}

TEST(HeldInput, without_wants_result_an_output_is_still_needed) {
  Context context;
  Options options;
  options.input.files = {"held cube"};
  JobExtras extras = holding("held cube", fixtures::cube_surface());
  extras.wants_result = false;
  EXPECT_EQ(run_job(options, context, "", JobKind::grid, extras).exit_code, ExitCode::usage);
}

TEST(HeldInput, fields_of_the_program_lower_the_sizes) {
  Context context;
  Options options;
  options.input.files = {"held cube"};
  options.surface.method = "front";
  const JobExtras extras = holding("held cube", fixtures::cube_surface());
  const std::size_t coarse = run_job(options, context, "", JobKind::grid, extras).mesh.num_cells(CellType::tetrahedron);
  options.size.fields = {build_callback_size_field(
      [](std::span<const Point> at, std::span<double> size) {
        for (std::size_t i = 0; i < at.size(); ++i) size[i] = 0.1 + 0.1 * at[i].x;
      },
      0.01, context)};
  const JobResult result = run_job(options, context, "", JobKind::grid, extras);
  EXPECT_GT(result.mesh.num_cells(CellType::tetrahedron), 4 * coarse) << result.error;
}

TEST(HeldInput, a_table_with_a_main_key_takes_its_value) {
  Options options;
  set_option(options, "volume", "front");
  set_option(options, "surface", "delaunay");
  set_option(options, "improve", "false");
  set_option(options, "refine", "2");
  EXPECT_EQ(options.volume.method, "front");
  EXPECT_EQ(options.surface.method, "delaunay");
  EXPECT_FALSE(options.improve.enabled);
  EXPECT_EQ(options.refine.levels, 2);
}

}  // namespace
}  // namespace delfront
