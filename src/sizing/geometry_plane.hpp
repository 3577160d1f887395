// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sizing/geometry_facets.hpp"

namespace delfront {

/// @return whether the model is one of lines in a plane z = const: curves, no triangles
bool is_in_the_plane(const Model& model);

/// @brief The segments of a model's curves, each once, and how they follow each other, as the ways of sizing look at
/// them. Which side of a segment is inside is not known.
class PlaneLines {
 public:
  explicit PlaneLines(const Model& model);

  struct Segment {
    std::array<VertexId, 2> ends;
    double length = 0;  ///< > 0
  };
  /// A way over a vertex: from one segment to the other.
  struct Passage {
    VertexId at;
    std::uint32_t in = 0, out = 0;
  };

  const Model& model;
  std::vector<Segment> segments;

  double diagonal() const { return diagonal_; }
  Point start(std::uint32_t s) const { return model.points[segments[s].ends[0]]; }
  Point end(std::uint32_t s) const { return model.points[segments[s].ends[1]]; }
  bool share_an_end(std::uint32_t s, std::uint32_t t) const;

  /// @return the way over a vertex between two segments, and no others, that turns by no more than the feature angle
  std::optional<Passage> smooth_at(VertexId v) const;
  /// @return the next such way along the line
  std::optional<Passage> next(const Passage& from) const;

  /// @return 1 / r at a vertex, positive where the line turns to the left; 0 on a straight line, to rounding
  double curvature(const Passage& here) const;
  /// @brief The same where noise is likely: no neighbour turns to the same side. The mean of the three vertices.
  double steady_curvature(const Passage& here) const;

 private:
  struct Joint {
    std::array<std::uint32_t, 2> segment{};
    int count = 0;
  };
  VertexId other_end(std::uint32_t s, VertexId v) const {
    return segments[s].ends[0] == v ? segments[s].ends[1] : segments[s].ends[0];
  }
  double through(Point a, Point b, Point c) const;
  Point reach_out(const Passage& here, double least) const;

  std::vector<Joint> joints_;  ///< by vertex
  double diagonal_ = 0, flat_ = 0, cos_corner_ = 0;
};

inline PlaneLines::Passage reversed(const PlaneLines::Passage& p) { return {p.at, p.out, p.in}; }

/// @brief find_curvature_sizes() and find_gap_sizes() for lines in the plane, with options that are checked.
GeometrySources find_plane_curvature_sizes(const Model& model, const CurvatureSizes& wish, Context& context);
GeometrySources find_plane_gap_sizes(const Model& model, const GapSizes& wish, Context& context);

}  // namespace delfront
