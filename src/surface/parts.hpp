// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "delfront/model.hpp"
#include "delfront/size_field.hpp"
#include "geometry/surface.hpp"

namespace delfront {

/// @brief A feature line: a chain of edges of the given triangles between two corners, or a loop.
struct SurfaceLine {
  std::vector<VertexId> vertices;    ///< a loop names its first vertex again at its end
  std::vector<std::uint32_t> edges;  ///< of SurfaceEdges, one fewer than vertices
  bool is_loop = false;              ///< without corners
};

/// @brief A side of a region on a line: the region lies to the left of the line, or of the line run backwards.
struct RegionSide {
  std::uint32_t line = 0;
  bool is_backward = false;
  std::vector<std::uint32_t> triangles;  ///< of the region, one an edge of the line, in the order of line.edges
};

/// @brief A connected piece of the surface between feature lines, of one patch and one orientation.
struct SurfaceRegion {
  PatchId patch;
  std::vector<std::uint32_t> triangles;
  std::vector<RegionSide> sides;
  bool is_simple = true;  ///< no line runs twice in the same direction: else its sides cannot be told apart
};

/// @brief Lines, corners and regions of a model's surface.
struct SurfaceParts {
  explicit SurfaceParts(const Model& model, const SizeField& size, Context& context);

  const Model& model;
  SurfaceEdges edges;
  std::vector<Point> normal;     ///< by triangle; slivers have that of the neighbour over their longest edge
  std::vector<bool> is_feature;  ///< by edge
  std::vector<bool> is_corner;   ///< where lines end, meet or turn sharply, and given corners
  std::vector<SurfaceLine> lines;
  std::vector<std::uint32_t> line_of_edge;  ///< or kNoTriangle
  std::vector<SurfaceRegion> regions;
  std::vector<std::uint32_t> region_of_triangle;

  Point corner(std::size_t t, std::size_t k) const { return model.points[model.triangles[TriangleId(t)][k]]; }
  VertexId start(std::uint32_t half_edge) const { return model.triangles[TriangleId(half_edge / 3)][half_edge % 3]; }
  /// @brief The edge of triangles on a given curve, or kNoTriangle where the curve runs through the volume.
  std::uint32_t edge_between(VertexId a, VertexId b) const;

 private:
  void find_normals();
  void smooth_slivers();
  void find_features();
  void close_gaps(const std::vector<double>& turn);
  bool is_by_angle(std::size_t edge) const;
  void drop_short_creases(const SizeField& size);
  void mark_curve_corners(const Curve& curve);
  void find_corners();
  void find_lines();
  void find_regions();
  void find_sides();
  std::vector<std::vector<std::uint32_t>> features_at_vertices() const;
  VertexId other_end(std::uint32_t edge, VertexId v) const;
  std::unordered_map<std::uint64_t, std::uint32_t> curve_edges_;  ///< of the triangles' edges on given curves
  std::vector<std::uint32_t> given_curve_;  ///< by edge: a curve of the model on it, or kNoTriangle
};

}  // namespace delfront
