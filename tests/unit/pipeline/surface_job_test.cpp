// SPDX-License-Identifier: Apache-2.0
// surface.method through generate() and run_job().
#include "pipeline/surface_job.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "delfront/generate.hpp"
#include "delfront/io.hpp"
#include "delfront/job.hpp"
#include "support/support.hpp"

namespace delfront {
namespace {

Model cube() {
  Context context;
  return build_model({{fixtures::cube_surface(), "cube"}}, context);
}

std::size_t boundary_faces(const Mesh& mesh) { return mesh.num_cells_of_dimension(2); }

TEST(SurfaceJob, GenerateFillsANewSurface) {
  for (const std::string method : {"front", "delaunay"}) {
    Options options;
    options.surface.method = method;
    options.size.hmax = Length{0.25, ""};
    Context context;
    const Outcome outcome = generate(cube(), options, context);
    EXPECT_TRUE(outcome.report.surface_grid.fallbacks.empty());
    EXPECT_EQ(boundary_faces(outcome.mesh), outcome.report.surface_grid.triangles);
    EXPECT_EQ(outcome.report.surface.num_triangles, outcome.report.surface_grid.triangles);
    EXPECT_GT(boundary_faces(outcome.mesh), 12u * 12u);
    EXPECT_NEAR(outcome.report.quality.volume, 1, 1e-9);
    EXPECT_TRUE(outcome.report.warnings.empty());
    for (const char* name : {"xmin", "zmax"}) EXPECT_TRUE(outcome.mesh.find_group(2, name).is_valid());
  }
}

TEST(SurfaceJob, KeepIsTheDefault) {
  Options options;
  options.size.hmax = Length{0.25, ""};
  Context context;
  const Outcome outcome = generate(cube(), options, context);
  EXPECT_EQ(boundary_faces(outcome.mesh), 12u);
  EXPECT_EQ(outcome.report.surface_grid.triangles, 0u);
}

TEST(SurfaceJob, WithoutAnyWishSidesAreAsLongAsGivenOnes) {
  Options options;
  options.surface.method = "front";
  Context context;
  Model model = build_model({{fixtures::sphere_surface(3), "ball"}}, context);
  const std::size_t given = model.triangles.size();
  SurfaceGridReport report;
  regrid_as_asked(model, options, *surface_sizes(model, options, nullptr), report, context);
  EXPECT_NEAR(double(model.triangles.size()) / double(given), 1, 0.15);
}

class SurfaceRun : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fixtures::scratch_folder();
    Context context;
    write_mesh(fixtures::cube_surface(), (folder_ / "cube.vtp").string(), context, {}, "");
    options_.input.files = {(folder_ / "cube.vtp").string()};
    options_.surface.method = "front";
  }
  Mesh run(const std::string& name) {
    options_.output.files = {(folder_ / name).string()};
    Context context;
    result_ = run_job(options_, context, "test");
    EXPECT_EQ(result_.exit_code, ExitCode::done) << result_.error;
    return read_mesh(options_.output.files[0], context);
  }

  std::filesystem::path folder_;
  Options options_;
  JobResult result_;
};

TEST_F(SurfaceRun, StopAfterSurfaceWritesWhatTheGridWouldHave) {
  options_.size.hmax = Length{20, "%"};
  options_.stop_after = "surface";
  const std::size_t alone = boundary_faces(run("surface.vtp"));
  options_.stop_after.clear();
  const Mesh grid = run("grid.vtu");
  EXPECT_EQ(alone, boundary_faces(grid));
  EXPECT_GT(alone, 12u);
}

TEST_F(SurfaceRun, TheFarFieldKeepsItsTriangles) {
  options_.domain.enclose.shape = "box";
  options_.domain.enclose.size = Length{3, ""};
  options_.stop_after = "surface";
  options_.surface.method = "keep";
  const Mesh kept = run("kept.vtp");
  options_.surface.method = "front";
  options_.size.on = {{"x*", Length{0.1, ""}}};
  const Mesh made = run("made.vtp");
  const auto far_faces = [](const Mesh& mesh) {
    const GroupId group = mesh.find_group(2, "farfield");
    std::size_t count = 0;
    for (const CellBlock& block : mesh.blocks)
      if (dimension(block.type) == 2) count += std::size_t(std::count(block.group.begin(), block.group.end(), group));
    return count;
  };
  EXPECT_GT(far_faces(kept), 0u);
  EXPECT_EQ(far_faces(kept), far_faces(made));
  EXPECT_GT(boundary_faces(made) - far_faces(made), 2u * 200u);
}

}  // namespace
}  // namespace delfront
