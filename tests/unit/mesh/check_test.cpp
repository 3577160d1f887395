// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "delfront/grid_check.hpp"
#include "unit/mesh/grids.hpp"

namespace delfront {
namespace {

using grids::add_cell;

/// The kinds of all findings, one after the other.
std::string kinds(const std::vector<Finding>& findings) {
  std::string all;
  for (const Finding& finding : findings) all += (all.empty() ? "" : " ") + finding.kind;
  return all;
}

const Finding& find(const std::vector<Finding>& findings, const std::string& kind) {
  static const Finding kNothing;
  for (const Finding& finding : findings)
    if (finding.kind == kind) return finding;
  ADD_FAILURE() << "no " << kind << " among: " << kinds(findings);
  return kNothing;
}

TEST(Check, finds_nothing_in_valid_grids) {
  EXPECT_EQ(kinds(check(grids::regular_tet())), "");
  EXPECT_EQ(kinds(check(grids::cube(1))), "");
  EXPECT_EQ(kinds(check(grids::cube(4))), "");
  EXPECT_EQ(kinds(check(grids::mixed_cells())), "");
  EXPECT_EQ(kinds(check(grids::square(5))), "");
}

TEST(Check, lines_are_edges_of_cells) {
  Mesh mesh = grids::cube(1);  // six tets around the diagonal from (0, 0, 0) to (1, 1, 1)
  const auto at = [&](Point p) {
    return VertexId(
        static_cast<std::size_t>(std::find(mesh.points.begin(), mesh.points.end(), p) - mesh.points.begin()));
  };
  std::vector<VertexId>& lines = mesh.block(CellType::line).vertices;
  lines = {at({1, 1, 1}), at({0, 0, 0}), at({0, 0, 0}), at({1, 0, 0})};
  EXPECT_EQ(kinds(check(mesh)), "");
  lines.insert(lines.end(), {at({1, 0, 0}), at({0, 1, 1})});
  const std::vector<Finding> findings = check(mesh);
  EXPECT_EQ(kinds(findings), "loose_lines");
  EXPECT_EQ(find(findings, "loose_lines").count, 1u);
  EXPECT_EQ(find(findings, "loose_lines").places[0].at, (Point{0.5, 0.5, 0.5}));
}

TEST(Check, decides_orientation_exactly) {
  // Offset so far that the tetrahedron is one unit in the last place high.
  const double x = 1e6, up = std::nextafter(x, 2 * x);
  Mesh mesh =
      grids::single_cell(CellType::tetrahedron, {{x, x, x}, {x + 1, x, x}, {x, x + 1, x}, {x + 0.25, x + 0.25, up}});
  EXPECT_EQ(kinds(check(mesh)), "");
  mesh.points[VertexId(3)].z = x;
  EXPECT_EQ(kinds(check(mesh)), "flat_cell");
  mesh.points[VertexId(3)].z = std::nextafter(x, 0);
  EXPECT_EQ(kinds(check(mesh)), "inverted_cell");
}

TEST(Check, decides_at_any_scale) {
  for (const double scale : {1e-100, 1e-30, 1e30, 1e100}) {
    Mesh mesh = grids::cube(2);
    for (Point& p : mesh.points) p = scale * p;
    EXPECT_EQ(kinds(check(mesh)), "") << scale;
  }
}

TEST(Check, rejects_an_inverted_tet_and_says_where) {
  Mesh mesh = grids::cube(2);
  auto& vertices = mesh.block(CellType::tetrahedron).vertices;
  std::swap(vertices[4 * 17], vertices[4 * 17 + 1]);
  const auto findings = check(mesh);
  EXPECT_EQ(find(findings, "inverted_cell").count, 1u);
  EXPECT_EQ(find(findings, "inverted_cell").places.at(0).ids.at(0), 17u);
  EXPECT_EQ(find(findings, "inverted_cell").severity, Severity::error);
  EXPECT_NE(find(findings, "inverted_cell").message.find("id 17"), std::string::npos);
}

TEST(Check, rejects_a_cell_pulled_inside_out_though_all_faces_fit) {
  Mesh mesh = grids::cube(2);
  mesh.points[VertexId(13)] = {1.5, 0.5, 0.5};  // the middle point, out of the cube
  EXPECT_EQ(kinds(check(mesh)), "inverted_cell");
}

TEST(Check, rejects_inverted_cells_of_every_type) {
  for (const CellType type : {CellType::pyramid, CellType::prism, CellType::hexahedron}) {
    Mesh mesh = grids::mixed_cells();
    auto& v = mesh.block(type).vertices;
    if (type == CellType::pyramid)
      std::swap(v[1], v[3]);
    else
      std::swap_ranges(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2),
                       v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2));
    EXPECT_EQ(find(check(mesh), "inverted_cell").count, 1u) << name_of(type);
  }
}

TEST(Check, rejects_a_hexahedron_with_one_dented_corner) {
  std::vector<Point> p = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  EXPECT_EQ(kinds(check(grids::single_cell(CellType::hexahedron, p))), "");
  p[6] = {0.2, 0.2, 0.2};
  EXPECT_EQ(kinds(check(grids::single_cell(CellType::hexahedron, p))), "inverted_cell");
}

TEST(Check, rejects_a_boundary_face_that_is_not_stored) {
  Mesh mesh = grids::cube(2);
  auto& vertices = mesh.block(CellType::triangle).vertices;
  vertices.resize(vertices.size() - 6);
  const auto findings = check(mesh);
  EXPECT_EQ(kinds(findings), "missing_boundary_facets");
  EXPECT_EQ(findings[0].count, 2u);
}

TEST(Check, rejects_a_hole_where_a_cell_is_missing) {
  Mesh mesh = grids::cube(3);
  auto& vertices = mesh.block(CellType::tetrahedron).vertices;
  const std::size_t middle = 6 * 13;  // in the cube at the centre: all its faces were inner ones
  vertices.erase(vertices.begin() + 4 * middle, vertices.begin() + 4 * (middle + 1));
  const auto findings = check(mesh);
  EXPECT_EQ(kinds(findings), "missing_boundary_facets");
  EXPECT_EQ(findings[0].count, 4u);
}

TEST(Check, rejects_a_stored_face_that_is_none_and_one_stored_twice) {
  Mesh mesh = grids::cube(2);
  add_cell(mesh, CellType::triangle, {0, 13, 26});
  EXPECT_EQ(kinds(check(mesh)), "loose_facets");
  mesh = grids::cube(2);
  auto& vertices = mesh.block(CellType::triangle).vertices;
  const std::vector<VertexId> first(vertices.begin(), vertices.begin() + 3);
  vertices.insert(vertices.end(), first.begin(), first.end());
  EXPECT_EQ(kinds(check(mesh)), "repeated_boundary_facets");
}

TEST(Check, warns_of_a_stored_face_that_points_inwards) {
  Mesh mesh = grids::cube(2);
  std::swap(mesh.block(CellType::triangle).vertices[0], mesh.block(CellType::triangle).vertices[1]);
  const auto findings = check(mesh);
  EXPECT_EQ(kinds(findings), "turned_boundary_facets");
  EXPECT_FALSE(has_errors(findings));
}

TEST(Check, accepts_stored_inner_faces) {
  Mesh mesh = grids::cube(1);
  add_cell(mesh, CellType::triangle, {0, 1, 7});  // two of the six tetrahedra share it
  EXPECT_EQ(kinds(check(mesh)), "");
}

TEST(Check, rejects_a_face_with_three_cells) {
  Mesh mesh = grids::corner_tet();
  mesh.points.push_back({1, 1, 1});
  mesh.points.push_back({2, 2, 2});
  add_cell(mesh, CellType::tetrahedron, {1, 2, 3, 4});
  add_cell(mesh, CellType::tetrahedron, {1, 2, 3, 5});
  EXPECT_EQ(find(check(mesh), "overfull_facets").count, 1u);
}

TEST(Check, rejects_a_fold_whose_cells_lie_on_the_same_side) {
  Mesh mesh;
  for (const Point p : {Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}, Point{0.1, 0.1, 0.5}})
    mesh.points.push_back(p);
  add_cell(mesh, CellType::tetrahedron, {0, 1, 2, 3});
  add_cell(mesh, CellType::tetrahedron, {0, 1, 2, 4});
  grids::store_boundary(mesh);
  const auto findings = check(mesh);
  EXPECT_EQ(kinds(findings), "overlapping_cells");
  EXPECT_EQ(findings[0].places.at(0).ids, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(Check, notes_an_edge_where_the_boundary_touches_itself) {
  Mesh mesh = grids::corner_tet();
  mesh.blocks.resize(1);
  mesh.points.push_back({0, -1, 0});
  mesh.points.push_back({0, 0, -1});
  add_cell(mesh, CellType::tetrahedron, {0, 1, 4, 5});  // shares the edge 0-1
  grids::store_boundary(mesh);
  const auto findings = check(mesh);
  EXPECT_EQ(kinds(findings), "nonmanifold_edges");
  EXPECT_FALSE(has_errors(findings));
}

TEST(Check, rejects_faces_that_do_not_fit) {
  // A quad against two triangles: the hexahedron's side is not the side of the two tetrahedra.
  Mesh mesh = grids::mixed_cells();
  mesh.blocks.clear();
  add_cell(mesh, CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  add_cell(mesh, CellType::tetrahedron, {4, 5, 6, 8});
  add_cell(mesh, CellType::tetrahedron, {4, 6, 7, 8});
  mesh.points.resize(9);
  EXPECT_NE(kinds(check(mesh)), "");
}

TEST(Check, rejects_doubled_and_unused_points) {
  Mesh mesh = grids::cube(2);
  mesh.points.push_back({9, 9, 9});
  EXPECT_EQ(kinds(check(mesh)), "unused_points");
  EXPECT_EQ(check(mesh)[0].places.at(0).ids.at(0), 27u);
  mesh = grids::cube(1);
  // The tetrahedra of one cube get a point of their own at the place of point 7, with the sign of zero turned.
  mesh.points.push_back(mesh.points[VertexId(0)]);
  mesh.points.back().x = -0.0;
  mesh.block(CellType::tetrahedron).vertices[0] = VertexId(8);
  EXPECT_EQ(find(check(mesh), "doubled_points").count, 1u);
  EXPECT_EQ(find(check(mesh), "doubled_points").places.at(0).ids.at(0), 8u);
}

TEST(Check, rejects_unsound_arrays) {
  Mesh mesh = grids::cube(1);
  mesh.block(CellType::tetrahedron).vertices[5] = VertexId(8);
  EXPECT_EQ(kinds(check(mesh)), "index_out_of_range");
  EXPECT_EQ(check(mesh)[0].places.at(0).ids.at(0), 1u);
  mesh = grids::cube(1);
  mesh.block(CellType::triangle).vertices[3] = VertexId();
  EXPECT_EQ(kinds(check(mesh)), "index_out_of_range");
  mesh = grids::cube(1);
  mesh.block(CellType::tetrahedron).vertices.pop_back();
  EXPECT_EQ(find(check(mesh), "bad_block").count, 1u);
  mesh = grids::cube(1);
  mesh.block(CellType::tetrahedron).group.assign(6, GroupId(3));
  EXPECT_EQ(kinds(check(mesh)), "bad_block");
  mesh = grids::cube(1);
  mesh.points[VertexId(2)].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(kinds(check(mesh)), "not_finite");
  EXPECT_EQ(kinds(check(Mesh{})), "no_cells");
}

TEST(Check, rejects_a_repeated_vertex) {
  Mesh mesh = grids::cube(1);
  mesh.block(CellType::tetrahedron).vertices[1] = mesh.block(CellType::tetrahedron).vertices[0];
  EXPECT_EQ(find(check(mesh), "repeated_vertex").count, 1u);
}

TEST(Check, E1_E2_plane_grids_run_anticlockwise_and_store_their_border) {
  Mesh mesh = grids::square(4);
  auto& quads = mesh.block(CellType::quad).vertices;
  std::reverse(quads.begin(), quads.begin() + 4);
  EXPECT_EQ(find(check(mesh), "inverted_cell").count, 1u);
  EXPECT_GT(find(check(mesh), "overlapping_cells").count, 0u);

  mesh = grids::square(4);
  mesh.block(CellType::line).vertices.resize(2 * 15);
  EXPECT_EQ(kinds(check(mesh)), "missing_boundary_facets");

  mesh = grids::square(4);
  mesh.points[VertexId(6)] = {0.6, 0.6, 0};  // a quad with a dent
  EXPECT_GT(find(check(mesh), "inverted_cell").count, 0u);

  mesh = grids::square(4);
  mesh.points[VertexId(12)].z = 0.5;
  EXPECT_EQ(kinds(check(mesh)), "points_off_plane");
}

}  // namespace
}  // namespace delfront
