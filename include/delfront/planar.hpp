// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "delfront/ids.hpp"
#include "delfront/mesh.hpp"
#include "delfront/options.hpp"
#include "delfront/size_field.hpp"

namespace delfront {

/// @brief A place in the plane, model units.
struct Point2 {
  double x = 0, y = 0;
  friend bool operator==(const Point2&, const Point2&) = default;
};

/// @brief A triangulation of a point set: triangles anticlockwise, neighbours over the side opposite each corner.
struct Triangulation2 {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< (num_triangles, 3) point numbers
  std::vector<std::array<std::uint32_t, 3>>
      neighbours;                   ///< neighbours[t][i] lies opposite triangles[t][i]; kNone: hull
  std::vector<std::uint32_t> hull;  ///< anticlockwise; with the points on its sides
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;  ///< (point, the earlier one at the same place)
};

/// @brief Delaunay triangulation of any set of points in the plane (T4). Exact: no point lies in a triangle's circle.
///
/// Points at one place: the first of them is used. Cocircular points: one of the possible triangulations, always the
/// same for the same points in the same order.
/// @throws InputError  fewer than three distinct points, all on one line, a coordinate not finite or over 2^100
/// @par Cost  O(n log n) in any order of the points; about 0.6 microseconds a point on one core
/// @par Source  Bowyer (1981), Watson (1981); order of insertion: Amenta, Choi & Rote (2003)
Triangulation2 delaunay2(std::span<const Point2> points, Context& context);

/// @brief A named line of the boundary: one or more chains of segments.
struct PlanarCurve {
  std::string name;
  std::string kind;  ///< "wall", "farfield", …; empty: not said
};

/// @brief A place in a region, which names it and may bound its size.
struct PlanarSeed {
  Point2 at;
  std::string name;         ///< empty: not said
  std::optional<double> h;  ///< no side wanted above this in the region, model units
};

/// @brief How inner loops are told from holes where no seed says it.
enum class InnerLoops : std::uint8_t {
  by_direction,  ///< a loop that runs against the one around it bounds a hole; with it: a region of its own
  are_regions,   ///< every bounded part is a region but where `holes` has a seed
};

/// @brief What is to be gridded in the plane: points, segments with names, seeds of holes and regions.
///
/// Segments may form any number of loops, share points, hang in a region (embedded lines) or stand in it free. Points
/// that no segment uses are embedded points. Points on a segment split it. Segments must not cross.
struct PlanarDomain {
  Array<VertexId, Point2> points;
  std::vector<std::array<VertexId, 2>> segments;
  std::vector<CurveId> curve_of_segment;  ///< one a segment
  Array<CurveId, PlanarCurve> curves;
  std::vector<Point2> holes;
  std::vector<PlanarSeed> regions;
  InnerLoops inner_loops = InnerLoops::by_direction;
};

/// @brief Points along the cubic spline with continuous curvature through given points (D5).
///
/// Over the length of the chords; without curvature at open ends, smooth all round where closed. Pieces are about h
/// long and turn by at most about 10 degrees each; the first point, and of an open curve the last, are the given ones.
/// @param closed  the curve goes on from the last point to the first, which is not repeated
/// @param h  length of the pieces, model units; 0: as the given points lie apart
/// @return points of a chain, or of a loop without its first point again
/// @throws InputError  too few points; two in a row are the same
/// @throws LimitError  more pieces than fit, or a limit of the context; its number of cells before a piece is made
std::vector<Point2> sample_spline(std::span<const Point2> through, bool closed, double h,
                                  const Context& context = Context());

/// @brief The whole run in the plane: a domain to a grid of triangles (2-D Mesh: segments are named groups of lines).
///
/// With options.planar.boundary = "keep" the boundary's points are the given ones, bit for bit, in the same order, and
/// no other point lies on it; with "split" segments are divided where sizes or angles ask for it. Sizes come from the
/// boundary and options.size; `asked`, where given, lowers them. options.refine is seen to by run_job.
/// @throws InputError    segments that cross (places), nothing bounded, a coordinate not finite
/// @throws LimitError, Cancelled
/// @par Threads  one; the same grid for any number
/// @par Cost     about 0.4 microseconds a triangle on one core
Outcome generate_planar(const PlanarDomain& domain, const Options& options, Context& context,
                        std::shared_ptr<const SizeField> asked = nullptr);

/// @brief What keeps a domain from being gridded: crossing segments, nothing bounded, each with its places.
/// @return empty for a domain that generate_planar takes
std::vector<Finding> check_planar_domain(const PlanarDomain& domain, Context& context);

/// @brief The domain that a 2-D mesh describes: its lines (with their groups as curves), its points, seeds from groups
/// of points of kind "hole" and "region". Cells are not used. Equal points are merged, the first stays.
/// @throws InputError  no lines; a point off the plane z = 0 or not finite
PlanarDomain build_planar_domain(const std::vector<NamedMesh>& inputs, Context& context);

}  // namespace delfront
