// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "delfront/brep.hpp"
#include "delfront/nurbs.hpp"

namespace delfront {

/// Smooth geometry as text (D1): TOML files NAME.geom.toml of corners, edges, surfaces and faces, or of whole shapes.
/// Every key with an example: docs/geometry.md. Angles are degrees here. Lines of the file stand with everything that
/// came from one, and do not count in comparisons.

/// @brief The suffix of such files.
inline constexpr const char* kGeometrySuffix = ".geom.toml";
bool is_geometry_file(const std::string& path);

/// @brief Where in its file something stands; 0: nowhere.
struct TextLine {
  int number = 0;
  friend bool operator==(const TextLine&, const TextLine&) { return true; }
};

/// @brief Where round and flat things stand.
struct TextFrame {
  Point origin;
  Point axis{0, 0, 1};     ///< any length
  std::optional<Point> x;  ///< where angles begin, square to the axis; absent: (1, 0, 0) where that is, else some way
  friend bool operator==(const TextFrame&, const TextFrame&) = default;
};

struct TextCorner {
  std::string name;
  Point at;
  TextLine line;
  friend bool operator==(const TextCorner&, const TextCorner&) = default;
};

/// @brief An edge; which of the fields count is a matter of its type.
struct TextEdge {
  std::string name;
  std::string type;                            ///< line circle ellipse nurbs interpolated on
  std::string from, to;                        ///< corners; both empty: closed, or corners are made
  TextFrame frame;                             ///< circle, ellipse
  double radius = 0;                           ///< circle
  std::array<double, 2> radii{0, 0};           ///< ellipse
  std::optional<std::array<double, 2>> range;  ///< circle, ellipse: degrees; nurbs: parameters
  int degree = 3;                              ///< nurbs
  std::vector<double> knots, weights;          ///< nurbs; empty: even, clamped; all 1
  std::vector<Point> points;                   ///< nurbs: control points; interpolated: what it goes through
  bool closed = false;                         ///< interpolated
  std::string surface;                         ///< on: which
  std::vector<std::array<double, 2>> uv;       ///< on: two places, straight between; more: smooth through them
  TextLine line;
  friend bool operator==(const TextEdge&, const TextEdge&) = default;
};

/// @brief A surface; which of the fields count is a matter of its type.
struct TextSurface {
  std::string name;
  std::string type;  ///< plane cylinder cone sphere torus nurbs interpolated
  TextFrame frame;
  double radius = 0, tube = 0, half_angle = 0;  ///< cylinder, sphere, torus; torus; cone
  std::array<int, 2> degree{3, 3};              ///< nurbs
  std::vector<double> knots_u, knots_v;         ///< nurbs; empty: even, clamped
  std::vector<std::vector<Point>> points;       ///< nurbs: rows along v, one after the other along u
  std::vector<std::vector<double>> weights;     ///< nurbs; empty: all 1
  std::vector<std::vector<Point>> sections;     ///< interpolated
  bool closed = false;                          ///< interpolated: sections are
  int degree_across = 3;                        ///< interpolated
  TextLine line;
  friend bool operator==(const TextSurface&, const TextSurface&) = default;
};

/// @brief An edge in a loop. Without a parameter curve of its own it is projected on the surface.
struct TextUse {
  std::string edge;
  bool is_reversed = false;               ///< written "-edge"
  std::vector<std::array<double, 2>> uv;  ///< straight from the first place to the second, from its edge's beginning
  int degree = 3;                         ///< of a spline instead, with the same range as the edge
  std::vector<double> knots, weights;
  std::vector<std::array<double, 2>> points;
  TextLine line;
  friend bool operator==(const TextUse&, const TextUse&) = default;
};

struct TextFace {
  std::string name, kind;  ///< of the patch
  std::string surface;
  bool reversed = false;                    ///< faces against the surface's normal
  std::vector<std::vector<TextUse>> loops;  ///< the outer one first, either way round; none: the whole surface
  TextLine line;
  friend bool operator==(const TextFace&, const TextFace&) = default;
};

/// @brief A whole closed shape, facing outwards.
struct TextShape {
  std::string type;  ///< sphere box cylinder cone torus
  std::string name, kind;
  TextFrame frame;    ///< sphere: origin is the centre; cone: the tip, the axis points to the base
  double radius = 0;  ///< sphere, cylinder, torus (of its middle line); cone: of the base
  double tube = 0, height = 0;
  Point min, max;         ///< box
  bool reversed = false;  ///< faces inwards: a hole in a body round it
  TextLine line;
  friend bool operator==(const TextShape&, const TextShape&) = default;
};

/// @brief A file of geometry.
struct GeometryText {
  double tolerance = 0;  ///< as Brep::tolerance
  std::vector<TextCorner> corners;
  std::vector<TextEdge> edges;
  std::vector<TextSurface> surfaces;
  std::vector<TextFace> faces;
  std::vector<TextShape> shapes;
  friend bool operator==(const GeometryText&, const GeometryText&) = default;
};

/// @param file  for messages
/// @throws InputError  not TOML; an unknown key, a value of the wrong kind, a missing one: file, line, what to try
GeometryText parse_geometry(const std::string& text, const std::string& file);
/// @throws InputError  cannot be read, as parse_geometry
GeometryText read_geometry(const std::string& path);

/// @brief In one canonical form: parse_geometry of it gives the same again, and so the same text.
std::string to_text(const GeometryText& geometry);
/// @throws IoError  cannot be written
void write_geometry(const GeometryText& geometry, const std::string& path);

/// @brief What the text describes: curves and surfaces are made, edges projected where loops have no parameter curves,
/// loops unwrapped over seams and turned the right way, poles filled in, corners made where edges have none.
/// @throws InputError  names that do not exist, knots, weights, edges off their corners or surfaces, loops that are
/// open
Brep build_brep(const GeometryText& geometry, const std::string& file);

/// @brief Whether a shape is reversed.
bool has_holes(const GeometryText& geometry);

struct NamedGeometry {
  GeometryText text;
  std::string file;  ///< for messages
};

/// @brief What is gridded together: each reversed shape must be a hole in a body. By boxes alone: the innermost one
/// round that of the hole belongs to a shape that is not reversed, to faces of a file, or is one of the bodies.
/// @param bodies  boxes of other input
/// @throws InputError  one lies in no body: file, line, what to try
void check_holes(const std::vector<NamedGeometry>& files, const std::vector<Box>& bodies);

}  // namespace delfront
