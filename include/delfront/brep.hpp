// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/ids.hpp"
#include "delfront/mesh.hpp"
#include "delfront/model.hpp"
#include "delfront/planar.hpp"
#include "delfront/point.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief A place on a curve, and how it goes on: derivatives by the parameter.
struct CurveDerivatives {
  Point at, first, second;
};

/// @brief A smooth curve in space, t -> place. Immutable and safe to ask from several threads, as all classes here.
class SmoothCurve {
 public:
  virtual ~SmoothCurve() = default;
  virtual CurveDerivatives derivatives(double t) const = 0;
  virtual Point at(double t) const { return derivatives(t).at; }
  /// @brief Where it has places; an edge uses a part of it.
  virtual std::array<double, 2> range() const = 0;
  /// @brief Whether it ends where it begins, smoothly.
  virtual bool is_closed() const { return false; }
};

/// @brief A place on a curve in a parameter plane, and its derivatives.
struct ParameterCurveDerivatives {
  Point2 at, first, second;
};

/// @brief A curve in the parameter plane of a surface, t -> (u, v).
class ParameterCurve {
 public:
  virtual ~ParameterCurve() = default;
  virtual ParameterCurveDerivatives derivatives(double t) const = 0;
  virtual Point2 at(double t) const { return derivatives(t).at; }
};

/// @brief A place on a surface and its derivatives to second order.
struct SurfaceDerivatives {
  Point at, u, v, uu, uv, vv;
};
/// @brief A place on a surface and its tangents along the parameters.
struct SurfaceTangents {
  Point at, u, v;
};

/// @brief A box in the parameter plane; sides may be infinite.
struct ParameterBox {
  Point2 low, high;
};

/// @brief Sides of the parameter box that are one point in space: poles, tips.
struct DegenerateSides {
  bool u_low = false, u_high = false, v_low = false, v_high = false;
};

/// @brief A smooth surface, (u, v) -> place: what a face is cut from.
///
/// Parameters may run on over a period (an unwrapped plane). The normal is that of du x dv.
class SmoothSurface {
 public:
  virtual ~SmoothSurface() = default;
  virtual SurfaceDerivatives derivatives(Point2 uv) const = 0;
  virtual SurfaceTangents tangents(Point2 uv) const;
  virtual Point at(Point2 uv) const { return tangents(uv).at; }
  virtual ParameterBox box() const = 0;
  /// @brief In u and in v; 0: none.
  virtual std::array<double, 2> period() const { return {0, 0}; }
  virtual DegenerateSides degenerate_sides() const { return {}; }
  /// @brief Unit normal; on a degenerate side its limit along that line of the other parameter.
  virtual Point normal(Point2 uv) const;
  /// @brief Parameters of the place nearest to p, from a start near it: Newton's method, within the box where there is
  /// no period. The answer is as near as the start at least.
  virtual Point2 closest(Point p, Point2 start) const;
};

/// @brief The larger of the principal curvatures' magnitudes, 1 / length; 0 where the mapping is degenerate.
double largest_curvature(const SurfaceDerivatives& s);

using CornerId = Id<struct CornerTag>;
using EdgeId = Id<struct EdgeTag>;
using FaceId = Id<struct FaceTag>;

/// @brief A point that the grid has: becomes a corner of Model where it is named or a curve of Model ends in it.
struct BrepCorner {
  Point at;
  std::string name;
  double tolerance = 0;  ///< of it and the ends of edges there; below the Brep's: that
};

/// @brief A part of a smooth curve between two corners, or a closed one: becomes a curve of Model.
struct BrepEdge {
  std::shared_ptr<const SmoothCurve> curve;  ///< null: degenerate
  std::array<double, 2> range{0, 1};         ///< of the curve, and of all parameter curves of the edge
  std::array<CornerId, 2> corners{};  ///< at the range's ends; twice the same: closed there; both invalid: closed,
                                      ///< without a corner
  std::string name;
  double tolerance = 0;  ///< between the curve and faces' surfaces along it; below the Brep's: that
  bool is_degenerate() const { return curve == nullptr; }  ///< one point in space, a line in the parameter plane
};

/// @brief An edge as one side of a loop.
struct BrepUse {
  EdgeId edge;
  std::shared_ptr<const ParameterCurve> curve;  ///< where the edge lies in the face's plane, at the same t
  bool is_reversed = false;                     ///< the loop runs from the edge's end to its beginning
};

/// @brief A part of a surface, bounded by loops.
///
/// Loops run with the face to their left in the plane (u, v), and close there: that of a periodic surface is unwrapped,
/// a seam edge is used twice, one period apart; a pole is a degenerate edge.
struct BrepFace {
  std::shared_ptr<const SmoothSurface> surface;
  bool is_reversed = false;  ///< its triangles face against the surface's normal
  std::vector<std::vector<BrepUse>> loops;
  std::string name;                   ///< faces of one name are one patch of Model
  std::string kind;                   ///< of the patch: "wall", …
  std::array<RegionId, 2> regions{};  ///< behind it, out of which its triangles face, and ahead of it; invalid: none,
                                      ///< or not known
  double tolerance = 0;               ///< between the surface and its edges; below the Brep's: that
};

/// @brief Smooth geometry, bounded: what CAD, splines and analytic shapes give (D1).
///
/// Corners, edges and faces are what corners, curves and patches are in Model, which grid_brep() makes of them.
struct Brep {
  Array<CornerId, BrepCorner> corners;
  Array<EdgeId, BrepEdge> edges;
  Array<FaceId, BrepFace> faces;
  std::vector<std::string> regions;  ///< names of what the faces bound, where that is known; some may be empty
  double tolerance =
      0;  ///< between what should coincide; 0: 1e-9 of the diagonal; corners, edges and faces may have more
};

/// @brief What makes a Brep unfit for gridding: ids that do not exist, ranges, loops that do not close, parameter
/// curves that disagree with their edge.
/// @throws InputError  the first of it, with its edge or face and place
void check_brep(const Brep& brep);

struct BrepOptions {
  /// @brief How faces are gridded. choose: by even charts, and in other ways where those fail.
  enum class Method : std::uint8_t { choose, mapped, direct };
  Method method = Method::choose;
  double most_turn_deg = 40;     ///< sides are so short that neither edges nor surfaces turn by more along them
  double normal_angle_deg = 90;  ///< a triangle whose normal differs by more from a corner's is a failure
  int smoothing_passes = 6;
  bool checks_crossings = true;   ///< the whole surface, exactly
  bool keeps_parameters = false;  ///< BrepGridReport::corner_uv is filled
  double least_size = 0;          ///< of sides that are made shorter for their turn, or beside short edges
  /// @brief What is narrower is gridded across: tiny edges, sliver faces, borders that touch; 0: nothing is.
  double bridge_below = 0;
  int most_rounds = 8;  ///< of gridding with lower sizes where a face or the whole failed
};

/// @brief One face's grid.
struct BrepFaceReport {
  std::string name;
  bool is_mapped = false;  ///< else directly in space
  std::string why;         ///< even charts were not taken, or failed
  std::size_t triangles = 0;
  double min_angle_deg = 180;
};

/// @brief A place that was gridded across, as too narrow for its triangles.
struct BrepBridge {
  Point at;
  double width = 0;  ///< how far the geometry is moved there
};

/// @brief What grid_brep() made.
struct BrepGridReport {
  std::size_t triangles = 0, points = 0;
  double min_angle_deg = 0, mean_min_angle_deg = 0;
  std::size_t below_25_deg = 0;         ///< triangles with an angle under 25 degrees
  double largest_distance = 0;          ///< of triangles' middles from their surface
  double largest_normal_angle_deg = 0;  ///< between a triangle and its surface at one of its corners
  std::size_t rounds = 0;               ///< of gridding; sizes are lowered where the one before failed
  std::size_t sizes_lowered = 0;
  std::vector<BrepFaceReport> faces;  ///< one of no triangles is bridged
  std::vector<BrepBridge> bridges;
  /// One a point of the model: the corner, edge or face of the Brep that it lies on; t is in u for edges.
  std::vector<VertexEntity> entity;
  /// One a triangle, where asked for: the parameters of its corners in the plane of its face. Those of a pole say
  /// nothing along the degenerate side; a seam's may be a period off those of the other corners.
  std::vector<std::array<Point2, 3>> corner_uv;
};

/// @brief Grid smooth geometry: triangles whose points lie on it, sides as long as the size field asks (F3, F4).
///
/// Edges are divided first, by the integral of 1 / h along them; faces that share one share its points. A face is
/// filled by the planar front in its parameter plane (near a pole: in polar coordinates round it) with the metric
/// J^T J / h^2, then smoothed and flipped in space, with exact validity in the plane. Where its mapping is too bad for
/// that, it is seen from above if it is almost flat, or gridded with a metric of whole sides, or the front on discrete
/// surfaces grids a fine triangulation of it, whose new points are then put on the surface.
/// Model::input_face is the face of a triangle.
/// @param size  wanted sides; metrics are not used
/// @throws InputError    the Brep is not valid (see check_brep)
/// @throws MeshingError  a face has no valid grid even with lower sizes (place and reason)
/// @par Source   Löhner (2008), 2.6, 3.6
/// @par Threads  faces in parallel; the same grid for any number
Model grid_brep(const Brep& brep, const SizeField& size, const BrepOptions& options, BrepGridReport& report,
                Context& context);

}  // namespace delfront
