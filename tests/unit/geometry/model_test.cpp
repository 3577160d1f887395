// SPDX-License-Identifier: Apache-2.0
#include "delfront/model.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/support.hpp"
#include "surface_fixtures.hpp"

namespace delfront {
namespace {

using fixtures::facets;
using fixtures::model_of;

TEST(BuildModel, welds_exactly_first_occurrence_wins_and_minus_zero_is_zero) {
  const Model model = model_of(
      facets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, -0.0}, {-0.0, 1, 0}, {1, 1, 1e-300}}, {{0, 1, 2}, {4, 3, 5}}));
  ASSERT_EQ(model.points.size(), 4u) << "1e-300 is another place than 0";
  EXPECT_EQ(model.points[VertexId(3)], (Point{1, 1, 1e-300}));
  EXPECT_EQ(model.triangles[TriangleId(1)], (std::array{VertexId(2), VertexId(1), VertexId(3)}));
}

TEST(BuildModel, keeps_the_order_of_triangles_and_drops_nothing) {
  const Model model = model_of(facets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 2}, {0, 1, 1}, {2, 1, 0}}));
  ASSERT_EQ(model.triangles.size(), 4u);
  for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(model.input_face[TriangleId(t)], t);
  EXPECT_EQ(model.triangles[TriangleId(2)][1], model.triangles[TriangleId(2)][2]);
}

TEST(BuildModel, names_patches_by_group_by_stem_and_without_doubles) {
  Mesh mesh = fixtures::cube_surface();
  mesh.groups[GroupId(1)].name = "";
  mesh.groups[GroupId(0)].kind = "wall";
  mesh.block(CellType::triangle).group.back() = GroupId();
  Context context;
  const Model model = build_model({{mesh, "cube"}, {mesh, "cube"}}, context);
  std::vector<std::string> names;
  for (const Patch& patch : model.patches) names.push_back(patch.name);
  const std::vector<std::string> expected = {"xmin",   "cube",   "ymin",   "ymax",   "zmin",   "zmax",   "cube_2",
                                             "xmin_2", "cube_3", "ymin_2", "ymax_2", "zmin_2", "zmax_2", "cube_4"};
  EXPECT_EQ(names, expected);
  EXPECT_EQ(model.patches[PatchId(0)].kind, "wall");
  EXPECT_EQ(model.points.size(), 8u) << "inputs are welded with each other";
  EXPECT_EQ(model.input_face[TriangleId(23)], 23u) << "faces are numbered through";
}

TEST(BuildModel, cuts_polygons_and_remembers_their_faces) {
  Mesh mesh = facets({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {5, 5, 5}}, {});
  mesh.blocks.clear();
  CellBlock& polygons = mesh.block(CellType::polygon);
  for (std::size_t v : {0, 1, 2, 3, 4}) polygons.vertices.push_back(VertexId(v));
  polygons.offsets = {0, 5};
  CellBlock& quads = mesh.block(CellType::quad);
  for (std::size_t v : {0, 2, 3, 4}) quads.vertices.push_back(VertexId(v));
  const Model model = model_of(mesh);
  ASSERT_EQ(model.triangles.size(), 5u);
  EXPECT_EQ(model.points.size(), 5u) << "points of no face are left out";
  const std::vector<std::uint32_t> faces(model.input_face.begin(), model.input_face.end());
  EXPECT_EQ(faces, (std::vector<std::uint32_t>{0, 0, 0, 1, 1}));
}

TEST(BuildModel, refuses_what_is_not_finite_with_places) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  try {
    model_of(facets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}, {2, -inf, 0}}, {{0, 1, 2}, {0, 1, 3}, {1, 2, 4}}));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    ASSERT_EQ(error.places.size(), 2u);
    EXPECT_EQ(error.places[0].ids, std::vector<std::uint32_t>{1});
    EXPECT_EQ(error.places[1].ids, std::vector<std::uint32_t>{2});
    EXPECT_NE(std::string(error.what()).find("2 faces"), std::string::npos) << error.what();
  }
  const Model kept = model_of(facets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}}, {{0, 1, 2}}));
  EXPECT_EQ(kept.points.size(), 3u) << "a bad point of no face does no harm";
}

TEST(BuildModel, refuses_no_faces_and_damaged_indices) {
  Context context;
  EXPECT_THROW(build_model({}, context), InputError);
  EXPECT_THROW(model_of(facets({{0, 0, 0}}, {})), InputError);
  EXPECT_THROW(model_of(facets({{0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}})), InputError);
}

}  // namespace
}  // namespace delfront
