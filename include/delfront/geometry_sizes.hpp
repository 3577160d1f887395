// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/model.hpp"
#include "delfront/point.hpp"
#include "delfront/size_sources.hpp"

namespace delfront {

/// Sizes that follow from the model. Each way yields sources for build_source_size_field(): points, segments and
/// triangles with a constant size on them (law: step), which the growth of that field spreads into the volume (3.15).

/// @brief What a way of sizing gave.
struct GeometrySizeReport {
  std::size_t num_sources = 0;
  std::size_t num_at_hmin = 0;  ///< sources that would be smaller, were it not for hmin
  double smallest = std::numeric_limits<double>::infinity();
  Point smallest_at;
};

struct GeometrySources {
  std::vector<SizeSource> sources;
  GeometrySizeReport report;
  void append(GeometrySources&& other);
};

/// @brief Sources much smaller than their size, of sizes within 25 % in one cell of half that size, become one: a ball
/// round them all with the least of their sizes. So do segments from one such cell to another. So no size rises
/// anywhere; what falls does so within a size of there. Fine facets of a smooth surface are many more sources than
/// their sizes need: jobs merge those from curvature, gaps and lines.
/// @return how many are gone; the report's num_sources is what is left, num_at_hmin stays what it was
/// @par Cost  O(n log n)
std::size_t merge_close_sources(GeometrySources& found);

/// @brief A size on everything whose name fits a pattern: patches, curves, corners (S7).
struct NamedSize {
  std::string pattern;  ///< * any letters, ? one letter; else the name
  double h = 0;         ///< > 0, model units
};

/// @throws UsageError  h not positive; a pattern that fits nothing: the names there are, the one probably meant
/// @par Cost  O(n + names * patterns)
GeometrySources find_named_sizes(const Model& model, std::span<const NamedSize> sizes, Context& context);

/// @brief How many cells a curved surface needs (S9). Of several wishes the smallest size counts.
struct CurvatureSizes {
  std::optional<double> cells_per_turn;  ///< n: h = 2 pi r / n
  std::optional<double> angle_deg;       ///< between adjacent faces, in (0, 180)
  std::optional<double> deviation;       ///< d, of an edge from the surface: h = 2 sqrt(2 r d - d^2)
  enum class Form : std::uint8_t {
    sine,    ///< h = 2 r sin(angle / 2): exact for faces inscribed in the surface
    tangent  ///< h = 2 r tan(angle / 2), eq. 3.20
  };
  Form form = Form::sine;
  double hmin = 0;
  double hmax = std::numeric_limits<double>::infinity();  ///< larger sizes give no source
};

/// @return the size asked for on a surface of radius r; infinite for an infinite radius or without a wish
double size_on_radius(double r, const CurvatureSizes& wish);

/// @brief Sizes from the curvature of the surface and of its feature lines.
///
/// The curvature of a triangle follows from the normals at its corners and from those around: normals are means over
/// the triangles that meet there without a crease, by angle, so that it does not matter how flat facets are cut into
/// triangles. Creases are edges that turn by more than model.feature_angle, or with one or more than two triangles.
///
/// Lines in the plane (a model of curves without triangles): the circle through a vertex and its neighbours, at
/// vertices between two segments that turn by no more than model.feature_angle.
/// @throws UsageError  n < 1, an angle outside of (0, 180), a deviation or bounds that are not positive, hmin > hmax
/// @par Cost  O(n)
/// @par Source  Löhner (2008), 3.2.8, eq. 3.20; tensor fit after Rusinkiewicz (2004)
GeometrySources find_curvature_sizes(const Model& model, const CurvatureSizes& wish, Context& context);

/// @brief The rule for a grid that exists: h_p = h_g f(angle_p / 2) / f(angle_g / 2), f sine or tangent (eq. 3.21).
struct FaceAngleSizes {
  double angle_deg = 15;  ///< wanted between adjacent faces
  CurvatureSizes::Form form = CurvatureSizes::Form::sine;
  double least_ratio = 0.5;  ///< h_p is no less than this times h_g: one pass lowers sizes by no more
  double hmin = 0;
};

/// @brief Sizes from the angles between the faces of a grid; a source for each edge that turns more than wanted (S9,
/// for the loop S13). Creases are left out; h_g is the mean height of both triangles over the edge.
/// @throws UsageError  options out of range
GeometrySources find_face_angle_sizes(const Model& grid, const FaceAngleSizes& wish, Context& context);

/// @brief Cells across gaps between faces (S10).
struct GapSizes {
  double cells = 1;  ///< wanted across, > 0
  double hmin = 0;   ///< 0: 1e-3 of the diagonal of the surface's box
  double hmax = std::numeric_limits<double>::infinity();
  enum class Side : std::uint8_t {
    behind,  ///< against the normals: the bodies that the surface encloses
    ahead,   ///< the space around them
    both
  };
  Side side = Side::behind;
  double facing_deg = 45;  ///< faces whose normals are farther from opposite are no gap
  /// Whether a place lies in what is gridded: asked of the middle of each gap, which counts only then. Called from
  /// several threads at once. Empty: all places do. `find_line_gap_sizes` does not ask.
  std::function<bool(Point)> is_kept = {};
};

/// @brief From places on each triangle, rays along its normal and 30 degrees round it; the first face met, where it
/// faces the triangle, is the other side of a gap, at its nearest point. Triangles are cut where the gap changes.
/// Sources are the (cut) triangles and segments across the gap.
///
/// Lines in the plane (a model of curves without triangles): the same from places on each segment, to both sides of it
/// whatever `side` says; segments that share an end are no gap. Sources are the (cut) segments and what lies between
/// them and the other side.
/// @throws UsageError  options out of range
/// @par Cost  O(n log n) times the pieces cut
GeometrySources find_gap_sizes(const Model& model, const GapSizes& wish, Context& context);

/// @brief The same between lines across a patch: borders of patches, creases, open edges. From places on each line the
/// patch is walked square to the line, over its triangles, to the next line; `facing_deg` is between the lines'
/// normals.
GeometrySources find_line_gap_sizes(const Model& model, const GapSizes& wish, Context& context);

/// @brief Sizes without any input (S11), merged by merge_close_sources().
struct AutomaticSizes {
  std::optional<double> cells_per_turn = 12;  ///< 30 degrees an edge: a deviation of 3.4 % of the radius
  std::optional<double> gap_cells = 1;        ///< no cell flatter than the gap it lies in; more is a matter of physics
  std::optional<double> line_cells = 1;
  std::vector<NamedSize> named;
  double hmin = 0;  ///< 0: 1e-3 of the diagonal of the surface's box
  GapSizes::Side side = GapSizes::Side::behind;
  std::function<bool(Point)> is_kept = {};  ///< as GapSizes::is_kept
};

/// @brief What a word of size.accuracy stands for, where nothing else is said.
struct AccuracyNumbers {
  double cells_per_turn;   ///< of curved surfaces and edges
  double deviation_share;  ///< of the grid from smooth geometry, of its extent
  double line_cells;       ///< between lines that come close
  double gap_cells;        ///< between faces
  double growth;
  double hmax_share;  ///< of smooth geometry, of its extent
  double hmin_share;  ///< of its extent: of curvature, lines and gaps. Facets: 1e-3 of the diagonal whatever is said
};

/// @param word  coarse, medium, fine; anything else is medium
AccuracyNumbers accuracy_numbers(const std::string& word);

/// @return 1e-3 of the diagonal of the model's surface: the hmin where none is given
double usual_hmin(const Model& model);

GeometrySources find_automatic_sizes(const Model& model, const AutomaticSizes& wish, Context& context);

/// @brief How well a surface grid describes its surface (S13): what the loop over surface grids has to look at.
struct SurfaceLimits {
  double angle_deg = 180;
  double deviation = std::numeric_limits<double>::infinity();
  double line_distance = 0;
  double side = 0;
};

struct SurfaceAccuracy {
  struct Worst {
    double value = 0;
    Point at;
    std::size_t num_beyond = 0;  ///< over the limit (angle, deviation) or under it (distance, side)
  };
  Worst angle_deg;      ///< between neighbours, creases excluded
  Worst deviation;      ///< of a triangle from the surface, estimated from the curvature
  Worst line_distance;  ///< across a patch between lines that face each other; infinite where there are none
  Worst side;           ///< the shortest
};

/// @par Cost  O(n sqrt(n)) at most, for the lines
SurfaceAccuracy measure_surface_accuracy(const Model& grid, const SurfaceLimits& limits, Context& context);

}  // namespace delfront
