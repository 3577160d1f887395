// SPDX-License-Identifier: Apache-2.0
// What the module libdelfront_cad.so hands over: plain data, and evaluators of what has no class here. Both sides are
// built from this header by one compiler; the version and sizes are compared when the module is loaded.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "delfront/brep_shapes.hpp"
#include "delfront/cad.hpp"
#include "delfront/nurbs.hpp"

namespace delfront::cad {

inline constexpr int kInterfaceVersion = 2;

/// Evaluators never throw: what fails gives not a number. From several threads at once.
struct OtherCurve {
  virtual ~OtherCurve() = default;
  virtual CurveDerivatives derivatives(double t) const noexcept = 0;
};
struct OtherParameterCurve {
  virtual ~OtherParameterCurve() = default;
  virtual ParameterCurveDerivatives derivatives(double t) const noexcept = 0;
};
struct OtherSurface {
  virtual ~OtherSurface() = default;
  virtual SurfaceDerivatives derivatives(Point2 uv) const noexcept = 0;
};

struct CurveData {
  enum class Kind { none, line, ellipse, nurbs, other } kind = Kind::none;
  SpaceFrame frame;                         ///< line: origin + t x; ellipse: in the plane of x and y
  double a = 0, b = 0;                      ///< ellipse: half axes; a circle where they are the same
  NurbsCurveData nurbs;                     ///< nurbs
  std::shared_ptr<const OtherCurve> other;  ///< other, and nurbs where the range goes beyond its knots
  std::array<double, 2> range{0, 0};        ///< other: where it has places
};

struct ParameterCurveData {
  enum class Kind { line, ellipse, nurbs, other } kind = Kind::line;
  Point2 origin, x, y;   ///< line: origin + t x; ellipse: origin + cos t x + sin t y
  NurbsCurveData nurbs;  ///< z is 0
  std::shared_ptr<const OtherParameterCurve> other;
};

struct SurfaceData {
  enum class Kind { plane, cylinder, cone, sphere, torus, nurbs, extrusion, revolution, other } kind = Kind::plane;
  SpaceFrame frame;     ///< may be left-handed; revolution: z the axis; extrusion: z the way
  double a = 0, b = 0;  ///< radius; torus: and of the tube; cone: radius at v = 0 and half angle, of any sign
  NurbsSurfaceData nurbs;
  CurveData curve;  ///< extrusion: curve(u) + v z; revolution: curve(v) turned by u
  std::shared_ptr<const OtherSurface> other;
  ParameterBox box;                    ///< sides may be infinite
  std::array<double, 2> period{0, 0};  ///< as the file says
  DegenerateSides degenerate;          ///< other: sides that are points
};

struct Vertex {
  Point at;
  double tolerance = 0;
  std::string name;
};

struct Edge {
  CurveData curve;  ///< none: degenerate
  std::array<double, 2> range{0, 1};
  std::array<int, 2> corners{-1, -1};
  double tolerance = 0;
  std::string name;
};

struct Use {
  int edge = 0;
  ParameterCurveData curve;
  bool has_curve = true;  ///< else it is to be found by projection
  bool is_reversed = false;
};

struct Face {
  SurfaceData surface;
  bool is_reversed = false;
  std::vector<std::vector<Use>> loops;  ///< uses in the order of the file's wire
  double tolerance = 0;
  std::string name;  ///< as the grid will have it
  CadFace facts;
  std::array<int, 2> regions{-1, -1};  ///< behind it, out of which its normal points, and ahead; -1: none of them
};

struct Request {
  const char* path = "";
  CadOptions options;
  /// @return whether to go on; called from the reading thread. fraction < 0: not known
  bool (*progress)(void* user, const char* what, double fraction) = nullptr;
  void* user = nullptr;
};

struct Result {
  enum class Ending { done, failed, stopped } ending = Ending::failed;
  std::string error;  ///< failed: a sentence
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
  std::vector<Face> faces;
  std::vector<std::string> regions;  ///< names of the solids, in the order of the file; some may have none
  CadReport report;                  ///< all but faces
};

struct ModuleInfo {
  int version;
  std::size_t request_size, result_size, face_size;
  const char* library;  ///< e.g. OpenCASCADE 7.6.3
  Result* (*read)(const Request*);
  void (*release)(Result*);
};

/// The one symbol of the module.
inline constexpr const char* kEntryPoint = "delfront_cad_module";
using EntryPoint = const ModuleInfo* (*)();

}  // namespace delfront::cad
