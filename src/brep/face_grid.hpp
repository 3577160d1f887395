// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "brep/wanted_size.hpp"
#include "delfront/brep.hpp"

namespace delfront {

inline constexpr std::uint32_t kNoVertex = 0xffffffffu;

/// @brief The points of an edge from its range's beginning to its end; vertices are numbered over the whole Brep.
struct EdgePoints {
  std::vector<double> t;
  std::vector<Point> at;
  std::vector<std::uint32_t> vertex;
};

/// @brief A point of a face's grid. Those on a seam stand twice, one period apart.
struct FacePoint {
  Point at;
  Point2 uv;
  std::uint32_t vertex = kNoVertex;  ///< of the Brep's edges; kNoVertex: the face's own
  bool is_pole = false;              ///< uv says nothing along the degenerate side
  bool is_vague = false;             ///< the surface's normal there says nothing of triangles
};

/// @brief A face's points and loops in its parameter plane, and later its triangles.
struct FaceGrid {
  std::vector<FacePoint> points;                  ///< those of the loops first
  std::vector<std::vector<std::uint32_t>> loops;  ///< points, the face to the left
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool is_mapped = false;
  std::string gave_up;  ///< why there are no triangles; empty: there are
  Point gave_up_at;
  bool is_border_wrong = false;  ///< that is why: sizes have no part in it
  std::string why_direct;        ///< why it is not mapped in even charts
  Point up;                      ///< of a flat chart: the side that the face shows, wherever its mapping folds; else 0
  bool is_folded = false;        ///< normals that are against it were met
  double largest_distance = 0;   ///< of triangles' middles from the surface
  double largest_angle = 0;      ///< between normals of triangles and surface, radians

  /// @brief A normal of the surface, turned round where the mapping folds.
  Point facing(Point normal) const { return dot(normal, up) < 0 ? Point{} - normal : normal; }

  void fail(const std::string& why, Point at) {
    if (gave_up.empty()) {
      gave_up = why;
      gave_up_at = at;
    }
  }
};

/// @brief Points of the loops, from those of the edges.
FaceGrid make_face_border(const Brep& brep, const BrepFace& face, const Array<EdgeId, EdgePoints>& edges);

/// @brief Which charts a face is filled in. even: those that are near lengths in space; flat: seen from above, for
/// faces that are almost plane, whatever their parameters do; any: by whole sides, however far from lengths in space;
/// cut_off: the same, with tips cut off where a face is far longer than wide.
enum class ChartWay : std::uint8_t { even, flat, any, cut_off };

/// @brief Fill a face in charts of its parameter plane (see chart.hpp). Says in gave_up why it could not.
void grid_mapped(const BrepFace& face, const WantedSize& size, const BrepOptions& options, ChartWay way, FaceGrid& grid,
                 Context& context);

/// @brief Fill a face by the front on discrete surfaces, over a fine triangulation of it; new points are put on the
/// face's surface.
void grid_directly(const Brep& brep, const BrepFace& face, const Array<EdgeId, EdgePoints>& edges,
                   const WantedSize& size, FaceGrid& grid, Context& context);

/// @brief Normals of triangles against those of the surface at their corners, and distances of middles.
/// @param tolerance  of the face's edges: triangles about as low as that are not asked for their normal
void check_face_grid(const BrepFace& face, double most_angle, double tolerance, FaceGrid& grid);

}  // namespace delfront
