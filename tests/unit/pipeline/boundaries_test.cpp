// SPDX-License-Identifier: Apache-2.0
#include "pipeline/boundaries.hpp"

#include <gtest/gtest.h>

#include "delfront/errors.hpp"

namespace delfront {
namespace {

Model model_with_patches(const std::vector<std::string>& names) {
  Model model;
  model.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    model.patches.push_back({names[i], i == 0 ? "inlet" : ""});
    model.triangles.push_back({VertexId(0), VertexId(1), VertexId(2)});
    model.patch_of_triangle.push_back(PatchId(i));
  }
  return model;
}

std::vector<std::string> names_of_triangles(const Model& model) {
  std::vector<std::string> names;
  for (const PatchId patch : model.patch_of_triangle) names.push_back(model.patches[patch].name);
  return names;
}

TEST(ApplyBoundaries, merges_what_a_pattern_selects_and_keeps_the_rest) {
  Model model = model_with_patches({"OML_top", "hub", "OML_low", "tip"});
  apply_boundaries({{"wing", {"OML*"}, "wall"}, {"tip", {}, "symmetry"}}, model);
  EXPECT_EQ(names_of_triangles(model), (std::vector<std::string>{"wing", "hub", "wing", "tip"}));
  ASSERT_EQ(model.patches.size(), 3u);
  EXPECT_EQ(model.patches[model.patch_of_triangle[TriangleId(0)]].kind, "wall");
  EXPECT_EQ(model.patches[model.patch_of_triangle[TriangleId(1)]].kind, "");
  EXPECT_EQ(model.patches[model.patch_of_triangle[TriangleId(3)]].kind, "symmetry");
}

TEST(ApplyBoundaries, the_later_of_two_gets_the_patch_and_a_kind_of_the_input_stays) {
  Model model = model_with_patches({"a1", "a2"});
  apply_boundaries({{"all", {"a*"}, ""}, {"second", {"a2"}, ""}}, model);
  EXPECT_EQ(names_of_triangles(model), (std::vector<std::string>{"all", "second"}));
  EXPECT_EQ(model.patches[model.patch_of_triangle[TriangleId(0)]].kind, "inlet");
}

TEST(ApplyBoundaries, a_selector_that_matches_nothing_names_what_there_is) {
  Model model = model_with_patches({"body", "ground"});
  try {
    apply_boundaries({{"bodi", {}, "wall"}}, model);
    FAIL() << "accepted";
  } catch (const UsageError& e) {
    const std::string message = e.what();
    EXPECT_NE(message.find("did you mean 'body'?"), std::string::npos) << message;
    EXPECT_NE(message.find("body, ground"), std::string::npos) << message;
  }
}

TEST(SurfaceMesh, keeps_points_triangles_and_patches) {
  const Model model = model_with_patches({"a", "b"});
  const Mesh mesh = surface_mesh(model);
  EXPECT_EQ(mesh.points.size(), 3u);
  ASSERT_EQ(mesh.num_cells(CellType::triangle), 2u);
  EXPECT_EQ(mesh.groups[mesh.find_block(CellType::triangle)->group[1]].name, "b");
  EXPECT_EQ(mesh.groups[GroupId(0)].kind, "inlet");
}

}  // namespace
}  // namespace delfront
