// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "delfront/model.hpp"
#include "spatial/bvh.hpp"

namespace delfront {

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// @brief The edges of triangles, each with the half-edges on it, and the edge of each half-edge.
///
/// Half-edge 3 t + k runs from corner k of triangle t to corner (k + 1) % 3.
class SurfaceEdges {
 public:
  SurfaceEdges() = default;
  /// @param is_used  triangles to take; others (a corner twice) have no edges here
  SurfaceEdges(const Array<TriangleId, std::array<VertexId, 3>>& triangles, const std::vector<bool>& is_used);

  std::size_t size() const { return offsets_.empty() ? 0 : offsets_.size() - 1; }
  std::span<const std::uint32_t> half_edges(std::size_t edge) const {
    return {half_edges_.data() + offsets_[edge], half_edges_.data() + offsets_[edge + 1]};
  }
  /// @brief Both ends, the lower id first.
  std::array<VertexId, 2> ends(std::size_t edge) const { return ends_[edge]; }
  std::uint32_t edge_of(std::size_t half_edge) const { return edge_of_[half_edge]; }

 private:
  std::vector<std::uint32_t> offsets_, half_edges_, edge_of_;
  std::vector<std::array<VertexId, 2>> ends_;
};

/// @brief A model's triangles as the checks see them: scaled exactly for the predicates, defective ones marked.
struct Surface {
  explicit Surface(const Model& model);

  const Model& model;
  double scale = 1;                 ///< a power of two: points = scale * model.points, exact signs are the same
  Array<VertexId, Point> points;    ///< the largest coordinate is within what predicates.hpp asks for
  std::vector<bool> has_edges;      ///< by triangle: three different corners
  std::vector<bool> is_degenerate;  ///< by triangle: no area, exactly
  std::vector<std::uint32_t> twin;  ///< by triangle: the first triangle with the same three corners; itself if none
  SurfaceEdges edges;               ///< of all triangles with three different corners

  std::size_t num_triangles() const { return model.triangles.size(); }
  const std::array<VertexId, 3>& corners(std::size_t t) const { return model.triangles[TriangleId(t)]; }
  Point corner(std::size_t t, int k) const { return points[corners(t)[std::size_t(k)]]; }
  VertexId start(std::uint32_t half_edge) const { return corners(half_edge / 3)[half_edge % 3]; }
  VertexId apex(std::uint32_t half_edge) const { return corners(half_edge / 3)[(half_edge + 2) % 3]; }
  bool is_first(std::size_t t) const { return twin[t] == t; }
  /// @brief Takes part in topology: an area, and no earlier copy.
  bool is_sound(std::size_t t) const { return !is_degenerate[t] && is_first(t); }
  /// @brief Centroid in the model's own units.
  Point centroid(std::size_t t) const;
  Box box(std::size_t t) const;
};

/// @brief Groups of a disjoint-set forest, path halving, lower root wins.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size);
  std::uint32_t find(std::uint32_t i);
  void join(std::uint32_t i, std::uint32_t j);
  /// @brief Number the groups 0, 1, … by their lowest member. @return group of each member
  std::vector<std::uint32_t> number(std::uint32_t& num_groups);

 private:
  std::vector<std::uint32_t> parent_;
};

/// @brief By triangle: was it taken away when triangles with an edge of their own only are peeled off, again and again?
///
/// Triangles without edges and later copies of a triangle go first. Nothing left: the surface encloses nothing.
std::vector<bool> peel_open_triangles(const Surface& surface);

}  // namespace delfront
