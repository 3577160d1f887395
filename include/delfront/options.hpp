// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "delfront/point.hpp"

namespace delfront {

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

struct BoundaryOptions {
  std::string name;         ///< table key: boundaries.<name>
  std::string select;       ///< name pattern with * and ?; empty: the patch of that name
  std::string kind;         ///< wall patch inlet outlet farfield symmetry empty wedge cyclic interface
  std::string set_at = {};  ///< as Options::set_at
};

struct SizeOptions {
  std::optional<Length> hmin, hmax;
  std::optional<double> growth;  ///< > 1; absent: 1.2, and cells no larger than the largest boundary edges
};

/// @brief Grids in the plane.
struct PlanarOptions {
  std::string boundary = "keep";  ///< keep: the given points and no others; split: divided where sizes ask for it
  double min_angle = 30;          ///< degrees, goal
};

struct VolumeOptions {
  std::string method = "delaunay";  ///< delaunay none
  bool core = true;                 ///< a regular lattice where sizes are at their largest, far from the boundary
};

struct ImproveOptions {
  bool enabled = true;
  double min_dihedral = 15;  ///< degrees, goal
  double max_nonortho = 65;  ///< degrees, goal
  int max_passes = 8;
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
  std::string report;       ///< JSON
  std::string defects;      ///< VTP
  std::string require;      ///< gates
  bool ascii = false;       ///< text instead of binary, where a format has both
  bool compress = false;    ///< VTK XML: zlib
  std::string msh_version;  ///< "", "2.2" or "4.1"
};

/// @brief The whole job: the job file's tree, field for field.
struct Options {
  InputOptions input;
  DomainOptions domain;
  std::vector<BoundaryOptions> boundaries;
  SizeOptions size;
  VolumeOptions volume;
  PlanarOptions planar;
  ImproveOptions improve;
  LimitOptions limits;
  OutputOptions output;
  std::string stop_after;  ///< last stage to run: "" all, geometry, surface, volume, improve, write
  /// Where a key was set, for messages: "case.toml:12", "--hmax"; entries of lists as "output.files[0]" too.
  std::map<std::string, std::string> set_at = {};
};

}  // namespace delfront
