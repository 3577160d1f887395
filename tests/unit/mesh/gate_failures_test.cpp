// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "delfront/grid_check.hpp"
#include "unit/mesh/grids.hpp"

namespace delfront {
namespace {

constexpr unsigned kSeed = 3;

/// A cube of 162 tets whose points were moved a little.
Mesh jittered_cube() {
  Mesh mesh = grids::cube(3);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> shift(-0.06, 0.06);
  for (Point& p : mesh.points) p = p + Point{shift(random), shift(random), shift(random)};
  return mesh;
}

double min_dihedral_of(const Mesh& mesh, std::size_t cell) {
  std::vector<Point> corners;
  for (const VertexId v : (*mesh.find_block(CellType::tetrahedron))[cell]) corners.push_back(mesh.points[v]);
  Context context;
  return measure_quality(grids::single_cell(CellType::tetrahedron, corners), context).find("min_dihedral")->min;
}

std::vector<Finding> failures(const Mesh& mesh, const std::string& gates) {
  Context context;
  return find_gate_failures(mesh, gates, context);
}

TEST(GateFailures, are_exactly_the_cells_that_miss_the_gate) {
  const Mesh mesh = jittered_cube();
  std::set<std::uint32_t> wanted, found;
  for (std::uint32_t cell = 0; cell < mesh.num_cells(CellType::tetrahedron); ++cell)
    if (min_dihedral_of(mesh, cell) <= 38) wanted.insert(cell);
  ASSERT_GT(wanted.size(), 12u) << "more than a report lists; seed " << kSeed;
  const std::vector<Finding> findings = failures(mesh, "min_dihedral > 38");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, "gate_min_dihedral");
  EXPECT_EQ(findings[0].count, wanted.size());
  for (const Place& place : findings[0].places) found.insert(place.ids.at(0));
  EXPECT_EQ(found, wanted);
  EXPECT_EQ(findings[0].outlines.size(), 4 * wanted.size());
  EXPECT_LE(min_dihedral_of(mesh, findings[0].places[0].ids[0]), min_dihedral_of(mesh, findings[0].places[1].ids[0]));
}

TEST(GateFailures, of_two_cells_show_the_face_between_them) {
  const Mesh mesh = jittered_cube();
  const std::vector<Finding> findings = failures(mesh, "max_nonortho < 20, volume_ratio < 1.5");
  ASSERT_EQ(findings.size(), 2u);
  const CellBlock& tets = *mesh.find_block(CellType::tetrahedron);
  for (const Finding& finding : findings) {
    ASSERT_EQ(finding.outlines.size(), finding.places.size());
    ASSERT_GT(finding.places.size(), 0u);
    for (std::size_t i = 0; i < finding.places.size(); ++i) {
      ASSERT_EQ(finding.places[i].ids.size(), 2u);
      EXPECT_EQ(finding.outlines[i].corners.size(), 3u);
      for (const std::uint32_t cell : finding.places[i].ids)
        for (const Point corner : finding.outlines[i].corners)
          EXPECT_TRUE(
              std::any_of(tets[cell].begin(), tets[cell].end(), [&](VertexId v) { return mesh.points[v] == corner; }));
    }
  }
}

TEST(GateFailures, of_edges_show_the_edges) {
  const Mesh mesh = grids::cube(2);
  const std::vector<Finding> findings = failures(mesh, "edge_length > 0.6");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].places.size(), 54u) << "3 directions, 9 lines, 2 pieces of length 0.5";
  for (const Outline& outline : findings[0].outlines)
    EXPECT_NEAR(distance(outline.corners.at(0), outline.corners.at(1)), 0.5, 1e-15);
}

TEST(GateFailures, in_the_plane_show_whole_cells) {
  const std::vector<Finding> findings = failures(grids::square(2), "min_angle > 60");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].places.size(), 4u) << "the triangles";
  for (const Outline& outline : findings[0].outlines) EXPECT_EQ(outline.corners.size(), 3u);
}

TEST(GateFailures, counts_of_cells_show_those_below_the_angle) {
  Mesh mesh = grids::regular_tet();
  mesh.points[VertexId(3)] = (mesh.points[VertexId(0)] + mesh.points[VertexId(1)] + mesh.points[VertexId(2)]) / 3 +
                             0.01 * (mesh.points[VertexId(3)] - mesh.points[VertexId(0)]);
  const std::vector<Finding> findings = failures(mesh, "cells_below_10_deg < 1, num_cells > 5");
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].places.size(), 1u);
  EXPECT_TRUE(findings[1].places.empty()) << "what is not there has no place";
}

TEST(GateFailures, none_where_all_are_met) {
  EXPECT_TRUE(failures(jittered_cube(), "").empty());
  EXPECT_TRUE(failures(jittered_cube(), "min_dihedral > 1, max_nonortho < 80").empty());
}

}  // namespace
}  // namespace delfront
