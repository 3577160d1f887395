// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delfront/ids.hpp"
#include "delfront/point.hpp"

namespace delfront {

class SizeField;

/// @brief A length as a person types it: "5", "2 mm", "5%" (of the bounding-box diagonal), "20c" (longest side).
struct Length {
  double value = 0;
  std::string unit;  ///< "", "m", "mm", "in", "ft", "%", "c"
};

/// @brief Geometry a length may refer to: the input before any far field.
struct LengthScale {
  double diagonal = 0;
  double longest_side = 0;
  double metres_per_unit = 0;  ///< 0: model units are not known, and m, mm, in, ft are refused
};

/// @throws UsageError  malformed, not finite, or an unknown unit
Length parse_length(const std::string& text);
/// @throws UsageError  a length in m, mm, in, ft while the unit of the model is not known
double resolve_length(const Length& length, const LengthScale& scale);

struct InputOptions {
  std::vector<std::string> files;
  std::string units = "auto";  ///< auto m mm in ft
  double feature_angle = 40;   ///< degrees
};

/// @brief An outer boundary made by us around the input.
struct EncloseOptions {
  std::string shape = "none";                    ///< none box sphere
  Length size;                                   ///< sphere: radius; box: half side
  std::optional<std::array<double, 6>> corners;  ///< box given as xmin,ymin,zmin,xmax,ymax,zmax instead
  std::string name = "farfield";
  std::optional<Length> h;  ///< its triangles' side; default from its size
};

struct DomainOptions {
  EncloseOptions enclose;
  std::string keep;  ///< "" default (all bounded regions; with a far field the outside), "largest", "all", "outside"
  std::vector<Point> keep_points;  ///< seeds: only the regions that hold one of these
};

/// @brief A boundary of the grid, and what it is made of; one way to select, at most.
struct BoundaryOptions {
  std::string name;                       ///< table key: boundaries.<name>
  std::vector<std::string> select;        ///< name patterns with * and ?; empty: the patch of that name
  std::string kind;                       ///< wall patch inlet outlet farfield symmetry empty wedge cyclic interface
  std::string set_at = {};                ///< as Options::set_at
  std::vector<std::uint32_t> faces = {};  ///< of smooth geometry, from 1 as `info` counts them
  std::optional<Point> normal = {};       ///< faces of smooth geometry that look this way all over, within 5 degrees
  std::vector<std::string> colours = {};  ///< faces of a CAD file that have one of them, RRGGBB in capitals
  std::optional<Box> box = {};            ///< faces of smooth geometry that lie in it, model units
  std::vector<Point> near = {};           ///< faces of smooth geometry that are nearest to these places
  std::string expression = {};            ///< faces of smooth geometry where this formula in x, y, z is true all over

  /// @brief What patches are selected by: patterns of names.
  std::vector<std::string> patterns() const { return select.empty() ? std::vector{name} : select; }
  /// @brief Whether faces of smooth geometry are selected, rather than patches by name.
  bool selects_faces() const {
    return !faces.empty() || normal || !colours.empty() || box || !near.empty() || !expression.empty();
  }
};

/// @brief Sizes by formulas in x, y, z, pi, e and distance("name") (S2); empty: not asked for.
struct ExpressionOptions {
  std::string delta;                      ///< size, model units
  std::string s1, s2;                     ///< stretchings
  std::array<std::string, 3> first = {};  ///< their directions
  std::array<std::string, 3> second = {};
};

/// @brief Turning and stretching that sources and formulas may have (spec S; lengths are delta s1, delta s2, delta).
struct StretchOptions {
  double s1 = 1, s2 = 1;
  Point first{1, 0, 0}, second{0, 1, 0};
};

struct MotionOptions {
  Point velocity, centre, axis;  ///< model units a time unit; axis of turning, any length
  double rate = 0;               ///< degrees a time unit
};

/// @brief One entry of [[size.source]] (S4).
struct SourceOptions {
  std::string type;       ///< point line polyline triangle surface
  std::vector<Point> at;  ///< point: any number, line: 2, polyline: 2 or more, triangle: 3
  std::string file;       ///< surface: a file of facets
  std::optional<Length> delta0;
  Length r0;
  std::optional<Length> r1;  ///< absent (and no law): the size rises as fast as growth lets it
  std::string law;           ///< power exponential polynomial; empty: power where r1 is given
  double gamma = 1;
  std::vector<double> coefficients;  ///< of the polynomial
  std::optional<StretchOptions> stretch;
  std::optional<MotionOptions> motion;
  std::string group;
};

/// @brief One entry of [[size.box]] (S3): a constant size in a region, growing outside of it.
struct SizeBoxOptions {
  std::string shape = "box";      ///< box sphere cylinder cone surface
  std::optional<Point> min, max;  ///< box
  std::optional<Point> centre;    ///< sphere
  std::optional<Point> from, to;  ///< cylinder, cone: ends of the axis
  std::optional<Length> radius;   ///< sphere, cylinder; cone: at `from`
  Length radius_to;               ///< cone: at `to`
  std::string file;               ///< surface: a closed one
  std::optional<Length> h;
};

/// @brief [size.on.NAME] (S7): the size on patches, curves and corners of that name.
struct SizeOnOptions {
  std::string name;  ///< a pattern with * and ?
  std::optional<Length> h;
};

/// @brief Sizes at the nodes of a grid (S6).
struct BackgroundFileOptions {
  std::string file;
  std::string size;    ///< a scalar field; empty, and no metric: the field "h", or the only one there is
  std::string metric;  ///< a tensor field instead
  std::string combine = "min";
  double factor = 1;
};

/// @brief Sizes from fields of a solution (S12).
struct SolutionFileOptions {
  std::string file;
  std::vector<std::string> sensor;    ///< scalar fields
  std::string indicator = "hessian";  ///< hessian error
  double norm = 2;                    ///< p of L^p
  double complexity = 0;              ///< wanted; 0: not set
  double hgrad = 1.5;                 ///< growth of what it asks for
  double error = 0.1;                 ///< wanted value of the error indicator, 0 to 1
  bool stretched = false;             ///< metrics; methods without stretched cells take their least size
};

/// @brief Cells across gaps and between lines that come close (S10).
struct GapOptions {
  double cells = 0;  ///< 0: not asked for
  std::optional<Length> hmin;
};

/// @brief All that is asked for, kept on a grid of tetrahedra (triangles in the plane) that is refined to it (S8).
struct AdaptiveGridOptions {
  std::size_t cells = 0;      ///< along the longest side at first; 0: not asked for
  double refine_above = 1.5;  ///< a cell is refined whose least size is more than this times one wanted in it
  bool smooth = false;        ///< sizes on it are smoothed, never above what is asked for
};

struct SizeOptions {
  std::optional<Length> hmin, hmax;
  std::optional<double> growth;     ///< > 1; absent: 1.2, and cells no larger than the largest boundary edges
  double curvature = 0;             ///< cells per 2 pi; 0: not asked for
  double angle = 0;                 ///< degrees between neighbouring faces; 0: not asked for
  std::string angle_form = "sine";  ///< sine, exact for inscribed faces; tangent: eq. 3.20
  std::optional<Length> deviation;  ///< of chords from the surface
  std::string accuracy;             ///< coarse medium fine: the numbers of all that is not given (AccuracyNumbers)
  /// curvature, gap and proximity with their defaults, where they are not given; absent: of smooth geometry, or where
  /// accuracy is given
  std::optional<bool> automatic;
  GapOptions gap;
  GapOptions proximity;  ///< of curves within a patch
  ExpressionOptions expression;
  BackgroundFileOptions background;
  SolutionFileOptions solution;
  AdaptiveGridOptions adaptive;
  std::vector<SourceOptions> sources;
  std::vector<SizeBoxOptions> boxes;
  std::vector<SizeOnOptions> on;
  std::vector<std::string> without;  ///< groups of sources that are left out
  double time = 0;                   ///< for sources that move
  /// No key: fields of the program that calls; they need not keep to the growth, nor have good lower bounds.
  std::vector<std::shared_ptr<const SizeField>> fields = {};
  double steeper = 1;  ///< no key: sizes rise so many times as fast as growth says (see coarse_options)
};

/// @brief One entry of [[planar.curve]] (D5): a line of the boundary, or in a region, given by points.
struct PlanarCurveOptions {
  std::string name;
  std::string type = "spline";  ///< spline: smooth through the points; line: straight between them
  std::vector<Point> at;        ///< z = 0
  bool closed = false;          ///< from the last point to the first
  std::optional<Length> h;      ///< of its pieces; absent: as the points lie apart (line: from point to point)
};

/// @brief Grids in the plane.
struct PlanarOptions {
  std::vector<PlanarCurveOptions> curves;  ///< beside those of the files
  /// front: a pure advancing front; front-delaunay: its points, connected by Delaunay; delaunay: circumcentres
  std::string method = "front-delaunay";
  std::string boundary = "keep";  ///< keep: the given points and no others; split: divided where sizes ask for it
  double min_angle = 30;          ///< degrees, goal
};

/// @brief How the surface that is given becomes the boundary of the grid.
struct SurfaceOptions {
  /// keep: triangle for triangle; front, delaunay: gridded anew to the sizes asked for. Of smooth geometry keep and
  /// mapped: through its parameters; front: in space
  std::string method = "keep";
  bool bridge = true;              ///< smooth geometry: across what is narrower than hmin (BrepOptions::bridge_below)
  std::vector<PatchId> kept = {};  ///< patches that keep their triangles all the same; set by the run
};

struct VolumeOptions {
  std::string method = "front-delaunay";  ///< front front-delaunay delaunay none
  bool core = true;                       ///< a regular lattice where sizes are at their largest, far from the boundary
};

struct ImproveOptions {
  bool enabled = true;
  double min_dihedral = 15;  ///< degrees, goal
  double max_nonortho = 65;  ///< degrees, goal
  int max_passes = 8;
};

/// @brief Coarse at first, then every edge halved (F19).
struct LevelOptions {
  int levels = 0;        ///< times; sizes of the grid before are 2^levels those asked for
  std::string geometry;  ///< file on whose surface (in the plane: lines) new boundary points are put
};

struct LimitOptions {
  double time = 0;           ///< seconds, 0: none
  std::uint64_t memory = 0;  ///< bytes, 0: none
  std::uint64_t max_cells = 0;
};

struct OutputOptions {
  std::vector<std::string> files;
  std::string format;       ///< overrides the extension
  std::string units;        ///< "", or m mm in ft: rescale on output
  std::string report;       ///< JSON; NAME.html: a page to read, and the JSON as NAME.json beside it
  std::string defects;      ///< VTP
  std::string require;      ///< gates
  bool ascii = false;       ///< text instead of binary, where a format has both
  bool compress = false;    ///< VTK XML: zlib
  bool sizes = false;       ///< the wanted size at each point, as the field "h"
  std::string msh_version;  ///< "", "2.2" or "4.1"
  std::string solver;       ///< "", or su2 openfoam: starter files beside the outputs of that format
};

/// @brief The whole job: the job file's tree, field for field.
struct Options {
  InputOptions input;
  DomainOptions domain;
  std::vector<BoundaryOptions> boundaries;
  SizeOptions size;
  SurfaceOptions surface;
  VolumeOptions volume;
  PlanarOptions planar;
  ImproveOptions improve;
  LevelOptions refine;
  LimitOptions limits;
  OutputOptions output;
  std::string stop_after;  ///< last stage to run: "" all, geometry, surface, volume, improve, write
  /// Where a key was set, for messages: "case.toml:12", "--hmax"; entries of lists as "output.files[0]" too.
  std::map<std::string, std::string> set_at = {};
};

}  // namespace delfront
