// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "delfront/errors.hpp"
#include "delfront/grid_check.hpp"
#include "unit/mesh/grids.hpp"

namespace delfront {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

const Measure& get(const QualityReport& report, const std::string& name) {
  const Measure* measure = report.find(name);
  if (!measure) throw std::runtime_error("no measure " + name);
  return *measure;
}

QualityReport quality_of(const Mesh& mesh) {
  Context context;
  return measure_quality(mesh, context);
}

TEST(Quality, regular_tetrahedron_is_perfect) {
  const QualityReport report = quality_of(grids::regular_tet());
  EXPECT_NEAR(get(report, "min_dihedral").min, 70.528779365509308, 1e-10);
  EXPECT_NEAR(get(report, "max_dihedral").max, 70.528779365509308, 1e-10);
  for (const char* name : {"mean_ratio", "radius_ratio", "aspect_ratio"}) EXPECT_NEAR(get(report, name).min, 1, 1e-14);
  EXPECT_NEAR(get(report, "edge_length").min, std::sqrt(8), 1e-14);
  EXPECT_NEAR(get(report, "skewness").max, 0, 1e-14);
  EXPECT_NEAR(report.volume, 8.0 / 3, 1e-14);
  EXPECT_EQ(report.num_boundary_faces, 4u);
  EXPECT_EQ(report.cells_below_10_deg, 0u);
}

TEST(Quality, corner_tetrahedron_has_the_known_values) {
  const QualityReport report = quality_of(grids::corner_tet());
  EXPECT_NEAR(get(report, "min_dihedral").min, std::acos(1 / std::sqrt(3.0)) * kDegrees, 1e-10);
  EXPECT_NEAR(get(report, "max_dihedral").max, 90, 1e-10);
  EXPECT_NEAR(get(report, "mean_ratio").min, 12 * std::pow(0.5, 2.0 / 3) / 9, 1e-14);
  const double inradius = 1 / (3 + std::sqrt(3.0)), circumradius = std::sqrt(3.0) / 2;
  EXPECT_NEAR(get(report, "radius_ratio").min, 3 * inradius / circumradius, 1e-14);
  EXPECT_NEAR(get(report, "aspect_ratio").max, std::sqrt(2.0) / (2 * std::sqrt(6.0) * inradius), 1e-14);
  EXPECT_NEAR(get(report, "edge_length").max, std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(report.volume, 1.0 / 6, 1e-16);
  // Sums of |area| along each axis: 1/2 of the axis' own face and 1/2 of the slanted one.
  EXPECT_NEAR(get(report, "openfoam_aspect").max, 0.5 / std::pow(1.0 / 6, 2.0 / 3), 1e-12);
}

TEST(Quality, cube_of_six_tetrahedra_has_the_known_values) {
  const QualityReport report = quality_of(grids::cube(1));
  EXPECT_EQ(report.num_cells, 6u);
  EXPECT_EQ(report.num_boundary_faces, 12u);
  EXPECT_NEAR(report.volume, 1, 1e-15);
  EXPECT_NEAR(get(report, "min_dihedral").min, 45, 1e-10);
  EXPECT_NEAR(get(report, "max_dihedral").max, 90, 1e-10);
  EXPECT_NEAR(get(report, "volume_ratio").max, 1, 1e-14);
  EXPECT_NEAR(get(report, "edge_length").min, 1, 0);
  EXPECT_NEAR(get(report, "edge_length").max, std::sqrt(3.0), 1e-15);
  const std::vector<std::size_t>& bins = get(report, "edge_length").histogram;
  EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), std::size_t{0}), 19u);  // 12 sides, 6 diagonals of faces, 1
  // Neighbours share the space diagonal: centres (1/2, 1/4, 3/4) and alike, line of centres along the normal.
  EXPECT_NEAR(get(report, "max_nonortho").max, 0, 1e-5);
}

TEST(Quality, nonorthogonality_and_skewness_follow_openfoams_definition) {
  // Two tetrahedra on one face in the plane z = 0, apexes at (a, b, +-1), the upper one shifted by `shift` along x.
  const double shift = 0.9;
  Mesh mesh;
  for (const Point p :
       {Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{0.2 + shift, 0.3, 1}, Point{0.2, 0.3, -1}})
    mesh.points.push_back(p);
  grids::add_cell(mesh, CellType::tetrahedron, {0, 1, 2, 3});
  grids::add_cell(mesh, CellType::tetrahedron, {0, 2, 1, 4});
  grids::store_boundary(mesh);
  const QualityReport report = quality_of(mesh);
  // Centres are a quarter of the apexes' way apart: d = (shift / 4, 0, 1 / 2).
  EXPECT_NEAR(get(report, "max_nonortho").max, std::atan(shift / 2) * kDegrees, 1e-10);
  EXPECT_NEAR(get(report, "max_nonortho").mean, std::atan(shift / 2) * kDegrees, 1e-10);
  EXPECT_EQ(get(report, "max_nonortho").worst.at(0).ids.size(), 2u);
  // Inner face: the line of centres meets z = 0 midway between them; the extent is that of the face.
  const Point facet{1.0 / 3, 1.0 / 3, 0};
  const Point crossing{(1.0 + 0.2) / 4 + shift / 8, (1.0 + 0.3) / 4, 0};
  const Point off = facet - crossing;
  const Point direction = off / length(off);
  double extent = 0.2 * std::hypot(shift / 4, 0.5);
  for (const int corner : {0, 1, 2})
    extent = std::max(extent, std::abs(dot(direction, mesh.points[VertexId(corner)] - facet)));
  const double expected = length(off) / extent;
  const Measure& skewness = get(report, "skewness");
  bool is_found = false;
  for (std::size_t i = 0; i < skewness.worst.size(); ++i)
    if (skewness.worst[i].ids.size() == 2) {
      EXPECT_NEAR(skewness.worst_values[i], expected, 1e-12);
      is_found = true;
    }
  EXPECT_TRUE(is_found);
  EXPECT_EQ(skewness.worst.size(), 7u);
}

TEST(Quality, boundary_skewness_follows_openfoams_definition) {
  // Bottom face of a slanted tetrahedron: the normal through the cell's centre misses the face's centre.
  const Mesh mesh = grids::single_cell(CellType::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {4, 0, 1}});
  const Point facet{1.0 / 3, 1.0 / 3, 0}, cell{1.25, 0.25, 0.25};
  const Point off = facet - Point{cell.x, cell.y, 0};
  double extent = 0.4 * cell.z;
  for (const int corner : {0, 1, 2})
    extent = std::max(extent, std::abs(dot(off / length(off), mesh.points[VertexId(corner)] - facet)));
  double nearest = 1e300;
  const QualityReport report = quality_of(mesh);
  for (const double value : get(report, "skewness").worst_values)
    nearest = std::min(nearest, std::abs(value - length(off) / extent));
  EXPECT_LT(nearest, 1e-12);
}

TEST(Quality, mixed_cells_have_volumes_and_right_angles) {
  const QualityReport report = quality_of(grids::mixed_cells());
  EXPECT_EQ(report.num_cells, 4u);
  // Hexahedron 1, pyramid 0.7 / 3, prism 1/2, tetrahedron with base of area 1/2 on y = 1, height 1.
  EXPECT_NEAR(report.volume, 1 + 0.7 / 3 + 0.5 + 0.5 / 3, 1e-12);
  const Mesh hexahedron = grids::single_cell(
      CellType::hexahedron, {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {0, 1, 1}});
  EXPECT_NEAR(get(quality_of(hexahedron), "min_dihedral").min, 90, 1e-10);
  EXPECT_NEAR(get(quality_of(hexahedron), "max_dihedral").max, 90, 1e-10);
  EXPECT_NEAR(quality_of(hexahedron).volume, 2, 1e-14);
  EXPECT_NEAR(get(quality_of(hexahedron), "openfoam_aspect").max, 2, 1e-12);
}

TEST(Quality, worst_cells_come_first_with_their_places) {
  Mesh mesh = grids::cube(4);
  const std::uint32_t middle = 62;
  mesh.points[VertexId(middle)].x += 0.24;  // almost onto its neighbour
  const QualityReport report = quality_of(mesh);
  const Measure& measure = get(report, "min_dihedral");
  ASSERT_EQ(measure.worst.size(), 10u);
  EXPECT_EQ(measure.worst_values[0], measure.min);
  for (std::size_t i = 1; i < 10; ++i) EXPECT_LE(measure.worst_values[i - 1], measure.worst_values[i]);
  EXPECT_LT(distance(measure.worst[0].at, mesh.points[VertexId(middle)]), 0.3);
  EXPECT_LT(measure.worst[0].ids.at(0), report.num_cells);
  EXPECT_GT(report.cells_below_10_deg, 0u);
  std::size_t in_first_bin = measure.histogram[0];  // [0, 5) degrees
  EXPECT_EQ(in_first_bin, report.cells_below_5_deg);
}

TEST(Quality, plane_grids_have_angles) {
  const QualityReport report = quality_of(grids::square(4));
  EXPECT_NEAR(report.volume, 1, 1e-14);
  EXPECT_NEAR(get(report, "min_angle").min, 45, 1e-10);
  EXPECT_NEAR(get(report, "max_angle").max, 90, 1e-10);
  EXPECT_NEAR(get(report, "mean_ratio").min, std::sqrt(3.0) / 2, 1e-14);
  EXPECT_NEAR(get(report, "volume_ratio").max, 2, 1e-12);
  EXPECT_EQ(report.num_boundary_faces, 16u);
  EXPECT_EQ(report.find("min_dihedral"), nullptr);
}

TEST(Quality, refuses_indices_out_of_range) {
  Mesh mesh = grids::cube(1);
  mesh.block(CellType::tetrahedron).vertices[3] = VertexId(99);
  EXPECT_THROW(quality_of(mesh), InputError);
}

TEST(Gates, say_what_is_not_met) {
  const QualityReport report = quality_of(grids::cube(2));
  EXPECT_TRUE(failed_gates(report, "").empty());
  EXPECT_TRUE(failed_gates(report, " min_dihedral>8 , max_nonortho < 70,volume_ratio<=1.001").empty());
  const auto failed = failed_gates(report, "min_dihedral > 50, max_dihedral<=100, edge_length>1, cells_below_5_deg<1");
  ASSERT_EQ(failed.size(), 2u);
  EXPECT_EQ(failed[0].find("min_dihedral is 45 deg, wanted > 50; the worst is near ("), 0u) << failed[0];
  EXPECT_EQ(failed[1].find("edge_length is 0.5, wanted > 1"), 0u) << failed[1];
}

TEST(Gates, a_measure_without_values_is_met) {
  EXPECT_TRUE(failed_gates(quality_of(grids::regular_tet()), "max_nonortho<70, volume_ratio<2").empty());
}

std::string message_of(const std::string& gates) {
  try {
    failed_gates(quality_of(grids::regular_tet()), gates);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Gates, malformed_ones_are_usage_errors) {
  EXPECT_NE(message_of("min_dihedrl > 8").find("did you mean 'min_dihedral'?"), std::string::npos);
  EXPECT_NE(message_of("min_angle > 8").find("not made for grids of this kind"), std::string::npos);
  EXPECT_NE(message_of("min_dihedral").find("no comparison"), std::string::npos);
  EXPECT_NE(message_of("min_dihedral = 8").find("not a comparison"), std::string::npos);
  EXPECT_NE(message_of("min_dihedral > eight").find("not a number"), std::string::npos);
  EXPECT_NE(message_of("min_dihedral > 8 deg").find("not a number"), std::string::npos);
  EXPECT_NE(message_of("min_dihedral > nan").find("not a number"), std::string::npos);
  EXPECT_NE(message_of("> 8").find("no measure"), std::string::npos);
  EXPECT_NE(message_of("min_dihedral > 8,,max_nonortho<70").find("no comparison"), std::string::npos);
}

}  // namespace
}  // namespace delfront
