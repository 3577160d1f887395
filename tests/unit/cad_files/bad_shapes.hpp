// SPDX-License-Identifier: Apache-2.0
// Shapes with one thing wrong, by OpenCASCADE's builder, which makes what it is told to.
#pragma once
#include <TopoDS_Shape.hxx>
#include <cstddef>
#include <string>

namespace delfront::occ {

/// @brief A solid of a box whose shell lacks its last face.
TopoDS_Shape box_with_a_face_missing();
/// @brief A square face whose outer wire is a figure of eight.
TopoDS_Shape crossing_wire();
/// @brief A box, one edge of whose top is interrupted by one of this length, between two vertices.
TopoDS_Shape box_with_a_tiny_edge(double length);
/// @brief A cylinder; on its side the parameter curve of one ring is moved by this along v.
TopoDS_Shape cylinder_with_a_moved_parameter_curve(double by);
/// @brief The same face twice in one shell; copied: with edges of its own.
TopoDS_Shape box_with_a_double_face(bool is_copied);
/// @brief A box whose faces all look inwards.
TopoDS_Shape inside_out_box();
/// @brief A box, one face of whose shell is turned against the others.
TopoDS_Shape box_with_a_turned_face();
/// @brief Two boxes of 1 that have a layer in common.
TopoDS_Shape overlapping_boxes(double layer);
/// @brief A box and a sheet that goes through it and out on all sides.
TopoDS_Shape sheet_through_a_box();
/// @brief A box and an edge somewhere in space.
TopoDS_Shape box_and_an_edge();
TopoDS_Shape empty_compound();
TopoDS_Shape curves_only();
/// @brief A box with a vertex moved to a place that is no number, or far away.
TopoDS_Shape box_with_a_corner_at(double x);
/// @brief A box as far away as this.
TopoDS_Shape box_at(double x);
/// @brief A box with an edge within its top, which bounds nothing.
TopoDS_Shape box_with_an_inner_edge();

/// @brief An assembly of n boxes of 1, in a row of rows, as instances of one product.
/// @param gap  between them; 0: they touch
void write_boxes(std::size_t n, double gap, const std::string& path);

}  // namespace delfront::occ
